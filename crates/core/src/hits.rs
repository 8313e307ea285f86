//! Hits of many rays.

use crate::hit::{MISS, PrimitiveHit};
use crate::num::simd::{LANES, Lanes, Mask8};

/// The closest hits of many rays, in structure-of-arrays order.
///
/// t, u and v are empty where only the triangles were asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hits {
    /// As [`PrimitiveHit::primitive`].
    pub primitives: Vec<u32>,
    /// As [`PrimitiveHit::t`].
    pub t: Vec<f32>,
    /// As [`PrimitiveHit::u`].
    pub u: Vec<f32>,
    /// As [`PrimitiveHit::v`].
    pub v: Vec<f32>,
}

impl Hits {
    /// The number of rays, misses included.
    pub fn len(&self) -> usize {
        self.primitives.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.primitives.is_empty()
    }

    /// The hit of one ray; a miss beyond the last. t, u and v that were not interpolated are those of a miss.
    pub fn get(&self, index: usize) -> PrimitiveHit {
        let or = |numbers: &[f32], otherwise| numbers.get(index).copied().unwrap_or(otherwise);
        PrimitiveHit {
            primitive: self.primitives.get(index).copied().unwrap_or(MISS),
            t: or(&self.t, PrimitiveHit::NONE.t),
            u: or(&self.u, PrimitiveHit::NONE.u),
            v: or(&self.v, PrimitiveHit::NONE.v),
        }
    }

    /// The hits in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = PrimitiveHit> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }

    /// Drops t, u and v.
    pub(crate) fn clear_tuv(&mut self) {
        for numbers in [&mut self.t, &mut self.u, &mut self.v] {
            numbers.clear();
        }
    }

    /// Makes room for t, u and v; their values are unspecified.
    pub(crate) fn resize_tuv(&mut self) {
        let count = self.len();
        for numbers in [&mut self.t, &mut self.u, &mut self.v] {
            numbers.resize(count, 0.0);
        }
    }
}

impl FromIterator<PrimitiveHit> for Hits {
    fn from_iter<I: IntoIterator<Item = PrimitiveHit>>(all: I) -> Self {
        let mut hits = Self::default();
        for hit in all {
            hits.primitives.push(hit.primitive);
            hits.t.push(hit.t);
            hits.u.push(hit.u);
            hits.v.push(hit.v);
        }
        hits
    }
}

/// The first lane of eight neighbouring rays that hits a primitive; the lanes after it may hit the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) primitive: u32,
    pub(crate) first: usize,
}

/// Runs of equal primitives among eight neighbouring rays, from left to right, without misses.
///
/// What a run's lanes share is computed once and written to all lanes from its first on; the next run overwrites the
/// rest. That stays in registers, where lanes stored one by one would have to reach memory before eight could be loaded
/// as one vector. Lanes of misses hold anything.
#[derive(Clone, Copy)]
pub(crate) struct Runs<'a> {
    primitives: &'a [u32; LANES],
    /// A bit for each first lane that is left.
    starts: u32,
}

/// The runs of eight rays' primitives.
#[inline(always)]
pub(crate) fn runs(lanes: impl Lanes, primitives: &[u32; LANES]) -> Runs<'_> {
    let [a, b, c, d, e, f, g, _] = *primitives;
    let before = [MISS, a, b, c, d, e, f, g];
    let are_misses = lanes.equal(primitives, &[MISS; LANES]);
    let starts = !(lanes.equal(primitives, &before) | are_misses).bits() & 0xff;
    Runs { primitives, starts }
}

impl Iterator for Runs<'_> {
    type Item = Run;

    #[inline(always)]
    fn next(&mut self) -> Option<Run> {
        if self.starts == 0 {
            return None;
        }
        let first = self.starts.trailing_zeros() as usize % LANES;
        self.starts &= self.starts - 1;
        let primitive = self.primitives[first];
        Some(Run { primitive, first })
    }
}

/// Whether any of eight rays misses: all lanes at once, where a search would compare one by one.
#[inline(always)]
pub(crate) fn any_misses(primitives: &[u32; LANES]) -> bool {
    let mut any = false;
    for &primitive in primitives {
        any |= primitive == MISS;
    }
    any
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::simd::Plain;

    #[test]
    fn a_miss_is_found_in_any_lane() {
        assert!(!any_misses(&[3; LANES]));
        for lane in 0..LANES {
            let mut primitives = [3; LANES];
            primitives[lane] = MISS;
            assert!(any_misses(&primitives));
        }
    }

    #[test]
    fn runs_are_of_neighbours_with_one_primitive_and_skip_misses() {
        let found = |primitives: [u32; LANES]| -> Vec<(u32, usize)> {
            let runs = runs(Plain, &primitives);
            runs.map(|run| (run.primitive, run.first)).collect()
        };
        assert_eq!(found([MISS; LANES]), []);
        assert_eq!(found([7; LANES]), [(7, 0)]);
        assert_eq!(
            found([MISS, 3, 3, MISS, 3, 0, 0, 9]),
            [(3, 1), (3, 4), (0, 5), (9, 7)]
        );
        assert_eq!(found([1, 2, 3, 4, 5, 6, 7, 8]).len(), LANES);
        assert_eq!(found([5, 5, 5, 5, 5, 5, 5, MISS]), [(5, 0)]);
    }
}
