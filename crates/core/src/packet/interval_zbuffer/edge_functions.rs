//! A triangle's functions over the rays of a packet, and the rays where these say that it may be hit.

use crate::num::simd::{F32x8, LANES, Lanes, Mask8, Work};
use crate::packet::params::{CELLS, COLUMNS, ROW, SIDE};
use crate::packet::ray_box::RayBox;
use crate::packet::setup::TriangleSetup;

/// The distance from a cell's first ray to its centre.
pub(super) const HALF: f32 = (ROW as f32 - 1.0) * 0.5;
/// Columns, and rows, of the centres of two rows of cells.
pub(super) const CELL_X: [f32; ROW] = [3.5, 11.5, 19.5, 27.5, 3.5, 11.5, 19.5, 27.5];
pub(super) const CELL_Y: [f32; ROW] = [3.5, 3.5, 3.5, 3.5, 11.5, 11.5, 11.5, 11.5];

/// A triangle's edge functions and depth key: value at the first ray, step per column, step per row.
#[derive(Clone, Copy, Debug)]
pub(in crate::packet) struct EdgeFunctions {
    pub(in crate::packet) primitive: u32,
    pub(in crate::packet) edges: [[f32; 3]; 3],
    pub(in crate::packet) edge_error: f32,
    pub(in crate::packet) depth_key: [f32; 3],
    pub(in crate::packet) depth_key_error: f32,
}

impl EdgeFunctions {
    /// Those of lane `l` of a set-up.
    #[inline(always)]
    pub(in crate::packet) fn of(set_up: &TriangleSetup, l: usize, primitive: u32) -> Self {
        let linear = |f: &[[f32; LANES]; 3]| [f[0][l], f[1][l], f[2][l]];
        Self {
            primitive,
            edges: [
                linear(&set_up.edges[0]),
                linear(&set_up.edges[1]),
                linear(&set_up.edges[2]),
            ],
            edge_error: set_up.edge_error[l],
            depth_key: linear(&set_up.depth_key),
            depth_key_error: set_up.depth_key_error[l],
        }
    }

    /// Of eight places, as bits, those where a ray may hit the triangle: where the signs of its edge functions do not surely
    /// differ within `half` of the place, across and along. For ill-conditioned triangles, of which it is not known which side
    /// the ray sees.
    #[inline(always)]
    pub(in crate::packet) fn may_be_hit<L: Lanes>(
        &self,
        lanes: L,
        (x, y): (L::F32, L::F32),
        half: f32,
    ) -> u32 {
        let (error, minus_error) = (lanes.splat(self.edge_error), lanes.splat(-self.edge_error));
        let mut sure = [0; 2];
        for [constant, by_column, by_row] in self.edges {
            let below = lanes.splat(constant) + lanes.splat(by_row) * y;
            let value = below + lanes.splat(by_column) * x;
            let swing = lanes.splat((by_column.abs() + by_row.abs()) * half);
            // Comparisons with NaN are false.
            sure[0] |= error.lt(value - swing).bits();
            sure[1] |= (value + swing).lt(minus_error).bits();
        }
        !(sure[0] & sure[1]) & ((1 << LANES) - 1)
    }
}

/// Hands over each ray of a packet within bounds that may hit a triangle, by [`EdgeFunctions::may_be_hit`]; first tests cells
/// of 8 × 8 rays, since triangles that are seen edge-on cross many and touch few rays.
pub(in crate::packet) struct ForEachThatMayHit<'f, F> {
    pub(in crate::packet) functions: &'f EdgeFunctions,
    /// Column and row of the ray that the functions begin at. None of the bounds is less.
    pub(in crate::packet) first: (usize, usize),
    pub(in crate::packet) bounds: RayBox,
    pub(in crate::packet) of_ray: F,
}

impl<F: FnMut(usize)> Work for ForEachThatMayHit<'_, F> {
    #[inline(always)]
    fn run(mut self, lanes: impl Lanes) {
        let (column, row) = self.first;
        let RayBox { right, bottom, .. } = self.bounds;
        let rows = (bottom as usize - row) / ROW + 1;
        let columns = (right as usize - column) / ROW + 1;
        // Two rows of cells at a time: eight cells.
        for cell_row in (0..rows).step_by(ROW / CELLS) {
            let below = lanes.splat((cell_row * ROW) as f32);
            let centres = (lanes.load(&CELL_X), lanes.load(&CELL_Y) + below);
            let mut cells = self.functions.may_be_hit(lanes, centres, HALF);
            while cells != 0 {
                let cell = cells.trailing_zeros() as usize;
                cells &= cells - 1;
                let (cell_column, cell_row) = (cell % CELLS, cell_row + cell / CELLS);
                if cell_column < columns && cell_row < rows {
                    self.visit_cell(lanes, (cell_column * ROW, cell_row * ROW));
                }
            }
        }
    }
}

impl<F: FnMut(usize)> ForEachThatMayHit<'_, F> {
    /// The rays of the cell that begins so many columns and rows from the first.
    #[inline(always)]
    fn visit_cell<L: Lanes>(&mut self, lanes: L, (across, along): (usize, usize)) {
        let (column, row) = (self.first.0 + across, self.first.1 + along);
        let bounds = self.bounds;
        let x = lanes.load(&COLUMNS) + lanes.splat(across as f32);
        let rows = row.max(bounds.top as usize)..=(row + ROW - 1).min(bounds.bottom as usize);
        for at in rows {
            let y = lanes.splat((at - self.first.1) as f32);
            let mut rays = self.functions.may_be_hit(lanes, (x, y), 0.0);
            while rays != 0 {
                let at_column = column + rays.trailing_zeros() as usize;
                rays &= rays - 1;
                if (bounds.left as usize..=bounds.right as usize).contains(&at_column) {
                    (self.of_ray)(at * SIDE + at_column);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::simd::{Simd, dispatch};
    use crate::packet::linear::FunctionDomain;
    use crate::random::Random;

    /// Functions in which nothing is rounded, over wide and narrow bounds anywhere in a packet: exactly those rays are handed
    /// over, each once, where not both signs are sure; where a function is not a number, all.
    #[test]
    fn rays_that_may_hit_are_those_of_every_single_test() {
        let mut random = Random(58);
        let (mut none, mut some, mut all) = (0, 0, 0);
        for round in 0..4000 {
            let mut whole = |most: f64| (random.signed() * most).round();
            let mut edges = [(); 3].map(|()| [whole(300.0), whole(16.0), whole(16.0)]);
            if round % 50 == 0 {
                edges = [[f64::NAN; 3]; 3];
            }
            let error = whole(40.0).abs();
            let [[left, right], [top, bottom]] = [(); 2].map(|()| {
                let most = if round % 2 == 0 { 31.0 } else { 7.0 };
                let [a, b] = [(); 2].map(|()| (random.unit() * most).round() as i32);
                let moved = (random.unit() * (31.0 - most)).round() as i32;
                [a.min(b) + moved, a.max(b) + moved]
            });
            let bounds = RayBox {
                left,
                right,
                top,
                bottom,
            };
            let functions = EdgeFunctions {
                primitive: 0,
                edges: edges.map(|edge| edge.map(|coefficient| coefficient as f32)),
                edge_error: error as f32,
                depth_key: [0.0; 3],
                depth_key_error: 0.0,
            };
            let span = FunctionDomain::of(&bounds);
            let mut expected = Vec::new();
            for (row, column) in
                (top..=bottom).flat_map(|row| (left..=right).map(move |at| (row, at)))
            {
                let place = [column - span.column, row - span.row].map(f64::from);
                let values = edges.map(|[constant, x, y]| constant + x * place[0] + y * place[1]);
                let is_sure = |sign: f64| values.iter().any(|value| value * sign > error);
                if !(is_sure(1.0) && is_sure(-1.0)) {
                    expected.push(row as usize * SIDE + column as usize);
                }
            }
            for simd in Simd::available() {
                let mut found = Vec::new();
                let finding = ForEachThatMayHit {
                    functions: &functions,
                    first: (span.column as usize, span.row as usize),
                    bounds,
                    of_ray: |ray| found.push(ray),
                };
                dispatch(simd, finding);
                found.sort_unstable();
                assert_eq!(found, expected, "{simd:?} {functions:?} {bounds:?}");
            }
            none += u32::from(expected.is_empty());
            all += u32::from(expected.len() == bounds.count() as usize);
            some += u32::from(!expected.is_empty());
        }
        some -= all;
        assert!(none > 400 && some > 400 && all > 400, "{none} {some} {all}");
    }
}
