//! Lanes as arrays, for any processor.

use super::{F32x8, F64x4, LANES, Lanes, Mask8};
use crate::num::double_double::Doubles;
use std::array::from_fn;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

/// The instruction set that every processor has.
#[derive(Clone, Copy)]
pub(crate) struct Plain;

/// Eight numbers in an array.
#[derive(Clone, Copy)]
pub(crate) struct PlainF32([f32; LANES]);

/// Eight booleans in an array.
#[derive(Clone, Copy)]
pub(crate) struct PlainMask([bool; LANES]);

/// Four numbers in double precision in an array.
#[derive(Clone, Copy)]
pub(crate) struct PlainF64([f64; 4]);

/// Applies an operation lane by lane.
macro_rules! each {
    ($lane:ident => $value:expr) => {{
        let mut all = [Default::default(); LANES];
        for $lane in 0..LANES {
            all[$lane] = $value;
        }
        all
    }};
}

/// An operator between two vectors, and between a vector and one number for all lanes.
macro_rules! operator {
    ($($trait:ident $method:ident $symbol:tt),+) => {$(
        impl $trait for PlainF32 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(each!(l => self.0[l] $symbol other.0[l]))
            }
        }
        impl $trait<f32> for PlainF32 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f32) -> Self {
                Self(each!(l => self.0[l] $symbol other))
            }
        }
    )+};
}

operator!(Add add +, Sub sub -, Mul mul *, Div div /);

impl BitAnd for PlainMask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(each!(l => self.0[l] & other.0[l]))
    }
}

impl BitOr for PlainMask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(each!(l => self.0[l] | other.0[l]))
    }
}

impl F32x8 for PlainF32 {
    type Mask = PlainMask;

    #[inline(always)]
    fn store(self, to: &mut [f32; LANES]) {
        *to = self.0;
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(each!(l => self.0[l].sqrt()))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(each!(l => self.0[l].abs()))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(each!(l => self.0[l].floor()))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(each!(l => if self.0[l] < other.0[l] { self.0[l] } else { other.0[l] }))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(each!(l => if self.0[l] > other.0[l] { self.0[l] } else { other.0[l] }))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> PlainMask {
        PlainMask(each!(l => self.0[l] < other.0[l]))
    }
    #[inline(always)]
    fn upper_halves(self) -> [u16; LANES] {
        each!(l => (self.0[l].to_bits() >> 16) as u16)
    }
    #[inline(always)]
    fn lower_halves(self) -> [u32; LANES] {
        each!(l => self.0[l].to_bits() & 0xffff)
    }
}

impl Mask8 for PlainMask {
    type F32 = PlainF32;

    #[inline(always)]
    fn select(self, yes: PlainF32, no: PlainF32) -> PlainF32 {
        PlainF32(each!(l => if self.0[l] { yes.0[l] } else { no.0[l] }))
    }
    #[inline(always)]
    fn store(self, number: u32, to: &mut [u32; LANES]) {
        let old = *to;
        *to = each!(l => if self.0[l] { number } else { old[l] });
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        let mut bits = 0;
        for (l, &yes) in self.0.iter().enumerate() {
            bits |= u32::from(yes) << l;
        }
        bits
    }
}

impl Add for PlainF64 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] + other.0[l]))
    }
}

impl Sub for PlainF64 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] - other.0[l]))
    }
}

impl Mul for PlainF64 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] * other.0[l]))
    }
}

impl Neg for PlainF64 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl Doubles for PlainF64 {
    #[inline(always)]
    fn zero(self) -> Self {
        Self([0.0; 4])
    }
    #[inline(always)]
    fn lost_in_product(self, other: Self, product: Self) -> Self {
        Self(from_fn(|l| {
            self.0[l].lost_in_product(other.0[l], product.0[l])
        }))
    }
}

impl F64x4 for PlainF64 {
    #[inline(always)]
    fn to_array(self) -> [f64; 4] {
        self.0
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }
    #[inline(always)]
    fn yzx(self) -> Self {
        let [x, y, z, w] = self.0;
        Self([y, z, x, w])
    }
    #[inline(always)]
    fn transpose(rows: [Self; 4]) -> [Self; 4] {
        from_fn(|column| Self(rows.map(|row| row.0[column])))
    }
}

impl Lanes for Plain {
    type F32 = PlainF32;
    type Mask = PlainMask;
    type F64 = PlainF64;

    #[inline(always)]
    fn splat(self, x: f32) -> PlainF32 {
        PlainF32([x; LANES])
    }
    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> PlainF32 {
        PlainF32(*from)
    }
    #[inline(always)]
    fn doubles(self, four: [f64; 4]) -> PlainF64 {
        PlainF64(four)
    }
    #[inline(always)]
    fn equal(self, these: &[u32; LANES], those: &[u32; LANES]) -> PlainMask {
        PlainMask(each!(l => these[l] == those[l]))
    }
    #[inline(always)]
    fn transpose(self, rows: [PlainF32; LANES]) -> [PlainF32; LANES] {
        from_fn(|column| PlainF32(each!(row => rows[row].0[column])))
    }
    #[inline(always)]
    fn prefetch<T>(self, _: &[T], _: usize) {}
}
