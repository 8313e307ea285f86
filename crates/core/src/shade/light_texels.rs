//! Textures in linear light, from which bilinear interpolation reads two neighbouring texels at once.

use super::Filter;
use super::sample::{decoded, sample_eight, whole, wrapped_texel};
use super::srgb::Tables;
use super::vectors::{Row, Vectors};
use crate::num::simd::{LANES, Lanes};
use crate::scene::{Texture, Wrap};

/// A texture's texels in linear light with premultiplied alpha, and those that wrapping shows beyond its sides.
struct LightTexels<'t> {
    texture: &'t Texture,
    texels: &'t [f32],
    columns: u32,
}

/// [`sample`](super::sample::sample) at eight places, as colours and alphas.
#[inline(always)]
pub(super) fn read_eight<L: Lanes>(
    lanes: L,
    tables: &Tables,
    texture: &Texture,
    uv: &[[f64; LANES]; 2],
    filter: Filter,
) -> (Vectors<L>, L::F32) {
    if filter != Filter::Nearest
        && let Some(light) = LightTexels::of(tables, texture)
    {
        return light.bilinear(lanes, uv);
    }
    sample_eight(lanes, tables, texture, uv, filter)
}

impl<'t> LightTexels<'t> {
    /// A texture's, computed on first use; `None` for textures that have none.
    #[inline(always)]
    fn of(tables: &Tables, texture: &'t Texture) -> Option<Self> {
        let (columns, _) = texture.light_size()?;
        let texels = texture.light(|texture| light(tables, texture));
        Some(Self {
            texture,
            texels: texels.as_flattened(),
            columns,
        })
    }

    /// Interpolates between the four texels around eight places.
    #[inline(always)]
    fn bilinear<L: Lanes>(&self, lanes: L, [u, v]: &[[f64; LANES]; 2]) -> (Vectors<L>, L::F32) {
        let [across, down] = self.texture.wrap();
        let (width, height) = (self.texture.width(), self.texture.height());
        let mut places = [near(across, u), near(down, v)];
        for lane in 0..LANES {
            places[0][lane] *= f64::from(width);
            places[1][lane] = (1.0 - places[1][lane]) * f64::from(height);
        }
        let (lefts, right) = neighbors(&places[0], width);
        let (tops, below) = neighbors(&places[1], height);
        let beyond = f64::from(Texture::BEYOND);
        let mut at = [0; LANES];
        for lane in 0..LANES {
            // Numbers of texels fit 32 bits.
            let row = (tops[lane] + beyond) * f64::from(self.columns);
            at[lane] = whole(row + (lefts[lane] + beyond));
        }
        let (right, below) = (lanes.load(&right), lanes.load(&below));
        let one = lanes.splat(1.0);
        let (left, above) = (one - right, one - below);
        let [a, b] = self.pairs(lanes, &at, 0);
        let [c, d] = self.pairs(lanes, &at, self.columns);
        let channel = |i: usize| {
            let top = a[i] * left * above + b[i] * right * above;
            top + c[i] * left * below + d[i] * right * below
        };
        let [r, g, b, alpha] = std::array::from_fn(channel);
        (Vectors::new(lanes, [r, g, b]), alpha)
    }

    /// The channels of eight texels so many after these, and of the eight to their right.
    #[inline(always)]
    fn pairs<L: Lanes>(&self, lanes: L, at: &[u32; LANES], after: u32) -> [[L::F32; 4]; 2] {
        const NONE: &Row = &[0.0; LANES];
        let mut pairs = [lanes.splat(0.0); LANES];
        for (pair, &at) in pairs.iter_mut().zip(at) {
            // Wherever wrapping ends, both are stored.
            let first = (at + after) as usize * 4;
            let both = self.texels.get(first..).and_then(<[f32]>::first_chunk);
            *pair = lanes.load(both.unwrap_or(NONE));
        }
        let [a, b, c, d, e, f, g, h] = lanes.transpose(pairs);
        [[a, b, c, d], [e, f, g, h]]
    }
}

/// [`Wrap::near`] of eight coordinates. Comparisons that are false for NaN, since a test for finite numbers would be compiled
/// lane by lane.
#[inline(always)]
fn near(wrap: Wrap, coordinates: &[f64; LANES]) -> [f64; LANES] {
    let mut near = [0.0; LANES];
    if matches!(wrap, Wrap::Repeat) {
        for (near, coordinate) in near.iter_mut().zip(coordinates) {
            let within = coordinate - coordinate.floor();
            *near = if within <= 1.0 { within } else { 0.0 };
        }
    } else {
        for (near, &coordinate) in near.iter_mut().zip(coordinates) {
            let clamped = if coordinate > -1.0 { coordinate } else { -1.0 };
            let clamped = if clamped < 2.0 { clamped } else { 2.0 };
            let is_finite = coordinate.abs() < f64::INFINITY;
            *near = if is_finite { clamped } else { 0.0 };
        }
    }
    near
}

/// The texels whose centres are at or before eight positions along a side, and the positions' fractions between them and
/// the next ones. Those that are farther from the image than two texels are as those.
#[inline(always)]
fn neighbors(places: &[f64; LANES], size: u32) -> ([f64; LANES], Row) {
    let (mut before, mut fraction) = ([0.0; LANES], [0.0; LANES]);
    let (first, last) = (-f64::from(Texture::BEYOND), f64::from(size));
    for lane in 0..LANES {
        let from_center = places[lane] - 0.5;
        let at = from_center.floor();
        fraction[lane] = (from_center - at) as f32;
        let at = if at < first { first } else { at };
        before[lane] = if at > last { last } else { at };
    }
    (before, fraction)
}

/// The texels of [`Texture::light`].
#[inline(never)]
fn light(tables: &Tables, texture: &Texture) -> Vec<[f32; 4]> {
    let beyond = i64::from(Texture::BEYOND);
    let (width, height) = (i64::from(texture.width()), i64::from(texture.height()));
    let mut light = Vec::new();
    light.reserve_exact(texture.light_bytes() as usize / size_of::<[f32; 4]>());
    let mut rows = texture.texels().chunks(texture.width() as usize).peekable();
    for y in -beyond..height + beyond {
        let wrapped = |x| wrapped_texel(tables, texture, x, y);
        light.extend((-beyond..0).map(wrapped));
        match rows.next_if(|_| (0..height).contains(&y)) {
            Some(row) => light.extend(row.iter().map(|&texel| decoded(tables, texel))),
            None => light.extend((0..width).map(wrapped)),
        }
        light.extend((width..width + beyond).map(wrapped));
    }
    light
}

#[cfg(test)]
mod tests {
    use super::super::sample::sample;
    use super::super::srgb::tables;
    use super::*;
    use crate::num::simd::{F32x8, Simd, Work, dispatch};
    use crate::random::Random;

    struct ReadEight<'a> {
        texture: &'a Texture,
        uv: &'a [[f64; LANES]; 2],
        filter: Filter,
        found: &'a mut [Row; 4],
    }

    impl Work for ReadEight<'_> {
        #[inline(always)]
        fn run(self, lanes: impl Lanes) {
            let (color, alpha) = read_eight(lanes, tables(), self.texture, self.uv, self.filter);
            let [r, g, b, a] = self.found;
            [*r, *g, *b] = color.store().0;
            alpha.store(a);
        }
    }

    /// On each side of texels' centres and borders and of the image's seams, and far away.
    #[test]
    fn eight_samples_have_the_bits_of_single_ones() {
        let mut random = Random(5);
        let texel = |i: u32| {
            [
                (i * 37) as u8,
                (i * 91) as u8,
                (i * 11) as u8,
                (i * 59) as u8,
            ]
        };
        let red = Wrap::Border(Some(crate::scene::Color([255, 0, 0])));
        // The last has too many texels to be stored in linear light.
        for (width, height) in [(1, 1), (2, 1), (5, 3), (64, 1), (127, 33), (1100, 1000)] {
            let texels = (0..width * height).map(texel).collect();
            let texture = Texture::new(width, height, texels).expect("a good texture");
            for wrap in [
                [Wrap::Repeat, Wrap::Repeat],
                [Wrap::Clamp, Wrap::Mirror],
                [Wrap::Clamp, Wrap::Repeat],
                [Wrap::Border(None), Wrap::Clamp],
                [Wrap::Repeat, red],
                [red, Wrap::Border(None)],
            ] {
                let texture = &texture.clone().wrapped(wrap);
                for round in 0..200 {
                    let mut coordinate = |size: u32| {
                        let near = (random.signed() * 40.0).round() / f64::from(size * 2);
                        match round % 4 {
                            0 => near,
                            1 => near.next_up(),
                            2 => near.next_down(),
                            _ => random.signed() * crate::math::pow(10.0, random.signed() * 20.0),
                        }
                    };
                    let mut uv = [[0.0; LANES]; 2];
                    uv[0] = uv[0].map(|_| coordinate(width));
                    uv[1] = uv[1].map(|_| coordinate(height));
                    if round == 0 {
                        uv[0] = [-0.0, f64::NAN, f64::INFINITY, -1e-30, 1e300, 0.5, 1.0, -1.0];
                        uv[1] = [f64::NEG_INFINITY, -1e-30, 0.0, -0.0, 1.0, 1e-300, 0.5, 2.0];
                    }
                    for filter in [Filter::Nearest, Filter::Bilinear] {
                        for simd in [Simd::Plain, Simd::Avx2] {
                            let mut found = [[0.0; LANES]; 4];
                            let work = ReadEight {
                                texture,
                                uv: &uv,
                                filter,
                                found: &mut found,
                            };
                            dispatch(simd, work);
                            for lane in 0..LANES {
                                let (u, v) = (uv[0][lane], uv[1][lane]);
                                let expected = sample(tables(), texture, u, v, filter);
                                let found = found.map(|row| row[lane]);
                                assert_eq!(found, expected, "{width} {height} {u} {v} {filter:?}");
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn texels_in_linear_light_take_the_bytes_that_are_counted() {
        let texels = |count: u32| (0..count).map(|i| [i as u8, 9, 200, 255]).collect();
        for (width, height) in [(1, 1), (7, 5), (64, 1)] {
            let texture = Texture::new(width, height, texels(width * height));
            let texture = texture.expect("a good texture");
            let before = texture.retained_bytes() as u64;
            assert!(LightTexels::of(tables(), &texture).is_some());
            let taken = texture.retained_bytes() as u64 - before;
            assert_eq!(taken, texture.light_bytes());
            assert_eq!(taken, u64::from((width + 4) * (height + 4)) * 16);
        }
        let large = Texture::new(1100, 1000, texels(1_100_000)).expect("a good texture");
        assert!(LightTexels::of(tables(), &large).is_none());
        assert_eq!(large.light_bytes(), 0);
    }
}
