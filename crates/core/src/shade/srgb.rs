//! Conversion between sRGB bytes and linear light (IEC 61966-2-1) by tables: each value gives the byte that the standard's
//! formula rounds to, without a power per pixel.

use super::vectors::{Rows, Vectors};
use crate::math;
use crate::num::simd::{F32x8, LANES, Lanes, Simd, Work, dispatch};
use crate::scene::Color;
use glam::{Vec3, Vec4};
use std::sync::LazyLock;

/// The tables, made on first use.
static TABLES: LazyLock<Tables> = LazyLock::new(Tables::new);

/// All smaller values give byte 0: the least value of byte 1 is 0.5 / 255 / 12.92 ≈ 1.24 · 2⁻¹³.
const DARKEST: f32 = 1.0 / 8192.0;

/// The largest value below one.
const BRIGHTEST: f32 = 1.0 - f32::EPSILON / 2.0;

/// The number of single-precision values in a bucket, a 128th of a binade: the upper half of a value's bits, with 7 bits
/// of the mantissa, is its bucket's index.
///
/// The least values of neighbouring bytes differ by at least 2.4 / 269 of themselves, more than a 128th: at most one lies
/// in a bucket.
const BUCKET: u32 = 1 << 16;

/// Buckets from [`DARKEST`] to one: 13 binades.
const BUCKETS: usize = 13 * 128;

/// Indices of 16 bits need no bounds check. The table's memory beyond [`BUCKETS`] is never touched.
const ALL_BUCKETS: usize = 1 << 16;

/// The index of [`DARKEST`]'s bucket, whose first value it is.
const FIRST_BUCKET: usize = bucket(DARKEST) as usize;

/// The index of a value's bucket.
#[inline(always)]
const fn bucket(value: f32) -> u16 {
    (value.to_bits() / BUCKET) as u16
}

/// The sum with an integer from 0 to 2²² has the integer in its lowest bits.
const WHOLE: f32 = (1 << 23) as f32;

/// The tables of both directions.
#[derive(Debug)]
pub(crate) struct Tables {
    /// The linear light of each byte.
    linear: [f32; 256],
    /// For each bucket b · [`BUCKET`] + [`BUCKET`] − n, with b the byte at its lower end and n the offset in the bucket at
    /// which byte b + 1 begins. Adding a value's offset carries into the byte where that is n or more.
    steps: &'static [u32; ALL_BUCKETS],
}

/// The steps of [`Tables`].
static STEPS: LazyLock<Box<[u32; ALL_BUCKETS]>> = LazyLock::new(steps);

/// Linear light from an sRGB value, both 0 to 1.
fn to_linear(value: f64) -> f64 {
    if value <= 0.04045 {
        value / 12.92
    } else {
        math::pow((value + 0.055) / 1.055, 2.4)
    }
}

/// The least single-precision linear light that rounds to a byte.
fn begin(byte: u8) -> f32 {
    let threshold = to_linear(((f64::from(byte) - 0.5) / 255.0).max(0.0));
    let nearest = threshold as f32;
    if f64::from(nearest) < threshold {
        nearest.next_up()
    } else {
        nearest
    }
}

/// The steps of the buckets from [`DARKEST`] to one.
fn steps() -> Box<[u32; ALL_BUCKETS]> {
    let begins: [f32; 256] = std::array::from_fn(|byte| begin(byte as u8));
    let mut steps = vec![0; ALL_BUCKETS];
    for (index, step) in steps
        .iter_mut()
        .enumerate()
        .skip(FIRST_BUCKET)
        .take(BUCKETS)
    {
        let lower = index as u32 * BUCKET;
        let reached = |&begin: &f32| begin.to_bits() <= lower;
        let byte = begins.partition_point(reached) as u32 - 1;
        let next = begins.get(byte as usize + 1);
        let next = next.map_or(BUCKET, |next| (next.to_bits() - lower).min(BUCKET));
        *step = byte * BUCKET + (BUCKET - next);
    }
    let steps: Result<Box<[u32; ALL_BUCKETS]>, _> = steps.try_into();
    steps.expect("the length is that of the array")
}

impl Tables {
    fn new() -> Self {
        Self {
            linear: std::array::from_fn(|byte| to_linear(byte as f64 / 255.0) as f32),
            steps: &STEPS,
        }
    }

    /// The linear light of a byte.
    #[inline]
    pub(crate) fn decode(&self, byte: u8) -> f32 {
        self.linear[usize::from(byte)]
    }

    /// The nearest byte; below zero and NaN give 0, above one gives 255.
    #[inline(always)]
    pub(crate) fn encode(&self, linear: f32) -> u8 {
        // NaN compares as false, and becomes the darkest.
        self.encode_within(if linear > DARKEST {
            linear.min(BRIGHTEST)
        } else {
            DARKEST
        })
    }

    /// [`Tables::encode`] of a value from [`DARKEST`] to [`BRIGHTEST`].
    #[inline(always)]
    fn encode_within(&self, linear: f32) -> u8 {
        let step = self.steps[usize::from(bucket(linear))];
        ((step + linear.to_bits() % BUCKET) / BUCKET) as u8
    }

    /// The bytes of eight opaque colours.
    #[inline(always)]
    pub(super) fn encode_row<L: Lanes>(
        &self,
        lanes: L,
        colors: Vectors<L>,
        pixels: &mut [[u8; 4]; LANES],
    ) {
        let colors = within(lanes, colors);
        let mut bytes = [[0; LANES]; 3];
        for (colors, bytes) in colors.xyz().into_iter().zip(&mut bytes) {
            // In lanes, all but the lookups.
            *bytes = self.looked_up(&colors.upper_halves(), &colors.lower_halves());
        }
        pack(&bytes, pixels);
    }

    /// The bytes of eight opaque colours [`within`] the tables, whose buckets, the [`F32x8::upper_halves`], are known.
    ///
    /// The lookups wait for the buckets, and those for all that the colours follow from. Where buckets come from memory,
    /// written some time ago, the processor looks up one row's while it computes the next one's.
    #[inline(always)]
    pub(super) fn encode_buckets<L: Lanes>(
        &self,
        colors: Vectors<L>,
        buckets: [&[u16; LANES]; 3],
        pixels: &mut [[u8; 4]; LANES],
    ) {
        let mut bytes = [[0; LANES]; 3];
        for ((colors, buckets), bytes) in colors.xyz().into_iter().zip(buckets).zip(&mut bytes) {
            *bytes = self.looked_up(buckets, &colors.lower_halves());
        }
        pack(&bytes, pixels);
    }

    /// The bytes at these offsets in buckets.
    #[inline(always)]
    fn looked_up(&self, buckets: &[u16; LANES], offsets: &[u32; LANES]) -> [u32; LANES] {
        let mut steps = [0; LANES];
        for lane in 0..LANES {
            steps[lane] = self.steps[usize::from(buckets[lane])];
        }
        let mut bytes = [0; LANES];
        for lane in 0..LANES {
            bytes[lane] = (steps[lane] + offsets[lane]) / BUCKET;
        }
        bytes
    }

    /// The bytes of eight opaque colours given in sRGB, 0 to 1: [`Tables::encode`] of [`Tables::display`].
    #[inline(always)]
    pub(super) fn display_row<L: Lanes>(
        &self,
        lanes: L,
        values: Vectors<L>,
        pixels: &mut [[u8; 4]; LANES],
    ) {
        pack(&displayed_bytes(lanes, values), pixels);
    }

    /// [`Tables::display`] of eight colours.
    #[inline(always)]
    pub(super) fn displayed<L: Lanes>(&self, lanes: L, values: Vectors<L>) -> Vectors<L> {
        let bytes = displayed_bytes(lanes, values);
        let mut light = Rows::ZERO;
        for (light, bytes) in light.0.iter_mut().zip(bytes) {
            for lane in 0..LANES {
                light[lane] = self.linear[bytes[lane] as usize % 256];
            }
        }
        Vectors::load(lanes, &light)
    }

    /// The bytes of an opaque colour.
    #[inline(always)]
    fn encode_opaque(&self, linear: Vec3) -> [u8; 4] {
        [
            self.encode(linear.x),
            self.encode(linear.y),
            self.encode(linear.z),
            u8::MAX,
        ]
    }

    /// The linear light of the byte nearest to an sRGB value, 0 to 1.
    pub(crate) fn display(&self, value: f32) -> f32 {
        // The cast is saturating, and NaN becomes zero.
        self.decode((value * 255.0 + 0.5) as u8)
    }
}

/// Colours clamped to the range of the tables; NaN becomes the darkest.
#[inline(always)]
pub(super) fn within<L: Lanes>(lanes: L, colors: Vectors<L>) -> Vectors<L> {
    colors
        .max(Vectors::splat(lanes, Vec3::splat(DARKEST)))
        .min(Vectors::splat(lanes, Vec3::splat(BRIGHTEST)))
}

/// The nearest bytes of eight colours given in sRGB, 0 to 1.
#[inline(always)]
fn displayed_bytes<L: Lanes>(lanes: L, values: Vectors<L>) -> [[u32; LANES]; 3] {
    let (zero, most) = (lanes.splat(0.0), lanes.splat(255.0));
    let mut bytes = [[0; LANES]; 3];
    for (value, bytes) in values.xyz().into_iter().zip(&mut bytes) {
        // NaN becomes zero.
        let whole = (value * 255.0 + 0.5).max(zero).min(most).floor() + WHOLE;
        let mut row = [0.0; LANES];
        whole.store(&mut row);
        for lane in 0..LANES {
            bytes[lane] = row[lane].to_bits() % 256;
        }
    }
    bytes
}

/// Eight opaque pixels of these bytes.
#[inline(always)]
fn pack([r, g, b]: &[[u32; LANES]; 3], pixels: &mut [[u8; 4]; LANES]) {
    for lane in 0..LANES {
        let all = r[lane] | g[lane] << 8 | b[lane] << 16 | u32::from(u8::MAX) << 24;
        pixels[lane] = all.to_le_bytes();
    }
}

/// The tables. Loops call this once: each call tests whether they exist.
pub(crate) fn tables() -> &'static Tables {
    &TABLES
}

/// Tables for images of numbers, such as roughness: a byte decodes to itself over 255. Encoding is that of colours.
pub(crate) fn numbers() -> &'static Tables {
    &NUMBERS
}

static NUMBERS: LazyLock<Tables> = LazyLock::new(|| Tables {
    linear: std::array::from_fn(|byte| (byte as f64 / 255.0) as f32),
    steps: &STEPS,
});

/// The linear light of a colour that a person chose.
pub(crate) fn linear(color: Color) -> Vec3 {
    Vec3::from(color.0.map(|byte| TABLES.decode(byte)))
}

/// Premultiplied from straight alpha.
#[inline(always)]
pub(crate) fn premultiply(color: [f32; 4]) -> [f32; 4] {
    let color = Vec4::from(color);
    // A vector for each colour: four colours at once, as compilers like it, take shuffling them.
    (color * Vec4::splat(color.w).with_w(1.0)).into()
}

/// sRGB bytes with straight alpha, from linear light with premultiplied alpha.
pub(crate) fn encode_premultiplied([r, g, b, a]: [f32; 4]) -> [u8; 4] {
    if a == 1.0 {
        return TABLES.encode_opaque(Vec3::new(r, g, b));
    }
    let alpha = (a * 255.0 + 0.5) as u8;
    if alpha == 0 {
        return [0; 4];
    }
    let [r, g, b] = [r / a, g / a, b / a].map(|channel| TABLES.encode(channel));
    [r, g, b, alpha]
}

/// [`encode_premultiplied`] of many colours; most are opaque.
pub(crate) fn encode_all_premultiplied(simd: Simd, colors: &[[f32; 4]], pixels: &mut [[u8; 4]]) {
    dispatch(simd, EncodeAll { colors, pixels });
}

struct EncodeAll<'c, 'p> {
    colors: &'c [[f32; 4]],
    pixels: &'p mut [[u8; 4]],
}

impl Work for EncodeAll<'_, '_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let (eights, rest) = self.colors.as_chunks::<LANES>();
        let (pixels, pixels_rest) = self.pixels.as_chunks_mut::<LANES>();
        let tables = tables();
        for (colors, pixels) in eights.iter().zip(pixels) {
            let mut rows = Rows::ZERO;
            let mut are_opaque = true;
            for (lane, &[r, g, b, a]) in colors.iter().enumerate() {
                rows.set(lane, Vec3::new(r, g, b));
                are_opaque &= a == 1.0;
            }
            if are_opaque {
                tables.encode_row(lanes, Vectors::load(lanes, &rows), pixels);
            } else {
                for (color, pixel) in colors.iter().zip(pixels) {
                    *pixel = encode_premultiplied(*color);
                }
            }
        }
        for (color, pixel) in rest.iter().zip(pixels_rest) {
            *pixel = encode_premultiplied(*color);
        }
    }
}

/// Linear light with premultiplied alpha, from sRGB bytes with straight alpha.
pub(crate) fn decode_premultiplied([r, g, b, a]: [u8; 4]) -> [f32; 4] {
    let [r, g, b] = [r, g, b].map(|byte| TABLES.decode(byte));
    premultiply([r, g, b, f32::from(a) / 255.0])
}

/// sRGB bytes from linear light, both with straight alpha. It rounds as [`premultiply`] does, so that a picture's bytes
/// follow from its layers.
#[inline]
pub(crate) fn encode(color: [f32; 4]) -> [u8; 4] {
    let [r, g, b, a] = color;
    if a == 1.0 {
        TABLES.encode_opaque(Vec3::new(r, g, b))
    } else {
        encode_premultiplied(premultiply(color))
    }
}

/// sRGB bytes composited over black in linear light.
pub(crate) fn over_black([r, g, b, a]: [u8; 4]) -> [u8; 3] {
    let alpha = f32::from(a) / 255.0;
    [r, g, b].map(|byte| TABLES.encode(TABLES.decode(byte) * alpha))
}

/// A colour of this coverage composited over another; straight alpha.
pub(super) fn over(color: Vec3, coverage: f32, [r, g, b, a]: [f32; 4]) -> [f32; 4] {
    if coverage == 0.0 {
        return [r, g, b, a];
    }
    let alpha = coverage + a * (1.0 - coverage);
    let mixed = (color * coverage + Vec3::new(r, g, b) * (a * (1.0 - coverage))) / alpha;
    [mixed.x, mixed.y, mixed.z, alpha]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// The byte by the standard's own formula in double precision, before rounding.
    fn formula(linear: f64) -> f64 {
        let value = if linear <= 0.04045 / 12.92 {
            linear * 12.92
        } else {
            1.055 * math::pow(linear, 1.0 / 2.4) - 0.055
        };
        value * 255.0
    }

    #[test]
    fn bytes_come_back() {
        for byte in 0..=255 {
            assert_eq!(TABLES.encode(TABLES.decode(byte)), byte);
            assert_eq!(TABLES.display(f32::from(byte) / 255.0), TABLES.decode(byte));
        }
        assert_eq!((TABLES.decode(0), TABLES.decode(255)), (0.0, 1.0));
    }

    #[test]
    fn rounds_as_the_formula_does() {
        // Values over five decades and up to one, from a fixed generator; the truth is the
        // standard's formula in double precision, whose error is far below the 1e-6 allowed.
        let mut random = Random(1);
        for _ in 0..100_000 {
            let even = random.unit() as f32;
            for value in [even, even * even * even, even * 1e-3] {
                let error = f64::from(TABLES.encode(value)) - formula(f64::from(value));
                assert!(error.abs() <= 0.5 + 1e-6, "{value} is off by {error}");
            }
        }
    }

    #[test]
    fn every_threshold_is_sharp() {
        for byte in 1..=255u8 {
            let begin = begin(byte);
            assert_eq!(TABLES.encode(begin), byte);
            assert_eq!(TABLES.encode(begin.next_down()), byte - 1);
            assert!((formula(f64::from(begin)) - (f64::from(byte) - 0.5)).abs() < 1e-4);
        }
    }

    #[test]
    fn out_of_range_is_clamped() {
        for (value, byte) in [
            (f32::NAN, 0),
            (-1.0, 0),
            (f32::NEG_INFINITY, 0),
            (1.5, 255),
            (f32::INFINITY, 255),
        ] {
            assert_eq!(TABLES.encode(value), byte, "{value}");
        }
    }

    #[test]
    fn many_colors_have_the_bytes_of_single_ones() {
        let mut random = Random(2);
        for count in [0, 7, 8, 50] {
            for is_opaque in [true, false] {
                let color = |_| {
                    let [r, g, b, a] = [(); 4].map(|()| random.unit() as f32 * 1.2 - 0.1);
                    [r, g, b, if is_opaque { 1.0 } else { a.clamp(0.0, 1.0) }]
                };
                let colors: Vec<_> = (0..count).map(color).collect();
                for simd in Simd::available() {
                    let mut pixels = vec![[0; 4]; count];
                    encode_all_premultiplied(simd, &colors, &mut pixels);
                    let expected: Vec<_> = colors
                        .iter()
                        .map(|&color| encode_premultiplied(color))
                        .collect();
                    assert_eq!(pixels, expected);
                }
            }
        }
    }

    #[test]
    fn alpha_apart_and_multiplied_in_agree() {
        for alpha in [0.0, 0.1, 1.0 / 3.0, 0.5, 0.75, 1.0] {
            let color = [0.2, 0.7, 1.0, alpha];
            assert_eq!(encode(color), encode_premultiplied(premultiply(color)));
        }
        assert_eq!(encode([1.0, 0.0, 1.0, 0.5]), [255, 0, 255, 128]);
        assert_eq!(encode([1.0, 1.0, 1.0, 0.0]), [0; 4]);
    }
}
