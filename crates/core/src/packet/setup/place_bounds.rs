//! Bounds of triangles in packet space, for rays that lie at [`Places`](crate::packet::places::Places) of their own.
//!
//! # Error bound
//! A corner's place is X/Z and Y/Z, with X and Y off by Kδ and Z by δ (see [`setup`](super)). Where Z ≥ 1024δ, a
//! place p is off by less than 1.001(K + |p|)δ/Z. 1.01(K + h + 64)δ/Z, which is taken, is more where |p| ≤ 100 +
//! K/120; a place further out is off by less than (K + |p|)/1000, and stays beyond 32 columns or rows, where no ray
//! is. The rays' own error comes on top. Places of rays and these bounds are rounded to single precision alike:
//! rounding keeps their order. A hit is no nearer than the nearest corner, whose inverse depth is off by 1.01δ/Z of
//! itself, and by u where it is rounded to single precision: twice both are taken.

#![allow(
    clippy::needless_range_loop,
    reason = "a lane is an index into all the arrays at once"
)]

use super::{LANES, PacketSpace, greatest_of_three};
use crate::num::choice::{greater, lesser};
use crate::num::simd::F32x8;
use crate::packet::place_box::PlaceBox;
use crate::triangle::CornerLanes;

/// The least ratio of a corner's depth to its error at which its place is used. With a lesser one the factor 1.001 of
/// the bound grows; with a greater one more triangles close to the eye are set up for every ray.
const LEAST_DEPTH_RATIO: f64 = 1024.0;

/// Bounds of eight triangles.
#[derive(Clone, Debug)]
pub(in crate::packet) struct PlaceBounds {
    left: [f32; LANES],
    right: [f32; LANES],
    top: [f32; LANES],
    bottom: [f32; LANES],
    /// Upper bound of the depth key; infinite where it is not known.
    pub(in crate::packet) nearest: [f32; LANES],
    /// Triangles that some ray may hit, as bits.
    pub(in crate::packet) seen: u32,
}

impl PlaceBounds {
    /// No triangles.
    pub(in crate::packet) const NONE: Self = Self {
        left: [0.0; LANES],
        right: [0.0; LANES],
        top: [0.0; LANES],
        bottom: [0.0; LANES],
        nearest: [0.0; LANES],
        seen: 0,
    };

    /// Those of eight triangles, projected in single precision: left, right, top, bottom and the nearest depth key.
    #[inline(always)]
    pub(in crate::packet) fn store<F: F32x8>(&mut self, bounds: [F; 5], seen: u32) {
        let [left, right, top, bottom, nearest] = bounds;
        left.store(&mut self.left);
        right.store(&mut self.right);
        top.store(&mut self.top);
        bottom.store(&mut self.bottom);
        nearest.store(&mut self.nearest);
        self.seen = seen;
    }

    /// Bounds of one triangle.
    #[inline(always)]
    pub(in crate::packet) fn of(&self, lane: usize) -> PlaceBox {
        PlaceBox {
            left: self.left[lane],
            right: self.right[lane],
            top: self.top[lane],
            bottom: self.bottom[lane],
        }
    }
}

impl PacketSpace {
    /// Bounds the places where rays may hit each of the first `count` triangles.
    #[inline(always)]
    pub(in crate::packet) fn bound_places(
        &self,
        corners: &CornerLanes,
        count: usize,
        out: &mut PlaceBounds,
    ) {
        let [ax, ay, az, bx, by, bz, cx, cy, cz] = self.map(corners);
        let margin = 2.0 * self.ray_error;
        let mut behind = [false; LANES];
        for l in 0..LANES {
            let reach = greater(
                greatest_of_three(ax[l], bx[l], cx[l]),
                greatest_of_three(ay[l], by[l], cy[l]),
            );
            let delta = self.delta(reach, greatest_of_three(az[l], bz[l], cz[l]));
            let front = least(az[l], bz[l], cz[l]);
            // No number is NaN: eyes and corners are far within range (`FURTHEST` in `places`).
            let is_clear = front > LEAST_DEPTH_RATIO * delta;
            behind[l] = most(az[l], bz[l], cz[l]) < -delta;
            let [ia, ib, ic] = [1.0 / az[l], 1.0 / bz[l], 1.0 / cz[l]];
            let nearest = most(ia, ib, ic);
            let off = margin + 1.01 * (self.stretch_and_reach + 64.0) * delta * nearest;
            let [px, qx, rx] = [ax[l] * ia, bx[l] * ib, cx[l] * ic];
            let [py, qy, ry] = [ay[l] * ia, by[l] * ib, cy[l] * ic];
            let or = |value: f64, other: f32| if is_clear { value as f32 } else { other };
            out.left[l] = or(least(px, qx, rx) - off, f32::NEG_INFINITY);
            out.right[l] = or(most(px, qx, rx) + off, f32::INFINITY);
            out.top[l] = or(least(py, qy, ry) - off, f32::NEG_INFINITY);
            out.bottom[l] = or(most(py, qy, ry) + off, f32::INFINITY);
            let nearest =
                nearest * (1.0 + 2.0 / (1u64 << 24) as f64) + 2.0 * delta * nearest * nearest;
            out.nearest[l] = or(nearest, f32::INFINITY);
        }
        let mut seen = 0;
        for (l, behind) in behind.into_iter().enumerate() {
            seen |= u32::from(!behind & (l < count)) << l;
        }
        out.seen = seen;
    }
}

#[inline(always)]
fn least(a: f64, b: f64, c: f64) -> f64 {
    lesser(lesser(a, b), c)
}

#[inline(always)]
fn most(a: f64, b: f64, c: f64) -> f64 {
    greater(greater(a, b), c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, ImagePlane, Pose, Projection};
    use crate::hit::Cull;
    use crate::packet::setup_tests::{lanes_of, space};
    use crate::random::Random;
    use crate::ray::Ray;
    use crate::triangle::exact::{self, OffsetTriangle};
    use glam::{DVec3, Vec3};

    /// Checks that a hit's ray has its place within the bounds, and that the hit is no nearer than the bounds say.
    /// Returns whether the ray hits.
    fn holds(
        space: &PacketSpace,
        tree_origin: DVec3,
        corners: [Vec3; 3],
        ray: &Ray,
        place: [f64; 2],
    ) -> bool {
        let triangle = OffsetTriangle {
            corners,
            origin: tree_origin,
        };
        let Some(hit) = exact::hit(ray, &triangle, Cull::None, 0) else {
            return false;
        };
        let mut bounds = PlaceBounds::NONE;
        space.bound_places(&lanes_of([corners; LANES]), LANES, &mut bounds);
        assert!(bounds.seen & 1 != 0, "{corners:?} {ray:?}");
        let PlaceBox {
            left,
            right,
            top,
            bottom,
        } = bounds.of(0);
        let [x, y] = place.map(|at| at as f32);
        assert!(
            (left..=right).contains(&x),
            "{corners:?} {ray:?}: {left} {x} {right}"
        );
        assert!(
            (top..=bottom).contains(&y),
            "{corners:?} {ray:?}: {top} {y} {bottom}"
        );
        // The truth is rounded too.
        let forward = space.map[2];
        let key = 1.0 / (hit.t * ray.direction.dot(forward));
        let nearest = f64::from(bounds.nearest[0]);
        assert!(
            key <= nearest * (1.0 + 1e-14),
            "{corners:?} {ray:?}: {key} {nearest}"
        );
        true
    }

    /// Triangles with a corner on a ray, far from the point that corners are relative to, so that the eye's position
    /// there is rounded. With the bound on corners at zero this fails, and with either bound on the nearest depth.
    #[test]
    fn rays_through_corners_are_within_the_bounds() {
        let mut random = Random(92);
        let mut hits = 0;
        for round in 0..6000 {
            let is_far = round % 2 == 0;
            let tree_origin = if is_far {
                DVec3::new(1e-9, 2e-9, -1e-9)
            } else {
                DVec3::ZERO
            };
            let middle = if is_far {
                DVec3::new(3e7, 2e7, -3e7)
            } else {
                DVec3::ZERO
            };
            let a = (middle + random.point() * 1000.0).as_vec3();
            let way = random.point().normalize();
            let distance = random.decades(-3.3, 3.0);
            let eye = tree_origin + a.as_dvec3() - way * distance;
            let [b, c] = [(); 2].map(|()| {
                let out = random.point() * 100.0 + way * 200.0;
                (a.as_dvec3() + out).as_vec3()
            });
            let pitch = distance * random.decades(-10.0, -3.0);
            let plane = ImagePlane::new(32, 32, pitch).expect("a good plane");
            let pose = Pose::towards(eye, tree_origin + a.as_dvec3());
            let camera = Camera::new(pose, Projection::Perspective, plane);
            let space = space(&camera, tree_origin, Cull::None);
            // The view axis goes through the corner except for rounding.
            for aside in [0.0, 1e-4, -1e-4] {
                let ray = camera.ray(16.0 + aside, 16.0 - aside);
                let place = [15.5 + aside, 15.5 - aside];
                hits += usize::from(holds(&space, tree_origin, [a, b, c], &ray, place));
            }
        }
        assert!(hits > 1000, "{hits}");
    }

    /// Rays beside their places by as much as they may be. With their error at zero this fails.
    #[test]
    fn rays_beside_their_places_are_within_the_bounds() {
        let mut random = Random(93);
        let mut hits = 0;
        for _ in 0..3000 {
            let eye = random.point() * 5.0;
            let plane = ImagePlane::new(32, 32, 1e-3).expect("a good plane");
            let camera = Camera::new(
                Pose::towards(eye, DVec3::ZERO),
                Projection::Perspective,
                plane,
            );
            let mut space = space(&camera, DVec3::ZERO, Cull::None);
            space.ray_error = 1e-3;
            let aside = [random.signed(), random.signed()].map(|share| 1e-3 * share);
            let ray = camera.ray(16.0 + aside[0], 16.0 + aside[1]);
            let corners = [(); 3].map(|()| (random.point() * 2e-6).as_vec3());
            hits += usize::from(holds(&space, DVec3::ZERO, corners, &ray, [15.5; 2]));
        }
        assert!(hits > 100, "{hits}");
    }

    /// Triangles in front of the eye by less than the rounding of its position. Without δ they would count as behind
    /// it.
    #[test]
    fn triangles_within_rounding_of_the_eyes_plane_are_not_behind() {
        let mut random = Random(94);
        let mut hits = 0;
        let tree_origin = DVec3::X * 1e-9;
        for _ in 0..20_000 {
            // Coordinates there are multiples of 2⁻²⁸, and the eye is half of that beside one.
            let x = f64::from(1 << 25);
            let unit = 2f64.powi(-28);
            let eye = DVec3::new(x, 0.0, 0.0);
            let way = DVec3::new(random.unit(), random.signed(), random.signed()).normalize();
            let far = random.decades(0.0, 2.0);
            let corners = [(); 3].map(|()| {
                let aside = DVec3::new(0.0, random.signed(), random.signed()) * unit * far;
                (DVec3::X * x + aside).as_vec3()
            });
            let plane = ImagePlane::new(32, 32, 0.05).expect("a good plane");
            let camera = Camera::new(
                Pose::towards(eye, eye + way),
                Projection::Perspective,
                plane,
            );
            let space = space(&camera, tree_origin, Cull::None);
            let (x, y) = (random.unit() * 31.0, random.unit() * 31.0);
            let ray = camera.ray(x + 0.5, y + 0.5);
            hits += usize::from(holds(&space, tree_origin, corners, &ray, [x, y]));
        }
        assert!(hits > 10, "{hits}");
    }
}
