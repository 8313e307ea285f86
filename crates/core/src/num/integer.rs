//! The integer operations that exact decisions use.

use num_bigint::{BigInt, Sign};
use num_traits::Zero;
use std::cmp::Ordering;

/// A signed integer, of any length that the implementation can hold.
pub(crate) trait Integer: Clone {
    /// `mantissa · 2^shift`.
    fn shifted(mantissa: i64, shift: u32) -> Self;
    /// `self + other`.
    fn plus(&self, other: &Self) -> Self;
    /// `self − other`.
    fn minus(&self, other: &Self) -> Self;
    /// `self · other`.
    fn times(&self, other: &Self) -> Self;
    /// Compares with zero.
    fn sign(&self) -> Ordering;
    /// The number of binary digits of the magnitude; 0 for zero.
    fn bits(&self) -> u32;
    /// Compares `self · 2^shift` with `other`.
    fn compare_shifted(&self, shift: u32, other: &Self) -> Ordering;
    /// The highest 64 bits of the magnitude, truncated; all of them where there are fewer.
    fn highest(&self) -> u64;
}

/// Callers ensure that nothing overflows.
impl Integer for i128 {
    fn shifted(mantissa: i64, shift: u32) -> Self {
        Self::from(mantissa) << shift
    }

    fn plus(&self, other: &Self) -> Self {
        self + other
    }

    fn minus(&self, other: &Self) -> Self {
        self - other
    }

    fn times(&self, other: &Self) -> Self {
        self * other
    }

    fn sign(&self) -> Ordering {
        self.cmp(&0)
    }

    fn bits(&self) -> u32 {
        Self::BITS - self.unsigned_abs().leading_zeros()
    }

    fn compare_shifted(&self, shift: u32, other: &Self) -> Ordering {
        (self << shift).cmp(other)
    }

    fn highest(&self) -> u64 {
        let beyond = Integer::bits(self).saturating_sub(u64::BITS);
        (self.unsigned_abs() >> beyond) as u64
    }
}

impl Integer for BigInt {
    fn shifted(mantissa: i64, shift: u32) -> Self {
        Self::from(mantissa) << shift
    }

    fn plus(&self, other: &Self) -> Self {
        self + other
    }

    fn minus(&self, other: &Self) -> Self {
        self - other
    }

    fn times(&self, other: &Self) -> Self {
        self * other
    }

    fn sign(&self) -> Ordering {
        match self.sign() {
            Sign::Minus => Ordering::Less,
            Sign::NoSign => Ordering::Equal,
            Sign::Plus => Ordering::Greater,
        }
    }

    fn bits(&self) -> u32 {
        u32::try_from(self.bits()).unwrap_or(u32::MAX)
    }

    fn compare_shifted(&self, shift: u32, other: &Self) -> Ordering {
        (self << shift).cmp(other)
    }

    fn highest(&self) -> u64 {
        if self.is_zero() {
            return 0;
        }
        let beyond = self.bits().saturating_sub(64);
        let highest = self.magnitude() >> beyond;
        highest.iter_u64_digits().next().unwrap_or(0)
    }
}
