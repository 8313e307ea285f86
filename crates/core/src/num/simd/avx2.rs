//! Lanes as registers of AVX2.

#![allow(
    unsafe_code,
    reason = "an instruction may be used only where the machine has it, which an `Avx2` proves"
)]

use super::{F32x8, LANES, Lanes, Mask8};
use std::arch::x86_64::{
    __m256, _CMP_LT_OQ, _MM_HINT_T0, _mm_prefetch, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps,
    _mm256_blendv_epi8, _mm256_blendv_ps, _mm256_castps_si256, _mm256_cmp_ps, _mm256_div_ps,
    _mm256_loadu_ps, _mm256_loadu_si256, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps,
    _mm256_mul_ps, _mm256_or_ps, _mm256_permute2f128_ps, _mm256_set1_epi32, _mm256_set1_ps,
    _mm256_shuffle_ps, _mm256_sqrt_ps, _mm256_storeu_ps, _mm256_storeu_si256, _mm256_sub_ps,
    _mm256_unpackhi_ps, _mm256_unpacklo_ps,
};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// The machine has AVX2: made nowhere but in [`Avx2::new`].
#[derive(Clone, Copy)]
pub(super) struct Avx2(());

/// Eight numbers in a register: made from an [`Avx2`], or from others.
#[derive(Clone, Copy)]
pub(super) struct Avx2F32(__m256);

/// Eight times yes or no, all bits of a lane or none.
#[derive(Clone, Copy)]
pub(super) struct Avx2Mask(__m256);

impl Avx2 {
    /// # Safety
    /// The machine has AVX2.
    #[inline(always)]
    pub(super) unsafe fn new() -> Self {
        Self(())
    }
}

// SAFETY, for each block below: there is an `Avx2`, or numbers or a mask made from one, so the machine
// has what the instruction asks for; loads and stores are of whole arrays behind references, and ask
// for no alignment.

/// The operator between two of a type, and between one and a number for all lanes.
macro_rules! operator {
    ($($trait:ident $method:ident $instruction:ident),+) => {$(
        impl $trait for Avx2F32 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: see above.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
        impl $trait<f32> for Avx2F32 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f32) -> Self {
                // SAFETY: see above.
                Self(unsafe { $instruction(self.0, _mm256_set1_ps(other)) })
            }
        }
    )+};
}

operator!(
    Add add _mm256_add_ps,
    Sub sub _mm256_sub_ps,
    Mul mul _mm256_mul_ps,
    Div div _mm256_div_ps
);

impl BitAnd for Avx2Mask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_and_ps(self.0, other.0) })
    }
}

impl BitOr for Avx2Mask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_or_ps(self.0, other.0) })
    }
}

impl F32x8 for Avx2F32 {
    type Mask = Avx2Mask;

    #[inline(always)]
    fn store(self, to: &mut [f32; LANES]) {
        // SAFETY: see above.
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_sqrt_ps(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see above.
        Self(unsafe { _mm256_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Avx2Mask {
        // SAFETY: see above.
        Avx2Mask(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) })
    }
}

impl Mask8 for Avx2Mask {
    type F32 = Avx2F32;

    #[inline(always)]
    fn select(self, yes: Avx2F32, no: Avx2F32) -> Avx2F32 {
        // SAFETY: see above.
        Avx2F32(unsafe { _mm256_blendv_ps(no.0, yes.0, self.0) })
    }
    #[inline(always)]
    fn store(self, number: u32, to: &mut [u32; LANES]) {
        // Byte by byte, lest the compiler make it a masked store: those take some machines dozens
        // of cycles.
        // SAFETY: see above.
        unsafe {
            let old = _mm256_loadu_si256(to.as_ptr().cast());
            let number = _mm256_set1_epi32(number.cast_signed());
            let new = _mm256_blendv_epi8(old, number, _mm256_castps_si256(self.0));
            _mm256_storeu_si256(to.as_mut_ptr().cast(), new);
        }
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: see above.
        unsafe { _mm256_movemask_ps(self.0) }.cast_unsigned()
    }
}

impl Lanes for Avx2 {
    type F32 = Avx2F32;
    type Mask = Avx2Mask;

    #[inline(always)]
    fn splat(self, x: f32) -> Avx2F32 {
        // SAFETY: see above.
        Avx2F32(unsafe { _mm256_set1_ps(x) })
    }
    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> Avx2F32 {
        // SAFETY: see above.
        Avx2F32(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }
    #[inline(always)]
    fn transpose(self, rows: [Avx2F32; LANES]) -> [Avx2F32; LANES] {
        let [a, b, c, d, e, f, g, h] = rows.map(|row| row.0);
        // Pairs of numbers, then of pairs, then of halves.
        // SAFETY: see above.
        unsafe {
            let (ab, ab_high) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
            let (cd, cd_high) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
            let (ef, ef_high) = (_mm256_unpacklo_ps(e, f), _mm256_unpackhi_ps(e, f));
            let (gh, gh_high) = (_mm256_unpacklo_ps(g, h), _mm256_unpackhi_ps(g, h));
            let upper = [
                _mm256_shuffle_ps::<0x44>(ab, cd),
                _mm256_shuffle_ps::<0xee>(ab, cd),
                _mm256_shuffle_ps::<0x44>(ab_high, cd_high),
                _mm256_shuffle_ps::<0xee>(ab_high, cd_high),
            ];
            let lower = [
                _mm256_shuffle_ps::<0x44>(ef, gh),
                _mm256_shuffle_ps::<0xee>(ef, gh),
                _mm256_shuffle_ps::<0x44>(ef_high, gh_high),
                _mm256_shuffle_ps::<0xee>(ef_high, gh_high),
            ];
            [
                Avx2F32(_mm256_permute2f128_ps::<0x20>(upper[0], lower[0])),
                Avx2F32(_mm256_permute2f128_ps::<0x20>(upper[1], lower[1])),
                Avx2F32(_mm256_permute2f128_ps::<0x20>(upper[2], lower[2])),
                Avx2F32(_mm256_permute2f128_ps::<0x20>(upper[3], lower[3])),
                Avx2F32(_mm256_permute2f128_ps::<0x31>(upper[0], lower[0])),
                Avx2F32(_mm256_permute2f128_ps::<0x31>(upper[1], lower[1])),
                Avx2F32(_mm256_permute2f128_ps::<0x31>(upper[2], lower[2])),
                Avx2F32(_mm256_permute2f128_ps::<0x31>(upper[3], lower[3])),
            ]
        }
    }
    #[inline(always)]
    fn prefetch<T>(self, from: &[T], index: usize) {
        // SAFETY: a hint, which faults nowhere; the address is worked out without following it.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(from.as_ptr().wrapping_add(index).cast()) };
    }
}
