//! Lanes as vector registers, by `fearless_simd`.

use super::{F32x8, F64x4, LANES, Lanes, Mask8};
use crate::num::double_double::Doubles;
use fearless_simd::{
    Bytes, ExtractToken, Select, Simd, SimdBase, SimdFloat, SimdFrom, SimdInto, SimdMask,
    SimdSplit, f32x8, f64x4, mask32x8, u16x8, u32x8,
};
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{
    __m256, _mm256_max_ps, _mm256_min_ps, _mm256_permute2f128_ps, _mm256_shuffle_ps,
    _mm256_unpackhi_ps, _mm256_unpacklo_ps,
};

impl<S: Simd> F32x8 for f32x8<S> {
    type Mask = mask32x8<S>;

    #[inline(always)]
    fn store(self, to: &mut [f32; LANES]) {
        *to = *self;
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        SimdFloat::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        SimdBase::abs(self)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        SimdFloat::floor(self)
    }
    // The crate leaves unspecified which operand its minimum and maximum return where one is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = self.token().level().as_avx2() {
            return lesser(avx2, self.into(), other.into()).simd_into(self.token());
        }
        Mask8::select(self.lt(other), self, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = self.token().level().as_avx2() {
            return greater(avx2, self.into(), other.into()).simd_into(self.token());
        }
        Mask8::select(other.lt(self), self, other)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        self.simd_lt(other)
    }
    #[inline(always)]
    fn upper_halves(self) -> [u16; LANES] {
        let (first, last) = SimdSplit::split(self);
        let (first, last): (u16x8<S>, u16x8<S>) = (first.bitcast(), last.bitcast());
        // The odd ones.
        *first.unzip_high(last)
    }
    #[inline(always)]
    fn lower_halves(self) -> [u32; LANES] {
        *(self.bitcast::<u32x8<S>>() & 0xffff)
    }
}

impl<S: Simd> Mask8 for mask32x8<S> {
    type F32 = f32x8<S>;

    #[inline(always)]
    fn select(self, yes: Self::F32, no: Self::F32) -> Self::F32 {
        Select::select(self, yes, no)
    }
    // A select, not a masked-store instruction: on some processors those take dozens of cycles.
    #[inline(always)]
    fn store(self, number: u32, to: &mut [u32; LANES]) {
        let number: u32x8<S> = number.simd_into(self.token());
        *to = *Select::select(self, number, (*to).simd_into(self.token()));
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        (self.to_bitmask() & 0xff) as u32
    }
}

impl<S: Simd> Doubles for f64x4<S> {
    #[inline(always)]
    fn zero(self) -> Self {
        0.0.simd_into(self.token())
    }
    // Rounded once, and so exact.
    #[inline(always)]
    fn lost_in_product(self, other: Self, product: Self) -> Self {
        self.mul_sub_precise(other, product)
    }
}

impl<S: Simd> F64x4 for f64x4<S> {
    #[inline(always)]
    fn to_array(self) -> [f64; 4] {
        *self
    }
    #[inline(always)]
    fn abs(self) -> Self {
        SimdBase::abs(self)
    }
    #[inline(always)]
    fn yzx(self) -> Self {
        let [x, y, z, w] = *self;
        [y, z, x, w].simd_into(self.token())
    }
    #[inline(always)]
    fn transpose(rows: [Self; 4]) -> [Self; 4] {
        let token = rows[0].token();
        let [a, b, c, d] = rows.map(|row| *row);
        [
            [a[0], b[0], c[0], d[0]].simd_into(token),
            [a[1], b[1], c[1], d[1]].simd_into(token),
            [a[2], b[2], c[2], d[2]].simd_into(token),
            [a[3], b[3], c[3], d[3]].simd_into(token),
        ]
    }
}

impl<S: Simd> Lanes for S {
    type F32 = f32x8<S>;
    type Mask = mask32x8<S>;
    type F64 = f64x4<S>;

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F32 {
        x.simd_into(self)
    }
    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> Self::F32 {
        (*from).simd_into(self)
    }
    #[inline(always)]
    fn doubles(self, four: [f64; 4]) -> Self::F64 {
        four.simd_into(self)
    }
    #[inline(always)]
    fn equal(self, these: &[u32; LANES], those: &[u32; LANES]) -> Self::Mask {
        let these: u32x8<S> = (*these).simd_into(self);
        these.simd_eq(u32x8::simd_from(self, *those))
    }
    #[inline(always)]
    fn transpose(self, rows: [Self::F32; LANES]) -> [Self::F32; LANES] {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = self.level().as_avx2() {
            return transposed(avx2, rows.map(Into::into)).map(|column| column.simd_into(self));
        }
        // Zipping row i with row i + 4 moves the highest bit of a row's index below the bits of its column. Doing so
        // three times swaps rows and columns.
        let mut rows = rows;
        for _ in 0..LANES.ilog2() {
            let [a, b, c, d, e, f, g, h] = rows;
            rows = [
                a.zip_low(e),
                a.zip_high(e),
                b.zip_low(f),
                b.zip_high(f),
                c.zip_low(g),
                c.zip_high(g),
                d.zip_low(h),
                d.zip_high(h),
            ];
        }
        rows
    }
    #[inline(always)]
    fn prefetch<T>(self, from: &[T], index: usize) {
        super::prefetch(from, index);
    }
}

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel!(
    #[inline(always)]
    fn lesser(simd: Avx2, a: __m256, b: __m256) -> __m256 {
        _mm256_min_ps(a, b)
    }
);

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel!(
    #[inline(always)]
    fn greater(simd: Avx2, a: __m256, b: __m256) -> __m256 {
        _mm256_max_ps(a, b)
    }
);

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel!(
    #[inline(always)]
    fn transposed(simd: Avx2, rows: [__m256; LANES]) -> [__m256; LANES] {
        let [a, b, c, d, e, f, g, h] = rows;
        // Interleaves single numbers, then pairs, then halves.
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
);

#[cfg(test)]
mod tests {
    use super::super::{Simd, Work, dispatch};
    use super::*;

    /// The bits of what each operation gives.
    struct EveryOperation<'a>(&'a mut Vec<u32>);

    impl Work for EveryOperation<'_> {
        fn run(self, lanes: impl Lanes) {
            let (a, b) = (
                lanes.load(&[1.0, -2.5, 0.0, -0.0, f32::NAN, 7.0, 1e-40, f32::INFINITY]),
                lanes.load(&[1.5, -2.5, -0.0, 0.0, 1.0, f32::NAN, -1e-40, f32::MAX]),
            );
            let (c, d) = (
                lanes.load(&[1.0, 3.0, 1e30, 1e-30, 1e-40, 0.1, 0.7, 16_777_217.0]),
                lanes.load(&[3.0, 0.3, 1e20, 1e-20, 3.0, 0.2, 1e-7, 0.9]),
            );
            let row = |row: usize| lanes.splat(row as f32) + c;
            let numbers = [
                a.min(b),
                a.max(b),
                b.min(a),
                b.max(a),
                a.abs(),
                a.lt(b).select(a, b),
                c + d,
                c - d,
                c * d,
                c / d,
                c + 0.1,
                c - 0.1,
                c * 0.1,
                c / 0.1,
                c.sqrt(),
                b.floor(),
            ];
            let columns = lanes.transpose(std::array::from_fn(row));
            for number in numbers.into_iter().chain(columns) {
                let mut all = [0.0; LANES];
                number.store(&mut all);
                self.0.extend(all.map(f32::to_bits));
            }
            for mask in [
                a.lt(b),
                a.lt(b) & c.lt(d),
                a.lt(b) | c.lt(d),
                lanes.mask_from(3),
                lanes.equal(
                    &[1, 2, 3, 4, u32::MAX, 6, 7, 8],
                    &[1, 0, 3, 5, u32::MAX, 6, 8, 8],
                ),
            ] {
                let mut all = [1; LANES];
                mask.store(2, &mut all);
                self.0.extend(all);
                self.0.push(mask.bits());
            }
            self.0.extend(a.upper_halves().map(u32::from));
            self.0.extend(c.lower_halves());
            self.0.push(c.reduce_min().to_bits());
            let e = lanes.doubles([1.1, -2.7e9, 0.0, 0.3e-40]);
            let f = lanes.doubles([3.7e-5, 0.9, -0.0, 1.7e-60]);
            let product = e * f;
            let [g, h, i, j] = F64x4::transpose([e, f, product, e.yzx()]);
            let lost = e.lost_in_product(f, product);
            for four in [
                e + f,
                e - f,
                product,
                lost,
                -e,
                f.abs(),
                f.zero(),
                e.yzx(),
                g,
                h,
                i,
                j,
            ] {
                let bits = four.to_array().map(f64::to_bits);
                self.0.extend(bits.map(|bits| bits as u32));
                self.0.extend(bits.map(|bits| (bits >> 32) as u32));
            }
        }
    }

    #[test]
    fn every_operation_has_the_bits_of_plain_lanes() {
        let of = |simd| {
            let mut bits = Vec::new();
            dispatch(simd, EveryOperation(&mut bits));
            bits
        };
        let plain = of(Simd::Plain);
        assert_eq!(
            plain.len(),
            (18 + LANES) * LANES + 5 * (LANES + 1) + 1 + 12 * 8
        );
        assert_eq!(of(Simd::best()), plain);
    }
}
