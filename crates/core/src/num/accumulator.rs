//! Exact sums of products of three single-precision numbers, for determinants of corners of any magnitude: a
//! fixed-point number as long as the range of such products takes no shifts to a common length, and no multiplications
//! of long integers (Kulisch, Miranker, "The Arithmetic of the Digital Computer: A New Approach", 1986).

use super::exact::power_of_two;
use std::cmp::Ordering;

/// The exponent of the lowest binary digit: the least number of single precision is 2⁻¹⁴⁹.
const LOWEST: i32 = -3 * 149;

/// Binary digits of a limb.
const LIMB: usize = u64::BITS as usize;

/// Limbs of an accumulator. A product is below 2³⁸⁴, so that 2⁶⁴ of them are below 2⁴⁴⁹.
const LIMBS: usize = 14;

/// A number of single precision as `mantissa · 2^exponent`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Number {
    pub(crate) mantissa: i64,
    pub(crate) exponent: i32,
}

impl Number {
    /// The number is finite.
    pub(crate) fn of(x: f32) -> Self {
        let bits = x.to_bits();
        let biased = (bits >> 23 & 0xff) as i32;
        let fraction = i64::from(bits & 0x007f_ffff);
        let (mantissa, exponent) = match biased {
            0 => (fraction, -149),
            _ => (fraction | 1 << 23, biased - 150),
        };
        Self {
            mantissa: if x < 0.0 { -mantissa } else { mantissa },
            exponent,
        }
    }

    pub(crate) fn negated(self) -> Self {
        Self {
            mantissa: -self.mantissa,
            ..self
        }
    }

    /// The product of two numbers, exactly.
    pub(crate) fn times(self, other: Self) -> Self {
        Self {
            mantissa: self.mantissa * other.mantissa,
            exponent: self.exponent + other.exponent,
        }
    }
}

/// A sum of products, exactly: a fixed-point number long enough for all of them.
#[derive(Clone, Debug)]
pub(crate) struct Accumulator {
    /// The sum of the positive products, and that of the negative ones: so carries seldom go further than a limb. The
    /// lowest limb first.
    sums: [[u64; LIMBS]; 2],
}

impl Accumulator {
    pub(crate) const ZERO: Self = Self {
        sums: [[0; LIMBS]; 2],
    };

    /// Adds the product of a number and the product of two others.
    pub(crate) fn add(&mut self, number: Number, of_two: Number) {
        let mantissa = i128::from(number.mantissa) * i128::from(of_two.mantissa);
        if mantissa == 0 {
            return;
        }
        let at = (number.exponent + of_two.exponent - LOWEST) as usize;
        let magnitude = mantissa.unsigned_abs();
        let low = u128::from(magnitude as u64) << (at % LIMB);
        let high = (magnitude >> LIMB) << (at % LIMB);
        let middle = (low >> LIMB) + u128::from(high as u64);
        let above = (middle >> LIMB) + (high >> LIMB);
        let mut digits = [low as u64, middle as u64, above as u64].into_iter();
        let mut carry = false;
        for limb in self.sums[usize::from(mantissa < 0)]
            .iter_mut()
            .skip(at / LIMB)
        {
            let Some(added) = digits.next().or(carry.then_some(0)) else {
                return;
            };
            let (sum, over) = limb.overflowing_add(added);
            let (sum, over_again) = sum.overflowing_add(carry.into());
            *limb = sum;
            carry = over | over_again;
        }
    }

    /// The sum rounded to within a unit in the last place; zero only where it is zero. All are normal numbers.
    pub(crate) fn rounded(&self) -> f64 {
        let [positive, negative] = &self.sums;
        let order = positive.iter().rev().cmp(negative.iter().rev());
        let (greater, lesser) = match order {
            Ordering::Less => (negative, positive),
            _ => (positive, negative),
        };
        let mut magnitude = [0; LIMBS];
        let mut borrow = false;
        for ((limb, &a), &b) in magnitude.iter_mut().zip(greater).zip(lesser) {
            let (rest, under) = a.overflowing_sub(b);
            let (rest, under_again) = rest.overflowing_sub(borrow.into());
            *limb = rest;
            borrow = under | under_again;
        }
        let Some(top) = magnitude.iter().rposition(|&limb| limb != 0) else {
            return 0.0;
        };
        // At least 65 digits, but for numbers of one limb, which are exact.
        let below = match top {
            0 => 0,
            _ => magnitude[top - 1],
        };
        let digits = u128::from(magnitude[top]) << LIMB | u128::from(below);
        let exponent = (top as i32 - 1) * LIMB as i32 + LOWEST;
        let rounded = digits as f64 * power_of_two(exponent);
        if order == Ordering::Less {
            -rounded
        } else {
            rounded
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::roundoff::EPSILON;
    use crate::random::Random;
    use num_bigint::BigInt;

    fn sum_of(products: &[[f32; 3]]) -> f64 {
        let mut sum = Accumulator::ZERO;
        for product in products {
            let [a, b, c] = product.map(Number::of);
            sum.add(a, b.times(c));
        }
        sum.rounded()
    }

    /// The integer times 2^−LOWEST that a sum of products is.
    fn truth(products: &[[f32; 3]]) -> BigInt {
        let product = |product: &[f32; 3]| {
            let [a, b, c] = product.map(Number::of);
            let shift = a.exponent + b.exponent + c.exponent - LOWEST;
            (BigInt::from(a.mantissa) * b.mantissa * c.mantissa) << shift
        };
        products.iter().map(product).sum()
    }

    #[test]
    fn sums_of_the_least_and_the_greatest_numbers_are_exact() {
        let (least, most) = (f32::from_bits(1), f32::MAX);
        let third = |x: f32| f64::from(x).powi(3);
        assert_eq!(sum_of(&[]), 0.0);
        assert_eq!(sum_of(&[[least; 3]]), third(least));
        assert_eq!(sum_of(&[[most; 3], [most, most, -most]]), 0.0);
        let all = [[most; 3], [least, -least, least], [-most, most, most]];
        assert_eq!(sum_of(&all), -third(least));
        assert_eq!(sum_of(&[[-most; 3]; 24]), -24.0 * third(most));
    }

    /// Numbers of all magnitudes, of which most of the sum cancels in every other round, against long integers.
    #[test]
    fn sums_are_within_a_unit_in_the_last_place_of_those_in_integers() {
        let mut random = Random(131);
        for round in 0..20_000 {
            let spread = [3.0, 40.0, 140.0][round % 3];
            let mut number = || {
                let number = random.signed() * crate::math::pow(2.0, spread * random.signed());
                (number as f32).clamp(f32::MIN, f32::MAX)
            };
            let mut products: Vec<[f32; 3]> = (0..12).map(|_| [(); 3].map(|()| number())).collect();
            if round % 2 == 0 {
                let negated = products.iter().map(|&[a, b, c]| [b, -c, a]);
                products.extend(negated.collect::<Vec<_>>());
                products.push([number(), f32::from_bits(1), 1.0]);
            }
            let (sum, truth) = (sum_of(&products), truth(&products));
            // A double that is rounded to a unit in the last place, as an integer: both bounds have 53 digits.
            let scaled = |x: f64| {
                let bits = x.abs().to_bits();
                let mantissa = BigInt::from(bits & 0x000f_ffff_ffff_ffff | 1 << 52);
                let shift = (bits >> 52) as i32 - 1075 - LOWEST;
                match shift {
                    _ if x == 0.0 => BigInt::from(0),
                    0.. => mantissa << shift,
                    _ => mantissa >> -shift,
                }
            };
            let off = BigInt::from(truth.magnitude().clone()) - scaled(sum);
            let most = scaled(2.0 * EPSILON * sum);
            assert!(off.magnitude() <= most.magnitude(), "{products:?} {sum}");
            assert_eq!(sum < 0.0, truth.sign() == num_bigint::Sign::Minus);
            assert_eq!(sum == 0.0, truth == BigInt::from(0));
        }
    }
}
