//! The rivals of undecided rays: the triangles of which one is the ray's closest hit, if anything is. A single ray
//! tests these alone, and does not traverse the tree.
//!
//! A triangle that is surely further than one that the ray surely hits is no rival. So one sure hit of each undecided
//! ray is kept: without it every later triangle would be a rival of a ray once it is undecided, and thousands are where
//! triangles of one plane overlap.

use super::params::SIDE;
use crate::hit::MISS;

/// The most rivals that a packet records: 128 a ray. With more, undecided rays would test as many triangles as
/// traversing the tree does; with fewer, more of them traverse it.
const MOST: usize = 1 << 17;

/// The rivals of a packet's rays.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rivals {
    /// The ray's index, in row order, and a primitive index.
    pairs: Vec<(u32, u32)>,
    /// For each undecided ray a triangle that it surely hits, or [`MISS`]. Empty before the first undecided ray;
    /// entries of other rays are meaningless.
    sure_hits: Vec<u32>,
    overflowed: bool,
}

impl Rivals {
    pub(super) fn clear(&mut self) {
        self.pairs.clear();
        self.overflowed = false;
    }

    /// Records that a triangle may be a ray's closest hit.
    pub(super) fn push(&mut self, ray: usize, primitive: u32) {
        if self.pairs.len() < MOST {
            self.pairs.push((ray as u32, primitive));
        } else {
            self.overflowed = true;
        }
    }

    /// Begins the list of a ray that was decided until now, with the closest hit that it had, if any.
    pub(super) fn begin(&mut self, ray: usize, before: Option<u32>) {
        if self.sure_hits.is_empty() {
            self.sure_hits.resize(SIDE * SIDE, MISS);
        }
        if let Some(before) = before {
            self.push(ray, before);
        }
        self.set_sure_hit(ray, before.unwrap_or(MISS));
    }

    /// Keeps, as the sure hit of an undecided ray, one of its rivals.
    pub(super) fn set_sure_hit(&mut self, ray: usize, primitive: u32) {
        if let Some(sure_hit) = self.sure_hits.get_mut(ray) {
            *sure_hit = primitive;
        }
    }

    /// The sure hit of an undecided ray, if one is known.
    pub(super) fn sure_hit(&self, ray: usize) -> Option<u32> {
        let sure_hit = self.sure_hits.get(ray).copied();
        sure_hit.filter(|&primitive| primitive != MISS)
    }

    /// Records that any triangle may be any ray's closest hit.
    pub(super) fn forget(&mut self) {
        self.overflowed = true;
    }

    /// Sorts the pairs by ray, as [`Rivals::of`] needs them.
    pub(super) fn sort(&mut self) {
        if self.overflowed {
            return;
        }
        self.pairs.sort_unstable();
        self.pairs.dedup();
    }

    /// A ray's rivals, after sorting; `None` where too many were recorded.
    pub(super) fn of(&self, ray: usize) -> Option<&[(u32, u32)]> {
        if self.overflowed {
            return None;
        }
        let first = self.pairs.partition_point(|pair| (pair.0 as usize) < ray);
        let rest = &self.pairs[first..];
        let count = rest.partition_point(|pair| pair.0 as usize == ray);
        Some(&rest[..count])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_becomes_undecided_with_the_hit_that_it_had() {
        let mut rivals = Rivals::default();
        rivals.begin(3, Some(8));
        rivals.begin(4, None);
        rivals.push(4, 9);
        rivals.sort();
        assert_eq!((rivals.sure_hit(3), rivals.sure_hit(4)), (Some(8), None));
        assert_eq!(rivals.of(3), Some(&[(3, 8)][..]));
        rivals.set_sure_hit(4, 9);
        assert_eq!(rivals.sure_hit(4), Some(9));
        rivals.begin(4, None);
        assert_eq!(rivals.sure_hit(4), None);
    }

    #[test]
    fn rivals_are_grouped_by_ray_without_repetition() {
        let mut rivals = Rivals::default();
        for (ray, primitive) in [(7, 3), (2, 9), (7, 1), (7, 3), (0, 4)] {
            rivals.push(ray, primitive);
        }
        rivals.sort();
        assert_eq!(rivals.of(7), Some(&[(7, 1), (7, 3)][..]));
        assert_eq!(rivals.of(0), Some(&[(0, 4)][..]));
        assert_eq!(rivals.of(5), Some(&[][..]));
        for _ in 0..=MOST {
            rivals.push(1, 1);
        }
        rivals.sort();
        assert_eq!(rivals.of(2), None);
        rivals.clear();
        assert_eq!(rivals.of(2), Some(&[][..]));
    }
}
