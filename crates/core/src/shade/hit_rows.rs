//! Hits of a lattice's rays, eight of a row at a time.

use super::vectors::Row;
use crate::num::simd::{LANES, Lanes};
use crate::{Hits, MISS, PrimitiveHit};

/// What a lattice's rays hit, row by row; t, u and v are empty where the triangles alone are known.
#[derive(Clone, Copy)]
pub(super) struct HitRows<'h> {
    pub(super) primitives: &'h [u32],
    pub(super) t: &'h [f32],
    pub(super) u: &'h [f32],
    pub(super) v: &'h [f32],
}

impl<'h> HitRows<'h> {
    pub(super) fn new(hits: &'h Hits) -> Self {
        Self {
            primitives: &hits.primitives,
            t: &hits.t,
            u: &hits.u,
            v: &hits.v,
        }
    }

    /// Of which the triangles alone are known.
    pub(super) fn of_primitives(primitives: &'h [u32]) -> Self {
        let none = &[];
        Self {
            primitives,
            t: none,
            u: none,
            v: none,
        }
    }

    /// One ray's; a miss beyond the last.
    pub(super) fn get(&self, index: usize) -> PrimitiveHit {
        let or = |numbers: &[f32], otherwise| numbers.get(index).copied().unwrap_or(otherwise);
        let none = PrimitiveHit::NONE;
        PrimitiveHit {
            primitive: self.primitives.get(index).copied().unwrap_or(MISS),
            t: or(self.t, none.t),
            u: or(self.u, none.u),
            v: or(self.v, none.v),
        }
    }

    /// The triangles that so many rays from a number on hit, as far as they are known.
    #[inline(always)]
    pub(super) fn row(&self, first: usize, count: usize) -> &'h [u32] {
        let all = self.primitives.get(first..).unwrap_or_default();
        &all[..all.len().min(count)]
    }

    /// The triangles that eight rays from a number on hit; a miss beyond the last.
    #[inline(always)]
    pub(super) fn eight_primitives(&self, first: usize) -> &'h [u32; LANES] {
        let primitives = self.primitives.get(first..).and_then(<[u32]>::first_chunk);
        primitives.unwrap_or(&[MISS; LANES])
    }

    /// The hits of eight rays from a number on; a miss beyond the last.
    #[inline(always)]
    pub(super) fn eight(&self, first: usize) -> EightHits<'h> {
        const UNKNOWN: &Row = &[0.0; LANES];
        let numbers = |numbers: &'h [f32]| numbers.get(first..).and_then(<[f32]>::first_chunk);
        EightHits {
            primitives: self.eight_primitives(first),
            t: numbers(self.t).unwrap_or(UNKNOWN),
            weights: match (numbers(self.u), numbers(self.v)) {
                (Some(u), Some(v)) => Some((u, v)),
                _ => None,
            },
        }
    }
}

/// t, u and v of eight hits.
#[repr(align(32))]
pub(super) struct EightNumbers {
    pub(super) t: Row,
    pub(super) u: Row,
    pub(super) v: Row,
}

impl EightNumbers {
    pub(super) const ZERO: Self = Self {
        t: [0.0; LANES],
        u: [0.0; LANES],
        v: [0.0; LANES],
    };

    /// The hits of these triangles there.
    #[inline(always)]
    pub(super) fn with<'h>(&'h self, primitives: &'h [u32; LANES]) -> EightHits<'h> {
        EightHits {
            primitives,
            t: &self.t,
            weights: Some((&self.u, &self.v)),
        }
    }
}

/// What eight rays of a row hit, and where.
pub(super) struct EightHits<'h> {
    pub(super) primitives: &'h [u32; LANES],
    pub(super) t: &'h Row,
    /// u and v, where they are known.
    pub(super) weights: Option<(&'h Row, &'h Row)>,
}

impl EightHits<'_> {
    /// The hit of one of them.
    pub(super) fn get(&self, lane: usize) -> PrimitiveHit {
        PrimitiveHit {
            primitive: self.primitives[lane],
            t: self.t[lane],
            u: self.weights.map_or(0.0, |(u, _)| u[lane]),
            v: self.weights.map_or(0.0, |(_, v)| v[lane]),
        }
    }

    /// u and v; zero where they are not known.
    #[inline(always)]
    pub(super) fn load_weights<L: Lanes>(&self, lanes: L) -> (L::F32, L::F32) {
        match self.weights {
            Some((u, v)) => (lanes.load(u), lanes.load(v)),
            None => (lanes.splat(0.0), lanes.splat(0.0)),
        }
    }
}
