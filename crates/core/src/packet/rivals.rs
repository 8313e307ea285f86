//! The rivals of undecided rays: the triangles of which one is the ray's closest hit, if anything is. A single ray
//! tests these alone, and does not traverse the tree.

/// The most rivals that a packet records: 64 a ray. With more, undecided rays would test as many triangles as
/// traversing the tree does; with fewer, more of them traverse it.
const MOST: usize = 1 << 16;

/// The rivals of a packet's rays.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rivals {
    /// The ray's index, in row order, and a primitive index.
    pairs: Vec<(u32, u32)>,
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

    /// Records a triangle, and the one that was the ray's decided closest hit before, if any.
    pub(super) fn push_both(&mut self, ray: usize, before: Option<u32>, primitive: u32) {
        if let Some(before) = before {
            self.push(ray, before);
        }
        self.push(ray, primitive);
    }

    /// Sorts the pairs by ray, as [`Rivals::of`] needs them.
    pub(super) fn sort(&mut self) {
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
