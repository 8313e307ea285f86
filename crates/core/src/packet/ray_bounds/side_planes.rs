//! Culling of triangles that pass the eye, whose corners have no places: those that lie wholly beyond a plane along the
//! packet's rays.
//!
//! A ray at the place (i, j) hits points with X = iZ, Y = jZ and Z > 0. So with g the margin of bounds, all hits of the
//! packet's rays have X + gZ ≥ 0, (L + g)Z − X ≥ 0 with L the last column, the same for rows, and sums of two of these:
//! planes along the packet's sides and through its edges. A triangle all of whose corners have a negative value is hit
//! by no ray, wherever it lies (Assarsson, Möller, "Optimized View Frustum Culling Algorithms for Bounding Boxes",
//! 2000, for boxes).
//!
//! # Error bound
//! Errors of X, Y and Z are those of [`ray_bounds`](super), with each corner's own greatest coordinate for r: a corner
//! next to the eye keeps its digits where another is far away. Rounded products and sums included, a value is off by
//! 12ur·S for X, and for Z by less than 32 times (12ur·S_z, 7u|t_z|), where 64 times e_z are taken: all that is within
//! 1.25(e_x, 64e_z). Sums of two take twice that. Underflow loses less than [`LEAST_ERROR`].

use super::CornerProjector;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use crate::triangle::CornerLanes;

/// An error above what underflow loses: ten products, each off by 2⁻¹⁴⁹, times 64 columns. With a greater one triangles
/// that pass the eye as closely are set up.
const LEAST_ERROR: f32 = 1e-41;

impl CornerProjector {
    /// The triangles, as bits, that surely lie beyond one plane along the rays of a perspective packet.
    #[inline(always)]
    pub(in crate::packet) fn beside<L: Lanes>(&self, lanes: L, corners: &CornerLanes) -> u32 {
        let [grown, by_depth, by_reach] = self.margin;
        let [columns, rows] = self.last.map(|last| last + grown);
        let zero = lanes.splat(0.0);
        // Of three corners.
        let mut beyond = [u32::MAX >> (32 - LANES); 8];
        for corner in 0..3 {
            let ([x, y, z], reach) = self.map_corner(lanes, corners, corner);
            let in_range = reach.lt(lanes.splat(self.most_reach));
            let error = lanes.splat(by_depth) + reach * by_reach + LEAST_ERROR;
            let (left, right) = (x + z * grown, z * columns - x);
            let (top, bottom) = (y + z * grown, z * rows - y);
            let (at_side, at_edge) = (zero - error, zero - error * 2.0);
            let values = [
                (left, at_side),
                (right, at_side),
                (top, at_side),
                (bottom, at_side),
                (left + top, at_edge),
                (left + bottom, at_edge),
                (right + top, at_edge),
                (right + bottom, at_edge),
            ];
            for (beyond, (value, least)) in beyond.iter_mut().zip(values) {
                *beyond &= (in_range & value.lt(least)).bits();
            }
        }
        beyond.into_iter().fold(0, |any, one| any | one)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, ImagePlane, Pose, Projection};
    use crate::hit::Cull;
    use crate::num::simd::Plain;
    use crate::packet::setup::PacketSpace;
    use crate::packet::setup_tests::{kept_hits, lanes_of, space};
    use crate::random::Random;
    use glam::{DVec3, Vec3};

    /// A packet's space, and its camera with 32 × 32 rays, for an eye of these coordinates.
    fn packet(random: &mut Random, eye: DVec3) -> (Camera, PacketSpace) {
        let pitch = random.decades(-6.0, -1.0);
        let plane = ImagePlane::new(32, 32, pitch).expect("a good plane");
        let pose = Pose::towards(eye, eye + random.point().normalize());
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let space = space(&camera, DVec3::ZERO, Cull::None);
        (camera, space)
    }

    fn beside(space: &PacketSpace, triangles: [[Vec3; 3]; LANES]) -> u32 {
        CornerProjector::new(space, 0.0).beside(Plain, &lanes_of(triangles))
    }

    /// Triangles with a tip at a ray on the packet's rim, and all else beyond the rim, behind the eye at times, and of
    /// other magnitudes. With the error of X, Y and Z at zero this fails.
    #[test]
    fn triangles_that_pass_the_eye_keep_the_rays_that_hit_them() {
        let mut random = Random(131);
        let mut hits = 0;
        for round in 0..10_000 {
            let eye = random.point() * [0.0, 1.0, 1e3][round % 3];
            let (camera, space) = packet(&mut random, eye);
            let sides = [-camera.right(), camera.right(), camera.up(), -camera.up()];
            let mut aimed = || {
                let side = (random.unit() * 4.0) as usize % 4;
                let along = (random.unit() * 32.0).floor();
                let edge = if random.unit() < 0.3 { 0.0 } else { along };
                let place = [(0.0, edge), (31.0, edge), (edge, 0.0), (edge, 31.0)][side];
                let ray = camera.ray(place.0 + 0.5, place.1 + 0.5);
                let tip = ray.at(random.decades(-3.0, 1.0));
                let tip = tip - sides[side] * (random.unit() * 1e-7 * (tip - eye).length());
                let mut beyond = || {
                    let out = sides[side] * random.unit() + camera.forward() * random.signed();
                    let out = out + camera.right() * (0.1 * random.signed());
                    tip + out * random.decades(-3.0, 3.0)
                };
                let corners = [tip, beyond(), beyond()].map(DVec3::as_vec3);
                (corners, ray)
            };
            let triangles: [_; LANES] = std::array::from_fn(|_| aimed());
            let beside = beside(&space, triangles.map(|(corners, _)| corners));
            hits += kept_hits(beside, triangles);
        }
        assert!(hits > 10_000, "{hits}");
    }

    /// Of triangles whose corners lie anywhere about the eye, and whose magnitudes differ, three in four miss a narrow
    /// packet, and more than half of those lie beyond one plane.
    #[test]
    fn most_triangles_about_the_eye_are_culled() {
        let mut random = Random(132);
        let (mut culled, mut all) = (0, 0);
        for _ in 0..200 {
            let (_, space) = packet(&mut random, DVec3::ZERO);
            let triangles = [(); LANES].map(|()| {
                [(); 3].map(|()| (random.point() * random.decades(-12.0, 12.0)).as_vec3())
            });
            culled += beside(&space, triangles).count_ones();
            all += LANES as u32;
        }
        assert!(culled * 5 > all * 2, "{culled} of {all}");
    }

    /// Corners closer to the eye than underflow distinguishes.
    #[test]
    fn triangles_within_underflow_of_the_eye_are_kept() {
        let mut random = Random(133);
        let least = f32::from_bits(1);
        let mut hits = 0;
        for _ in 0..2000 {
            let (camera, space) = packet(&mut random, DVec3::ZERO);
            let triangles = [(); LANES]
                .map(|()| [(); 3].map(|()| (random.point() * 8.0).round().as_vec3() * least));
            let beside = beside(&space, triangles);
            for place in [0.5, 15.5, 31.5] {
                let ray = camera.ray(place, place);
                hits += kept_hits(beside, triangles.map(|corners| (corners, ray)));
            }
        }
        assert!(hits > 1000, "{hits}");
    }
}
