//! Lines over eight samples of a row at once.

use super::TileShader;
use super::edges::LineStyle;
use super::lines::Lines;
use super::tile_rays::TileRays;
use super::vectors::{Rows, Vectors};
use crate::hits::runs;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};

/// Lines over eight samples.
pub(super) struct EightLines<L: Lanes> {
    /// Their opacity, 0 to 1.
    coverage: L::F32,
    color: Vectors<L>,
}

impl<L: Lanes> EightLines<L> {
    /// Plain lines.
    #[inline(always)]
    pub(super) fn plain(lanes: L, lines: &Lines<'_>, coverage: L::F32) -> Self {
        Self {
            coverage,
            color: Vectors::splat(lanes, lines.color_of(LineStyle::Plain)),
        }
    }

    /// Whether any covers a sample.
    #[inline(always)]
    pub(super) fn are_seen(&self, lanes: L) -> bool {
        lanes.splat(0.0).lt(self.coverage).bits() != 0
    }

    /// Over opaque colours: as `over` has it, since c + (1 − c) is 1, its difference being off by half a unit in the last
    /// place of what is below 1 at most.
    #[inline(always)]
    pub(super) fn over(&self, lanes: L, under: Vectors<L>) -> Vectors<L> {
        let rest = lanes.splat(1.0) - self.coverage;
        let lined = self.color.scaled(self.coverage).plus(under.scaled(rest));
        under.replaced(lanes.splat(0.0).lt(self.coverage), lined)
    }
}

impl TileShader<'_> {
    /// The lines over eight samples.
    #[inline(always)]
    pub(super) fn eight_lines<L: Lanes>(
        &mut self,
        lanes: L,
        rays: &TileRays,
        (column, row): (u32, u32),
        primitives: &[u32; LANES],
    ) -> EightLines<L> {
        let shader = self.shader();
        let (xs, y) = (rays.columns(column), rays.row(row));
        let mut coverage = lanes.splat(0.0);
        let mut color = Vectors::splat(lanes, shader.lines.color_of(LineStyle::Plain));
        for run in runs(lanes, primitives) {
            let facet = self.facet(run.primitive, xs[0]);
            let from = lanes.mask_from(run.first);
            let mut covered = [0.0; LANES];
            match &facet.edges {
                None => {}
                Some(edges) if !edges.is_chosen() => {
                    covered = edges.coverages(&xs, y, shader.lines.width);
                }
                Some(edges) => {
                    let mut colors = Rows::ZERO;
                    for (lane, covered) in covered.iter_mut().enumerate() {
                        let (most, style) = edges.coverage(xs[lane], y, shader.lines.width);
                        *covered = most;
                        colors.set(lane, shader.lines.color_of(style));
                    }
                    color = color.replaced(from, Vectors::load(lanes, &colors));
                }
            }
            coverage = from.select(lanes.load(&covered), coverage);
        }
        EightLines { coverage, color }
    }
}
