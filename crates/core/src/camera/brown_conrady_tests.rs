use super::*;
use crate::camera::{Camera, ImagePlane, LensPatch, Panorama, Pose, Projection};
use crate::math;
use crate::random::Random;

/// Lenses, and points (x, y) with the places where OpenCV shows (x, y, 1), as `tests/tools/opencv_lenses.py` prints
/// them.
type Shown = ([f64; 5], [[f64; 4]; 7]);

#[rustfmt::skip]
const SHOWN: [Shown; 4] = [
    ([-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0], [
        [0.0, 0.0, 0.0, 0.0],
        [0.1, 0.0, 0.099717860042042, 1.9359000000000004e-06],
        [-0.3, 0.2, -0.28933982519436596, 0.192919910451232],
        [0.5, 0.5, 0.4385072699614, 0.43859525560570006],
        [-0.7, -0.1, -0.6136968204571279, -0.087575437830404],
        [0.05, -0.6, 0.045344021684798876, -0.5439814424479964],
        [0.65, -0.45, 0.5535567747854456, -0.3831029960821065],
    ]),
    ([-0.3, 0.1, 0.001, -0.0005, -0.01], [
        [0.0, 0.0, 0.0, 0.0],
        [0.1, 0.0, 0.099685999, 1.0000000000000003e-05],
        [-0.3, 0.2, -0.289075409, 0.192803606],
        [0.5, 0.5, 0.436875, 0.43762500000000004],
        [-0.7, -0.1, -0.612225, -0.08692500000000002],
        [0.05, -0.6, 0.0449519638671875, -0.54123606640625],
        [0.65, -0.45, 0.5506087109375001, -0.3807819921875001],
    ]),
    ([0.2, -0.05, 0.0, 0.002, 0.01], [
        [0.0, 0.0, 0.0, 0.0],
        [0.1, 0.0, 0.100259501, 0.0],
        [-0.3, 0.2, -0.306933091, 0.20479539400000002],
        [0.5, 0.5, 0.546375, 0.545375],
        [-0.7, -0.1, -0.7591650000000001, -0.10859500000000001],
        [0.05, -0.6, 0.05405530175781249, -0.6399636210937499],
        [0.65, -0.45, 0.7230816015625001, -0.49972957031250004],
    ]),
    ([0.12, 0.0, -0.003, 0.0, 0.0], [
        [0.0, 0.0, 0.0, 0.0],
        [0.1, 0.0, 0.10012000000000001, -3.0000000000000008e-05],
        [-0.3, 0.2, -0.30432, 0.20249000000000003],
        [0.5, 0.5, 0.5285000000000001, 0.527],
        [-0.7, -0.1, -0.74242, -0.10756000000000002],
        [0.05, -0.6, 0.052355000000000006, -0.6293475],
        [0.65, -0.45, 0.7005049999999999, -0.48684],
    ]),
];

fn lens(coefficients: [f64; 5]) -> BrownConrady {
    BrownConrady::new(coefficients).expect("finite numbers")
}

#[test]
fn points_are_seen_where_opencv_projects_them_and_rays_go_back_to_them() {
    for (coefficients, points) in SHOWN {
        let lens = lens(coefficients);
        let pose = Pose::towards(DVec3::ZERO, DVec3::NEG_Z * 2.0);
        // A focal length of 400 pixels.
        let plane = ImagePlane::new(640, 480, 2.0 / 400.0).expect("a good plane");
        let camera = Camera::new(pose, Projection::Panoramic(Panorama::Lens(lens)), plane);
        for [x, y, u, v] in points {
            let (found_u, found_v) = lens.distort(x, y).expect("inside");
            assert!(
                (found_u - u).abs() < 1e-15 && (found_v - v).abs() < 1e-15,
                "{lens} {x} {y}"
            );
            let ray = camera.ray(320.0 + 400.0 * u, 240.0 + 400.0 * v);
            let (back_x, back_y) = (
                ray.direction.x / -ray.direction.z,
                ray.direction.y / ray.direction.z,
            );
            assert!(
                (back_x - x).abs() < 1e-13 && (back_y - y).abs() < 1e-13,
                "{lens} {x} {y}"
            );
            let place = camera
                .project(DVec3::new(x, -y, -1.0) * 7.0)
                .expect("in front");
            let off = (place.0 - 320.0 - 400.0 * u).abs() + (place.1 - 240.0 - 400.0 * v).abs();
            assert!(off < 1e-10, "{lens} {x} {y}");
        }
    }
}

#[test]
fn a_picture_ends_where_the_lens_folds_back() {
    for (coefficients, end) in [
        // The roots: 1 + 3 k1 r² = 0; 1 + 7 k3 r⁶ = 0; none.
        ([-0.3, 0.0, 0.0, 0.0, 0.0], (1.0 / 0.9_f64).sqrt()),
        ([0.0, 0.0, 0.0, 0.0, -1.0 / 7.0], 1.0),
        ([0.1, 0.1, 0.0, 0.0, 0.1], 1000.0),
        // 1 − 3 r² + 2.3 r⁴ has no root; 1 − 3 r² + 2.2 r⁴ has two, of which the lesser counts.
        ([-1.0, 0.46, 0.0, 0.0, 0.0], 1000.0),
        (
            [-1.0, 0.44, 0.0, 0.0, 0.0],
            ((3.0 - (9.0_f64 - 8.8).sqrt()) / 4.4).sqrt(),
        ),
    ] {
        let lens = lens(coefficients);
        assert!(
            (lens.end() - end).abs() < 1e-9 * end,
            "{lens}: {} {end}",
            lens.end()
        );
        assert_eq!(lens.distort(end * 1.000001, 0.0), None);
        if end < 1000.0 {
            let (rim, _) = lens.distort(end * 0.999, 0.0).expect("inside");
            assert!(lens.direction(rim, 0.0).is_some(), "{lens}");
            assert_eq!(lens.direction(rim * 1.001, 0.0), None, "{lens}");
            assert_eq!(lens.direction(5.0 * rim, -3.0 * rim), None, "{lens}");
        }
    }
    for bad in [f64::NAN, 1e308, -10_001.0] {
        let refused = BrownConrady::new([bad, 0.0, 0.0, 0.0, 0.0]);
        assert!(matches!(refused, Err(LensError::Range(_))), "{bad}");
    }
    assert_eq!("1,2".parse::<BrownConrady>(), Err(LensError::Count));
}

#[test]
fn directions_and_places_are_each_others_inverse() {
    let mut random = Random(12);
    for (coefficients, _) in SHOWN {
        let lens = lens(coefficients);
        for _ in 0..3000 {
            let p = random.point() * 0.75;
            let (u, v) = lens.distort(p.x, p.y).expect("inside");
            let ([[x], [y]], [has]) = lens.undistort(&[u], &[v]);
            assert!(
                has && (x - p.x).abs() < 1e-12 && (y - p.y).abs() < 1e-12,
                "{lens} {p}"
            );
            let slopes = lens.derivatives(u, -v);
            let near = 1e-6;
            for (axis, [da, db]) in [[near, 0.0], [0.0, near]].into_iter().enumerate() {
                let at = |sign: f64| {
                    lens.direction(u + sign * da, -v + sign * db)
                        .expect("inside")
                };
                let slope = (at(1.0) - at(-1.0)) / (2.0 * near);
                assert!(
                    (slope - slopes[axis]).length() < 1e-6 * slope.length(),
                    "{lens} {p}"
                );
            }
        }
    }
}

/// Calibrated and arbitrary lenses.
fn many() -> impl Iterator<Item = BrownConrady> {
    let mut random = Random(44);
    let made = (0..200).map(move |_| {
        let size = math::pow(2.0, random.signed() * 4.0 - 3.0);
        let [a, b, c] = (random.point() * size).to_array();
        let decentred = random.point() * 0.05 * size;
        [a, b, decentred.x, decentred.y, c]
    });
    let known = SHOWN.map(|(coefficients, _)| coefficients);
    made.chain(known).chain([[0.0; 5]]).map(lens)
}

/// All of Newton's steps, one by one.
fn by_all_steps(lens: &BrownConrady, to_x: f64, to_y: f64) -> [f64; 2] {
    let (mut x, mut y) = (to_x, to_y);
    for _ in 0..STEPS {
        let at = lens.distortion.at(x, y);
        let (off_x, off_y) = (at.x - to_x, at.y - to_y);
        let inverse = 1.0 / at.determinant();
        x -= (at.yy * off_x - at.xy * off_y) * inverse;
        y -= (at.xx * off_y - at.xy * off_x) * inverse;
    }
    [x, y]
}

#[test]
fn stopping_early_gives_the_bits_of_all_newton_steps() {
    let mut random = Random(45);
    for lens in many() {
        for _ in 0..200 {
            let to = random.point() * 1.5;
            let expected = by_all_steps(&lens, to.x, to.y).map(f64::to_bits);
            let alone = lens.undistort(&[to.x], &[to.y]).0;
            assert_eq!(alone.map(|[x]| x.to_bits()), expected, "{lens} {to}");
            let other = random.point();
            let ([x, y], _) = lens.undistort(&[other.x, to.x], &[other.y, to.y]);
            assert_eq!([x[1], y[1]].map(f64::to_bits), expected, "{lens} {to}");
        }
    }
}

#[test]
fn a_lens_is_well_behaved_where_it_is_said_to_be() {
    let mut random = Random(46);
    let (mut widest, mut count) = (0.0_f64, 0);
    for lens in many() {
        let radius = lens.well_behaved.radius;
        widest = widest.max(radius);
        for _ in 0..50 {
            let middle = random.point() * radius;
            let half = random.point().abs() * (0.2 * radius * random.unit());
            let across = (middle.x - half.x, middle.x + half.x);
            let along = (middle.y - half.y, middle.y + half.y);
            let furthest = [across.0.abs().max(across.1), along.0.abs().max(along.1)];
            if !lens.is_well_behaved(furthest[0], furthest[1]) {
                continue;
            }
            let patch = LensPatch::new(&lens, across, along, 0.0, None);
            let [xs, ys] = patch.expect("well-behaved").window();
            for _ in 0..20 {
                let (a, b) = (
                    middle.x + half.x * random.signed(),
                    middle.y + half.y * random.signed(),
                );
                assert!(lens.is_well_behaved(a, b) && lens.has_place(a, b));
                let found = lens.direction(a, b).expect("a well-behaved place");
                let is_in = |(least, most): (f64, f64), it: f64| (least..=most).contains(&it);
                assert!(is_in(xs, found.x) && is_in(ys, found.y), "{lens} {a} {b}");
                assert!(found.x.abs().max(found.y.abs()) < FLATTEST);
                count += 1;
            }
        }
    }
    assert!(widest > 1.9 && count > 20_000, "{widest} {count}");
    // The whole picture of a calibrated camera except its corners.
    let (calibrated, _) = SHOWN[0];
    assert!(lens(calibrated).well_behaved.radius > 0.5);
}

/// The truth is all of Newton's steps.
#[test]
fn no_place_beyond_the_rim_has_a_direction() {
    let mut random = Random(57);
    let mut closest = f64::INFINITY;
    for lens in many() {
        if lens.rim > 100.0 {
            continue;
        }
        for _ in 0..50 {
            let (sin, cos) = math::sin_cos(random.signed() * 3.2);
            for along in [1.000_000_001, 1.01, 1.0 + 3.0 * random.unit()] {
                let (a, b) = (lens.rim * along * cos, lens.rim * along * sin);
                assert!(lens.surely_lacks(a, b) && !lens.has_place(a, b));
                assert_eq!(lens.direction(a, b), None, "{lens} {a} {b}");
            }
            // The edge of what is seen.
            let end = 0.999_999 * lens.end();
            let (x, y) = lens.distort(end * cos, end * sin).expect("within the end");
            assert!(!lens.surely_lacks(x, y));
            closest = closest.min(lens.rim / math::hypot(x, y));
        }
    }
    assert!(closest < 1.01, "{closest}");
}
