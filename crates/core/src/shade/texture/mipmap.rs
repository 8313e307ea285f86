//! Mip levels of textures: L. Williams, "Pyramidal Parametrics", 1983.

use crate::scene::Texture;
use crate::shade::srgb::{self, Tables};

/// The texture at half its size, a quarter, and so on down to one texel: computed on first use and kept with the
/// texture. They take a third of its memory.
pub(in crate::shade) fn levels(texture: &Texture) -> &[Texture] {
    texture.levels(|texture| {
        let mut levels: Vec<Texture> = Vec::new();
        for size in texture.level_sizes() {
            let larger = levels.last().unwrap_or(texture);
            // The number of texels fits the sides.
            levels.extend(halved(larger, size));
        }
        levels
    })
}

/// A mip level by number: 0 is the texture itself, beyond the last it is the last.
pub(in crate::shade) fn level<'t>(
    texture: &'t Texture,
    levels: &'t [Texture],
    number: usize,
) -> &'t Texture {
    match number.min(levels.len()) {
        0 => texture,
        number => &levels[number - 1],
    }
}

/// A texture of half as many columns and rows.
///
/// Each texel is the mean of the texels that it covers, weighted by area (three instead of two on an odd side), in
/// linear light with premultiplied alpha, and rounded to 8-bit sRGB: by at most half a step a level.
fn halved(texture: &Texture, (width, height): (u32, u32)) -> Option<Texture> {
    let (columns, rows) = (texture.width(), texture.height());
    let across: Vec<TexelRange> = (0..width)
        .map(|x| TexelRange::new(x, width, columns))
        .collect();
    let tables = srgb::tables();
    let mut texels = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        let down = TexelRange::new(y, height, rows);
        for across in &across {
            let mut sum = [0.0f32; 4];
            for (row, high) in down.parts() {
                for (column, wide) in across.parts() {
                    let at = row as usize * columns as usize + column as usize;
                    let texel = light(tables, texture.texels()[at]);
                    for (sum, channel) in sum.iter_mut().zip(texel) {
                        *sum += channel * (wide * high);
                    }
                }
            }
            texels.push(encoded(tables, sum));
        }
    }
    Texture::new(width, height, texels).map(|smaller| smaller.wrapped(texture.wrap()))
}

/// The range of texels along a side that one texel of the next level covers.
struct TexelRange {
    first: u32,
    count: u32,
    from: f64,
    to: f64,
}

impl TexelRange {
    fn new(index: u32, smaller: u32, size: u32) -> Self {
        let scale = f64::from(size) / f64::from(smaller);
        let (from, to) = (f64::from(index) * scale, f64::from(index + 1) * scale);
        let first = (from as u32).min(size - 1);
        let end = (to.ceil() as u32).clamp(first + 1, size);
        Self {
            first,
            count: end - first,
            from,
            to,
        }
    }

    /// Each texel and its weight; the weights sum to one.
    fn parts(&self) -> impl Iterator<Item = (u32, f32)> {
        (self.first..self.first + self.count).map(|texel| {
            let covered = f64::from(texel + 1).min(self.to) - f64::from(texel).max(self.from);
            (texel, (covered.max(0.0) / (self.to - self.from)) as f32)
        })
    }
}

fn light(tables: &Tables, [r, g, b, a]: [u8; 4]) -> [f32; 4] {
    let alpha = f32::from(a) / 255.0;
    [
        tables.decode(r) * alpha,
        tables.decode(g) * alpha,
        tables.decode(b) * alpha,
        alpha,
    ]
}

fn encoded(tables: &Tables, [r, g, b, a]: [f32; 4]) -> [u8; 4] {
    if a <= 0.0 {
        return [0; 4];
    }
    let [r, g, b] = [r, g, b].map(|channel| tables.encode(channel / a));
    [r, g, b, (a.min(1.0) * 255.0 + 0.5) as u8]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(width: u32, height: u32) -> Texture {
        let texel = |i: u32| [(i * 37 % 256) as u8, (i * 91 % 256) as u8, 200, 255];
        let texels = (0..width * height).map(texel).collect();
        Texture::new(width, height, texels).expect("a good texture")
    }

    #[test]
    fn every_level_has_the_light_of_the_whole() {
        // The truth is the mean of all texels; each level's rounding may move it by half a step of a byte.
        let mean = |texture: &Texture| {
            let sum = texture.texels().iter().fold([0.0f64; 3], |sum, texel| {
                let [r, g, b, _] = light(srgb::tables(), *texel);
                [
                    sum[0] + f64::from(r),
                    sum[1] + f64::from(g),
                    sum[2] + f64::from(b),
                ]
            });
            sum.map(|channel| channel / texture.texels().len() as f64)
        };
        for (width, height) in [(64, 64), (13, 7), (1, 9), (31, 2), (1, 1)] {
            let texture = texture(width, height);
            let expected = mean(&texture);
            let mut sizes = (width, height);
            for level in levels(&texture) {
                sizes = ((sizes.0 / 2).max(1), (sizes.1 / 2).max(1));
                assert_eq!((level.width(), level.height()), sizes);
                for (found, expected) in mean(level).iter().zip(expected) {
                    assert!((found - expected).abs() < 0.012, "{found} for {expected}");
                }
            }
            assert_eq!(sizes, (1, 1));
            let taken: usize = levels(&texture).iter().map(Texture::retained_bytes).sum();
            assert_eq!(texture.level_bytes(), taken as u64);
        }
    }

    #[test]
    fn clear_texels_lend_no_color() {
        let texels = vec![[255, 0, 0, 0], [0, 128, 0, 255]];
        let texture = Texture::new(2, 1, texels).expect("a good texture");
        assert_eq!(levels(&texture)[0].texels(), [[0, 128, 0, 128]]);
    }
}
