//! Merging the depths of a triangle into rows of eight rays: intervals that do not overlap are ordered.

use super::edge_functions::EdgeFunctions;
use super::{ALL, ROW};
use crate::num::simd::{F32x8, Lanes, Mask8};

/// Of a row of eight rays, as bits, those that merging leaves undecided: neither the triangle nor the nearest hit so
/// far is surely nearer.
#[derive(Clone, Copy)]
pub(super) struct UndecidedRays {
    pub(super) rays: u32,
    /// The undecided rays that surely hit the triangle.
    pub(super) hits: u32,
}

/// Eight rays that surely cross a triangle, but may start behind it.
#[derive(Clone, Copy)]
pub(super) struct StartingRays {
    /// These of the eight, as bits.
    pub(super) rays: u32,
    /// Bounds of the triangle's depth keys.
    pub(super) low: [f32; ROW],
    pub(super) high: [f32; ROW],
}

/// The constants of merging a triangle, the same for every row.
pub(super) struct DepthMerge<L: Lanes> {
    pub(super) primitive: u32,
    error: L::F32,
    start_keys: [L::F32; 2],
    never: L::F32,
}

impl<L: Lanes> DepthMerge<L> {
    #[inline(always)]
    pub(super) fn new(lanes: L, functions: &EdgeFunctions, start_keys: [f32; 2]) -> Self {
        Self::of(
            lanes,
            functions.primitive,
            functions.depth_key_error,
            start_keys,
        )
    }

    /// For a triangle whose depth key is off by at most `error`.
    #[inline(always)]
    pub(super) fn of(lanes: L, primitive: u32, error: f32, start_keys: [f32; 2]) -> Self {
        Self {
            primitive,
            error: lanes.splat(error),
            start_keys: [lanes.splat(start_keys[0]), lanes.splat(start_keys[1])],
            never: lanes.splat(f32::NEG_INFINITY),
        }
    }

    /// Of the rays that are surely inside a triangle of depth key `near`, or of all, those that may start behind it.
    #[inline(always)]
    pub(super) fn starting(&self, near: L::F32, inside: Option<L::Mask>) -> StartingRays {
        let [mut low, mut high] = [[0.0; ROW]; 2];
        (near - self.error).store(&mut low);
        (near + self.error).store(&mut high);
        let in_front = (near + self.error).lt(self.start_keys[0]).bits();
        // Not `map_or`: its closure may be compiled without the instruction set.
        let inside = match inside {
            Some(inside) => inside.bits(),
            None => ALL,
        };
        StartingRays {
            rays: inside & !in_front,
            low,
            high,
        }
    }

    /// Merges a triangle of depth key `near` into a row of rays. `sides` are the rays surely inside the triangle, and
    /// those surely outside; `None` means that all are surely inside.
    ///
    /// No value here is NaN: a triangle whose functions are not finite is ill-conditioned and is not merged.
    #[inline(always)]
    pub(super) fn row(
        &self,
        lanes: L,
        near: L::F32,
        sides: Option<(L::Mask, L::Mask)>,
        low: &mut [f32; ROW],
        high: &mut [f32; ROW],
        primitives: &mut [u32; ROW],
    ) -> UndecidedRays {
        let (old_low, old_high) = (lanes.load(low), lanes.load(high));
        let near_low = near - self.error;
        let near_high = near + self.error;
        let in_front = near_high.lt(self.start_keys[0]);
        let behind = self.start_keys[1].lt(near_low);
        let (hit, missed) = match sides {
            Some((inside, outside)) => (inside & in_front, outside | behind),
            None => (in_front, behind),
        };
        // A sure hit raises the lower bound of the nearest depth, a possible one raises the upper bound. A triangle
        // that is surely further changes neither.
        let if_hit = hit.select(near_low, self.never);
        let unless_missed = missed.select(self.never, near_high);
        old_low.max(if_hit).store(low);
        old_high.max(unless_missed).store(high);
        let wins = hit & old_high.lt(near_low);
        let loses = missed | near_high.lt(old_low);
        wins.store(self.primitive, primitives);
        // A ray for which the triangle neither surely wins nor surely loses stays undecided until a surely nearer
        // triangle wins it.
        UndecidedRays {
            rays: !(wins | loses).bits() & ALL,
            hits: hit.bits(),
        }
    }
}
