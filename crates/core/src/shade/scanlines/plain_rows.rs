//! Rows of many triangles that have no normals at their corners.

use super::{NUMBERS, fill};
use crate::MISS;
use crate::num::simd::{Lanes, Work};
use crate::shade::TileShader;
use crate::shade::numbers::Numbers;
use crate::shade::spans::spans;

/// Writes the numbers of a row's samples. A function of its own: within the one over all modes' spans it took 5 % of the
/// time of other modes' pictures.
pub(super) struct WritePlainRow<'r, 's> {
    pub(super) tile: &'r mut TileShader<'s>,
    pub(super) numbers: &'r mut [Numbers<f32>; NUMBERS],
    /// The row's samples, and those after them.
    pub(super) ahead: &'r [u32],
    pub(super) count: usize,
    /// Whether colours are written, after the normals.
    pub(super) has_colors: bool,
}

impl Work for WritePlainRow<'_, '_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        for span in spans(lanes, &self.ahead[..self.count]) {
            if span.primitive == MISS {
                continue;
            }
            let facet = self.tile.plain_facet(&self.ahead[span.first..]);
            fill(lanes, facet.normal.to_array(), self.numbers, span);
            if self.has_colors {
                fill(lanes, facet.color.to_array(), &mut self.numbers[3..], span);
            }
        }
    }
}
