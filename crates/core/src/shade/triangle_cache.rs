//! A cache of what triangles show, for neighbouring samples.

use super::spans::{COLUMNS, Span, spans};
use crate::MISS;
use crate::num::simd::{LANES, Lanes};

/// The samples among which triangles are looked for that are not cached: four rows of a tile, but one row where
/// triangles are large. Where triangles are some twelve pixels large, 7.7 of eight are found on average; in two rows
/// 7.1, in eight 7.8.
const AHEAD: usize = 4 * COLUMNS;

/// What triangles show: a direct-mapped cache of `N` entries, indexed by the low bits of the primitive index.
///
/// Primitive indices are in the order of the tree's leaves, in which neighbours are close, so that few share an entry.
#[derive(Clone, Debug)]
pub(super) struct TriangleCache<T, const N: usize> {
    entries: Box<[(u32, T); N]>,
}

/// Triangles that are not cached.
pub(super) struct Unknown {
    /// They, and the first one again and again.
    pub(super) primitives: [u32; LANES],
    count: usize,
}

impl<T: Copy, const N: usize> TriangleCache<T, N> {
    /// A cache of misses, which have this value.
    pub(super) fn new(value: T) -> Self {
        Self {
            entries: Box::new([(MISS, value); N]),
        }
    }

    /// Whether a triangle is cached.
    #[inline(always)]
    pub(super) fn knows(&self, primitive: u32) -> bool {
        self.entries[primitive as usize % N].0 == primitive
    }

    /// What a triangle shows that is cached; another one's otherwise.
    ///
    /// By reference: a copy goes through the stack in pieces, and loads that span two of them wait for the stores.
    #[inline(always)]
    pub(super) fn get(&self, primitive: u32) -> &T {
        &self.entries[primitive as usize % N].1
    }

    #[inline(always)]
    pub(super) fn set(&mut self, primitive: u32, value: T) {
        self.entries[primitive as usize % N] = (primitive, value);
    }

    /// The triangle of the first of some samples of a tile, which is not cached, and up to seven others that samples
    /// after it show. They have entries from here on, whose values [`TriangleCache::set_all`] has to set.
    #[inline(always)]
    pub(super) fn unknown(&mut self, lanes: impl Lanes, samples: &[u32]) -> Unknown {
        let mut primitives = [samples[0]; LANES];
        let mut count = 0;
        'search: for row in samples[..samples.len().min(AHEAD)].chunks(COLUMNS) {
            let spans = spans(lanes, row);
            let are_large = spans.len() < LANES as u32;
            for Span { primitive, .. } in spans {
                let (known, _) = &mut self.entries[primitive as usize % N];
                let is_new = (*known != primitive) & (primitive != MISS);
                *known = if is_new { primitive } else { *known };
                primitives[count] = primitive;
                count += usize::from(is_new);
                if count == LANES {
                    break 'search;
                }
            }
            if are_large {
                break;
            }
        }
        primitives[count..].fill(samples[0]);
        Unknown { primitives, count }
    }

    /// Sets what these triangles show. The first one is cached from here on.
    #[inline(always)]
    pub(super) fn set_all(&mut self, unknown: &Unknown, values: &[T; LANES]) {
        let found = unknown.primitives.iter().zip(values).take(unknown.count);
        for (&primitive, &value) in found.rev() {
            self.set(primitive, value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::simd::Plain;
    use crate::random::Random;

    /// Values are those of their triangles, whatever shares an entry.
    #[test]
    fn triangles_have_their_own_values() {
        let mut random = Random(11);
        let mut found = 0;
        for kinds in [2.0, 9.0, 40.0, 3000.0] {
            let mut cache = TriangleCache::<u32, 16>::new(0);
            let samples: Vec<u32> = (0..4096)
                .map(|_| match (random.unit() * kinds) as u32 {
                    0 => MISS,
                    other => other * 5,
                })
                .collect();
            for (at, &primitive) in samples.iter().enumerate() {
                if primitive == MISS {
                    continue;
                }
                if !cache.knows(primitive) {
                    let unknown = cache.unknown(Plain, &samples[at..]);
                    assert_eq!(unknown.primitives[0], primitive);
                    assert!(!unknown.primitives.contains(&MISS));
                    found += unknown.count;
                    cache.set_all(&unknown, &unknown.primitives.map(|found| !found));
                    assert!(cache.knows(primitive));
                }
                assert_eq!(*cache.get(primitive), !primitive);
            }
            assert!(!cache.knows(MISS) || *cache.get(MISS) == 0);
        }
        assert!(found > 4096, "{found}");
    }

    /// Those of the next rows are found, but not those far ahead.
    #[test]
    fn next_triangles_are_found_in_the_next_rows() {
        let first_of = |cache: &mut TriangleCache<(), 64>, samples: &[u32]| {
            let unknown = cache.unknown(Plain, samples);
            unknown.primitives[..unknown.count].to_vec()
        };
        // Small triangles: a span every four samples, of two that come back.
        let mut samples: Vec<u32> = (0..2 * AHEAD as u32).map(|at| at / 4 % 2).collect();
        samples[AHEAD - 1] = 20;
        samples[AHEAD] = 21;
        let mut cache = TriangleCache::new(());
        assert_eq!(first_of(&mut cache, &samples), [0, 1, 20]);
        // Large ones: a row has few spans, and no other row is looked at.
        let mut samples = [0; AHEAD];
        samples[COLUMNS - 1] = 1;
        samples[COLUMNS] = 2;
        let mut cache = TriangleCache::new(());
        assert_eq!(first_of(&mut cache, &samples), [0, 1]);
        // More than there is room for.
        let samples: Vec<u32> = (0..AHEAD as u32).collect();
        let mut cache = TriangleCache::new(());
        assert_eq!(first_of(&mut cache, &samples), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert!(cache.knows(7) && !cache.knows(8));
    }
}
