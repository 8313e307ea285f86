//! Integers of bounded length, without heap allocation.

use super::integer::Integer;
use std::cmp::Ordering;

/// Binary digits of a limb.
const LIMB: u32 = u64::BITS;

/// An integer of at most `N` limbs, as sign and magnitude. Operations touch only the limbs in use, so that short
/// numbers are fast whatever `N` is.
///
/// Overflow panics (an index out of range); callers bound the length beforehand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wide<const N: usize> {
    is_negative: bool,
    /// Limbs in use; the highest of them is not zero.
    len: usize,
    /// The lowest limb first; limbs not in use are zero.
    limbs: [u64; N],
}

impl<const N: usize> Wide<N> {
    /// Zero. Results are computed in place, since copying long numbers takes longer than computing with short ones.
    fn zero(is_negative: bool) -> Self {
        Self {
            is_negative,
            len: 0,
            limbs: [0; N],
        }
    }

    /// Counts the limbs in use, which are at most `most`.
    fn count(&mut self, most: usize) {
        self.len = most.min(N);
        while self.len > 0 && self.limbs[self.len - 1] == 0 {
            self.len -= 1;
        }
    }

    fn magnitudes(&self, other: &Self) -> Ordering {
        self.len.cmp(&other.len).then_with(|| {
            let limbs = self.limbs[..self.len].iter().rev();
            limbs.cmp(other.limbs[..other.len].iter().rev())
        })
    }

    /// `self + other`, with the sign of `other` given by `other_is_negative`.
    #[allow(
        clippy::needless_range_loop,
        reason = "a limb is an index into all the numbers at once"
    )]
    fn add(&self, other: &Self, other_is_negative: bool) -> Self {
        if self.is_negative == other_is_negative {
            let mut total = Self::zero(self.is_negative);
            let most = self.len.max(other.len);
            let mut carry = false;
            for i in 0..most {
                let (sum, over) = self.limbs[i].overflowing_add(other.limbs[i]);
                let (sum, over_again) = sum.overflowing_add(carry.into());
                total.limbs[i] = sum;
                carry = over | over_again;
            }
            if carry {
                total.limbs[most] = 1;
            }
            total.count(most + 1);
            return total;
        }
        let (greater, lesser, is_negative) = match self.magnitudes(other) {
            Ordering::Less => (other, self, other_is_negative),
            _ => (self, other, self.is_negative),
        };
        let mut total = Self::zero(is_negative);
        let mut borrow = false;
        for i in 0..greater.len {
            let (rest, under) = greater.limbs[i].overflowing_sub(lesser.limbs[i]);
            let (rest, under_again) = rest.overflowing_sub(borrow.into());
            total.limbs[i] = rest;
            borrow = under | under_again;
        }
        total.count(greater.len);
        total
    }

    fn shifted_left(&self, shift: u32) -> Self {
        if self.len == 0 {
            return *self;
        }
        let (whole, part) = ((shift / LIMB) as usize, shift % LIMB);
        let mut shifted = Self::zero(self.is_negative);
        for i in 0..self.len {
            let wide = u128::from(self.limbs[i]) << part;
            shifted.limbs[i + whole] |= wide as u64;
            if wide >> LIMB != 0 {
                shifted.limbs[i + whole + 1] |= (wide >> LIMB) as u64;
            }
        }
        shifted.count(self.len + whole + 1);
        shifted
    }
}

impl<const N: usize> Integer for Wide<N> {
    fn shifted(mantissa: i64, shift: u32) -> Self {
        let mut number = Self::zero(mantissa < 0);
        let (whole, part) = ((shift / LIMB) as usize, shift % LIMB);
        let wide = u128::from(mantissa.unsigned_abs()) << part;
        number.limbs[whole] = wide as u64;
        if wide >> LIMB != 0 {
            number.limbs[whole + 1] = (wide >> LIMB) as u64;
        }
        number.count(whole + 2);
        number
    }

    fn plus(&self, other: &Self) -> Self {
        self.add(other, other.is_negative)
    }

    fn minus(&self, other: &Self) -> Self {
        self.add(other, !other.is_negative)
    }

    fn times(&self, other: &Self) -> Self {
        let mut product = Self::zero(self.is_negative != other.is_negative);
        for i in 0..self.len {
            let mut carry = 0;
            for j in 0..other.len {
                let term = u128::from(self.limbs[i]) * u128::from(other.limbs[j]);
                let sum = term + u128::from(product.limbs[i + j]) + carry;
                product.limbs[i + j] = sum as u64;
                carry = sum >> LIMB;
            }
            if carry != 0 {
                product.limbs[i + other.len] = carry as u64;
            }
        }
        product.count(self.len + other.len);
        product
    }

    fn sign(&self) -> Ordering {
        match (self.len, self.is_negative) {
            (0, _) => Ordering::Equal,
            (_, true) => Ordering::Less,
            (_, false) => Ordering::Greater,
        }
    }

    fn bits(&self) -> u32 {
        match self.limbs[..self.len].last() {
            Some(highest) => self.len as u32 * LIMB - highest.leading_zeros(),
            None => 0,
        }
    }

    fn compare_shifted(&self, shift: u32, other: &Self) -> Ordering {
        let shifted = self.shifted_left(shift);
        let by_sign = shifted.sign().cmp(&other.sign());
        by_sign.then_with(|| match shifted.is_negative {
            false => shifted.magnitudes(other),
            true => other.magnitudes(&shifted),
        })
    }

    fn highest(&self) -> u64 {
        let Some((highest, below)) = self.limbs[..self.len].split_last() else {
            return 0;
        };
        let Some(next) = below.last() else {
            return *highest;
        };
        let both = u128::from(*highest) << LIMB | u128::from(*next);
        (both << highest.leading_zeros() >> LIMB) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use num_bigint::BigInt;

    /// The truth is num-bigint's result.
    #[test]
    fn agrees_with_integers_of_any_length() {
        let mut random = Random(1);
        let mut equals = 0;
        for _ in 0..20_000 {
            let mut number = || {
                let mantissa = match (random.unit() * 6.0) as u32 {
                    0 => 0,
                    1 => i64::MIN,
                    2 => i64::MAX,
                    3 => (random.signed() * 4.0) as i64,
                    _ => (random.signed() * 9e18) as i64,
                };
                let shift = match (random.unit() * 4.0) as u32 {
                    0 => 0,
                    1 => 64,
                    _ => (random.unit() * 200.0) as u32,
                };
                (
                    Wide::<10>::shifted(mantissa, shift),
                    BigInt::shifted(mantissa, shift),
                )
            };
            let ((a, big_a), (b, big_b), (c, big_c)) = (number(), number(), number());
            let same = |wide: &Wide<10>, big: &BigInt| {
                assert_eq!(wide.sign(), Integer::sign(big));
                assert_eq!(wide.bits(), Integer::bits(big));
                assert_eq!(wide.highest(), big.highest());
                assert_eq!(wide.minus(wide).sign(), Ordering::Equal);
            };
            same(&a, &big_a);
            same(&a.plus(&b), &big_a.plus(&big_b));
            same(&a.minus(&b), &big_a.minus(&big_b));
            same(&a.times(&b), &big_a.times(&big_b));
            let (wide, big) = (a.times(&b).minus(&c), big_a.times(&big_b).minus(&big_c));
            same(&wide, &big);
            for shift in [0, 1, 63, 64, 100] {
                let order = b.compare_shifted(shift, &a);
                assert_eq!(order, big_b.compare_shifted(shift, &big_a));
                equals += u32::from(order == Ordering::Equal);
            }
        }
        assert!(equals > 100, "{equals}");
    }
}
