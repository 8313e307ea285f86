//! One source for several instruction sets: the same code, compiled for each, picked at run time.
//!
//! Loops in double precision are left to the compiler to vectorise. Rows of eight numbers in single precision, where it would
//! not see that they can be laid side by side, are spelt out as [`F32x8`]. Nothing contracts a product and a sum into one
//! rounding, so the bits are the same on each.

mod plain;
mod wide;

#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
use fearless_simd::{Level, Simd as _};
pub(crate) use plain::Plain;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// Instruction sets that tiles can be cast with, from the plainest to the widest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Simd {
    /// What every machine of this architecture has.
    Plain,
    /// NEON, of 64-bit ARM: four numbers in single precision at once.
    Neon,
    /// AVX2, with what else x86-64-v3 has: eight numbers in single precision at once.
    Avx2,
}

impl Simd {
    /// Each.
    const ALL: [Self; 3] = [Self::Plain, Self::Neon, Self::Avx2];

    /// The widest that this machine has. Sixteen lanes (AVX-512) are not among them: small triangles seldom
    /// bound more than eight rays of a row, and frames took as long as with eight, within 2 %.
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        if Level::new().as_avx2().is_some() {
            return Self::Avx2;
        }
        #[cfg(target_arch = "aarch64")]
        if Level::new().as_neon().is_some() {
            return Self::Neon;
        }
        Self::Plain
    }

    /// The name in statistics.
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

    /// Reads a name as [`Simd::name`] gives it.
    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|simd| simd.name() == name)
            .ok_or_else(|| format!("expected plain, neon or avx2, found {name:?}"))
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
    /// The greatest whole numbers that are not above; no numbers stay what they are.
    fn floor(self) -> Self;
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
