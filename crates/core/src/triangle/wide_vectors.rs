//! Vectors in double-double precision, their cross products, and the products of those with a third vector: determinants.
//!
//! A vector is in three of four lanes, so that its coordinates are computed at once. The bits are the same on every
//! instruction set: a product's rounding error is exact on each, as long as it does not underflow. Highs other than zero
//! are at least 2⁻³⁰⁰ in a factor and 2⁻⁶⁰⁰ in a cross product, or there are no determinants: their products are at least
//! 2⁻⁹⁰⁰, and the errors of those at least 2⁻¹⁰⁰⁶.

use super::componentwise::{Determinant, FACTOR_RANGE};
use crate::num::double_double::DoubleDouble;
use crate::num::roundoff::EPSILON;
use crate::num::simd::{F64x4, Lanes};
use glam::{DVec3, Vec3};

/// The magnitudes of a cross product's coordinates other than zero.
const CROSS_RANGE: (f64, f64) = (FACTOR_RANGE.0 * FACTOR_RANGE.0, f64::MAX);

/// The error of a determinant, as a share of its permanent (see
/// [`WideDeterminants`](super::wide_determinants::WideDeterminants)).
const OFF: f64 = 32.0 * EPSILON * EPSILON;

pub(super) type WideVector<L> = DoubleDouble<<L as Lanes>::F64>;

/// A vector in double-double precision, and the magnitudes of its coordinates, rounded to double precision.
#[derive(Clone, Copy)]
pub(super) struct WideFactor<L: Lanes> {
    pub(super) value: WideVector<L>,
    pub(super) size: L::F64,
}

impl<L: Lanes> WideFactor<L> {
    #[inline(always)]
    fn of(value: WideVector<L>) -> Self {
        Self {
            value,
            size: value.high.abs(),
        }
    }

    #[inline(always)]
    pub(super) fn exact(lanes: L, vector: DVec3) -> Self {
        Self::of(load(lanes, vector).into())
    }

    #[inline(always)]
    pub(super) fn difference(lanes: L, a: DVec3, b: DVec3) -> Self {
        Self::of(DoubleDouble::difference(load(lanes, a), load(lanes, b)))
    }

    /// From a corner to another.
    #[inline(always)]
    pub(super) fn edge(lanes: L, [from, to]: [Vec3; 2]) -> Self {
        Self::difference(lanes, to.as_dvec3(), from.as_dvec3())
    }

    /// A corner relative to the eye that the tree's origin is relative to.
    #[inline(always)]
    pub(super) fn relative(lanes: L, corner: Vec3, tree_origin: WideVector<L>) -> Self {
        Self::of(tree_origin + load(lanes, corner.as_dvec3()).into())
    }

    /// Whether all coordinates are in [`FACTOR_RANGE`]; NaN is not.
    #[inline(always)]
    pub(super) fn is_in_range(&self) -> bool {
        are_within(FACTOR_RANGE, self.size)
    }
}

/// In three lanes of four.
#[inline(always)]
pub(super) fn load<L: Lanes>(lanes: L, DVec3 { x, y, z }: DVec3) -> L::F64 {
    lanes.doubles([x, y, z, 0.0])
}

/// Whether all magnitudes are zero or in a range.
#[inline(always)]
fn are_within((least, most): (f64, f64), sizes: impl F64x4) -> bool {
    let range = least..=most;
    let mut are_within = true;
    for size in sizes.to_array() {
        are_within &= range.contains(&size) | (size == 0.0);
    }
    are_within
}

/// A cross product in double-double arithmetic. That of two corners relative to an eye, times a ray's direction, is one
/// of its weights.
#[derive(Clone, Copy)]
pub(super) struct Cross<L: Lanes> {
    value: WideVector<L>,
    /// Of each coordinate, the sum of its products' magnitudes.
    terms: L::F64,
}

impl<L: Lanes> Cross<L> {
    #[inline(always)]
    pub(super) fn new(b: &WideFactor<L>, c: &WideFactor<L>) -> Self {
        let ([b, c], terms) = ([b.value, c.value], terms(b, c));
        Self {
            value: turned(b * turned(c) - turned(b) * c),
            terms,
        }
    }

    /// A×C of two corners relative to an eye; `edge` is that from A to C. A×u and C×u are the same, with u = C − A: the one
    /// with the least terms is computed, so that triangles that are tiny compared with their distance are decided as
    /// well.
    #[inline(always)]
    pub(super) fn of_corners(a: &WideFactor<L>, c: &WideFactor<L>, edge: &WideFactor<L>) -> Self {
        let pairs = [(a, c), (a, edge), (c, edge)];
        let sums = [sum(terms(a, c)), sum(terms(a, edge)), sum(terms(c, edge))];
        let mut best = 0;
        for other in 1..3 {
            if sums[other] < sums[best] {
                best = other;
            }
        }
        let (b, c) = pairs[best];
        Self::new(b, c)
    }

    /// Whether products with factors in range do not underflow.
    #[inline(always)]
    pub(super) fn is_in_range(&self) -> bool {
        are_within(CROSS_RANGE, self.value.high.abs())
    }

    #[inline(always)]
    pub(super) fn load(lanes: L, cross: &WideCross) -> Self {
        Self {
            value: DoubleDouble {
                high: lanes.doubles(cross.high),
                low: lanes.doubles(cross.low),
            },
            terms: lanes.doubles(cross.terms),
        }
    }

    #[inline(always)]
    pub(super) fn store(&self) -> WideCross {
        WideCross {
            high: self.value.high.to_array(),
            low: self.value.low.to_array(),
            terms: self.terms.to_array(),
        }
    }
}

/// Of each coordinate of a cross product, the sum of its products' magnitudes.
#[inline(always)]
pub(super) fn terms<L: Lanes>(b: &WideFactor<L>, c: &WideFactor<L>) -> L::F64 {
    let (b, c) = (b.size, c.size);
    (b * c.yzx() + b.yzx() * c).yzx()
}

#[inline(always)]
pub(super) fn sum(vector: impl F64x4) -> f64 {
    let [x, y, z, _] = vector.to_array();
    x + y + z
}

#[inline(always)]
fn turned<F: F64x4>(vector: DoubleDouble<F>) -> DoubleDouble<F> {
    DoubleDouble {
        high: vector.high.yzx(),
        low: vector.low.yzx(),
    }
}

/// The products of three cross products with a third factor each.
#[inline(always)]
pub(super) fn determinants<L: Lanes>(
    lanes: L,
    crosses: &[Cross<L>; 3],
    factors: [&WideFactor<L>; 3],
) -> [Determinant; 3] {
    let zero = lanes.doubles([0.0; 4]);
    let (mut high, mut low, mut magnitudes) = ([zero; 4], [zero; 4], [zero; 4]);
    for (at, (cross, factor)) in crosses.iter().zip(factors).enumerate() {
        let products = factor.value * cross.value;
        (high[at], low[at]) = (products.high, products.low);
        magnitudes[at] = factor.size * cross.terms;
    }
    let ([x, y, z, _], [x_low, y_low, z_low, _]) = (F64x4::transpose(high), F64x4::transpose(low));
    let of_x = DoubleDouble {
        high: x,
        low: x_low,
    };
    let of_y = DoubleDouble {
        high: y,
        low: y_low,
    };
    let of_z = DoubleDouble {
        high: z,
        low: z_low,
    };
    let sums = of_x + of_y + of_z;
    let [x, y, z, _] = F64x4::transpose(magnitudes);
    let permanents = (x + y + z).to_array();
    let values = sums.high.to_array();
    let of = |at: usize| Determinant {
        value: values[at],
        // A thousandth covers the permanent's own rounding.
        error: OFF * (permanents[at] * 1.001) + EPSILON * values[at].abs(),
    };
    [of(0), of(1), of(2)]
}

/// The product of a cross product with a third factor.
#[inline(always)]
pub(super) fn determinant<L: Lanes>(
    lanes: L,
    cross: Cross<L>,
    factor: &WideFactor<L>,
) -> Determinant {
    let [determinant, ..] = determinants(lanes, &[cross; 3], [factor; 3]);
    determinant
}

/// A cross product in memory; of no coordinate in the fourth place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WideCross {
    pub(super) high: [f64; 4],
    pub(super) low: [f64; 4],
    /// Of each coordinate, the sum of its products' magnitudes.
    pub(super) terms: [f64; 4],
}

impl WideCross {
    /// Rounded to double precision, and of each component the bound on its error before that (see
    /// [`eye_determinants`](super::eye_determinants)).
    pub(super) fn rounded(&self) -> (DVec3, DVec3) {
        let xyz = |[x, y, z, _]: [f64; 4]| DVec3::new(x, y, z);
        let off = xyz(self.terms) * (16.0 * EPSILON * EPSILON);
        (xyz(self.high), off)
    }
}
