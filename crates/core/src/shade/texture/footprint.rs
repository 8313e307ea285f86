//! A pixel's footprint on a texture, and the texture's colour over it.

use super::mipmap::{level, levels};
use crate::math;
use crate::scene::Texture;
use crate::shade::Filter;
use crate::shade::sample::{sample, wrapped_texel};
use crate::shade::srgb::Tables;
use glam::DVec2;
use std::sync::LazyLock;

/// The largest anisotropy (length by width) of a footprint; a longer one is widened. It bounds the texels that a
/// pixel reads at some 600; with a smaller limit textures at grazing angles blur.
const MOST_ANISOTROPY: f64 = 16.0;

/// The variance of a box one pixel wide, along an axis. The Gaussian of [`ewa`] has the same variance, so that it
/// agrees with the mean over the pixel to the second moment.
const PIXEL_VARIANCE: f64 = 1.0 / 12.0;

/// The variance of bilinear interpolation between texels, a tent two texels wide.
const TEXEL_VARIANCE: f64 = 1.0 / 6.0;

/// The farthest that an ellipse may reach, in texels of its level: 16 times the four of its short axis, 2.5 standard
/// deviations of 0.29, are 46.
const MOST_REACH: f64 = 64.0;

/// The cut-off of the Gaussian, as a squared distance in standard deviations: at 2.5 of them it is 4 % of its
/// maximum.
const END: f64 = 6.25;

/// The length of the Gaussian's table.
const WEIGHTS: usize = 256;

/// exp(−r² / 2) at the middle of each 256th part of 0 ≤ r² < [`END`].
static GAUSSIAN: LazyLock<[f32; WEIGHTS]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let squared = (i as f64 + 0.5) * (END / WEIGHTS as f64);
        math::exp(-0.5 * squared) as f32
    })
});

/// The change of texture coordinates from pixel to pixel, to the right and down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::shade) struct Footprint {
    pub(in crate::shade) across: DVec2,
    pub(in crate::shade) down: DVec2,
}

/// The texture's colour over a pixel's footprint around (u, v): linear light, premultiplied alpha.
///
/// A footprint that is infinite or NaN gives the mean of the whole texture.
pub(in crate::shade) fn sample_over(
    tables: &Tables,
    texture: &Texture,
    uv: DVec2,
    footprint: Footprint,
    filter: Filter,
) -> [f32; 4] {
    let size = DVec2::new(texture.width().into(), texture.height().into());
    let (across, down) = (footprint.across * size, footprint.down * size);
    let longest = across.length().max(down.length());
    let bilinear = |texture: &Texture| sample(tables, texture, uv.x, uv.y, Filter::Bilinear);
    // NaN fails this comparison.
    if longest <= 1.0 {
        return bilinear(texture);
    }
    let levels = levels(texture);
    if longest.is_nan() || longest >= 1e9 {
        return bilinear(level(texture, levels, levels.len()));
    }
    let color = match filter {
        Filter::Nearest => sample(tables, texture, uv.x, uv.y, Filter::Nearest),
        Filter::Bilinear => bilinear(texture),
        Filter::Trilinear => {
            let between = math::log2(longest);
            let number = between.floor();
            let finer = bilinear(level(texture, levels, number as usize));
            let coarser = bilinear(level(texture, levels, number as usize + 1));
            mixed(finer, coarser, (between - number) as f32)
        }
        Filter::Ewa => {
            let color = ewa(tables, texture, levels, uv, [across, down]);
            // Blends from interpolation between texels to the mean over them, without a step.
            if longest < 2.0 {
                mixed(bilinear(texture), color, (longest - 1.0) as f32)
            } else {
                color
            }
        }
    };
    // Rounded weights may sum to slightly more than one.
    color.map(|channel| channel.min(1.0))
}

fn mixed(a: [f32; 4], b: [f32; 4], share: f32) -> [f32; 4] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share)
}

/// The mean of a texture under an elliptical Gaussian, the image of a round one around the pixel's middle (P.
/// Heckbert, "Fundamentals of Texture Mapping and Image Warping", 1989, section 3.5). It uses the mip level on which
/// the ellipse's short axis has two to four texels a pixel: with fewer the sum would be too coarse for a Gaussian,
/// whose standard deviation is 0.29 pixels.
///
/// `steps` are the pixel's, in texels of the whole texture.
fn ewa(
    tables: &Tables,
    texture: &Texture,
    levels: &[Texture],
    uv: DVec2,
    [across, down]: [DVec2; 2],
) -> [f32; 4] {
    // The pixel's covariance in texels, J Jᵀ, and its eigenvalues: the squared axes of its image.
    let (xx, xy, yy) = (
        across.x * across.x + down.x * down.x,
        across.x * across.y + down.x * down.y,
        across.y * across.y + down.y * down.y,
    );
    let (middle, half) = ((xx + yy) * 0.5, (xx - yy) * 0.5);
    let reach = (half * half + xy * xy).sqrt();
    let longest = middle + reach;
    let least = longest / (MOST_ANISOTROPY * MOST_ANISOTROPY);
    let shortest = (middle - reach).max(least);
    // Widened where it is too narrow: the same axes, the shortest lengthened to the least length.
    let share = if reach > 0.0 {
        (longest - shortest) * 0.5 / reach
    } else {
        0.0
    };
    let center = (longest + shortest) * 0.5;
    let (xx, xy, yy) = (center + half * share, xy * share, center - half * share);

    let number = (math::log2(shortest) * 0.5).floor() - 1.0;
    let chosen = level(texture, levels, number.max(0.0) as usize);
    // In texels of that level, whose sides may have been odd.
    let size = DVec2::new(chosen.width().into(), chosen.height().into());
    let scale = size / DVec2::new(texture.width().into(), texture.height().into());
    // Below two texels a pixel there is no finer level, and interpolation between texels widens it.
    let short = shortest.sqrt() * scale.x.min(scale.y);
    let between = TEXEL_VARIANCE * (2.0 - short).clamp(0.0, 1.0);
    let xx = xx * scale.x * scale.x * PIXEL_VARIANCE + between;
    let xy = xy * scale.x * scale.y * PIXEL_VARIANCE;
    let yy = yy * scale.y * scale.y * PIXEL_VARIANCE + between;

    // Q = A x² + 2 B x y + C y² is the squared distance in standard deviations.
    let area = xx * yy - xy * xy;
    let (a, b, c) = (yy / area, -xy / area, xx / area);
    let [wrap_u, wrap_v] = texture.wrap();
    let at = DVec2::new(
        wrap_u.near(uv.x) * size.x - 0.5,
        (1.0 - wrap_v.near(uv.y)) * size.y - 0.5,
    );
    // Rows point down and v points up: the mixed term changes its sign.
    let b = -b;
    let tall = (END * yy).sqrt();
    let wide = (END * xx).sqrt();
    if tall.max(wide) > MOST_REACH {
        // The footprint covers the whole image many times: beyond its last level, or along its shorter side.
        return sample(tables, chosen, uv.x, uv.y, Filter::Bilinear);
    }
    let gaussian = &*GAUSSIAN;
    let (mut sum, mut weights) = ([0.0f32; 4], 0.0f32);
    for row in (at.y - tall).ceil() as i64..=(at.y + tall).floor() as i64 {
        let y = row as f64 - at.y;
        // The columns where Q < END: the roots of a quadratic.
        let root = b * b * y * y - a * (c * y * y - END);
        if root < 0.0 {
            continue;
        }
        let (middle, half) = (at.x - b * y / a, root.sqrt() / a);
        for column in (middle - half).ceil() as i64..=(middle + half).floor() as i64 {
            let x = column as f64 - at.x;
            let squared = a * x * x + 2.0 * b * x * y + c * y * y;
            let place = (squared * (WEIGHTS as f64 / END)) as usize;
            let weight = gaussian[place.min(WEIGHTS - 1)];
            let texel = wrapped_texel(tables, chosen, column, row);
            for (sum, channel) in sum.iter_mut().zip(texel) {
                *sum += channel * weight;
            }
            weights += weight;
        }
    }
    if weights > 0.0 {
        sum.map(|channel| channel / weights)
    } else {
        // The ellipse contains no texel's centre.
        sample(tables, chosen, uv.x, uv.y, Filter::Bilinear)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::scene::Wrap;
    use crate::shade::srgb::tables;

    fn texture(side: u32, texel: impl Fn(u32, u32) -> u8) -> Texture {
        let texels = (0..side * side)
            .map(|i| [texel(i % side, i / side), 90, 200, 255])
            .collect();
        Texture::new(side, side, texels).expect("a good texture")
    }

    fn color(texture: &Texture, uv: DVec2, footprint: Footprint, filter: Filter) -> f64 {
        f64::from(sample_over(tables(), texture, uv, footprint, filter)[0])
    }

    /// The truth is the mean over 64 × 64 points of the pixel.
    fn mean(texture: &Texture, uv: DVec2, footprint: Footprint) -> f64 {
        let mut sum = 0.0;
        for i in 0..64 {
            for j in 0..64 {
                let at = |k: i32| (f64::from(k) + 0.5) / 64.0 - 0.5;
                let place = uv + footprint.across * at(i) + footprint.down * at(j);
                let texel = sample(tables(), texture, place.x, place.y, Filter::Bilinear);
                sum += f64::from(texel[0]);
            }
        }
        sum / 4096.0
    }

    #[test]
    fn elliptical_means_are_nearer_the_truth_than_other_filters() {
        let mut random = Random(3);
        let checkers = texture(256, |x, y| if (x / 8 + y / 8) % 2 == 0 { 255 } else { 0 });
        let mut squares = [0.0; 3];
        let filters = [Filter::Ewa, Filter::Trilinear, Filter::Bilinear];
        for _ in 0..400 {
            let uv = DVec2::new(random.unit(), random.unit());
            // Ellipses of 2 to 64 texels, up to 8 times as long as wide, in all directions.
            let long = 2.0 * math::pow(32.0, random.unit()) / 256.0;
            let short = long / math::pow(8.0, random.unit());
            let point = random.point();
            let along = DVec2::new(point.x, point.y).normalize();
            let footprint = Footprint {
                across: along * long,
                down: along.perp() * short,
            };
            let truth = mean(&checkers, uv, footprint);
            for (sum, filter) in squares.iter_mut().zip(filters) {
                *sum += (color(&checkers, uv, footprint, filter) - truth).powi(2);
            }
        }
        let [ewa, trilinear, bilinear] = squares.map(|sum| (sum / 400.0f64).sqrt());
        assert!(
            ewa < 0.06 && ewa < 0.65 * trilinear && ewa < 0.2 * bilinear,
            "{ewa} {trilinear} {bilinear}"
        );
    }

    #[test]
    fn one_color_and_one_slope_are_kept() {
        let mut random = Random(5);
        let flat = texture(64, |_, _| 120);
        let expected = f64::from(tables().decode(120));
        // Linear light with a constant gradient: its mean is the value at the middle.
        let slope = texture(128, |x, _| tables().encode(0.1 + x as f32 * 0.006));
        let slope = slope.wrapped([Wrap::Clamp; 2]);
        for _ in 0..200 {
            let uv = DVec2::splat(0.45) + DVec2::new(random.unit(), random.unit()) * 0.1;
            let vector = |random: &mut Random| {
                let point = random.point() * 0.1;
                DVec2::new(point.x, point.y)
            };
            let footprint = Footprint {
                across: vector(&mut random),
                down: vector(&mut random),
            };
            for filter in [Filter::Trilinear, Filter::Ewa] {
                // Levels are rounded to bytes: half a step is 0.002 of the light there.
                let found = color(&flat, uv, footprint, filter);
                assert!((found - expected).abs() < 1e-5, "{filter:?} {found}");
                let found = color(&slope, uv, footprint, filter);
                let middle = color(&slope, uv, footprint, Filter::Bilinear);
                assert!((found - middle).abs() < 0.02, "{filter:?} {found} {middle}");
            }
        }
    }

    #[test]
    fn odd_footprints_have_some_color() {
        let texture = texture(16, |x, y| (x * y) as u8);
        let odd = [0.0, 1e-300, 0.5, 1e5, 1e300, f64::INFINITY, f64::NAN];
        for a in odd {
            for b in odd {
                for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp, Wrap::Border(None)] {
                    let texture = texture.clone().wrapped([wrap; 2]);
                    let footprint = Footprint {
                        across: DVec2::new(a, b),
                        down: DVec2::new(-b, a * 0.3),
                    };
                    for filter in [Filter::Trilinear, Filter::Ewa] {
                        for uv in [DVec2::splat(0.3), DVec2::new(1e300, f64::NAN)] {
                            let found = sample_over(tables(), &texture, uv, footprint, filter);
                            assert!(
                                found.iter().all(|c| (0.0..=1.000_001).contains(c)),
                                "{found:?}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn magnified_textures_are_bilinear() {
        let texture = texture(16, |x, y| (x * 16 + y) as u8);
        let footprint = Footprint {
            across: DVec2::X / 17.0,
            down: DVec2::Y / 30.0,
        };
        let at = |filter| sample_over(tables(), &texture, DVec2::splat(0.37), footprint, filter);
        assert_eq!(at(Filter::Ewa), at(Filter::Bilinear));
        assert_eq!(at(Filter::Trilinear), at(Filter::Bilinear));
    }
}
