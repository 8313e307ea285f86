//! Lanes as arrays, for any processor.

use super::{F32x8, LANES, Lanes, Mask8};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// The instruction set that every processor has.
#[derive(Clone, Copy)]
pub(crate) struct Plain;

/// Eight numbers in an array.
#[derive(Clone, Copy)]
pub(crate) struct PlainF32([f32; LANES]);

/// Eight booleans in an array.
#[derive(Clone, Copy)]
pub(crate) struct PlainMask([bool; LANES]);

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

impl Lanes for Plain {
    type F32 = PlainF32;
    type Mask = PlainMask;

    #[inline(always)]
    fn splat(self, x: f32) -> PlainF32 {
        PlainF32([x; LANES])
    }
    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> PlainF32 {
        PlainF32(*from)
    }
    #[inline(always)]
    fn equal(self, these: &[u32; LANES], those: &[u32; LANES]) -> PlainMask {
        PlainMask(each!(l => these[l] == those[l]))
    }
    #[inline(always)]
    fn transpose(self, rows: [PlainF32; LANES]) -> [PlainF32; LANES] {
        std::array::from_fn(|column| PlainF32(each!(row => rows[row].0[column])))
    }
    #[inline(always)]
    fn prefetch<T>(self, _: &[T], _: usize) {}
}
