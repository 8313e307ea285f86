//! A leopard's skin that tiles.
//!
//! Rosettes stand in the cells around scattered feature points: S. Worley, "A cellular texture
//! basis function", 1996. Each is a ring along the border of its cell, broken where noise says so,
//! as the cascades of G. Turk, "Generating textures on arbitrary surfaces using
//! reaction-diffusion", 1991, leave them. All lattices wrap around, so the image does.

use glam::DVec2;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use crate::random::random;

/// Width and height in pixels.
const SIZE: u32 = 512;

/// Rosettes along a side.
const CELLS: i32 = 6;

/// How sharp the corners of cells are: the inverse of their rounding in lattice steps.
const HARDNESS: f64 = 14.0;

/// The image as a PNG file.
pub(crate) fn leopard() -> Vec<u8> {
    let pixels: Vec<u8> = (0..SIZE * SIZE)
        .flat_map(|i| {
            let pixel = DVec2::new(f64::from(i % SIZE), f64::from(i / SIZE));
            skin((pixel + 0.5) / f64::from(SIZE))
        })
        .collect();
    let mut file = Vec::new();
    // `Fast` is the one compression that a feature of some other package cannot change.
    PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Up)
        .write_image(&pixels, SIZE, SIZE, ExtendedColorType::Rgb8)
        .expect("memory takes every write, and the buffer has the image's size");
    file
}

/// The colour, 8-bit sRGB, at a place in the unit square.
fn skin(p: DVec2) -> [u8; 3] {
    // Wavy, so that no border is straight.
    let bent = p
        + DVec2::new(fractal(p, 5, 3, 11) - 0.5, fractal(p, 5, 3, 12) - 0.5) * 0.09
        + DVec2::new(noise(p, 40, 40, 13) - 0.5, noise(p, 40, 40, 14) - 0.5) * 0.012;
    let (border, cell) = cells(bent);

    // The ring stands a little inside of the cell's border. Noise of about a third of a rosette's
    // width opens it in places and fattens it in others.
    let ring_at = 0.17 + 0.06 * random(cell.0, cell.1, 3);
    let breaks = noise(bent, 25, 25, 15);
    let ring = 0.052 + 0.26 * (breaks - 0.5) - (border - ring_at).abs();
    // Solid spots where rosettes leave room.
    let fleck = 0.6 * (fractal(bent, 22, 2, 16) - 0.62) - 0.9 * (border - 0.02).max(0.0);
    // Hairs of the dark fur lie over the edge.
    let fringe = 0.03 * (noise(p, 200, 40, 17) - 0.5);
    let dark = smooth_step(-0.008, 0.012, ring.max(fleck) + fringe);
    let inside = smooth_step(-0.06, 0.05, border - ring_at);

    // Hairs lie along the vertical.
    let hair = 0.6 * noise(p, 170, 28, 21) + 0.4 * noise(p, 256, 64, 22) - 0.5;
    let patch = fractal(p, 3, 3, 23);
    let ground = mix(
        CREAM,
        GOLD,
        (0.25 + 0.9 * patch + 0.25 * hair).clamp(0.0, 1.0),
    );
    let ground = mix(ground, TAWNY, 0.75 * inside);
    let spot = mix(BLACK, BROWN, (0.45 + 0.8 * hair).clamp(0.0, 1.0));
    let colour = mix(
        ground,
        spot,
        (dark + 0.5 * hair * dark * (1.0 - dark)).clamp(0.0, 1.0),
    );
    let light = 1.0 + 0.16 * hair;
    // Steps of four levels: the eye does not see them in fur, and the file halves.
    colour.map(|channel| ((channel * light / 4.0).round() * 4.0).clamp(0.0, 255.0) as u8)
}

type Colour = [f64; 3];
const CREAM: Colour = [240.0, 214.0, 160.0];
const GOLD: Colour = [222.0, 170.0, 92.0];
const TAWNY: Colour = [188.0, 120.0, 54.0];
const BROWN: Colour = [62.0, 36.0, 20.0];
const BLACK: Colour = [28.0, 18.0, 14.0];

fn mix(from: Colour, to: Colour, part: f64) -> Colour {
    std::array::from_fn(|i| from[i] + (to[i] - from[i]) * part)
}

fn smooth_step(from: f64, to: f64, value: f64) -> f64 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// How far the place is inside of the border of its nearest feature point's cell, in lattice
/// steps, and that cell's place in the lattice.
fn cells(p: DVec2) -> (f64, (i32, i32)) {
    let p = p * f64::from(CELLS);
    let home = p.floor();
    let feature = |column: i32, row: i32| {
        let (x, y) = (column.rem_euclid(CELLS), row.rem_euclid(CELLS));
        // Every other row stands half a cell aside, which packs them more evenly than a square.
        let shift = if y % 2 == 0 { 0.0 } else { 0.5 };
        let jitter = DVec2::new(random(x, y, 1), random(x, y, 2)) * 0.62;
        (
            DVec2::new(f64::from(column) + shift, f64::from(row)) + 0.19 + jitter,
            (x, y),
        )
    };
    let mut around = Vec::with_capacity(30);
    for row in -2..=2 {
        for column in -3..=2 {
            around.push(feature(home.x as i32 + column, home.y as i32 + row));
        }
    }
    let &(centre, cell) = around
        .iter()
        .min_by(|a, b| p.distance_squared(a.0).total_cmp(&p.distance_squared(b.0)))
        .expect("there are thirty");
    // A soft minimum of the distances to the border's sides rounds the corners.
    let sum: f64 = around
        .iter()
        .filter(|(other, _)| *other != centre)
        .map(|&(other, _)| {
            let distance = (centre.midpoint(other) - p).dot((other - centre).normalize());
            libm::exp(-HARDNESS * distance)
        })
        .sum();
    (-libm::log(sum) / HARDNESS, cell)
}

/// Noise from 0 to 1 in `octaves`, each twice as fine and half as strong.
fn fractal(p: DVec2, lattice: i32, octaves: u32, seed: u32) -> f64 {
    let (mut sum, mut weight, mut strength) = (0.0, 0.0, 1.0);
    for octave in 0..octaves {
        let lattice = lattice << octave;
        sum += strength * noise(p, lattice, lattice, seed + 100 * octave);
        weight += strength;
        strength /= 2.0;
    }
    sum / weight
}

/// Smooth random values from 0 to 1 on a wrapping lattice of `columns` by `rows`.
fn noise(p: DVec2, columns: i32, rows: i32, seed: u32) -> f64 {
    let p = p * DVec2::new(f64::from(columns), f64::from(rows));
    let (corner, t) = (p.floor(), p - p.floor());
    let t = t * t * (3.0 - 2.0 * t);
    let value = |dx: i32, dy: i32| {
        let (x, y) = (corner.x as i32 + dx, corner.y as i32 + dy);
        random(x.rem_euclid(columns), y.rem_euclid(rows), seed)
    };
    let bottom = value(0, 0) + (value(1, 0) - value(0, 0)) * t.x;
    let top = value(0, 1) + (value(1, 1) - value(0, 1)) * t.x;
    bottom + (top - bottom) * t.y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_skin_tiles() {
        // Dyadic places, so that a whole step to the side is exact. A last digit may still tip a
        // channel into the next of its steps.
        for i in 0..64 {
            let p = DVec2::new(f64::from(i) / 64.0, f64::from(i * 37 % 64) / 64.0);
            for step in [DVec2::X, DVec2::Y, -DVec2::ONE] {
                for (here, there) in skin(p).into_iter().zip(skin(p + step)) {
                    assert!(here.abs_diff(there) <= 4, "{p}");
                }
            }
        }
    }

    #[test]
    fn noise_and_its_lattice_stay_within_bounds() {
        for i in 0..1000 {
            let p = DVec2::new(f64::from(i) * 0.137, f64::from(i) * -0.071);
            assert!((0.0..=1.0).contains(&fractal(p, 5, 3, 9)));
            assert!(cells(p).0 > -0.2);
        }
    }
}
