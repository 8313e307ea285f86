//! One source for several instruction sets: the same code, compiled for each, picked at run time.
//!
//! Loops over doubles are left to the compiler. Rows of eight singles, where it would not see that they
//! can be laid side by side, are spelt out as [`Lanes`]. Nothing contracts a product and a sum into one
//! rounding, so the bits are the same on each.

#![allow(
    unsafe_code,
    reason = "a function compiled for an instruction set may be called only where the machine has it"
)]

/// Instruction sets that tiles can be cast with, from the plainest to the widest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Simd {
    /// What every machine of this architecture has.
    Plain,
    /// AVX2: eight singles at once.
    Avx2,
    /// AVX-512: sixteen.
    Avx512,
}

impl Simd {
    /// The widest that this machine has.
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let has_512 = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl");
            if has_512 {
                return Self::Avx512;
            }
            if is_x86_feature_detected!("avx2") {
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
            Self::Avx512 => "avx512",
        }
    }
}

impl std::str::FromStr for Simd {
    type Err = String;

    /// Reads a name as [`Simd::name`] gives it.
    fn from_str(name: &str) -> Result<Self, String> {
        [Self::Plain, Self::Avx2, Self::Avx512]
            .into_iter()
            .find(|simd| simd.name() == name)
            .ok_or_else(|| format!("expected plain, avx2 or avx512, found {name:?}"))
    }
}

/// How many singles [`Lanes`] lay side by side.
pub(crate) const LANES: usize = 8;

/// Eight singles side by side, by one instruction set. A value of a type of these is the proof that
/// the machine has the set.
pub(crate) trait Lanes: Copy {
    /// Eight singles.
    type Singles: Copy;
    /// Yes or no for each.
    type Mask: Copy;

    /// The same for all.
    fn splat(self, x: f32) -> Self::Singles;
    /// From memory.
    fn load(self, from: &[f32; LANES]) -> Self::Singles;
    /// To memory.
    fn store(self, singles: Self::Singles, to: &mut [f32; LANES]);
    /// Sums.
    fn add(self, a: Self::Singles, b: Self::Singles) -> Self::Singles;
    /// Differences.
    fn sub(self, a: Self::Singles, b: Self::Singles) -> Self::Singles;
    /// Products.
    fn mul(self, a: Self::Singles, b: Self::Singles) -> Self::Singles;
    /// Quotients.
    fn div(self, a: Self::Singles, b: Self::Singles) -> Self::Singles;
    /// Square roots.
    fn sqrt(self, a: Self::Singles) -> Self::Singles;
    /// The lesser ones; where either is not a number, b.
    fn min(self, a: Self::Singles, b: Self::Singles) -> Self::Singles;
    /// The greater ones; where either is not a number, b.
    fn max(self, a: Self::Singles, b: Self::Singles) -> Self::Singles;
    /// Whether a < b; never where either is not a number.
    fn less(self, a: Self::Singles, b: Self::Singles) -> Self::Mask;
    /// Both.
    fn and(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Either.
    fn or(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// The first where the mask says yes, the second elsewhere.
    fn pick(self, mask: Self::Mask, yes: Self::Singles, no: Self::Singles) -> Self::Singles;
    /// Writes a number where the mask says yes.
    fn put(self, mask: Self::Mask, number: u32, to: &mut [u32; LANES]);
    /// The mask as bits, the first lane lowest.
    fn bits(self, mask: Self::Mask) -> u32;
    /// A lane and those after it.
    #[inline(always)]
    fn from(self, lane: usize) -> Self::Mask {
        const LANE: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        self.less(self.splat(lane as f32 - 0.5), self.load(&LANE))
    }

    /// Eight rows as eight columns.
    fn transpose(self, rows: [Self::Singles; LANES]) -> [Self::Singles; LANES];

    /// Asks for an item of a slice to be brought near, if there is such an item.
    fn prefetch<T>(self, from: &[T], index: usize);

    /// The least of the eight; they are numbers.
    #[inline(always)]
    fn least(self, singles: Self::Singles) -> f32 {
        let mut all = [0.0; LANES];
        self.store(singles, &mut all);
        let lesser = |a: f32, b: f32| if a < b { a } else { b };
        let [a, b, c, d, e, f, g, h] = all;
        lesser(
            lesser(lesser(a, b), lesser(c, d)),
            lesser(lesser(e, f), lesser(g, h)),
        )
    }
}

/// Arrays, for any machine.
#[derive(Clone, Copy)]
pub(crate) struct Plain;

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

impl Lanes for Plain {
    type Singles = [f32; LANES];
    type Mask = [bool; LANES];

    #[inline(always)]
    fn splat(self, x: f32) -> Self::Singles {
        [x; LANES]
    }
    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> Self::Singles {
        *from
    }
    #[inline(always)]
    fn store(self, singles: Self::Singles, to: &mut [f32; LANES]) {
        *to = singles;
    }
    #[inline(always)]
    fn add(self, a: Self::Singles, b: Self::Singles) -> Self::Singles {
        each!(l => a[l] + b[l])
    }
    #[inline(always)]
    fn sub(self, a: Self::Singles, b: Self::Singles) -> Self::Singles {
        each!(l => a[l] - b[l])
    }
    #[inline(always)]
    fn mul(self, a: Self::Singles, b: Self::Singles) -> Self::Singles {
        each!(l => a[l] * b[l])
    }
    #[inline(always)]
    fn div(self, a: Self::Singles, b: Self::Singles) -> Self::Singles {
        each!(l => a[l] / b[l])
    }
    #[inline(always)]
    fn sqrt(self, a: Self::Singles) -> Self::Singles {
        each!(l => a[l].sqrt())
    }
    #[inline(always)]
    fn min(self, a: Self::Singles, b: Self::Singles) -> Self::Singles {
        each!(l => if a[l] < b[l] { a[l] } else { b[l] })
    }
    #[inline(always)]
    fn max(self, a: Self::Singles, b: Self::Singles) -> Self::Singles {
        each!(l => if a[l] > b[l] { a[l] } else { b[l] })
    }
    #[inline(always)]
    fn less(self, a: Self::Singles, b: Self::Singles) -> Self::Mask {
        each!(l => a[l] < b[l])
    }
    #[inline(always)]
    fn and(self, a: Self::Mask, b: Self::Mask) -> Self::Mask {
        each!(l => a[l] & b[l])
    }
    #[inline(always)]
    fn or(self, a: Self::Mask, b: Self::Mask) -> Self::Mask {
        each!(l => a[l] | b[l])
    }
    #[inline(always)]
    fn pick(self, mask: Self::Mask, yes: Self::Singles, no: Self::Singles) -> Self::Singles {
        each!(l => if mask[l] { yes[l] } else { no[l] })
    }
    #[inline(always)]
    fn put(self, mask: Self::Mask, number: u32, to: &mut [u32; LANES]) {
        let old = *to;
        *to = each!(l => if mask[l] { number } else { old[l] });
    }
    #[inline(always)]
    fn bits(self, mask: Self::Mask) -> u32 {
        let mut bits = 0;
        for (l, &yes) in mask.iter().enumerate() {
            bits |= u32::from(yes) << l;
        }
        bits
    }
    #[inline(always)]
    fn transpose(self, rows: [Self::Singles; LANES]) -> [Self::Singles; LANES] {
        each!(column => each!(row => rows[row][column]))
    }
    #[inline(always)]
    fn prefetch<T>(self, _: &[T], _: usize) {}
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{LANES, Lanes};
    use std::arch::x86_64::{
        __m256, _CMP_LT_OQ, _MM_HINT_T0, _mm_prefetch, _mm256_add_ps, _mm256_and_ps,
        _mm256_blendv_epi8, _mm256_blendv_ps, _mm256_castps_si256, _mm256_cmp_ps, _mm256_div_ps,
        _mm256_loadu_ps, _mm256_loadu_si256, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps,
        _mm256_mul_ps, _mm256_or_ps, _mm256_permute2f128_ps, _mm256_set1_epi32, _mm256_set1_ps,
        _mm256_shuffle_ps, _mm256_sqrt_ps, _mm256_storeu_ps, _mm256_storeu_si256, _mm256_sub_ps,
        _mm256_unpackhi_ps, _mm256_unpacklo_ps,
    };

    /// The machine has AVX2: made nowhere but in [`Avx2::new`].
    #[derive(Clone, Copy)]
    pub(super) struct Avx2(());

    impl Avx2 {
        /// # Safety
        /// The machine has AVX2.
        #[inline(always)]
        pub(super) unsafe fn new() -> Self {
            Self(())
        }
    }

    // SAFETY, for each block below: there is an `Avx2`, so the machine has what the instruction asks
    // for; loads and stores are of whole arrays behind references, and ask for no alignment.
    impl Lanes for Avx2 {
        type Singles = __m256;
        type Mask = __m256;

        #[inline(always)]
        fn splat(self, x: f32) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_set1_ps(x) }
        }
        #[inline(always)]
        fn load(self, from: &[f32; LANES]) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_loadu_ps(from.as_ptr()) }
        }
        #[inline(always)]
        fn store(self, singles: __m256, to: &mut [f32; LANES]) {
            // SAFETY: see above.
            unsafe { _mm256_storeu_ps(to.as_mut_ptr(), singles) }
        }
        #[inline(always)]
        fn add(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_add_ps(a, b) }
        }
        #[inline(always)]
        fn sub(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_sub_ps(a, b) }
        }
        #[inline(always)]
        fn mul(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_mul_ps(a, b) }
        }
        #[inline(always)]
        fn div(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_div_ps(a, b) }
        }
        #[inline(always)]
        fn sqrt(self, a: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_sqrt_ps(a) }
        }
        #[inline(always)]
        fn min(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_min_ps(a, b) }
        }
        #[inline(always)]
        fn max(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_max_ps(a, b) }
        }
        #[inline(always)]
        fn less(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(a, b) }
        }
        #[inline(always)]
        fn and(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_and_ps(a, b) }
        }
        #[inline(always)]
        fn or(self, a: __m256, b: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_or_ps(a, b) }
        }
        #[inline(always)]
        fn pick(self, mask: __m256, yes: __m256, no: __m256) -> __m256 {
            // SAFETY: see above.
            unsafe { _mm256_blendv_ps(no, yes, mask) }
        }
        #[inline(always)]
        fn put(self, mask: __m256, number: u32, to: &mut [u32; LANES]) {
            // Byte by byte, lest the compiler make it a masked store: those take some machines dozens
            // of cycles.
            // SAFETY: see above.
            unsafe {
                let old = _mm256_loadu_si256(to.as_ptr().cast());
                let number = _mm256_set1_epi32(number.cast_signed());
                let new = _mm256_blendv_epi8(old, number, _mm256_castps_si256(mask));
                _mm256_storeu_si256(to.as_mut_ptr().cast(), new);
            }
        }
        #[inline(always)]
        fn bits(self, mask: __m256) -> u32 {
            // SAFETY: see above.
            unsafe { _mm256_movemask_ps(mask) }.cast_unsigned()
        }
        #[inline(always)]
        fn transpose(self, [a, b, c, d, e, f, g, h]: [__m256; LANES]) -> [__m256; LANES] {
            // Pairs of singles, then of pairs, then of halves.
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
                    _mm256_permute2f128_ps::<0x20>(upper[0], lower[0]),
                    _mm256_permute2f128_ps::<0x20>(upper[1], lower[1]),
                    _mm256_permute2f128_ps::<0x20>(upper[2], lower[2]),
                    _mm256_permute2f128_ps::<0x20>(upper[3], lower[3]),
                    _mm256_permute2f128_ps::<0x31>(upper[0], lower[0]),
                    _mm256_permute2f128_ps::<0x31>(upper[1], lower[1]),
                    _mm256_permute2f128_ps::<0x31>(upper[2], lower[2]),
                    _mm256_permute2f128_ps::<0x31>(upper[3], lower[3]),
                ]
            }
        }
        #[inline(always)]
        fn prefetch<T>(self, from: &[T], index: usize) {
            // SAFETY: a hint, which faults nowhere; the address is worked out without following it.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(from.as_ptr().wrapping_add(index).cast()) };
        }
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

        #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,bmi1,bmi2,popcnt,lzcnt")]
        fn avx512(work: impl Work, lanes: Avx2) {
            work.run(lanes);
        }

        #[target_feature(enable = "avx2,bmi1,bmi2,popcnt,lzcnt")]
        fn avx2(work: impl Work, lanes: Avx2) {
            work.run(lanes);
        }

        match simd.min(Simd::best()) {
            // SAFETY: `Simd::best` has just said that the machine has these features (every machine
            // with AVX2 has the bit manipulation ones).
            Simd::Avx512 => return unsafe { avx512(work, Avx2::new()) },
            // SAFETY: as above.
            Simd::Avx2 => return unsafe { avx2(work, Avx2::new()) },
            Simd::Plain => {}
        }
    }
    let _ = simd;
    work.run(Plain);
}
