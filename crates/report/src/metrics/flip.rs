//! FLIP: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference
//! Evaluator for Alternating Images", HPG 2020. Equations and sections named here are that paper's.

use image::RgbImage;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Pixels per degree of visual angle, as the paper sets: 3840 pixels on 0.7 m of screen seen from 0.7 m.
const PIXELS_PER_DEGREE: f64 = 67.020_644;

/// The D65 white point in XYZ, the image of linear RGB (1, 1, 1).
const WHITE: [f64; 3] = [0.950_428_545, 1.0, 1.088_900_371];

/// Linear RGB to XYZ: IEC 61966-2-1, the primaries as exact fractions.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [
        10_135_552.0 / 24_577_794.0,
        8_788_810.0 / 24_577_794.0,
        4_435_075.0 / 24_577_794.0,
    ],
    [
        2_613_072.0 / 12_288_897.0,
        8_788_810.0 / 12_288_897.0,
        887_015.0 / 12_288_897.0,
    ],
    [
        1_425_312.0 / 73_733_382.0,
        8_788_810.0 / 73_733_382.0,
        70_074_185.0 / 73_733_382.0,
    ],
];

/// One channel of a picture.
struct Plane {
    width: usize,
    height: usize,
    values: Vec<f64>,
}

impl Plane {
    /// Convolves along one axis with `kernel`, which has an odd length; edge pixels are repeated outside.
    fn filtered(&self, kernel: &[f64], (right, down): (usize, usize)) -> Self {
        let reach = (kernel.len() / 2) as i64;
        let value = |index: usize| {
            let (x, y) = ((index % self.width) as i64, (index / self.width) as i64);
            let taps = kernel.iter().zip(-reach..);
            taps.map(|(weight, offset)| {
                let x = (x + offset * right as i64).clamp(0, self.width as i64 - 1) as usize;
                let y = (y + offset * down as i64).clamp(0, self.height as i64 - 1) as usize;
                weight * self.values[y * self.width + x]
            })
            .sum()
        };
        Self {
            values: (0..self.values.len()).into_par_iter().map(value).collect(),
            ..*self
        }
    }

    fn separably(&self, across: &[f64], along: &[f64]) -> Self {
        self.filtered(across, (1, 0)).filtered(along, (0, 1))
    }
}

/// The mean FLIP error of a picture against a reference of the same size, from 0 to 1. It is 0 where a person who
/// flips between the two sees no difference.
pub fn flip(picture: &RgbImage, reference: &RgbImage) -> f64 {
    let (a, b) = (Perceived::new(picture), Perceived::new(reference));
    let (most, threshold) = (greatest_difference(), 0.4);
    let mean = (0..a.colors.len())
        .into_par_iter()
        .map(|at| {
            // Section 4.1.3, equation 6: maps colour differences to 0 to 1, large ones compressed.
            let difference = hyab(a.colors[at], b.colors[at]).powf(0.7);
            let color = if difference < threshold * most {
                0.95 / (threshold * most) * difference
            } else {
                0.95 + (difference - threshold * most) / (most - threshold * most) * 0.05
            };
            // Section 4.2, equations 7 and 8: an edge or point in only one of the pictures amplifies the colour
            // difference.
            let edge = (a.edges[at] - b.edges[at]).abs();
            let point = (a.points[at] - b.points[at]).abs();
            let feature = (edge.max(point) / 2f64.sqrt()).sqrt();
            color.powf(1.0 - feature)
        })
        .sum::<f64>();
    mean / a.colors.len().max(1) as f64
}

/// A picture as the metric compares it.
struct Perceived {
    /// CIELAB after filtering by contrast sensitivity, with the Hunt adjustment.
    colors: Vec<[f64; 3]>,
    edges: Vec<f64>,
    points: Vec<f64>,
}

impl Perceived {
    fn new(picture: &RgbImage) -> Self {
        let opponent: Vec<[f64; 3]> = picture
            .pixels()
            .map(|pixel| opponent_from_xyz(xyz_from_rgb(pixel.0.map(linear))))
            .collect();
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let plane = |channel: usize| Plane {
            width,
            height,
            values: opponent.iter().map(|color| color[channel]).collect(),
        };
        let (luminance, red_green, blue_yellow) = (plane(0), plane(1), plane(2));
        let blurred = [
            luminance.blurred(&[(1.0, 0.0047)]),
            red_green.blurred(&[(1.0, 0.0053)]),
            blue_yellow.blurred(&[(34.1, 0.04), (13.5, 0.025)]),
        ];
        let color =
            |at: usize| perceived_color([0, 1, 2].map(|channel| blurred[channel].values[at]));
        let features = Features::detect(&luminance);
        Self {
            colors: (0..opponent.len()).into_par_iter().map(color).collect(),
            edges: features.edges,
            points: features.points,
        }
    }
}

impl Plane {
    /// Section 4.1.1: filters with the contrast sensitivity function, a sum of Gaussians given by a and b each
    /// (equation 2 and its table).
    fn blurred(&self, gaussians: &[(f64, f64)]) -> Self {
        // All kernels have the length for the widest Gaussian of all channels.
        let reach = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i64;
        let mut sum = vec![0.0; self.values.len()];
        let mut whole = 0.0;
        for &(a, b) in gaussians {
            let weight = |offset: i64| {
                let degrees = offset as f64 / PIXELS_PER_DEGREE;
                (a * (PI / b).sqrt()).sqrt() * (-PI * PI * degrees * degrees / b).exp()
            };
            let kernel: Vec<f64> = (-reach..=reach).map(weight).collect();
            whole += kernel.iter().sum::<f64>().powi(2);
            for (sum, value) in sum.iter_mut().zip(self.separably(&kernel, &kernel).values) {
                *sum += value;
            }
        }
        Self {
            values: sum.into_iter().map(|value| value / whole).collect(),
            ..*self
        }
    }
}

/// Section 4.2: edge and point strength of the luminance.
struct Features {
    edges: Vec<f64>,
    points: Vec<f64>,
}

impl Features {
    fn detect(luminance: &Plane) -> Self {
        let deviation = 0.5 * 0.082 * PIXELS_PER_DEGREE;
        let reach = (3.0 * deviation).ceil() as i64;
        let kernel = |value: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let gaussian = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
            let raw = (-reach..=reach).map(|x| value(x as f64) * gaussian(x as f64));
            let raw: Vec<f64> = raw.collect();
            // Positive weights sum to 1, negative ones to −1.
            let (up, down) = raw.iter().fold((0.0, 0.0), |(up, down), &x| {
                (up + f64::max(x, 0.0), down - f64::min(x, 0.0))
            });
            raw.iter()
                .map(|&x| {
                    if x > 0.0 {
                        x / up
                    } else {
                        x / f64::max(down, 1e-300)
                    }
                })
                .collect()
        };
        let smooth = kernel(&|_| 1.0);
        let slope = kernel(&|x| -x);
        let bend = kernel(&|x| x * x / (deviation * deviation) - 1.0);
        let brightness = Plane {
            values: luminance
                .values
                .iter()
                .map(|y| (y + 16.0) / 116.0)
                .collect(),
            ..*luminance
        };
        let strength = |kernel: &[f64]| -> Vec<f64> {
            let across = brightness.separably(kernel, &smooth).values;
            let along = brightness.separably(&smooth, kernel).values;
            across.iter().zip(along).map(|(a, b)| a.hypot(b)).collect()
        };
        Self {
            edges: strength(&slope),
            points: strength(&bend),
        }
    }
}

fn linear(value: u8) -> f64 {
    let value = f64::from(value) / 255.0;
    if value <= 0.04045 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn xyz_from_rgb(rgb: [f64; 3]) -> [f64; 3] {
    times(&XYZ_FROM_RGB, rgb)
}

/// The inverse matrix.
fn rgb_from_xyz(xyz: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = XYZ_FROM_RGB.map(raycast_core::glam::DVec3::from_array);
    let inverse = raycast_core::glam::DMat3::from_cols(a, b, c)
        .transpose()
        .inverse();
    (inverse * raycast_core::glam::DVec3::from_array(xyz)).to_array()
}

/// XYZ to YCxCz, the linearised form of CIELAB.
fn opponent_from_xyz(xyz: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = std::array::from_fn(|i| xyz[i] / WHITE[i]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn xyz_from_opponent([y, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (y + 16.0) / 116.0;
    let relative = [y + cx / 500.0, y, y - cz / 200.0];
    std::array::from_fn(|i| relative[i] * WHITE[i])
}

/// Equation 3 and section 4.1.2: filtered YCxCz, clamped to the RGB gamut, to CIELAB with the Hunt adjustment:
/// chroma is scaled by lightness, because dark colours look less colourful.
fn perceived_color(opponent: [f64; 3]) -> [f64; 3] {
    let rgb = rgb_from_xyz(xyz_from_opponent(opponent)).map(|value| value.clamp(0.0, 1.0));
    adjusted_lab(rgb)
}

fn adjusted_lab(rgb: [f64; 3]) -> [f64; 3] {
    let xyz = xyz_from_rgb(rgb);
    let bent: [f64; 3] = std::array::from_fn(|i| {
        let (relative, delta) = (xyz[i] / WHITE[i], 6.0 / 29.0);
        if relative > delta * delta * delta {
            relative.cbrt()
        } else {
            relative / (3.0 * delta * delta) + 4.0 / 29.0
        }
    });
    let lightness = 116.0 * bent[1] - 16.0;
    let colorful = 0.01 * lightness;
    [
        lightness,
        500.0 * (bent[0] - bent[1]) * colorful,
        200.0 * (bent[1] - bent[2]) * colorful,
    ]
}

/// Equation 4: the HyAB distance, which is better than Euclidean distance for large differences.
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// Equation 5: the difference of green and blue, the greatest one within the gamut.
fn greatest_difference() -> f64 {
    hyab(adjusted_lab([0.0, 1.0, 0.0]), adjusted_lab([0.0, 0.0, 1.0])).powf(0.7)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::tests::hills;
    use image::Rgb;

    /// Ground truth: the output of the authors' program (version 1.2, C++, single precision) for the same pictures.
    #[test]
    fn agrees_with_the_authors_program() {
        let close = |found: f64, published: f64| {
            assert!((found - published).abs() < 5e-5, "{found}, not {published}");
        };
        let reference = hills(96, 64, 0);
        for (noise, published) in [
            (1, 0.090_405),
            (2, 0.158_574),
            (4, 0.266_355),
            (9, 0.452_419),
        ] {
            close(flip(&hills(96, 64, noise), &reference), published);
        }
        let mut lined = reference.clone();
        for x in 0..96 {
            lined.put_pixel(x, 30, Rgb([255, 255, 255]));
        }
        close(flip(&lined, &reference), 0.056_071);
        let all = |color| RgbImage::from_pixel(48, 40, Rgb(color));
        close(flip(&all([0, 255, 0]), &all([0, 0, 255])), 1.0);
        close(flip(&all([0, 0, 0]), &all([255, 255, 255])), 0.967_401);
        close(
            flip(&all([100, 110, 120]), &all([110, 110, 110])),
            0.144_213,
        );
    }
}
