//! A dahlia in full bloom.
//!
//! The petals follow one another by the golden angle, and stand at a distance from the axis that
//! grows with the root of their number: H. Vogel, "A better way to construct the sunflower head",
//! 1979. From the bud outwards they get longer and wider, and lean further out.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use crate::obj::{Corner, Face, Material, Model};
use crate::random::random;
use crate::sweep::sweep;

/// The petals of the demo's dahlia.
pub const PETALS: u32 = 106;
/// How many of [`PETALS`] are in the closed bud, and made of fewer triangles.
const BUD_PETALS: u32 = 40;

/// `π (3 − √5)`.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// The materials of petals, from the heart's depth to the outermost tips.
const SHADES: usize = 8;
const GREEN: usize = SHADES;
const STEM: usize = SHADES + 1;
const MATERIALS: [Material; SHADES + 2] = [
    Material::new("petal_1", 0x4a062c),
    Material::new("petal_2", 0x6e0a3c),
    Material::new("petal_3", 0x96124a),
    Material::new("petal_4", 0xbc2055),
    Material::new("petal_5", 0xd93b62),
    Material::new("petal_6", 0xec6172),
    Material::new("petal_7", 0xf68d86),
    Material::new("petal_8", 0xfbb9a0),
    Material::new("sepal", 0x5f8f3e),
    Material::new("stem", 0x467434),
];

/// The flower around the Y axis, its head some two units wide and of this many petals. Each petal is
/// a closed part with an upper and a lower side that meet at its edge.
pub fn dahlia(petals: u32) -> Model {
    let mut model = Model {
        name: "dahlia",
        about: "A dahlia in full bloom",
        materials: MATERIALS.to_vec(),
        ..Model::default()
    };
    for index in 0..petals {
        model.append(petal_of_bloom(index, petals));
    }
    for index in 0..SEPALS {
        model.append(sepal(index));
    }
    for leaf in leaves() {
        model.append(leaf);
    }
    model.append(stem());
    model
}

/// Quads along a petal and across it.
type Grid = (usize, usize);
const COARSE: Grid = (4, 2);
const FINE: Grid = (6, 4);

/// The number of triangles of a petal: both sides have quads in each row but the last, at the tip,
/// which has triangles.
fn petal_triangles((rows, columns): Grid) -> u64 {
    2 * (columns * (2 * rows - 1)) as u64
}

/// A petal's shape, before it is put in its place.
struct Petal {
    /// Where it is attached.
    base: DVec3,
    /// The direction that it grows away from the axis, around Y, in radians.
    azimuth: f64,
    /// The slope of its middle line where it begins, in radians: 0 is level, π/2 is upright.
    elevation: f64,
    /// By how much the slope has changed at its tip.
    bend: f64,
    /// Its length along the middle line.
    length: f64,
    /// Half its width at the widest place.
    half_width: f64,
    /// How far its edges are turned up, in radians, at its base and at its tip.
    cup: (f64, f64),
    /// Half its thickness.
    half_thickness: f64,
    /// Its quads; an even number across.
    grid: Grid,
}

/// Petal `index` of `petals`, counted from the middle of the bud.
fn petal_of_bloom(index: u32, petals: u32) -> Model {
    // 0 in the middle, 1 at the outermost petals.
    let out = ((f64::from(index) + 0.5) / f64::from(petals)).sqrt();
    let jitter = |seed: u32| random(index as i32, 0, seed) * 2.0 - 1.0;
    let azimuth = GOLDEN_ANGLE * f64::from(index) + 0.05 * jitter(1);
    let (sin, cos) = libm::sincos(azimuth);
    let petal = Petal {
        base: DVec3::new(0.2 * out * sin, 0.16 - 0.34 * out * out, 0.2 * out * cos),
        azimuth,
        elevation: curve(&[1.5, 1.42, 1.2, 0.9, 0.55, 0.2, -0.12], out) + 0.06 * jitter(2),
        bend: curve(&[0.5, 0.75, 0.5, 0.1, -0.25, -0.5, -0.75], out) + 0.08 * jitter(3),
        length: curve(&[0.26, 0.32, 0.45, 0.62, 0.78, 0.9, 0.96], out) * (1.0 + 0.04 * jitter(4)),
        half_width: curve(&[0.06, 0.085, 0.13, 0.17, 0.2, 0.22, 0.225], out),
        cup: (1.6, curve(&[1.3, 1.2, 1.1, 1.0, 0.9, 0.8, 0.75], out)),
        half_thickness: 0.008,
        grid: if index < bud_petals(petals) {
            COARSE
        } else {
            FINE
        },
    };
    petal.model(|along| {
        let light = 0.08 + 0.6 * out + 0.6 * (along - 0.45) + 0.05 * jitter(5);
        ((light * SHADES as f64) as usize).min(SHADES - 1)
    })
}

/// How many of a bloom's petals are in the bud.
fn bud_petals(petals: u32) -> u32 {
    (u64::from(petals) * u64::from(BUD_PETALS) / u64::from(PETALS)) as u32
}

/// The number of triangles of a dahlia with this many petals.
pub fn dahlia_triangles(petals: u32) -> u64 {
    let bud = u64::from(bud_petals(petals));
    let coarse = bud + SEPALS as u64;
    let fine = u64::from(petals) - bud + LEAVES as u64;
    // A segment has two triangles in each band of the stem, but one in each of the two at its poles.
    let stem = 2 * STEM_SEGMENTS * (STEM_STATIONS - 2);
    coarse * petal_triangles(COARSE) + fine * petal_triangles(FINE) + stem as u64
}

const LEAVES: usize = 2;
const STEM_STATIONS: usize = 11;
const STEM_SEGMENTS: usize = 12;
const SEPALS: usize = 8;

fn sepal(index: usize) -> Model {
    let azimuth = 2.0 * PI * (index as f64 + 0.3) / SEPALS as f64;
    Petal {
        base: DVec3::new(0.0, -0.3, 0.0),
        azimuth,
        elevation: -0.25,
        bend: -0.5,
        length: 0.42,
        half_width: 0.1,
        cup: (0.6, 0.3),
        half_thickness: 0.008,
        grid: COARSE,
    }
    .model(|_| GREEN)
}

fn leaves() -> [Model; LEAVES] {
    let leaf = |y: f64, azimuth: f64, elevation: f64, length: f64| {
        Petal {
            base: DVec3::new(0.0, y, 0.0),
            azimuth,
            elevation,
            bend: -0.9,
            length,
            half_width: length * 0.3,
            cup: (0.8, 0.3),
            half_thickness: 0.01,
            grid: FINE,
        }
        .model(|_| GREEN)
    };
    [leaf(-1.05, 1.2, 0.7, 0.95), leaf(-1.3, -1.6, 0.6, 0.85)]
}

fn stem() -> Model {
    let profile: [_; STEM_STATIONS] = [
        (0.14, 0.0, 0),
        (0.08, 0.12, 0),
        (-0.1, 0.2, 0),
        (-0.2, 0.22, 0),
        (-0.27, 0.22, GREEN),
        (-0.34, 0.18, GREEN),
        (-0.4, 0.1, GREEN),
        (-0.5, 0.065, STEM),
        (-1.0, 0.055, STEM),
        (-1.9, 0.065, STEM),
        (-1.9, 0.0, STEM),
    ];
    let stations = profile.map(|(y, radius, material)| (DVec3::new(0.0, y, 0.0), radius, material));
    sweep(&stations, STEM_SEGMENTS, DVec3::X)
}

/// The value at `t` of a line through evenly spaced values.
fn curve(values: &[f64], t: f64) -> f64 {
    let place = t * (values.len() - 1) as f64;
    let index = (place as usize).min(values.len() - 2);
    let [from, to] = [values[index], values[index + 1]];
    from + (to - from) * (place - index as f64)
}

impl Petal {
    /// The closed petal; `material` gives it by the place along the petal from 0 to 1.
    fn model(&self, material: impl Fn(f64) -> usize) -> Model {
        let (rows, columns) = self.grid;
        // Rows get closer towards the tip, where the outline turns.
        let along = |row: usize| {
            let t = row as f64 / rows as f64;
            t * (1.5 - 0.5 * t)
        };
        let mut model = Model::default();
        // Upper vertices row by row, the tip being a single one; lower ones only within the edge.
        let upper =
            |row: usize, column: usize| row * (columns + 1) + if row == rows { 0 } else { column };
        let mut points = Vec::new();
        let spine = self.spine(rows, along);
        for (row, &(middle, slope)) in spine.iter().enumerate() {
            for column in 0..if row == rows { 1 } else { columns + 1 } {
                let across = if row == rows {
                    0.0
                } else {
                    2.0 * column as f64 / columns as f64 - 1.0
                };
                points.push(self.point(along(row), across, middle, slope));
                model.uvs.push(DVec2::new((across + 1.0) / 2.0, along(row)));
            }
        }
        let tip = points.len() - 1;
        let mut lower_of: Vec<usize> = (0..points.len()).collect();
        model.positions = points.iter().map(|&(p, _)| p).collect();
        for row in 1..rows {
            for column in 1..columns {
                let index = upper(row, column);
                let (p, normal) = points[index];
                let swell = normal * self.half_thickness;
                lower_of[index] = model.positions.len();
                model.positions[index] = p + swell;
                model.positions.push(p - swell);
            }
        }
        model.normals = points
            .iter()
            .map(|&(_, n)| n)
            .chain(points.iter().map(|&(_, n)| -n))
            .collect();
        let sides = points.len();
        for row in 0..rows {
            let material = material((along(row) + along(row + 1)) / 2.0);
            for column in 0..columns {
                let mut ring = vec![upper(row, column + 1), upper(row, column)];
                if row + 1 == rows {
                    ring.push(tip);
                } else {
                    ring.extend([upper(row + 1, column), upper(row + 1, column + 1)]);
                    // The fan's diagonal points to the tip: a corner of the sheet would else have
                    // one between two edge vertices, which both sides share.
                    if column < columns / 2 {
                        ring.rotate_left(1);
                    }
                }
                let top = ring.iter().map(|&i| Corner {
                    position: i,
                    uv: i,
                    normal: i,
                });
                // The other way round from the same corner, so that both sides' fans have the
                // same diagonals and so thin a sheet cannot cut itself.
                let around = ring[..1].iter().chain(ring[1..].iter().rev());
                let bottom = around.map(|&i| Corner {
                    position: lower_of[i],
                    uv: i,
                    normal: i + sides,
                });
                model.faces.push(Face {
                    material,
                    corners: top.collect(),
                });
                model.faces.push(Face {
                    material,
                    corners: bottom.collect(),
                });
            }
        }
        model
    }

    /// The middle line's points (distance from the base outwards, height) and slopes at each row.
    fn spine(&self, rows: usize, along: impl Fn(usize) -> f64) -> Vec<(DVec2, f64)> {
        let slope = |t: f64| self.elevation + self.bend * t * t;
        let mut at = DVec2::ZERO;
        let mut spine = vec![(at, slope(0.0))];
        for row in 1..=rows {
            let (from, to) = (along(row - 1), along(row));
            let (sin, cos) = libm::sincos(slope((from + to) / 2.0));
            at += DVec2::new(cos, sin) * (self.length * (to - from));
            spine.push((at, slope(to)));
        }
        spine
    }

    /// A point of the petal's sheet and the normal of its upper side there.
    fn point(&self, along: f64, across: f64, middle: DVec2, slope: f64) -> (DVec3, DVec3) {
        let half_width = self.half_width * outline(along);
        let cup = self.cup.0 + (self.cup.1 - self.cup.0) * along;
        // Across, the sheet is an arc of a circle that turns by `cup` on either side.
        let (sin, cos) = libm::sincos(cup * across);
        let (aside, up) = (half_width * sin / cup, half_width * (1.0 - cos) / cup);
        let (sin_azimuth, cos_azimuth) = libm::sincos(self.azimuth);
        let outwards = DVec3::new(sin_azimuth, 0.0, cos_azimuth);
        let right = DVec3::new(cos_azimuth, 0.0, -sin_azimuth);
        let (sin_slope, cos_slope) = libm::sincos(slope);
        let upper = DVec3::Y * cos_slope - outwards * sin_slope;
        let p = self.base + outwards * middle.x + DVec3::Y * middle.y + right * aside + upper * up;
        (p, upper * cos - right * sin)
    }
}

/// A petal's width along it, of its greatest width: narrow at the base, widest past the middle,
/// and blunt with a point at the tip.
fn outline(along: f64) -> f64 {
    const WIDEST: f64 = 0.58;
    if along < WIDEST {
        let t = along / WIDEST;
        0.3 + 0.7 * t * (2.0 - t)
    } else {
        let t = (along - WIDEST) / (1.0 - WIDEST);
        (1.0 - t * t).max(0.0).sqrt() * (1.0 - 0.25 * t)
    }
}
