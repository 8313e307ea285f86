//! Rays that are closer together than they are rounded: packets find what single rays find.

use super::around_tests::accel;
use super::clip_tests::planes;
use super::close_planes_tests::{camera, check_faces, check_from};
use crate::camera::{ImagePlane, Projection};
use crate::hit::{Cull, Precision};
use crate::random::Random;
use glam::DVec3;

/// Triangles of some 1e-15 of their distance, without their backs: no packet of the lattice sees their edges, so it
/// leaves all its rays to be cast one by one after the first of them. Most of the rays are the same as a neighbour,
/// whose answer they have. With their backs packets see them from close to them.
#[test]
fn the_same_rays_of_packets_that_see_no_edges_are_cast_once() {
    let mut random = Random(101);
    let mut point = || random.point() * 1e-15;
    let accel = accel((0..400).map(|_| [point(), point(), point()]).collect());
    let eye = DVec3::new(1.0, 2.0, 4.0);
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let plane = ImagePlane::new(48, 40, 6e-17).expect("a good plane");
        let camera = camera(eye, -eye, projection, plane);
        let (hits, counts) = check_faces(&accel, &camera, Cull::Back);
        assert!(hits > 900, "{hits} hits, {counts:?}");
        assert!(counts.triangles < 800, "{counts:?}");
        let cast = counts.double_rays + counts.exact_rays;
        assert!((100..1000).contains(&cast), "{counts:?}");
        let (hits, counts) = check_from(&accel, &camera);
        let cast = counts.double_rays + counts.exact_rays;
        assert!(hits > 900 && cast < 20, "{counts:?}");
    }
}

/// Scenes of all kinds from 10¹² to 10¹⁶ of their lengths away, where rays are up to thousands of times closer together
/// than they are rounded: packets see them from an eye close to them, unless they are clipped or faces are culled.
#[test]
fn packets_from_far_away_see_the_scene_from_close_to_it() {
    let mut random = Random(102);
    let (mut hits, mut cast) = (0, 0);
    for round in 0..80 {
        let shift = random.point() * (round % 3) as f64;
        let tilt = random.point();
        let size = [0.02, 0.1, 0.5, 2.0][round % 4];
        let triangles = (0..200).map(|number| {
            let middle = random.point();
            let corners = [(); 3].map(|()| middle * (1.0 - size * 0.5) + random.point() * size);
            corners.map(|corner| {
                let flat = match round % 5 {
                    0 => corner,
                    // Layers that are close together, a plane and layers along the view axis, next to edge-on.
                    1 => corner - tilt * (tilt.dot(corner) / tilt.length_squared()) * 0.999_999,
                    2 => (corner * 64.0).round() / 64.0,
                    3 => corner.with_z(f64::from(number % 7) * 1e-7),
                    _ => corner.with_z(0.0),
                };
                flat + shift
            })
        });
        let accel = accel(triangles.collect());
        let away = random.decades(12.0, 16.0);
        let mut towards = random.point().normalize();
        if round % 7 == 0 {
            // Edge-on, except for what rays differ by.
            towards = towards.with_z(random.signed() * 1e-6).normalize();
        }
        let projection = [Projection::Perspective, Projection::Orthographic][round / 5 % 2];
        let step = random.decades(-2.0, -1.0);
        let plane = ImagePlane::new(48, 40, step).expect("a good plane");
        let aside = random.point() * 0.2;
        let eye = shift + aside - towards * away;
        let camera = camera(eye, towards * away, projection, plane);
        let (found, counts) = check_from(&accel, &camera);
        hits += found as u64;
        cast += counts.double_rays + counts.exact_rays;
        check_faces(&accel, &camera, Cull::Back);
        let lattice = camera.whole().lattice();
        let planes = planes(&mut random, &accel, eye, 2);
        let clipped = accel.clipped(&planes);
        let mut kept = Vec::new();
        clipped.find_closest(&lattice, Cull::None, Precision::Exact, &mut kept);
        for (at, &kept) in (0..).zip(&kept) {
            let ray = lattice.ray(at % lattice.columns, at / lattice.columns);
            let truth = clipped.cast_primitive(&ray, Cull::None, Precision::Exact);
            assert_eq!(kept, truth.primitive, "{ray:?} {planes:?}");
        }
    }
    assert!(hits > 20_000 && cast * 10 < hits, "{hits} {cast}");
}
