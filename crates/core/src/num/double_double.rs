//! Numbers of twice double precision's digits, as sums of two that do not overlap (Dekker, "A Floating-Point Technique
//! for Extending the Available Precision", 1971).
//!
//! ε = 2⁻⁵³. A sum is off by less than 3.1ε² of itself (`AccurateDWPlusDW` of Joldes, Muller, Popescu, "Tight and Rigorous
//! Error Bounds for Basic Building Blocks of Double-Word Arithmetic", 2017), and a product by 5ε² (their `DWTimesDW1`,
//! whose bound is that of Muller, Rideau, "Formalization of Double-Word Arithmetic", 2022, for ties to even), as long as
//! nothing overflows or underflows.

use std::ops::{Add, Mul, Neg, Sub};

/// `high` + `low`, `high` the sum rounded to double precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DoubleDouble {
    pub(crate) high: f64,
    pub(crate) low: f64,
}

impl DoubleDouble {
    /// a − b exactly.
    pub(crate) fn difference(a: f64, b: f64) -> Self {
        two_sum(a, -b)
    }
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let highs = two_sum(self.high, other.high);
        let lows = two_sum(self.low, other.low);
        let sum = renormalized(highs.high, highs.low + lows.high);
        renormalized(sum.high, sum.low + lows.low)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        let crossed = self.high * other.low + self.low * other.high;
        renormalized(product.high, product.low + crossed)
    }
}

/// a + b exactly (Knuth, "The Art of Computer Programming", volume 2, 1969, 4.2.2).
fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let high = a + b;
    let added = high - a;
    DoubleDouble {
        high,
        low: (a - (high - added)) + (b - added),
    }
}

/// high + low where `low` is the lesser.
fn renormalized(high: f64, low: f64) -> DoubleDouble {
    let sum = high + low;
    DoubleDouble {
        high: sum,
        low: low - (sum - high),
    }
}

/// a · b exactly (Dekker): without fused multiply-add, which not every processor has.
fn two_product(a: f64, b: f64) -> DoubleDouble {
    let high = a * b;
    let ([a1, a2], [b1, b2]) = (halves(a), halves(b));
    DoubleDouble {
        high,
        low: ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2,
    }
}

/// A number as a sum of two with 26 digits each (Veltkamp).
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
