//! Hits of many rays.

use crate::hit::{MISS, SlotHit};

/// The closest hits of many rays, in structure-of-arrays order.
///
/// t, u and v may not have been interpolated: they are then empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hits {
    /// As [`SlotHit::slot`].
    pub slots: Vec<u32>,
    /// As [`SlotHit::t`].
    pub t: Vec<f32>,
    /// As [`SlotHit::u`].
    pub u: Vec<f32>,
    /// As [`SlotHit::v`].
    pub v: Vec<f32>,
}

impl Hits {
    /// How many there are, misses included.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// One of them; a miss beyond the last. What was not interpolated is as at a miss.
    pub fn get(&self, index: usize) -> SlotHit {
        let or = |numbers: &[f32], otherwise| numbers.get(index).copied().unwrap_or(otherwise);
        SlotHit {
            slot: self.slots.get(index).copied().unwrap_or(MISS),
            t: or(&self.t, SlotHit::NONE.t),
            u: or(&self.u, SlotHit::NONE.u),
            v: or(&self.v, SlotHit::NONE.v),
        }
    }

    /// All of them.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = SlotHit> + '_ {
        (0..self.len()).map(|index| self.get(index))
    }

    /// Forgets t, u and v.
    pub(crate) fn forget_places(&mut self) {
        for numbers in [&mut self.t, &mut self.u, &mut self.v] {
            numbers.clear();
        }
    }

    /// Makes room for t, u and v, as at misses.
    pub(crate) fn make_places(&mut self) {
        self.forget_places();
        let SlotHit { t, u, v, .. } = SlotHit::NONE;
        self.t.resize(self.len(), t);
        self.u.resize(self.len(), u);
        self.v.resize(self.len(), v);
    }

    pub(crate) fn set(&mut self, index: usize, hit: SlotHit) {
        self.slots[index] = hit.slot;
        self.t[index] = hit.t;
        self.u[index] = hit.u;
        self.v[index] = hit.v;
    }
}

impl FromIterator<SlotHit> for Hits {
    fn from_iter<I: IntoIterator<Item = SlotHit>>(all: I) -> Self {
        let mut hits = Self::default();
        for hit in all {
            hits.slots.push(hit.slot);
            hits.t.push(hit.t);
            hits.u.push(hit.u);
            hits.v.push(hit.v);
        }
        hits
    }
}
