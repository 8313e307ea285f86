//! Dyadic numbers (integers times powers of two): sums and products of `f64` without rounding.

use dashu_int::{IBig, Sign};
use dashu_ratio::RBig;
use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

/// `mantissa · 2^exponent`.
#[derive(Clone, Debug)]
pub(crate) struct Dyadic {
    mantissa: IBig,
    exponent: i32,
}

impl Dyadic {
    /// The number of a finite double.
    pub(crate) fn new(x: f64) -> Self {
        assert!(x.is_finite(), "{x} is no number");
        let bits = x.to_bits();
        let fraction = (bits & ((1 << 52) - 1)) as i64;
        let biased = ((bits >> 52) & 0x7ff) as i32;
        let (magnitude, exponent) = match biased {
            0 => (fraction, -1074),
            _ => (fraction | (1 << 52), biased - 1075),
        };
        if magnitude == 0 {
            return Self {
                mantissa: IBig::ZERO,
                exponent: 0,
            };
        }
        // Fewer bits make later products shorter.
        let spare = magnitude.trailing_zeros();
        let mantissa = IBig::from(magnitude >> spare);
        Self {
            mantissa: if x < 0.0 { -mantissa } else { mantissa },
            exponent: exponent + spare as i32,
        }
    }

    /// −1, 0 or 1.
    pub(crate) fn signum(&self) -> i32 {
        if self.mantissa == IBig::ZERO {
            0
        } else if self.mantissa.sign() == Sign::Negative {
            -1
        } else {
            1
        }
    }

    /// The negated number.
    pub(crate) fn negated(&self) -> Self {
        Self {
            mantissa: -self.mantissa.clone(),
            exponent: self.exponent,
        }
    }

    /// `self / divisor` as the nearest double. The divisor is not zero.
    pub(crate) fn quotient(&self, divisor: &Self) -> f64 {
        if self.signum() == 0 {
            return 0.0;
        }
        let lowest = self.exponent.min(divisor.exponent);
        RBig::from_parts_signed(self.at(lowest), divisor.at(lowest))
            .to_f64()
            .value()
    }

    /// The mantissa for a lower exponent.
    fn at(&self, exponent: i32) -> IBig {
        let shift = usize::try_from(self.exponent - exponent).expect("a lower exponent");
        &self.mantissa << shift
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;

    fn add(self, other: Self) -> Dyadic {
        if self.signum() == 0 {
            return other.clone();
        }
        if other.signum() == 0 {
            return self.clone();
        }
        let exponent = self.exponent.min(other.exponent);
        Dyadic {
            mantissa: self.at(exponent) + other.at(exponent),
            exponent,
        }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;

    fn sub(self, other: Self) -> Dyadic {
        if other.signum() == 0 {
            return self.clone();
        }
        if self.signum() == 0 {
            return other.negated();
        }
        let exponent = self.exponent.min(other.exponent);
        Dyadic {
            mantissa: self.at(exponent) - other.at(exponent),
            exponent,
        }
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;

    fn mul(self, other: Self) -> Dyadic {
        Dyadic {
            mantissa: &self.mantissa * &other.mantissa,
            exponent: self.exponent + other.exponent,
        }
    }
}

impl PartialEq for Dyadic {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Dyadic {}

impl PartialOrd for Dyadic {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Dyadic {
    fn cmp(&self, other: &Self) -> Ordering {
        (self - other).signum().cmp(&0)
    }
}

/// A point or a direction.
pub(crate) type Vector = [Dyadic; 3];

/// The vector of three `f64`.
pub(crate) fn vector(x: [f64; 3]) -> Vector {
    x.map(Dyadic::new)
}

/// `a + b`.
pub(crate) fn sum(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] + &b[i])
}

/// `a − b`.
pub(crate) fn difference(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] - &b[i])
}

/// `a · b`.
pub(crate) fn dot(a: &Vector, b: &Vector) -> Dyadic {
    let [x, y, z]: [Dyadic; 3] = std::array::from_fn(|i| &a[i] * &b[i]);
    &(&x + &y) + &z
}

/// `a × b`.
pub(crate) fn cross(a: &Vector, b: &Vector) -> Vector {
    let minor = |i: usize, j: usize| &(&a[i] * &b[j]) - &(&a[j] * &b[i]);
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn holds_every_double() {
        for x in [0.0, -0.0, 1.0, -0.1, 5e-324, f64::MIN_POSITIVE, f64::MAX] {
            assert_eq!(Dyadic::new(x).quotient(&Dyadic::new(1.0)), x);
        }
    }

    #[test]
    fn agrees_with_integers() {
        // Integers below 2^40 over powers of two: i128 holds their products.
        let mut random = Random::new(1);
        for _ in 0..1000 {
            let [a, b, c]: [i64; 3] = std::array::from_fn(|_| (random.bits() as i64) >> 24);
            let [x, y, z] = [a, b, c].map(|n| Dyadic::new(n as f64 * 2f64.powi(-50)));
            let expected = i128::from(a) * i128::from(b) - (i128::from(c) << 50);
            let found = &(&x * &y) - &z;
            assert_eq!(found.signum(), expected.signum() as i32);
            assert_eq!(x.cmp(&y), a.cmp(&b));
            if b != 0 {
                assert_eq!(x.quotient(&y), a as f64 / b as f64);
            }
        }
    }
}
