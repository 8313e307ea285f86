//! Culling of triangles that pass the eye, before set-up: their corners have no places that would bound their rays, so
//! that each packet whose frustum meets their boxes sets them up, while a narrow frustum misses three in four of those
//! about it.
//!
//! First those go that lie beyond a plane along the rays (`ray_bounds::side_planes`), in single precision. Then, where
//! triangles are set up again with componentwise bounds ([`componentwise_setup`](super::componentwise_setup)), those of
//! which two edge functions surely have different signs at all rays, with such bounds and of cross products P×Q alone.

use super::componentwise_setup::{Bounded, corners_in_lane, is_in_range};
use super::linear::FunctionDomain;
use super::ray_bounds::{CornerProjector, ProjectedTriangles};
use super::setup::{PacketSpace, is_negative};
use crate::num::simd::{LANES, Lanes, Simd, Work, dispatch};
use crate::triangle::CornerLanes;

/// The share of triangles, one in so many, that must be culled for the tests to take less time than the set-up that
/// they save. With a lesser number triangles are set up that tests would have culled; with a greater one triangles that
/// rays hit are tested for nothing.
const WORTHWHILE: i32 = 3;

/// Batches that are not tested after too few were culled, and the greatest balance. With fewer, hopeless batches are
/// tested; with more, packets set up what they could cull, or test on for long in vain.
const PAUSE: i32 = 32;

/// Whether culling has saved more than it took: [`WORTHWHILE`] for each triangle that was culled, less one for each
/// that was tested. Where it is negative, as many batches are still not tested. No answer depends on it.
#[derive(Debug, Default)]
pub(super) struct CullingBalance(i32);

impl CullingBalance {
    /// Whether the next batch is worth testing.
    #[inline(always)]
    pub(super) fn allows_tests(&mut self) -> bool {
        let allows = self.0 >= 0;
        self.0 += i32::from(!allows);
        allows
    }

    fn record(&mut self, tested: u32, culled: u32) {
        self.0 = (self.0 + WORTHWHILE * culled as i32 - tested as i32).min(PAUSE);
        if self.0 < 0 {
            self.0 = -PAUSE;
        }
    }
}

/// Culls those of eight triangles that pass the eye beside the rays of a perspective packet. Given copies, so that what
/// most packets never need is not kept in memory for it.
pub(super) struct CullBesideRays<'p> {
    pub(super) space: &'p PacketSpace,
    pub(super) projector: CornerProjector,
    pub(super) corners: CornerLanes,
    pub(super) projected: &'p mut ProjectedTriangles,
    pub(super) balance: &'p mut CullingBalance,
    /// Whether to compute edge functions, which takes as long as setting up a triangle in double precision, and a
    /// fraction of setting it up again.
    pub(super) by_edges: bool,
}

impl CullBesideRays<'_> {
    #[cold]
    #[inline(never)]
    pub(super) fn cull(self, simd: Simd) {
        if self.space.perspective {
            dispatch(simd, self);
        }
    }
}

impl Work for CullBesideRays<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            space,
            projector,
            corners,
            projected,
            balance,
            by_edges,
        } = self;
        let tested = projected.unbounded & projected.seen;
        projected.seen &= !projector.beside(lanes, &corners);
        let unbounded = projected.unbounded & projected.seen;
        if by_edges && unbounded != 0 {
            projected.seen &= !(unbounded & space.beside(&corners));
        }
        let culled = tested & !projected.seen;
        balance.record(tested.count_ones(), culled.count_ones());
    }
}

impl PacketSpace {
    /// Those of eight triangles, as bits, of which two edge functions surely have different signs at all rays.
    #[inline(always)]
    fn beside(&self, corners: &CornerLanes) -> u32 {
        let (across, along) = (self.last.0.into(), self.last.1.into());
        let span = FunctionDomain {
            across,
            along,
            ..FunctionDomain::PACKET
        };
        let mut missed = [false; LANES];
        for (l, missed) in missed.iter_mut().enumerate() {
            let [a, b, c] = corners_in_lane(corners, l);
            let (p, q, r) = (a - self.origin, b - self.origin, c - self.origin);
            let (mut any_negative, mut any_positive) = (false, false);
            for (from, to, u) in [(q, r, c - b), (r, p, a - c), (p, q, b - a)] {
                let (function, error) = self.edge_function(&Bounded::cross_of(from, to), u);
                any_negative |= is_negative(function, error, &span);
                any_positive |= is_negative(function.times(-1.0), error, &span);
            }
            // As in set-up with these bounds.
            let is_sound = is_in_range(p) & is_in_range(q) & is_in_range(r);
            *missed = any_negative & any_positive & is_sound;
        }
        let mut bits = 0;
        for (l, &missed) in missed.iter().enumerate() {
            bits |= u32::from(missed) << l;
        }
        bits
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, ImagePlane, Pose, Projection};
    use crate::hit::Cull;
    use crate::packet::setup_tests::{kept_hits, lanes_of, space};
    use crate::random::Random;
    use glam::{DVec3, Vec3};

    /// Triangles about the eye of all magnitudes, one of whose edges a ray of the packet nearly meets, against exact
    /// arithmetic.
    #[test]
    fn triangles_about_the_eye_keep_the_rays_that_hit_them() {
        let mut random = Random(134);
        let (mut hits, mut culled) = (0, 0);
        for round in 0..6000 {
            let eye = random.point() * [0.0, 1.0, 1e3][round % 3];
            let pitch = random.decades(-9.0, -1.0);
            let plane = ImagePlane::new(32, 32, pitch).expect("a good plane");
            let pose = Pose::towards(eye, eye + random.point().normalize());
            let camera = Camera::new(pose, Projection::Perspective, plane);
            let space = space(&camera, DVec3::ZERO, Cull::None);
            let mut aimed = || {
                let place = [(); 2].map(|()| (random.unit() * 32.0).floor() + 0.5);
                let ray = camera.ray(place[0], place[1]);
                let at = ray.at(random.decades(-3.0, 1.0));
                let way = random.point() * random.decades(-3.0, 3.0);
                let third = eye + random.point() * random.decades(-3.0, 3.0);
                let corners = [at - way * random.unit(), at + way, third];
                (corners.map(DVec3::as_vec3), ray)
            };
            let triangles: [_; LANES] = std::array::from_fn(|_| aimed());
            let beside = space.beside(&lanes_of(triangles.map(|(corners, _)| corners)));
            culled += beside.count_ones();
            hits += kept_hits(beside, triangles);
        }
        assert!(hits > 5000 && culled > 500, "{hits} {culled}");
    }

    /// Rays closer together than roundings, along a line that an edge with whole coordinates meets, against exact
    /// arithmetic. With the error of edge functions at zero this fails.
    #[test]
    fn edges_that_rays_meet_but_for_rounding_have_no_sign() {
        let mut random = Random(136);
        let mut hits = 0;
        for _ in 0..3000 {
            let whole = |random: &mut Random, most: f64| (random.point() * most).round();
            let way = whole(&mut random, 9.0) + DVec3::splat(0.5);
            let plane = ImagePlane::new(32, 32, 1e-17).expect("a good plane");
            let pose = Pose::towards(DVec3::ZERO, way);
            let camera = Camera::new(pose, Projection::Perspective, plane);
            let space = space(&camera, DVec3::ZERO, Cull::None);
            let triangles: [[Vec3; 3]; LANES] = std::array::from_fn(|_| {
                let aside = whole(&mut random, 9.0);
                let corners = [
                    way * 2.0 + aside,
                    way * 2.0 - aside,
                    way + whole(&mut random, 9.0),
                ];
                corners.map(DVec3::as_vec3)
            });
            let beside = space.beside(&lanes_of(triangles));
            let ray = camera.ray(15.5, 15.5);
            hits += kept_hits(beside, triangles.map(|corners| (corners, ray)));
        }
        assert!(hits > 5000, "{hits}");
    }

    /// Of triangles whose corners lie anywhere about the eye, a narrow packet misses three in four; nearly all of these
    /// are culled.
    #[test]
    fn nearly_all_triangles_about_the_eye_that_no_ray_hits_are_culled() {
        let mut random = Random(135);
        let (mut culled, mut all) = (0, 0);
        for _ in 0..200 {
            let plane = ImagePlane::new(32, 32, 1e-3).expect("a good plane");
            let pose = Pose::towards(DVec3::ZERO, random.point());
            let camera = Camera::new(pose, Projection::Perspective, plane);
            let space = space(&camera, DVec3::ZERO, Cull::None);
            let triangles: [[Vec3; 3]; LANES] = std::array::from_fn(|_| {
                [(); 3].map(|()| (random.point() * random.decades(-12.0, 12.0)).as_vec3())
            });
            culled += space.beside(&lanes_of(triangles)).count_ones();
            all += LANES as u32;
        }
        assert!(culled * 10 > all * 7, "{culled} of {all}");
    }
}
