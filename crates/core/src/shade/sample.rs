//! Reading textures in linear light, wrapped beyond the image.

use super::Filter;
use super::srgb::Tables;
use super::texels::{TexelLight, is_read_at_once, read_eight, texel};
use super::vectors::{Row, Rows, Vectors};
use crate::num::simd::{LANES, Lanes};
use crate::scene::{Texture, Wrap};
use glam::Vec3;

/// The texture at (u, v): origin bottom left, one repeat a unit, linear light with premultiplied alpha. Texel centres
/// lie half a texel from the texture's edges. Beyond the image it is wrapped.
///
/// Coordinates that are not finite count as zero.
pub(super) fn sample(
    tables: &Tables,
    texture: &Texture,
    u: f64,
    v: f64,
    filter: Filter,
) -> [f32; 4] {
    if !texture.repeats() {
        return sample_wrapped(tables, texture, u, v, filter);
    }
    let x = within(u) * f64::from(texture.width());
    let y = (1.0 - within(v)) * f64::from(texture.height());
    match filter {
        Filter::Nearest => texel(tables, texture, x as u32, y as u32),
        // The other filters read mip levels in this way.
        Filter::Bilinear | Filter::Trilinear | Filter::Ewa => {
            let (left, right, across) = neighbors(x, texture.width());
            let (top, bottom, down) = neighbors(y, texture.height());
            let corners = [
                (texel(tables, texture, left, top), 1.0 - across, 1.0 - down),
                (texel(tables, texture, right, top), across, 1.0 - down),
                (texel(tables, texture, left, bottom), 1.0 - across, down),
                (texel(tables, texture, right, bottom), across, down),
            ];
            std::array::from_fn(|channel| {
                corners
                    .iter()
                    .map(|(texel, wide, high)| texel[channel] * wide * high)
                    .sum()
            })
        }
    }
}

/// [`sample`] at eight places, as colours and alphas.
#[inline(always)]
pub(super) fn sample_eight<L: Lanes>(
    lanes: L,
    tables: &Tables,
    texture: &Texture,
    uv: &[[f64; LANES]; 2],
    filter: Filter,
) -> (Vectors<L>, L::F32) {
    if !is_read_at_once(texture) {
        return sample_one_by_one(lanes, tables, texture, uv, filter);
    }
    if filter == Filter::Nearest {
        return read_eight(lanes, tables, texture, &nearest_of_eight(texture, uv));
    }
    let around = TexelsAround::of_eight(texture, uv);
    let texels = match TexelLight::of(texture) {
        Some(light) => {
            let [above, below] = around.lefts(light.stride());
            let [a, b] = light.eight_pairs(lanes, &above);
            let [c, d] = light.eight_pairs(lanes, &below);
            [a, b, c, d]
        }
        None => {
            let [a, b, c, d] = &around.all(texture.width());
            [
                read_eight(lanes, tables, texture, a),
                read_eight(lanes, tables, texture, b),
                read_eight(lanes, tables, texture, c),
                read_eight(lanes, tables, texture, d),
            ]
        }
    };
    bilinear(lanes, texels, [&around.across, &around.down])
}

/// The places of eight samples in texels, columns and rows, from the image's left and top.
#[inline(always)]
fn in_texels(texture: &Texture, uv: &[[f64; LANES]; 2]) -> [[f64; LANES]; 2] {
    let (width, height) = (f64::from(texture.width()), f64::from(texture.height()));
    let (mut xs, mut ys) = ([0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        xs[lane] = within(uv[0][lane]) * width;
        ys[lane] = (1.0 - within(uv[1][lane])) * height;
    }
    [xs, ys]
}

/// The indices of the texels that eight samples lie in.
#[inline(always)]
pub(super) fn nearest_of_eight(texture: &Texture, uv: &[[f64; LANES]; 2]) -> [u32; LANES] {
    let (width, height) = (texture.width(), texture.height());
    let [xs, ys] = in_texels(texture, uv);
    let mut at = [0; LANES];
    for lane in 0..LANES {
        let (x, y) = (whole(xs[lane].floor()), whole(ys[lane].floor()));
        // The texel after the last is the first.
        let x = if x < width { x } else { 0 };
        let y = if y < height { y } else { 0 };
        at[lane] = y * width + x;
    }
    at
}

/// The texels around eight samples.
pub(super) struct TexelsAround {
    lefts: [u32; LANES],
    rights: [u32; LANES],
    tops: [u32; LANES],
    bottoms: [u32; LANES],
    /// How far the samples lie from the left ones to the right ones, and from the top to the bottom.
    pub(super) across: Row,
    pub(super) down: Row,
}

impl TexelsAround {
    #[inline(always)]
    pub(super) fn of_eight(texture: &Texture, uv: &[[f64; LANES]; 2]) -> Self {
        let [xs, ys] = in_texels(texture, uv);
        let (lefts, rights, across) = eight_neighbors(&xs, texture.width());
        let (tops, bottoms, down) = eight_neighbors(&ys, texture.height());
        Self {
            lefts,
            rights,
            tops,
            bottoms,
            across,
            down,
        }
    }

    /// Their indices in rows of this length: top left, top right, bottom left, bottom right.
    #[inline(always)]
    pub(super) fn all(&self, stride: u32) -> [[u32; LANES]; 4] {
        let [top_lefts, bottom_lefts] = self.lefts(stride);
        let (mut top_rights, mut bottom_rights) = ([0; LANES], [0; LANES]);
        for lane in 0..LANES {
            top_rights[lane] = self.tops[lane] * stride + self.rights[lane];
            bottom_rights[lane] = self.bottoms[lane] * stride + self.rights[lane];
        }
        [top_lefts, top_rights, bottom_lefts, bottom_rights]
    }

    /// The indices of those on the left: top and bottom.
    #[inline(always)]
    pub(super) fn lefts(&self, stride: u32) -> [[u32; LANES]; 2] {
        let (mut tops, mut bottoms) = ([0; LANES], [0; LANES]);
        for lane in 0..LANES {
            tops[lane] = self.tops[lane] * stride + self.lefts[lane];
            bottoms[lane] = self.bottoms[lane] * stride + self.lefts[lane];
        }
        [tops, bottoms]
    }
}

/// Colours and alphas of eight samples between the texels around them.
#[inline(always)]
pub(super) fn bilinear<L: Lanes>(
    lanes: L,
    [a, b, c, d]: [(Vectors<L>, L::F32); 4],
    [across, down]: [&Row; 2],
) -> (Vectors<L>, L::F32) {
    let one = lanes.splat(1.0);
    let (right, below) = (lanes.load(across), lanes.load(down));
    let (left, above) = (one - right, one - below);
    let (mut color, mut alpha) = weighed(a, left, above);
    for (color_of_one, alpha_of_one) in [
        weighed(b, right, above),
        weighed(c, left, below),
        weighed(d, right, below),
    ] {
        color = color.plus(color_of_one);
        alpha = alpha + alpha_of_one;
    }
    (color, alpha)
}

/// Eight texels, weighted along both axes.
#[inline(always)]
fn weighed<L: Lanes>(
    (color, alpha): (Vectors<L>, L::F32),
    wide: L::F32,
    high: L::F32,
) -> (Vectors<L>, L::F32) {
    (color.scaled(wide).scaled(high), alpha * wide * high)
}

/// [`neighbors`] of eight positions within a side.
#[inline(always)]
fn eight_neighbors(places: &[f64; LANES], size: u32) -> ([u32; LANES], [u32; LANES], Row) {
    let (mut first, mut second, mut fraction) = ([0; LANES], [0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        let from_center = places[lane] - 0.5;
        let before = from_center.floor();
        fraction[lane] = (from_center - before) as f32;
        // From −1 to the last texel, since positions are from 0 to the side's length.
        let before = whole(before);
        let at = if before == u32::MAX { size - 1 } else { before };
        first[lane] = at;
        second[lane] = if at + 1 == size { 0 } else { at + 1 };
    }
    (first, second, fraction)
}

/// An integer from −2³¹ to 2³¹ − 1, negative ones wrapped around. The sum with 3 · 2⁵¹, in whose binade the unit in the
/// last place is 1, has it in its low bits; a cast, which saturates, would be compiled lane by lane.
#[inline(always)]
fn whole(integer: f64) -> u32 {
    const SHIFT: f64 = (3u64 << 51) as f64;
    (integer + SHIFT).to_bits() as u32
}

#[inline(always)]
fn sample_one_by_one<L: Lanes>(
    lanes: L,
    tables: &Tables,
    texture: &Texture,
    uv: &[[f64; LANES]; 2],
    filter: Filter,
) -> (Vectors<L>, L::F32) {
    let (mut color, mut alpha) = (Rows::ZERO, [0.0; LANES]);
    for lane in 0..LANES {
        let [r, g, b, a] = sample(tables, texture, uv[0][lane], uv[1][lane], filter);
        color.set(lane, Vec3::new(r, g, b));
        alpha[lane] = a;
    }
    (Vectors::load(lanes, &color), lanes.load(&alpha))
}

/// As [`sample`], for a texture that does not repeat.
#[inline(never)]
fn sample_wrapped(tables: &Tables, texture: &Texture, u: f64, v: f64, filter: Filter) -> [f32; 4] {
    let [across, down] = texture.wrap();
    let x = across.near(u) * f64::from(texture.width());
    let y = (1.0 - down.near(v)) * f64::from(texture.height());
    match filter {
        Filter::Nearest => wrapped_texel(tables, texture, x.floor() as i64, y.floor() as i64),
        Filter::Bilinear | Filter::Trilinear | Filter::Ewa => {
            let (left, top) = ((x - 0.5).floor(), (y - 0.5).floor());
            let (right, below) = ((x - 0.5 - left) as f32, (y - 0.5 - top) as f32);
            let (left, top) = (left as i64, top as i64);
            let mut color = [0.0; 4];
            for (row, high) in [(top, 1.0 - below), (top + 1, below)] {
                for (column, wide) in [(left, 1.0 - right), (left + 1, right)] {
                    let texel = wrapped_texel(tables, texture, column, row);
                    for (sum, channel) in color.iter_mut().zip(texel) {
                        *sum += channel * wide * high;
                    }
                }
            }
            color
        }
    }
}

/// The texel at any column and row: linear light with premultiplied alpha.
pub(super) fn wrapped_texel(tables: &Tables, texture: &Texture, x: i64, y: i64) -> [f32; 4] {
    let [across, down] = texture.wrap();
    match (
        across.texel(x, texture.width()),
        down.texel(y, texture.height()),
    ) {
        (Some(x), Some(y)) => texel(tables, texture, x, y),
        (None, _) => border(tables, across),
        (_, None) => border(tables, down),
    }
}

fn border(tables: &Tables, wrap: Wrap) -> [f32; 4] {
    let Wrap::Border(Some(color)) = wrap else {
        return [0.0; 4];
    };
    let [r, g, b] = color.0.map(|byte| tables.decode(byte));
    [r, g, b, 1.0]
}

/// The fractional part of a coordinate, 0 to 1.
#[inline(always)]
fn within(coordinate: f64) -> f64 {
    if coordinate.is_finite() {
        coordinate - coordinate.floor()
    } else {
        0.0
    }
}

/// The texels whose centres are at or before a position and after it, and the position's fraction between them.
fn neighbors(place: f64, size: u32) -> (u32, u32, f32) {
    let from_center = place - 0.5;
    let before = from_center.floor();
    let first = (before as i64).rem_euclid(i64::from(size)) as u32;
    let second = if first + 1 == size { 0 } else { first + 1 };
    (first, second, (from_center - before) as f32)
}

#[cfg(test)]
mod tests {
    use super::super::srgb::tables;
    use super::super::texels::decoded;
    use super::*;
    use crate::num::simd::{F32x8, Simd, Work, dispatch};
    use crate::random::Random;

    /// 4 × 2 opaque texels, all different.
    fn texture() -> Texture {
        let texels = (0..8u8)
            .map(|i| [i * 30, 255 - i * 20, i * i, 255])
            .collect();
        Texture::new(4, 2, texels).expect("a good texture")
    }

    fn at(u: f64, v: f64, filter: Filter) -> [f32; 4] {
        sample(tables(), &texture(), u, v, filter)
    }

    fn expected(x: usize, row: usize) -> [f32; 4] {
        let [r, g, b, _] = texture().texels()[row * 4 + x];
        let [r, g, b] = [r, g, b].map(|byte| tables().decode(byte));
        [r, g, b, 1.0]
    }

    #[test]
    fn texel_centers_give_the_texel() {
        for filter in [Filter::Nearest, Filter::Bilinear] {
            for x in 0..4 {
                for row in 0..2 {
                    for repeat in [-2.0, 0.0, 3.0] {
                        let u = (x as f64 + 0.5) / 4.0 + repeat;
                        let v = 1.0 - (row as f64 + 0.5) / 2.0 - repeat;
                        assert_eq!(at(u, v, filter), expected(x, row), "{filter:?} {u} {v}");
                    }
                }
            }
        }
    }

    #[test]
    fn halfway_is_the_mean_in_linear_light() {
        let mean = |a: [f32; 4], b: [f32; 4]| -> [f32; 4] {
            std::array::from_fn(|i| a[i] * 0.5 + b[i] * 0.5)
        };
        let along_u = at(2.0 / 4.0, 0.75, Filter::Bilinear);
        assert_eq!(along_u, mean(expected(1, 0), expected(2, 0)));
        let along_v = at(0.125, 0.5, Filter::Bilinear);
        assert_eq!(along_v, mean(expected(0, 0), expected(0, 1)));
    }

    #[test]
    fn seams_wrap() {
        let mean = |a: [f32; 4], b: [f32; 4]| -> [f32; 4] {
            std::array::from_fn(|i| a[i] * 0.5 + b[i] * 0.5)
        };
        for u in [-1.0, 0.0, 1.0, 2.0] {
            let across = at(u, 0.75, Filter::Bilinear);
            assert_eq!(across, mean(expected(3, 0), expected(0, 0)), "u = {u}");
        }
        let over_the_top = at(0.125, 1.0, Filter::Bilinear);
        assert_eq!(over_the_top, mean(expected(0, 1), expected(0, 0)));
    }

    #[test]
    fn the_origin_is_bottom_left() {
        assert_eq!(at(0.01, 0.01, Filter::Nearest), expected(0, 1));
        assert_eq!(at(0.99, 0.99, Filter::Nearest), expected(3, 0));
    }

    #[test]
    fn odd_coordinates_read_some_texel() {
        let odd = [
            f64::NAN,
            f64::INFINITY,
            -1e300,
            1e300,
            -1e-30,
            f64::MIN_POSITIVE,
        ];
        for u in odd {
            for v in odd {
                for filter in [Filter::Nearest, Filter::Bilinear] {
                    assert!(at(u, v, filter).iter().all(|c| (0.0..=1.0).contains(c)));
                }
            }
        }
    }

    #[test]
    fn hidden_texels_lend_no_color() {
        let texels = vec![[255, 0, 0, 0], [0, 255, 0, 255]];
        let texture = Texture::new(2, 1, texels).expect("a good texture");
        let middle = sample(tables(), &texture, 0.5, 0.5, Filter::Bilinear);
        assert_eq!(middle, [0.0, 0.5, 0.0, 0.5]);
    }

    /// Opaque linear light of a border.
    const RED: [f32; 4] = [1.0, 0.0, 0.0, 1.0];

    struct SampleEight<'a> {
        texture: &'a Texture,
        uv: &'a [[f64; LANES]; 2],
        filter: Filter,
        found: &'a mut [Row; 4],
    }

    impl Work for SampleEight<'_> {
        #[inline(always)]
        fn run(self, lanes: impl Lanes) {
            let (color, alpha) = sample_eight(lanes, tables(), self.texture, self.uv, self.filter);
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
        for (width, height) in [(1, 1), (2, 1), (5, 3), (64, 1), (127, 33)] {
            let texels = (0..width * height).map(texel).collect();
            let texture = Texture::new(width, height, texels).expect("a good texture");
            let clamped = texture.clone().wrapped([Wrap::Clamp, Wrap::Mirror]);
            let kept = texture.clone();
            (0..2).for_each(|_| kept.keep_light(|kept| decoded(tables(), kept)));
            for texture in [&texture, &clamped, &kept] {
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
                        for simd in Simd::available() {
                            let mut found = [[0.0; LANES]; 4];
                            let work = SampleEight {
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
    fn each_wrap_shows_its_texels_beyond_the_image() {
        let red = Wrap::Border(Some(crate::scene::Color([255, 0, 0])));
        // The column, and a position half a texel from its left, beyond the image on the right.
        for (wrap, third, ninth) in [
            (Wrap::Mirror, Some(1), Some(0)),
            (Wrap::Clamp, Some(3), Some(3)),
            (Wrap::Border(None), None, None),
            (red, None, None),
        ] {
            let texture = texture().wrapped([wrap, Wrap::Repeat]);
            let border = if wrap == red { RED } else { [0.0; 4] };
            for filter in [Filter::Nearest, Filter::Bilinear] {
                let at = |u| sample(tables(), &texture, u, 0.75, filter);
                let texel = |column: Option<usize>| column.map_or(border, |x| expected(x, 0));
                assert_eq!(at(6.5 / 4.0), texel(third), "{wrap} {filter:?}");
                assert_eq!(at(8.5 / 4.0), texel(ninth), "{wrap} {filter:?}");
                for inside in 0..4 {
                    let u = (inside as f64 + 0.5) / 4.0;
                    assert_eq!(at(u), texel(Some(inside)), "{wrap} {filter:?}");
                }
                for far in [1e300, -1e300, f64::NAN] {
                    assert!(at(far).iter().all(|c| (0.0..=1.0).contains(c)));
                }
            }
        }
        // Rows: the image's top is v = 1.
        let texture = texture().wrapped([Wrap::Repeat, Wrap::Clamp]);
        let at = |v| sample(tables(), &texture, 0.125, v, Filter::Bilinear);
        assert_eq!((at(1.4), at(-7.0)), (expected(0, 0), expected(0, 1)));
    }

    #[test]
    fn a_border_is_blended_with_its_neighbors() {
        let texture = texture().wrapped([Wrap::Border(None); 2]);
        let edge = sample(tables(), &texture, 0.0, 0.75, Filter::Bilinear);
        assert_eq!(edge, expected(0, 0).map(|channel| channel * 0.5));
        let corner = sample(tables(), &texture, 0.0, 1.0, Filter::Bilinear);
        assert_eq!(corner, expected(0, 0).map(|channel| channel * 0.25));
    }
}
