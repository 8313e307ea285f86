//! Edge functions of a triangle along one ray, in double precision, with bounds on their errors.

use crate::num::choice::greater;
use crate::num::roundoff::EPSILON;

/// The largest relative error of a weight, in units of the weights' sum, that still rounds well to single precision:
/// 2⁻²⁸, a sixteenth of its unit roundoff. With a larger one u and v lose digits; with a smaller one more hits are
/// computed with tighter bounds.
pub(super) const WELL_CONDITIONED: f64 = 1.0 / (1u64 << 28) as f64;

/// The axes in cyclic order, the major one last.
pub(super) const fn axes(major: usize) -> [usize; 3] {
    [(major + 1) % 3, (major + 2) % 3, major]
}

/// The axis along which a direction is longest.
#[inline(always)]
pub(super) fn major_axis(x: f64, y: f64, z: f64) -> usize {
    let (x, y, z) = (x.abs(), y.abs(), z.abs());
    if (z >= x) & (z >= y) {
        2
    } else if y >= x {
        1
    } else {
        0
    }
}

/// A triangle's edge functions for one ray, in double precision.
///
/// # Error bounds
/// ε = 2⁻⁵³ (notation and lemmas: `docs/error-bounds.md`), m the greatest coordinate of the corners relative to the ray's
/// origin, η the error of that origin.
///
/// * **Sheared corners.** A corner relative to the origin is off by εm + η a coordinate, a shear factor of at most 1
///   by ε, so their product by 3εm + η, and a sheared coordinate, after one more subtraction of numbers up to m each,
///   by 2·εm + 4·εm + 2η. With higher orders: δ = 8εm + 3η.
/// * **Edge functions.** `cx·by − cy·bx` of coordinates within δ is off by δ(|cx| + |by| + |cy| + |bx|) + 2δ², and
///   by 2ε(|cx·by| + |cy·bx|) from its own rounding, which is below half the first term since |cx| ≤ 2m. Summed over
///   all corners: E = 2δ(Σ|x| + Σ|y| + δ).
/// * **Depth.** It is the mean of the corners' depths z weighted by the edge functions (lemma 7). Errors of E move it by at
///   most 3E·(max z − min z)/|D|, D their sum; its own rounding, and that of the depths, is below 10εm + η. With
///   higher orders: 4E·(max z − min z)/|D| + 2δ.
///
/// E's δ² is covered: where Σ|x| + Σ|y| < 4δ, every function is less than δ(Σ|x| + Σ|y|) and undecided without it;
/// elsewhere the quarter of E's first term that rounding leaves is at least 2δ². The quotient by the advance rounds by
/// ε of the depth, at most m: 2δ, which is 16εm, has room for that.
#[derive(Clone, Copy)]
pub(super) struct Edges {
    pub(super) functions: [f64; 3],
    error: f64,
    pub(super) determinant: f64,
    depths: [f64; 3],
    delta: f64,
}

/// Where a ray hits a triangle, in double precision.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub(super) t: f64,
    pub(super) t_error: f64,
    pub(super) u: f64,
    pub(super) v: f64,
}

impl Edges {
    /// `x`, `y` and `z` are the corners' coordinates relative to the ray's origin, z along its major axis.
    #[inline(always)]
    pub(super) fn new(
        x: [f64; 3],
        y: [f64; 3],
        z: [f64; 3],
        shear: [f64; 2],
        origin_error: f64,
    ) -> Self {
        let largest = |[a, b, c]: [f64; 3]| greater(greater(a.abs(), b.abs()), c.abs());
        let m = greater(greater(largest(x), largest(y)), largest(z));
        let delta = 8.0 * EPSILON * m + 3.0 * origin_error;

        let x = [
            x[0] - shear[0] * z[0],
            x[1] - shear[0] * z[1],
            x[2] - shear[0] * z[2],
        ];
        let y = [
            y[0] - shear[1] * z[0],
            y[1] - shear[1] * z[1],
            y[2] - shear[1] * z[2],
        ];
        let u = x[2] * y[1] - y[2] * x[1];
        let v = x[0] * y[2] - y[0] * x[2];
        let w = x[1] * y[0] - y[1] * x[0];
        let sum = (x[0].abs() + x[1].abs() + x[2].abs()) + (y[0].abs() + y[1].abs() + y[2].abs());
        Self {
            functions: [u, v, w],
            error: 2.0 * delta * (sum + delta),
            determinant: u + v + w,
            depths: z,
            delta,
        }
    }

    /// Whether two of the functions surely have different signs.
    #[inline(always)]
    pub(super) fn surely_outside(&self) -> bool {
        let [u, v, w] = self.functions;
        let below = (u < -self.error) | (v < -self.error) | (w < -self.error);
        let above = (u > self.error) | (v > self.error) | (w > self.error);
        below & above
    }

    /// Whether all functions surely have one sign, and the weights are accurate to single precision.
    #[inline(always)]
    pub(super) fn surely_inside(&self) -> bool {
        let [u, v, w] = self.functions;
        let above = (u > self.error) & (v > self.error) & (w > self.error);
        let below = (u < -self.error) & (v < -self.error) & (w < -self.error);
        let well_conditioned = self.error <= WELL_CONDITIONED * self.determinant.abs();
        (above | below) & well_conditioned
    }

    /// The hit of a ray that is surely inside the triangle.
    #[inline(always)]
    pub(super) fn point(&self, advance: f64) -> Point {
        let [t, u, v] = self.weights(advance);
        let depth_error =
            4.0 * self.error * self.span() / self.determinant.abs() + 2.0 * self.delta;
        Point {
            t,
            t_error: depth_error / advance.abs(),
            u,
            v,
        }
    }

    /// As [`Edges::point`], without the error bound.
    #[inline(always)]
    pub(super) fn weights(&self, advance: f64) -> [f64; 3] {
        let [_, v, w] = self.functions;
        let depth = self.depth_sum() / self.determinant;
        [depth / advance, v / self.determinant, w / self.determinant]
    }

    /// Whether the parameter is surely accurate to single precision: the test of [`Point::is_single`] multiplied by
    /// the determinant. That saves two divisions; half the limit covers the roundings of both sides.
    #[inline(always)]
    pub(super) fn surely_single(&self) -> bool {
        let error = 4.0 * self.error * self.span() + 2.0 * self.delta * self.determinant.abs();
        error <= 1.0 / (1u64 << 28) as f64 * self.depth_sum().abs()
    }

    /// The interpolated depth times the determinant.
    #[inline(always)]
    fn depth_sum(&self) -> f64 {
        let ([u, v, w], z) = (self.functions, self.depths);
        u * z[0] + v * z[1] + w * z[2]
    }

    /// The difference in depth of the nearest and the furthest corner, along the major axis.
    #[inline(always)]
    fn span(&self) -> f64 {
        let z = self.depths;
        greater(greater(z[0], z[1]), z[2]) + greater(greater(-z[0], -z[1]), -z[2])
    }
}

impl Point {
    /// Whether the parameter is accurate to single precision, within an eighth of its unit roundoff.
    #[inline(always)]
    pub(super) fn is_single(&self) -> bool {
        self.t_error <= 1.0 / (1u64 << 27) as f64 * self.t.abs()
    }
}
