//! Numbers of twice double precision's digits, as sums of two that do not overlap (Dekker, "A Floating-Point Technique
//! for Extending the Available Precision", 1971).
//!
//! ε = 2⁻⁵³. A sum is off by less than 3.1ε² of itself (`AccurateDWPlusDW` of Joldes, Muller, Popescu, "Tight and Rigorous
//! Error Bounds for Basic Building Blocks of Double-Word Arithmetic", 2017), and a product by 5ε² (their `DWTimesDW1`,
//! whose bound is that of Muller, Rideau, "Formalization of Double-Word Arithmetic", 2022, for ties to even), as long as
//! nothing overflows or underflows.

use std::ops::{Add, Mul, Neg, Sub};

/// Numbers in double precision: one, or one in each of several lanes.
pub(crate) trait Doubles:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Zero, in as many lanes.
    fn zero(self) -> Self;
    /// What rounding to `product` took off a product: self · other − product exactly, as long as it does not underflow.
    fn lost_in_product(self, other: Self, product: Self) -> Self;
}

impl Doubles for f64 {
    #[inline(always)]
    fn zero(self) -> Self {
        0.0
    }

    /// Dekker's: without fused multiply-add, which not every processor has.
    #[inline(always)]
    fn lost_in_product(self, other: Self, product: Self) -> Self {
        let ([a1, a2], [b1, b2]) = (halves(self), halves(other));
        ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2
    }
}

/// `high` + `low`, `high` the sum rounded to double precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DoubleDouble<T = f64> {
    pub(crate) high: T,
    pub(crate) low: T,
}

impl<T: Doubles> DoubleDouble<T> {
    /// a − b exactly.
    #[inline(always)]
    pub(crate) fn difference(a: T, b: T) -> Self {
        two_sum(a, -b)
    }
}

impl<T: Doubles> From<T> for DoubleDouble<T> {
    #[inline(always)]
    fn from(high: T) -> Self {
        Self {
            high,
            low: high.zero(),
        }
    }
}

impl<T: Doubles> Neg for DoubleDouble<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl<T: Doubles> Add for DoubleDouble<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let highs = two_sum(self.high, other.high);
        let lows = two_sum(self.low, other.low);
        let sum = renormalized(highs.high, highs.low + lows.high);
        renormalized(sum.high, sum.low + lows.low)
    }
}

impl<T: Doubles> Sub for DoubleDouble<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<T: Doubles> Mul for DoubleDouble<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        let crossed = self.high * other.low + self.low * other.high;
        renormalized(product.high, product.low + crossed)
    }
}

/// a + b exactly (Knuth, "The Art of Computer Programming", volume 2, 1969, 4.2.2).
#[inline(always)]
fn two_sum<T: Doubles>(a: T, b: T) -> DoubleDouble<T> {
    let high = a + b;
    let added = high - a;
    DoubleDouble {
        high,
        low: (a - (high - added)) + (b - added),
    }
}

/// high + low where `low` is the lesser.
#[inline(always)]
fn renormalized<T: Doubles>(high: T, low: T) -> DoubleDouble<T> {
    let sum = high + low;
    DoubleDouble {
        high: sum,
        low: low - (sum - high),
    }
}

/// a · b exactly.
#[inline(always)]
fn two_product<T: Doubles>(a: T, b: T) -> DoubleDouble<T> {
    let high = a * b;
    DoubleDouble {
        high,
        low: a.lost_in_product(b, high),
    }
}

/// A number as a sum of two with 26 digits each (Veltkamp).
#[inline(always)]
fn halves(x: f64) -> [f64; 2] {
    let scaled = x * f64::from((1 << 27) + 1);
    let high = scaled - (scaled - x);
    [high, x - high]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::exact::decompose;
    use crate::random::Random;
    use num_bigint::BigInt;

    /// A number times 2^1200, exactly: the truth is integer arithmetic.
    fn exactly(x: DoubleDouble) -> BigInt {
        [x.high, x.low]
            .map(|x| {
                let (mantissa, exponent) = decompose(x);
                BigInt::from(mantissa) << (exponent + 1200)
            })
            .into_iter()
            .sum()
    }

    #[test]
    fn sums_and_products_are_within_their_error_bounds() {
        let mut random = Random(41);
        for _ in 0..20_000 {
            let mut double = || random.signed() * crate::math::pow(2.0, 40.0 * random.signed());
            let (a, b) = (
                DoubleDouble::difference(double(), double()),
                DoubleDouble::difference(double(), double()),
            );
            let [big_a, big_b] = [a, b].map(exactly);
            let near = |got: BigInt, expected: BigInt, factor: u32| {
                let off = (got - &expected).magnitude().clone() << 106u32;
                assert!(off <= expected.magnitude() * factor, "{a:?} {b:?}");
            };
            near(exactly(a + b), &big_a + &big_b, 4);
            near(exactly(a - b), &big_a - &big_b, 4);
            let product = exactly(a * b) << 1200;
            near(product, &big_a * &big_b, 5);
            let exact = two_product(a.high, b.high);
            let product = exactly(a.high.into()) * exactly(b.high.into());
            assert_eq!(exactly(exact) << 1200, product);
        }
    }
}
