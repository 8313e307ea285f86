//! A number for each sample of a row.

use super::spans::COLUMNS;
use crate::num::simd::LANES;

/// A number a sample of a row, and room for the last eight of a span.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(super) struct Numbers<N>(pub(super) [N; COLUMNS + LANES]);

impl<N: Copy> Numbers<N> {
    /// The same number for all samples.
    pub(super) fn all(number: N) -> Self {
        Self([number; COLUMNS + LANES])
    }

    /// Eight of them. Places are below [`COLUMNS`].
    #[inline(always)]
    pub(super) fn eight(&self, at: usize) -> &[N; LANES] {
        let all = &self.0[at % COLUMNS..];
        all.first_chunk()
            .expect("more than eight from any place on")
    }

    #[inline(always)]
    pub(super) fn eight_mut(&mut self, at: usize) -> &mut [N; LANES] {
        let all = &mut self.0[at % COLUMNS..];
        all.first_chunk_mut()
            .expect("more than eight from any place on")
    }
}
