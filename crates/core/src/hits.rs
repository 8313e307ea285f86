//! Hits of many rays.

use crate::hit::{MISS, PrimitiveHit};

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
