//! Spans of neighbouring samples of a row that show one triangle, or none.

use crate::MISS;
use crate::num::simd::{LANES, Lanes, Mask8};
use std::ops::Range;

/// The most samples of a row whose spans are found at once: a row of a tile of the usual size.
pub(super) const COLUMNS: usize = 64;

/// Samples of a row from `first` up to but not including `end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Span {
    pub(super) primitive: u32,
    pub(super) first: usize,
    pub(super) end: usize,
}

impl Span {
    /// A bit for each of its samples.
    #[inline(always)]
    pub(super) fn bits(self) -> u64 {
        (u64::MAX >> (COLUMNS - (self.end - self.first))) << self.first
    }
}

/// The spans of a row, from left to right.
pub(super) struct Spans<'h> {
    primitives: &'h [u32],
    /// A bit for each first sample of a span that is left.
    starts: u64,
}

/// The spans of at most [`COLUMNS`] samples; those beyond are left out.
#[inline(always)]
pub(super) fn spans(lanes: impl Lanes, primitives: &[u32]) -> Spans<'_> {
    let primitives = &primitives[..primitives.len().min(COLUMNS)];
    let count = primitives.len();
    let mut starts = u64::from(count > 0);
    // Without a branch, and eight at once: most rows have a span every few samples.
    let mut at = 1;
    while at + LANES <= count {
        starts |= changes(lanes, primitives, at) << at;
        at += LANES;
    }
    if at < count && count > LANES {
        // Some of these are known already.
        starts |= changes(lanes, primitives, count - LANES) << (count - LANES);
    } else {
        for at in at..count {
            starts |= u64::from(primitives[at] != primitives[at - 1]) << at;
        }
    }
    Spans { primitives, starts }
}

/// A bit for each of eight samples, from the one at `at` on, that shows another triangle than the one before it. `at`
/// is not the first, and there are eight.
#[inline(always)]
fn changes(lanes: impl Lanes, primitives: &[u32], at: usize) -> u64 {
    let eight = |at: usize| primitives.get(at..).and_then(<[u32]>::first_chunk);
    match (eight(at - 1), eight(at)) {
        (Some(before), Some(after)) => (!lanes.equal(before, after).bits() & 0xff).into(),
        _ => 0,
    }
}

impl Spans<'_> {
    /// The samples from the first to the last that shows a triangle.
    #[inline(always)]
    pub(super) fn shown(&self) -> Range<usize> {
        let Some((first, last)) = self.primitives.first().zip(self.primitives.last()) else {
            return 0..0;
        };
        let last_start = 63 - self.starts.leading_zeros() as usize % 64;
        let second_start = (self.starts & !1).trailing_zeros() as usize;
        let count = self.primitives.len();
        let begin = if *first == MISS {
            second_start.min(count)
        } else {
            0
        };
        let end = if *last == MISS { last_start } else { count };
        begin.min(end)..end
    }

    /// How many are left.
    #[inline(always)]
    pub(super) fn len(&self) -> u32 {
        self.starts.count_ones()
    }
}

impl Iterator for Spans<'_> {
    type Item = Span;

    #[inline(always)]
    fn next(&mut self) -> Option<Span> {
        if self.starts == 0 {
            return None;
        }
        let first = self.starts.trailing_zeros() as usize;
        self.starts &= self.starts - 1;
        // With no bit left there are 64 trailing zeros.
        let end = (self.starts.trailing_zeros() as usize).min(self.primitives.len());
        Some(Span {
            primitive: self.primitives[first],
            first,
            end,
        })
    }
}

/// Writes eight items from a place on, as far as the row reaches: a span's last eight reach into the next span, which
/// overwrites them.
#[inline(always)]
pub(super) fn store_eight<T: Copy>(row: &mut [T], at: usize, eight: &[T; LANES]) {
    match row.get_mut(at..).and_then(<[T]>::first_chunk_mut) {
        Some(all) => *all = *eight,
        None => {
            for (item, &one) in row.iter_mut().skip(at).zip(eight) {
                *item = one;
            }
        }
    }
}

/// The pixels of a row that are within a rectangle of so many columns.
#[inline(always)]
pub(super) fn within(pixels: &mut [[u8; 4]], columns: usize) -> &mut [[u8; 4]] {
    let count = pixels.len().min(columns);
    &mut pixels[..count]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::simd::{Simd, Work, dispatch};
    use crate::random::Random;

    /// A row's spans, and the samples from the first to the last that shows a triangle.
    struct Find<'t>(&'t [u32], &'t mut Vec<Span>, &'t mut Range<usize>);

    impl Work for Find<'_> {
        fn run(self, lanes: impl Lanes) {
            let Self(primitives, all, shown) = self;
            let spans = spans(lanes, primitives);
            *shown = spans.shown();
            all.extend(spans);
        }
    }

    /// Against a search one by one, for rows of every length.
    #[test]
    fn spans_are_the_longest_stretches_of_equal_primitives() {
        let mut random = Random(3);
        for length in 0..=COLUMNS {
            for kinds in [1.0, 2.0, 9.0] {
                let kind = |_| match (random.unit() * kinds) as u32 {
                    0 => MISS,
                    other => other,
                };
                let primitives: Vec<u32> = (0..length).map(kind).collect();
                let mut expected: Vec<Span> = Vec::new();
                for (at, &primitive) in primitives.iter().enumerate() {
                    match expected.last_mut() {
                        Some(span) if span.primitive == primitive => span.end = at + 1,
                        _ => expected.push(Span {
                            primitive,
                            first: at,
                            end: at + 1,
                        }),
                    }
                }
                let is_hit = |&primitive: &u32| primitive != MISS;
                let first = primitives.iter().position(is_hit);
                let last = primitives.iter().rposition(is_hit);
                let expected_shown = first.zip(last).map(|(first, last)| first..last + 1);
                for simd in Simd::available() {
                    let (mut found, mut shown) = (Vec::new(), 0..0);
                    dispatch(simd, Find(&primitives, &mut found, &mut shown));
                    assert_eq!(found, expected);
                    assert_eq!((!shown.is_empty()).then_some(shown), expected_shown);
                }
            }
        }
    }
}
