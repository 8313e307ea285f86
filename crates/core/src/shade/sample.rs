//! Reading textures: in linear light, repeated without end.

use super::Filter;
use super::srgb::Tables;
use crate::scene::Texture;

/// The texture at (u, v): origin bottom-left, one repeat a unit, linear light with alpha multiplied
/// in. Texel centres lie half a texel from the texture's edges.
///
/// Coordinates that are not finite read as zero.
pub(super) fn sample(
    tables: &Tables,
    texture: &Texture,
    u: f64,
    v: f64,
    filter: Filter,
) -> [f32; 4] {
    let x = within(u) * f64::from(texture.width());
    let y = (1.0 - within(v)) * f64::from(texture.height());
    match filter {
        Filter::Nearest => texel(tables, texture, x as u32, y as u32),
        Filter::Bilinear => {
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

/// What is left of a coordinate after whole repeats: 0 to 1.
fn within(coordinate: f64) -> f64 {
    if coordinate.is_finite() {
        coordinate - coordinate.floor()
    } else {
        0.0
    }
}

/// The texels whose centres lie at or before a place and after it, and how far it is between them.
fn neighbors(place: f64, size: u32) -> (u32, u32, f32) {
    let from_center = place - 0.5;
    let before = from_center.floor();
    let first = (before as i64).rem_euclid(i64::from(size)) as u32;
    let second = if first + 1 == size { 0 } else { first + 1 };
    (first, second, (from_center - before) as f32)
}

/// A texel; the one past the last is the first.
fn texel(tables: &Tables, texture: &Texture, x: u32, y: u32) -> [f32; 4] {
    let x = if x < texture.width() { x } else { 0 };
    let y = if y < texture.height() { y } else { 0 };
    let index = y as usize * texture.width() as usize + x as usize;
    let [r, g, b, a] = texture.texels()[index];
    let color = [r, g, b].map(|byte| tables.decode(byte));
    if a == u8::MAX {
        return [color[0], color[1], color[2], 1.0];
    }
    let alpha = f32::from(a) / 255.0;
    [color[0] * alpha, color[1] * alpha, color[2] * alpha, alpha]
}

#[cfg(test)]
mod tests {
    use super::super::srgb::tables;
    use super::*;

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
}
