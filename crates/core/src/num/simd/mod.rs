//! One source for several instruction sets: each work item is compiled for every set, and dispatched at run time.
//!
//! Loops in double precision are left to the compiler to vectorise. Rows of eight single-precision numbers, which it
//! would not vectorise by itself, are written as [`F32x8`], and double-double arithmetic as [`F64x4`]. No product and sum
//! are contracted into one rounding, but where the result is exact, so the bits are the same on each instruction set.

mod plain;
mod prefetch;
mod wide;

use super::double_double::Doubles;
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
use fearless_simd::{Level, Simd as _};
pub(crate) use plain::Plain;
pub(crate) use prefetch::prefetch;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// Instruction sets that packets can be cast with, from the plainest to the widest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Simd {
    /// What every processor of this architecture has.
    Plain,
    /// NEON, of 64-bit ARM: four single-precision numbers at once.
    Neon,
    /// AVX2 and the rest of x86-64-v3: eight single-precision numbers at once.
    Avx2,
}

impl Simd {
    /// All of them.
    const ALL: [Self; 3] = [Self::Plain, Self::Neon, Self::Avx2];

    /// Those that this machine has, from the plainest to the widest.
    pub fn available() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|simd| simd.is_available())
    }

    fn is_available(self) -> bool {
        match self {
            Self::Plain => true,
            #[cfg(target_arch = "aarch64")]
            Self::Neon => Level::new().as_neon().is_some(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => Level::new().as_avx2().is_some(),
            // Of other architectures.
            _ => false,
        }
    }

    /// The widest that this machine has. There is no variant with sixteen lanes (AVX-512): small triangles seldom
    /// bound more than eight rays of a row, and frames took as long as with eight, within 2 %.
    pub fn best() -> Self {
        Self::available().last().unwrap_or(Self::Plain)
    }

    /// The name that statistics show.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Neon => "neon",
            Self::Avx2 => "avx2",
        }
    }
}

impl std::str::FromStr for Simd {
    type Err = String;

    /// Parses a name as [`Simd::name`] gives it.
    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|simd| simd.name() == name)
            .ok_or_else(|| format!("expected plain, neon or avx2, found {name:?}"))
    }
}

/// The number of lanes of [`F32x8`].
pub(crate) const LANES: usize = 8;

/// Eight single-precision numbers. Operators work lane by lane; the right side may be one number for all lanes.
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
    /// A boolean a lane.
    type Mask: Mask8<F32 = Self>;

    /// Stores the eight to memory.
    fn store(self, to: &mut [f32; LANES]);
    /// Square roots, correctly rounded.
    fn sqrt(self) -> Self;
    /// Magnitudes.
    fn abs(self) -> Self;
    /// The greatest integers that are not above; NaN stays NaN.
    fn floor(self) -> Self;
    /// The lesser of two in each lane; `other`'s where either is NaN.
    fn min(self, other: Self) -> Self;
    /// The greater of two in each lane; `other`'s where either is NaN.
    fn max(self, other: Self) -> Self;
    /// Whether each lane is less than `other`'s; false where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// The upper halves of the numbers' bits: sign, exponent, and the first 7 bits of the mantissa.
    fn upper_halves(self) -> [u16; LANES];
    /// The lower halves of the numbers' bits.
    fn lower_halves(self) -> [u32; LANES];

    /// The least of the eight, none of which is NaN.
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

/// Four double-precision numbers, for what the compiler does not vectorise.
pub(crate) trait F64x4: Doubles {
    /// All four.
    fn to_array(self) -> [f64; 4];
    /// Magnitudes.
    fn abs(self) -> Self;
    /// The vector (y, z, x) of (x, y, z); the fourth lane stays.
    fn yzx(self) -> Self;
    /// Transposes a 4 × 4 matrix of rows.
    fn transpose(rows: [Self; 4]) -> [Self; 4];
}

/// Eight booleans.
pub(crate) trait Mask8: Copy + BitAnd<Output = Self> + BitOr<Output = Self> {
    /// The vectors that the mask selects from.
    type F32;

    /// `yes` where the mask is true, `no` elsewhere.
    fn select(self, yes: Self::F32, no: Self::F32) -> Self::F32;
    /// Masked store: writes a number to the lanes where the mask is true.
    fn store(self, number: u32, to: &mut [u32; LANES]);
    /// The mask as bits, the first lane lowest.
    fn bits(self) -> u32;
}

/// An instruction set. Having a value of such a type proves that the machine supports it.
pub(crate) trait Lanes: Copy {
    /// Eight numbers.
    type F32: F32x8<Mask = Self::Mask>;
    /// Eight booleans.
    type Mask: Mask8<F32 = Self::F32>;
    /// Four numbers in double precision.
    type F64: F64x4;

    /// The same number in all lanes.
    fn splat(self, x: f32) -> Self::F32;
    /// Loads eight from memory.
    fn load(self, from: &[f32; LANES]) -> Self::F32;
    /// Four numbers in double precision.
    fn doubles(self, four: [f64; 4]) -> Self::F64;
    /// Whether integers are equal, lane by lane.
    fn equal(self, these: &[u32; LANES], those: &[u32; LANES]) -> Self::Mask;
    /// Transposes an 8 × 8 matrix of rows.
    fn transpose(self, rows: [Self::F32; LANES]) -> [Self::F32; LANES];
    /// Prefetches an item of a slice; out of range it does nothing.
    fn prefetch<T>(self, from: &[T], index: usize);

    /// The mask that is true in a lane and all after it.
    #[inline(always)]
    fn mask_from(self, lane: usize) -> Self::Mask {
        const LANE: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        self.splat(lane as f32 - 0.5).lt(self.load(&LANE))
    }
}

/// Work that is compiled for each instruction set. `run` must be `#[inline(always)]`, so that it takes on the
/// caller's target features.
pub(crate) trait Work {
    /// Runs the work.
    fn run(self, lanes: impl Lanes);
}

/// Runs `work` compiled for `simd`, or for the best set below it that this machine has.
pub(crate) fn dispatch(simd: Simd, work: impl Work) {
    let simd = simd.min(Simd::best());
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = Level::new().as_avx2().filter(|_| simd == Simd::Avx2) {
        return avx2.vectorize(
            #[inline(always)]
            || work.run(avx2),
        );
    }
    #[cfg(target_arch = "aarch64")]
    if let Some(neon) = Level::new().as_neon().filter(|_| simd == Simd::Neon) {
        return neon.vectorize(
            #[inline(always)]
            || work.run(neon),
        );
    }
    let _ = simd;
    work.run(Plain);
}
