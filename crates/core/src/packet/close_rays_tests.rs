//! Rays that are closer together than they are rounded: packets find what single rays find.

use super::around_tests::accel;
use super::close_planes_tests::{camera, check_from};
use crate::camera::{ImagePlane, Projection};
use crate::random::Random;
use glam::DVec3;

/// Triangles of some 1e-15 of their distance: no packet sees their edges, so it leaves all its rays to be cast one by
/// one after the first of them. Half of the rays are the same as a neighbour, whose answer they have.
#[test]
fn the_same_rays_of_packets_that_see_no_edges_are_cast_once() {
    let mut random = Random(101);
    let mut point = || random.point() * 2e-15;
    let accel = accel((0..400).map(|_| [point(), point(), point()]).collect());
    let eye = DVec3::new(1.0, 2.0, 4.0);
    for projection in [Projection::Perspective, Projection::Orthographic] {
        let plane = ImagePlane::new(48, 40, 1.2e-16).expect("a good plane");
        let camera = camera(eye, -eye, projection, plane);
        let (hits, counts) = check_from(&accel, &camera);
        assert!(hits > 1000, "{hits} hits, {counts:?}");
        assert!(counts.triangles < 800, "{counts:?}");
        let cast = counts.double_rays + counts.exact_rays;
        assert!((100..1000).contains(&cast), "{counts:?}");
    }
}
