//! Bounds of triangles in packet space, for rays that lie at [`Places`](crate::packet::places::Places) of their own.
//!
//! # Error bound
//! A corner's place is X/Z and Y/Z, with X and Y off by Kδ and Z by δ (see [`setup`](super)). Where Z ≥ 1024δ, a place p
//! is off by less than 1.001(K + |p|)δ/Z. 1.01(K + h + 64)δ/Z, which is taken, is more where |p| ≤ 100 + K/120; a place
//! further out is off by less than (K + |p|)/1000, and stays beyond 32 columns or rows, where no ray is. Places of rays
//! and these bounds are rounded to single precision, 32u and 64u: 2⁻¹⁶ covers both, and the rays' own error comes on
//! top. A hit is no nearer than the nearest corner, whose inverse depth is off by 1.01δ/Z of itself, and by u where it is
//! rounded to single precision: twice both are taken.

#![allow(
    clippy::needless_range_loop,
    reason = "a lane is an index into all the arrays at once"
)]

use super::{CornerLanes, LANES, PacketSpace, max, max3};
use crate::packet::place_box::PlaceBox;

/// The least ratio of a corner's depth to its error at which its place is used.
const CLEAR: f64 = 1024.0;

/// What rounding places and bounds to single precision takes.
const ROUNDING: f64 = 1.0 / 65536.0;

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
        let margin = ROUNDING + 2.0 * self.ray_error;
        let mut behind = [false; LANES];
        for l in 0..LANES {
            let reach = max(max3(ax[l], bx[l], cx[l]), max3(ay[l], by[l], cy[l]));
            let delta = self.delta(reach, max3(az[l], bz[l], cz[l]));
            let front = least(az[l], bz[l], cz[l]);
            // No number is NaN: eyes and corners are far within range (`FURTHEST` in `places`).
            let is_clear = front > CLEAR * delta;
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
    let least = if a < b { a } else { b };
    if least < c { least } else { c }
}

#[inline(always)]
fn most(a: f64, b: f64, c: f64) -> f64 {
    max(max(a, b), c)
}
