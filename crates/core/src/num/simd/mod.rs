//! One source for several instruction sets: the same code, compiled for each, picked at run time.
//!
//! Loops in double precision are left to the compiler to vectorise. Rows of eight numbers in single precision, where it would
//! not see that they can be laid side by side, are spelt out as [`F32x8`]. Nothing contracts a product and a sum into one
//! rounding, so the bits are the same on each.

#![allow(
    unsafe_code,
    reason = "a function compiled for an instruction set may be called only where the machine has it"
)]

#[cfg(target_arch = "x86_64")]
mod avx2;
mod plain;

pub(crate) use plain::Plain;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// Instruction sets that tiles can be cast with, from the plainest to the widest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Simd {
    /// What every machine of this architecture has.
    Plain,
    /// AVX2: eight numbers in single precision at once.
    Avx2,
}

impl Simd {
    /// The widest that this machine has. Sixteen lanes (AVX-512) are not among them: small triangles seldom
    /// bound more than eight rays of a row, and frames took as long as with eight, within 2 %.
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            // A virtual machine may hide the bit manipulation that processors with AVX2 have.
            let has_avx2 = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("popcnt")
                && is_x86_feature_detected!("lzcnt");
            if has_avx2 {
                return Self::Avx2;
            }
        }
        Self::Plain
    }

    /// The name in statistics.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Avx2 => "avx2",
        }
    }
}

impl std::str::FromStr for Simd {
    type Err = String;

    /// Reads a name as [`Simd::name`] gives it.
    fn from_str(name: &str) -> Result<Self, String> {
        [Self::Plain, Self::Avx2]
            .into_iter()
            .find(|simd| simd.name() == name)
            .ok_or_else(|| format!("expected plain or avx2, found {name:?}"))
    }
}

/// How many numbers [`F32x8`] holds.
pub(crate) const LANES: usize = 8;

/// Eight numbers in single precision, side by side. An operator works lane by lane; its right side may be
/// one number for all lanes.
pub(crate) trait F32x8:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f32, Output = Self>
    + Sub<f32, Output = Self>
    + Mul<f32, Output = Self>
    + Div<f32, Output = Self>
{
    /// Yes or no for each lane.
    type Mask: Mask8<F32 = Self>;

    /// To memory.
    fn store(self, to: &mut [f32; LANES]);
    /// Square roots, correctly rounded.
    fn sqrt(self) -> Self;
    /// Magnitudes.
    fn abs(self) -> Self;
    /// The lesser of two; the other where either is not a number.
    fn min(self, other: Self) -> Self;
    /// The greater of two; the other where either is not a number.
    fn max(self, other: Self) -> Self;
    /// Whether it is less than the other; never where either is not a number.
    fn lt(self, other: Self) -> Self::Mask;

    /// The least of the eight, which are numbers.
    #[inline(always)]
    fn reduce_min(self) -> f32 {
        let mut all = [0.0; LANES];
        self.store(&mut all);
        let lesser = |a: f32, b: f32| if a < b { a } else { b };
        let [a, b, c, d, e, f, g, h] = all;
        lesser(
            lesser(lesser(a, b), lesser(c, d)),
            lesser(lesser(e, f), lesser(g, h)),
        )
    }
}

/// Yes or no for each of eight lanes.
pub(crate) trait Mask8: Copy + BitAnd<Output = Self> + BitOr<Output = Self> {
    /// The numbers that it masks.
    type F32;

    /// The first where the mask says yes, the second elsewhere.
    fn select(self, yes: Self::F32, no: Self::F32) -> Self::F32;
    /// Masked store: writes a number where the mask says yes.
    fn store(self, number: u32, to: &mut [u32; LANES]);
    /// The mask as bits, the first lane lowest.
    fn bits(self) -> u32;
}

/// An instruction set. A value of a type of these is the proof that the machine has it.
pub(crate) trait Lanes: Copy {
    /// Eight numbers.
    type F32: F32x8<Mask = Self::Mask>;
    /// Yes or no for each.
    type Mask: Mask8<F32 = Self::F32>;

    /// The same number in all lanes.
    fn splat(self, x: f32) -> Self::F32;
    /// From memory.
    fn load(self, from: &[f32; LANES]) -> Self::F32;
    /// Eight rows as eight columns.
    fn transpose(self, rows: [Self::F32; LANES]) -> [Self::F32; LANES];
    /// Prefetches an item of a slice, if there is such an item.
    fn prefetch<T>(self, from: &[T], index: usize);

    /// The mask of a lane and those after it.
    #[inline(always)]
    fn mask_from(self, lane: usize) -> Self::Mask {
        const LANE: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        self.splat(lane as f32 - 0.5).lt(self.load(&LANE))
    }
}

/// Work that is compiled for each instruction set. `run` must be inlined to be.
pub(crate) trait Work {
    /// Does it.
    fn run(self, lanes: impl Lanes);
}

/// Runs `work` as compiled for `simd`, or for the best below it that this machine has.
pub(crate) fn dispatch(simd: Simd, work: impl Work) {
    #[cfg(target_arch = "x86_64")]
    {
        use avx2::Avx2;

        #[target_feature(enable = "avx2,bmi1,bmi2,popcnt,lzcnt")]
        fn avx2(work: impl Work, lanes: Avx2) {
            work.run(lanes);
        }

        if simd.min(Simd::best()) == Simd::Avx2 {
            // SAFETY: `Simd::best` has just said that the machine has these features.
            return unsafe { avx2(work, Avx2::new()) };
        }
    }
    let _ = simd;
    work.run(Plain);
}
