//! Rows of eight rays at triangles that are hard to interpolate: nearly edge-on, close to the eye, and far from the
//! point that corners are relative to.

use super::PreparedRay;
use super::interpolate::{LANES, RowPlaces, interpolate_row};
use crate::camera::{Camera, ImagePlane, Lattice, Pose, Projection};
use crate::hit::{Cull, Precision};
use crate::random::Random;
use glam::{DVec3, Vec3};

/// The point that corners are relative to, and the approximate magnitude of corners there: without any rounding, and
/// with a rounded eye.
pub(crate) const SCENES: [(DVec3, f64); 3] = [
    (DVec3::ZERO, 0.0),
    (DVec3::new(1e7, -0.1, 3e3), 0.0),
    (DVec3::new(1e-9, 2e-9, -1e-9), 3e7),
];

/// A triangle, and eight rows of eight rays at it: from square to nearly edge-on, from a hundred thousand times the
/// triangle's size away to close by.
pub(crate) fn triangle_and_rays(
    random: &mut Random,
    (tree_origin, place): (DVec3, f64),
) -> ([Vec3; 3], Lattice) {
    let decades = |random: &mut Random, most: f64| crate::math::pow(10.0, most * random.unit());
    let size = place.max(4.0) * decades(random, -5.0);
    let middle = DVec3::new(place, place * 0.7, -place) + random.point() * 3.0;
    let mut corners = [(); 3].map(|()| (middle + random.point() * size).as_vec3());
    if random.unit() < 0.2 {
        // Seen along z, all corners have the same depth.
        corners = corners.map(|corner| corner.with_z(corners[0].z));
    }
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let target = a + ((b - a) * random.unit() + (c - a) * random.unit()) * 0.5;
    let normal = (b - a).cross(c - a).normalize_or(DVec3::X);
    let in_plane = random.point().cross(normal);
    let away = in_plane + normal * (random.signed() * decades(random, -4.0));
    let distance = size * decades(random, 15.0) * 1e-10;
    let distance = distance.max(place * 1e-12).max(1e-12);
    let target = tree_origin + target;
    let pose = Pose {
        eye: target + away.normalize_or(DVec3::X) * distance,
        target,
        up: DVec3::new(0.1, 1.0, 0.2),
    };
    let plane = ImagePlane::new(8, 8, size.min(distance) * 0.02).expect("a size and a step");
    let camera = Camera::new(pose, Projection::Perspective, plane);
    (corners, camera.whole().lattice())
}

/// With the bound on the origin's error at zero, or that on t, this fails.
#[test]
fn sure_lanes_have_the_bits_of_the_single_ray() {
    let mut random = Random(9);
    for scene in SCENES {
        let (mut sure, mut unsure) = (0, 0);
        for _ in 0..3000 {
            let (corners, lattice) = triangle_and_rays(&mut random, scene);
            let [a, b, c] = corners;
            let all = [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z].map(|x| [x; LANES]);
            for row in 0..lattice.rows {
                let places = RowPlaces::new(&lattice, 0, row);
                let found = interpolate_row(&lattice.camera, scene.0, places, &all);
                for column in 0..LANES {
                    if !found.sure[column] {
                        unsure += 1;
                        continue;
                    }
                    sure += 1;
                    let ray = lattice.ray(column as u32, row);
                    let ray = PreparedRay::new(&ray, scene.0, Cull::None, Precision::Exact);
                    let ray = ray.expect("a valid ray");
                    let expected = ray.hit_on(0, corners).to_primitive_hit();
                    let numbers = [found.t[column], found.u[column], found.v[column]];
                    assert_eq!(numbers, [expected.t, expected.u, expected.v]);
                }
            }
        }
        assert!(sure > 5_000 && unsure > 5_000, "{sure} {unsure}");
    }
}
