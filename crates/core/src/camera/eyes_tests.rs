use super::*;
use crate::camera::{BrownConrady, Pose};
use crate::random::Random;
use std::f64::consts::PI;

const EYES: f64 = 0.25;

fn camera(projection: Projection, (columns, rows): (u32, u32), step: f64) -> Camera {
    let pose = Pose::towards(DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 1.5, 4.0));
    let plane = ImagePlane::new(columns, rows, step).expect("a good plane");
    Camera::new(pose, projection, plane)
}

fn pair(convergence: Option<f64>) -> Stereo {
    Stereo {
        kind: StereoKind::Pair,
        eye_distance: EYES,
        convergence,
    }
}

const ODS: Stereo = Stereo {
    kind: StereoKind::Ods,
    eye_distance: EYES,
    convergence: None,
};

/// With eyes e apart that converge at C, the left eye sees a point at depth z e · d/s · (1/z − 1/C) pixels further to
/// the right than the right eye, at the same height.
#[test]
fn a_pairs_disparity_is_that_of_the_formula() {
    let plain = camera(Projection::Perspective, (640, 200), 0.01);
    let mut random = Random(7);
    for convergence in [None, Some(1.5), Some(40.0), Some(f64::INFINITY)] {
        let camera = plain.in_stereo(Some(pair(convergence)));
        let [(left, left_half), (right, right_half)] = camera.halves().expect("two eyes");
        assert_eq!((left_half.width, right_half.x), (320, 320));
        let [a, b] = [left, right].map(|eye| eye.pose().eye);
        assert!((b - a - plain.right() * EYES).length() < 1e-15);
        assert!(((a + b) * 0.5 - plain.pose().eye).length() < 1e-15);
        let at = convergence.unwrap_or(plain.distance());
        for _ in 0..100 {
            let depth = 0.5 + 9.0 * random.unit();
            let aside = plain.right() * random.signed() + plain.up() * random.signed();
            let point = plain.pose().eye + plain.forward() * depth + aside;
            let [p, q] = [left, right].map(|eye| eye.project(point).expect("in front"));
            let focal = plain.distance() / 0.01;
            let expected = EYES * focal * (1.0 / depth - 1.0 / at);
            let found = p.0 - (q.0 - 320.0);
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
            assert!((p.1 - q.1).abs() < 1e-9);
            // The picture's own ray at the place runs through the point, if the place is in that half.
            for (x, y, eye) in [(p.0, p.1, a), (q.0, q.1, b)] {
                if (x < 320.0) == (eye == a) {
                    let ray = camera.ray(x, y);
                    assert_eq!(ray.origin, eye);
                    let off = (point - eye).normalize().cross(ray.direction).length();
                    assert!(off < 1e-9, "{off}");
                }
            }
        }
    }
}

/// Each ray starts where it touches the circle of the eyes, to the side of its eye, in the direction of the panorama
/// for one eye.
#[test]
fn omni_directional_rays_touch_the_circle_of_the_eyes() {
    let projection = Projection::Panoramic(Panorama::Equirectangular);
    let distance = camera(projection, (8, 8), 1.0).distance();
    let step = PI * distance / 100.0;
    let camera = camera(projection, (200, 200), step).in_stereo(Some(ODS));
    assert_eq!(camera.fov_degrees().map(|fov| fov.round()), Some(180.0));
    assert!(camera.is_filled());
    let one = Camera::new(
        camera.pose(),
        projection,
        ImagePlane::new(200, 100, step).expect("a good plane"),
    );
    let eye = camera.pose().eye;
    let (right, up, forward) = (camera.right(), camera.up(), camera.forward());
    for (x, y) in [
        (0.5, 0.5),
        (31.0, 50.0),
        (100.0, 50.0),
        (150.0, 99.5),
        (199.5, 20.25),
    ] {
        let (left_eye, right_eye) = (camera.ray(x, y), camera.ray(x, y + 100.0));
        assert_eq!(left_eye.direction, one.ray(x, y).direction);
        assert_eq!(right_eye.direction, left_eye.direction);
        for (ray, side) in [(left_eye, -1.0), (right_eye, 1.0)] {
            let from = ray.origin - eye;
            assert!((from.length() - EYES * 0.5).abs() < 1e-15);
            assert!(from.dot(up).abs() < 1e-15);
            assert!(from.dot(ray.direction).abs() < 1e-15);
            // Up, the direction and the right eye are a right-handed set.
            let level = ray.direction - up * ray.direction.dot(up);
            if level.length() > 0.01 {
                let aside = level.normalize().cross(up) * side;
                assert!((from.normalize() - aside).length() < 1e-12, "{x} {y}");
            }
        }
    }
    // Ahead, the eyes are to the left and right; behind, the other way round.
    let ahead = camera.ray(100.0, 150.0).origin - eye;
    assert!((ahead - right * (EYES * 0.5)).length() < 1e-15);
    let behind = camera.ray(0.0, 150.0).origin - eye;
    assert!((behind + right * (EYES * 0.5)).length() < 1e-15);
    let right_way = camera.ray(150.0, 150.0);
    assert!((right_way.origin - eye + forward * (EYES * 0.5)).length() < 1e-15);
    // At a pole all rays go up, from all around the circle.
    for x in [0.5, 50.0, 120.0] {
        let pole = camera.ray(x, 1e-6);
        assert!(pole.direction.dot(up) > 1.0 - 1e-12);
        let longitude = (x - 100.0) * PI / 100.0;
        let (sin, cos) = math::sin_cos(longitude);
        let side = right * -cos + forward * sin;
        assert!((pole.origin - eye - side * (EYES * 0.5)).length() < 1e-12);
    }
    // Beyond a pole a half has no place, although the other half continues there.
    assert!(!camera.of_half(50.0, 99.5).has_place(50.0, 100.5));
    assert_eq!(
        camera.seen_at(50.0, 20.0).ray(50.0, 20.0),
        camera.ray(50.0, 20.0)
    );
}

#[test]
fn rays_of_a_lattice_are_those_of_their_pixels_eyes() {
    let lens = BrownConrady::new([-0.2, 0.05, 0.0, 0.0, 0.0]).expect("finite numbers");
    let all_around = Projection::Panoramic(Panorama::Equirectangular);
    for (projection, stereo) in [
        (Projection::Perspective, pair(None)),
        (Projection::through(lens), pair(Some(3.0))),
        (Projection::Panoramic(Panorama::Equidistant), pair(None)),
        (all_around, ODS),
    ] {
        let camera = camera(projection, (38, 26), 0.05).in_stereo(Some(stereo));
        for (stride, offset) in [(1, (0.5, 0.5)), (3, (1.9, -0.7))] {
            let mut lattice = camera.whole().sparse_lattice(stride, (2, 1));
            lattice.offset = offset;
            let halves = lattice.halves().expect("two eyes");
            let mut seen = 0;
            for (half, first) in halves {
                for (column, row) in
                    (0..half.columns).flat_map(|c| (0..half.rows).map(move |r| (c, r)))
                {
                    let of_all = lattice.ray(first.0 + column, first.1 + row);
                    assert_eq!(half.ray(column, row), of_all);
                    seen += 1;
                }
                if offset == (0.5, 0.5) && half.columns > 0 {
                    let (x, y) = half.place(half.columns - 1, half.rows - 1);
                    assert_eq!(camera.ray(x, y), half.ray(half.columns - 1, half.rows - 1));
                }
            }
            assert_eq!(seen, lattice.len());
        }
    }
}

#[test]
fn invalid_stereo_settings_are_refused() {
    let planar = Projection::Perspective;
    let all_around = Projection::Panoramic(Panorama::Equirectangular);
    let fisheye = Projection::Panoramic(Panorama::Equidistant);
    let plane = |columns, rows| ImagePlane::new(columns, rows, 1.0).ok();
    let far = |eye_distance| Stereo {
        eye_distance,
        ..pair(None)
    };
    for (stereo, projection, plane, expected) in [
        (pair(None), planar, plane(4, 3), Ok(())),
        (pair(None), fisheye, None, Ok(())),
        (pair(Some(f64::INFINITY)), fisheye, None, Ok(())),
        (ODS, all_around, plane(3, 4), Ok(())),
        (
            pair(None),
            planar,
            plane(5, 4),
            Err(StereoError::OddColumns),
        ),
        (ODS, all_around, plane(4, 3), Err(StereoError::OddRows)),
        (ODS, planar, None, Err(StereoError::NotEquirectangular)),
        (
            pair(Some(2.0)),
            fisheye,
            None,
            Err(StereoError::CannotConverge),
        ),
        (
            pair(None),
            Projection::Orthographic,
            None,
            Err(StereoError::Orthographic),
        ),
        (far(1e18), planar, None, Ok(())),
    ] {
        assert_eq!(stereo.check(projection, plane), expected, "{stereo:?}");
    }
    for stereo in [
        pair(Some(0.0)),
        pair(Some(f64::NAN)),
        far(0.0),
        far(f64::INFINITY),
        far(1.01e18),
    ] {
        let checked = stereo.check(planar, None);
        assert!(matches!(checked, Err(StereoError::Range(_))), "{stereo:?}");
    }
}
