//! Triangles that clipping planes cut.
//!
//! Where a ray hits a triangle, a plane's function n·p − c is the mean of its values at the corners, weighted by the
//! edge functions: inside the triangle, where these are all positive, it has the sign of f₀e₀ + f₁e₁ + f₂e₂, with fₖ
//! the value at the corner opposite to the edge k. That is one more linear function of the ray's place, and the part
//! of the triangle that is kept has one more edge.
//!
//! # Error bound
//! u = 2⁻²⁴. Edge functions are at most 1 and off by E < 1, each in a scale sₖ of its own. So values at the corners are
//! multiplied by these, and divided by the greatest product, M: fₖ below. A value is off by a ([`AtCorners::error`]) and
//! by u of itself, fₖ by aS with S = max sₖ / M, and by less than 3u of itself. F is the sum of their magnitudes. Three
//! products and two sums round no term more than three times: F·E + (3aS + 3u·F)(1 + E) + 3u·F(1 + 2E) < F·(E + 15u) +
//! 6aS. Underflow, 2⁻¹⁴⁸, is next to nothing, since F ≥ 1.

use super::depth_merge::DepthMerge;
use super::edge_functions::EdgeFunctions;
use super::{IntervalZBuffer, SIDE};
use crate::num::roundoff::U32;
use crate::num::simd::{F32x8, Lanes, Work, dispatch};
use crate::packet::decisions::Decisions;
use crate::packet::params::COLUMNS;
use crate::packet::plane_along_rays::PlaneAtKey;
use crate::packet::setup::TriangleSetup;
use crate::scene::CLIPPING_PLANES;
use crate::triangle::clip::AtCorners;

/// An additional edge: the plane's values at the corners, and the bound on the error of their weighted sum; and its
/// function along rays, which decides more next to the eye.
#[derive(Clone, Copy)]
pub(super) struct Cut {
    values: [f32; 3],
    error: f32,
    along: PlaneAtKey,
}

/// The cuts of a triangle, and their number.
pub(super) type Cuts = ([Cut; CLIPPING_PLANES], usize);

impl Cut {
    const NONE: Self = Self {
        values: [0.0; 3],
        error: 0.0,
        along: PlaneAtKey::UNKNOWN,
    };

    /// The cuts of a triangle that is set up in lane `l`.
    #[inline(always)]
    pub(super) fn all(
        primitive: u32,
        set_up: &TriangleSetup,
        l: usize,
        decisions: &Decisions<'_>,
    ) -> Cuts {
        let (mut cuts, mut count) = ([Self::NONE; CLIPPING_PLANES], 0);
        if !decisions.clip().is_empty() {
            let [p, q, r] = &set_up.edge_scales;
            let scales = [p[l], q[l], r[l]];
            for (cut, at) in cuts.iter_mut().zip(decisions.clipped(primitive)) {
                *cut = Self::new(&at, set_up.edge_error[l], scales);
                if let Some(plane) = decisions.plane_along_rays(at.plane) {
                    let key = set_up.depth_key.map(|coefficient| coefficient[l]);
                    let first = (set_up.column[l].into(), set_up.row[l].into());
                    cut.along = plane.at_key(key, set_up.depth_key_error[l], first);
                }
                count += 1;
            }
        }
        (cuts, count)
    }

    /// Where all values are zero the error is NaN, and leaves all rays undecided.
    fn new(at: &AtCorners, edge_error: f32, scales: [f64; 3]) -> Self {
        let mut values = [0.0; 3];
        for (value, (&at, scale)) in values.iter_mut().zip(at.values.iter().zip(scales)) {
            *value = f64::from(at) * scale;
        }
        let greatest = |of: [f64; 3]| of.into_iter().fold(0.0, |most: f64, it| most.max(it.abs()));
        let unit = greatest(values);
        let values = values.map(|value| (value / unit) as f32);
        let value_error = f64::from(at.error) * (greatest(scales) / unit);
        let sum: f32 = values.iter().map(|value| value.abs()).sum();
        // A hundredth covers the rounding of the bound itself.
        let error = 1.01 * (sum * (edge_error + 15.0 * U32) + 6.0 * value_error as f32);
        Self {
            values,
            error,
            ..Self::NONE
        }
    }

    /// The same as seen some columns further right and rows further down.
    #[inline(always)]
    fn moved(&self, columns: f32, rows: f32) -> Self {
        let [constant, x, y] = self.along.function;
        let mut moved = *self;
        moved.along.function = [(constant + y * rows) + x * columns, x, y];
        moved
    }

    /// Whether the plane surely removes what rays hit, and whether it surely keeps it: `edges` are the edge functions, `near`
    /// the depth key, `along` the function along rays.
    #[inline(always)]
    pub(super) fn decide<L: Lanes>(
        &self,
        lanes: L,
        [a, b, c]: [L::F32; 3],
        near: L::F32,
        along: L::F32,
    ) -> (L::Mask, L::Mask) {
        let [p, q, r] = self.values;
        let mean = lanes.splat(p) * a + lanes.splat(q) * b + lanes.splat(r) * c;
        let along = near * self.along.by_key + along;
        let (error, along_error) = (lanes.splat(self.error), lanes.splat(self.along.error));
        let removes = mean.lt(lanes.splat(-self.error)) | along.lt(lanes.splat(-self.along.error));
        let keeps = error.lt(mean) | along_error.lt(along);
        (removes, keeps)
    }

    /// The linear part of the function along rays.
    #[inline(always)]
    pub(super) fn along(&self) -> [f32; 3] {
        self.along.function
    }
}

/// [`IntervalZBuffer::rasterize_one`] of a triangle that planes cut. Apart from the others': next to them it made casting
/// without planes slower.
struct RasterizeCut<'r, 'd> {
    zbuffer: &'r mut IntervalZBuffer,
    set_up: &'r TriangleSetup,
    triangle: (usize, u32),
    cuts: &'r [Cut],
    decisions: &'r mut Decisions<'d>,
}

impl Work for RasterizeCut<'_, '_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            zbuffer,
            set_up,
            triangle,
            cuts,
            decisions,
        } = self;
        zbuffer.rasterize_one(lanes, set_up, triangle, cuts, decisions);
    }
}

impl IntervalZBuffer {
    /// Rasterises a triangle that clipping planes cut. Returns `false`, without doing anything, where no plane cuts
    /// it.
    #[inline(never)]
    pub(super) fn rasterize_cut(
        &mut self,
        set_up: &TriangleSetup,
        triangle: (usize, u32),
        decisions: &mut Decisions<'_>,
    ) -> bool {
        let (l, primitive) = triangle;
        let (cuts, count) = Cut::all(primitive, set_up, l, decisions);
        if count == 0 {
            return false;
        }
        let simd = decisions.simd();
        let work = RasterizeCut {
            zbuffer: self,
            set_up,
            triangle,
            cuts: &cuts[..count],
            decisions,
        };
        dispatch(simd, work);
        true
    }

    /// Rasterises rows of eight rays of a triangle that planes cut, which lie some columns and rows further than its first.
    #[inline(always)]
    pub(super) fn rasterize_cut_rows_at(
        &mut self,
        lanes: impl Lanes,
        functions: &EdgeFunctions,
        (cuts, columns, below): (&[Cut], f32, f32),
        (first, rows): (usize, usize),
        decisions: &mut Decisions<'_>,
    ) {
        let mut moved = [Cut::NONE; CLIPPING_PLANES];
        for (moved, cut) in moved.iter_mut().zip(cuts) {
            *moved = cut.moved(columns, below);
        }
        let cuts = &moved[..cuts.len()];
        self.rasterize_cut_rows(lanes, functions, cuts, first, rows, decisions);
    }

    /// Rasterises rows of eight rays, from the row of ray `first` on.
    #[inline(always)]
    pub(super) fn rasterize_cut_rows(
        &mut self,
        lanes: impl Lanes,
        functions: &EdgeFunctions,
        cuts: &[Cut],
        first: usize,
        rows: usize,
        decisions: &mut Decisions<'_>,
    ) {
        let [e, f, g] = functions.edges;
        let n = functions.depth_key;
        let x = lanes.load(&COLUMNS);
        let mut a = lanes.splat(e[0]) + lanes.splat(e[1]) * x;
        let mut b = lanes.splat(f[0]) + lanes.splat(f[1]) * x;
        let mut c = lanes.splat(g[0]) + lanes.splat(g[1]) * x;
        let mut near = lanes.splat(n[0]) + lanes.splat(n[1]) * x;
        let (step_a, step_b, step_c) = (lanes.splat(e[2]), lanes.splat(f[2]), lanes.splat(g[2]));
        let step_near = lanes.splat(n[2]);
        let error = lanes.splat(functions.edge_error);
        let minus_error = lanes.splat(-functions.edge_error);
        let merge = DepthMerge::new(lanes, functions, self.start_keys);
        for row in 0..rows {
            let first = first + row * SIDE;
            let Some((low, high, primitives)) = self.rays(first) else {
                return;
            };
            let least = a.min(b).min(c);
            let mut outside = least.lt(minus_error);
            let mut inside = error.lt(least);
            for cut in cuts {
                let [constant, by_column, by_row] = cut.along();
                let start = lanes.splat(constant + by_row * row as f32);
                let along = start + lanes.splat(by_column) * x;
                let (removes, keeps) = cut.decide(lanes, [a, b, c], near, along);
                outside = outside | removes;
                inside = inside & keeps;
            }
            let undecided = merge.row(lanes, near, Some((inside, outside)), low, high, primitives);
            if undecided.rays != 0 {
                let starting = merge.starting(near, Some(inside));
                self.leave_undecided_on_lattice(
                    (merge.primitive, first),
                    undecided,
                    &starting,
                    decisions,
                );
            }
            a = a + step_a;
            b = b + step_b;
            c = c + step_c;
            near = near + step_near;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Weighted sums that are off by as much as they may be: through edge functions, through plane values, and
    /// through rounding alone. With the bound of any of the three at zero this fails.
    #[test]
    fn weighted_sums_are_within_their_bounds() {
        let mut random = Random(37);
        for round in 0..3000 {
            let mut number = || random.signed() as f32;
            let (values, edges) = ([(); 3].map(|()| number()), [(); 3].map(|()| number()));
            let greatest = values
                .iter()
                .fold(0f32, |most, value| value.abs().max(most));
            let values = values.map(|value| value / greatest);
            let (edge_error, value_error) = [(1e-3, 0.0), (0.0, 1e-3), (0.0, 0.0)][round % 3];
            let at = AtCorners {
                plane: 0,
                values,
                error: value_error,
            };
            // One for all, or of any magnitude.
            let scales = [(); 3].map(|()| match round / 3 % 2 {
                0 => 1.0,
                _ => crate::math::pow(10.0, 30.0 * random.signed()),
            });
            let cut = Cut::new(&at, edge_error, scales);
            let [p, q, r] = cut.values;
            let [a, b, c] = edges;
            let sum = f64::from(p * a + q * b + r * c);
            let products: [f64; 3] = std::array::from_fn(|k| f64::from(values[k]) * scales[k]);
            let unit = products.iter().fold(0f64, |most, it| it.abs().max(most));
            let off = |x: f32, error: f32| f64::from(x) + f64::from(error);
            let truth: f64 = (0..3)
                .map(|k| {
                    let way = if edges[k] < 0.0 {
                        -value_error
                    } else {
                        value_error
                    };
                    let edge = off(edges[k], edge_error * values[k].signum());
                    off(values[k], way) * (scales[k] / unit) * edge
                })
                .sum();
            assert!(
                (sum - truth).abs() <= f64::from(cut.error),
                "{at:?} {scales:?} {edges:?}"
            );
        }
    }
}
