//! The colour of a texture at a hit.

use super::normal::blend;
use super::range::{Double, Single, Vector, cross, exactly, exactly_single, minus, to, unit};
use super::srgb;
use raycast_core::glam::{DVec3, Vec2};
use raycast_core::scene::{Mesh, Texture};
use raycast_core::shade::Filter;

/// Linear light with premultiplied alpha, and alpha.
pub(super) type Texel = [Single; 4];

const UNKNOWN: Texel = [Single::UNKNOWN; 4];

/// Texture coordinates at a hit, interpolated in double precision.
pub(super) fn place([a, b, c]: [Vec2; 3], u: Single, v: Single) -> [Double; 2] {
    let (u, v): (Double, Double) = (u.to(), v.to());
    let coordinate = |of: fn(Vec2) -> f32| {
        let [a, b, c] = [a, b, c].map(|uv| Double::exactly(of(uv).into()));
        a + (b - a) * u + (c - a) * v
    };
    [coordinate(|uv| uv.x), coordinate(|uv| uv.y)]
}

/// The texture at a range of coordinates. Its origin is bottom left, it repeats every unit, and texels' centres lie
/// half a texel from its edges. Unknown where the range is as wide as a texel.
pub(super) fn sample(texture: &Texture, place: [Double; 2], filter: Filter) -> Texel {
    sample_bytes_as(texture, place, filter, srgb::byte_to_linear)
}

/// As [`sample`], with `of` as the meaning of a byte of the image.
pub(super) fn sample_bytes_as(
    texture: &Texture,
    [u, v]: [Double; 2],
    filter: Filter,
    of: fn(u8) -> Single,
) -> Texel {
    let (columns, rows) = (f64::from(texture.width()), f64::from(texture.height()));
    // Without reduction to the first repeat: texels are found by remainders.
    let x = u * Double::exactly(columns);
    let y = -(v * Double::exactly(rows));
    if !(x.is_known() && y.is_known()) || x.high.abs().max(y.high.abs()) > 1e15 {
        return UNKNOWN;
    }
    match filter {
        Filter::Nearest => {
            let (across, down) = (
                x.low.floor()..=x.high.floor(),
                y.low.floor()..=y.high.floor(),
            );
            match texels(texture, across, down, of) {
                Some(texels) => range_over(&texels),
                None => UNKNOWN,
            }
        }
        Filter::Bilinear => bilinear(texture, x, y, of),
        // Footprints are not computed independently.
        Filter::Trilinear | Filter::Ewa => UNKNOWN,
    }
}

/// Interpolation between the four nearest texels.
fn bilinear(texture: &Texture, x: Double, y: Double, of: fn(u8) -> Single) -> Texel {
    let half = Double::exactly(0.5);
    let (x, y) = (x - half, y - half);
    let across = x.low.floor()..=x.high.floor() + 1.0;
    let down = y.low.floor()..=y.high.floor() + 1.0;
    let width = (across.end() - across.start()) as usize + 1;
    let (left, top) = (*across.start(), *down.start());
    let Some(texels) = texels(texture, across, down, of) else {
        return UNKNOWN;
    };
    let at = |column: usize, row: usize, channel: usize| {
        let texel: &Texel = &texels[row * width + column];
        (texel[channel].low + texel[channel].high) * 0.5
    };
    let height = texels.len() / width;
    // At the middle of the range.
    let (middle_x, middle_y) = ((x.low + x.high) * 0.5, (y.low + y.high) * 0.5);
    let column = ((middle_x - left).floor() as usize).min(width - 2);
    let row = ((middle_y - top).floor() as usize).min(height - 2);
    let (right, below) = (middle_x - left - column as f64, middle_y - top - row as f64);
    // The interpolation is continuous, and between texels that differ by so much it is nowhere steeper than that. The
    // position among the texels is rounded to single precision, by 2⁻²⁴ at most.
    let rounding = 2f64.powi(-24);
    let reach = (
        (x.high - x.low) * 0.5 + rounding,
        (y.high - y.low) * 0.5 + rounding,
    );
    std::array::from_fn(|channel| {
        let value = at(column, row, channel) * (1.0 - right) * (1.0 - below)
            + at(column + 1, row, channel) * right * (1.0 - below)
            + at(column, row + 1, channel) * (1.0 - right) * below
            + at(column + 1, row + 1, channel) * right * below;
        let mut steepest = (0.0f64, 0.0f64);
        for row in 0..height {
            for column in 0..width {
                let here = at(column, row, channel);
                if column + 1 < width {
                    steepest.0 = steepest.0.max((at(column + 1, row, channel) - here).abs());
                }
                if row + 1 < height {
                    steepest.1 = steepest.1.max((at(column, row + 1, channel) - here).abs());
                }
            }
        }
        let range = Single::around(value, steepest.0 * reach.0 + steepest.1 * reach.1);
        // A texel's light, two products and three sums of numbers that are not negative.
        (0..6).fold(range, |range, _| range.rounded())
    })
}

/// Some texels, row by row; `None` where there are more than a hit's rounding can reach.
fn texels(
    texture: &Texture,
    across: std::ops::RangeInclusive<f64>,
    down: std::ops::RangeInclusive<f64>,
    of: fn(u8) -> Single,
) -> Option<Vec<Texel>> {
    let counts = [across.end() - across.start(), down.end() - down.start()];
    if counts.iter().any(|count| *count > 2.0) {
        return None;
    }
    let mut texels = Vec::with_capacity(9);
    for row in *down.start() as i64..=*down.end() as i64 {
        for column in *across.start() as i64..=*across.end() as i64 {
            let x = column.rem_euclid(texture.width().into()) as usize;
            let y = row.rem_euclid(texture.height().into()) as usize;
            let [r, g, b, a] = texture.texels()[y * texture.width() as usize + x];
            let alpha = (Single::exactly(a.into()) / Single::exactly(255.0)).min(1.0);
            let alpha = if a == u8::MAX {
                Single::exactly(1.0)
            } else {
                alpha
            };
            let [r, g, b] = [r, g, b].map(|byte| of(byte) * alpha);
            texels.push([r, g, b, alpha]);
        }
    }
    Some(texels)
}

/// The range of some texels.
fn range_over(texels: &[Texel]) -> Texel {
    std::array::from_fn(|channel| {
        let ends = texels
            .iter()
            .flat_map(|texel| [texel[channel].low, texel[channel].high]);
        Single::over(ends)
    })
}

/// The position of a triplanar texture in an object's space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Repeat {
    center: DVec3,
    scale: f64,
}

impl Repeat {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let bounds = mesh.bounds();
        let longest = bounds.size().max_element();
        Self {
            center: bounds.center() - mesh.offset(),
            scale: if longest > 0.0 { 1.0 / longest } else { 0.0 },
        }
    }
}

/// The triplanar texture: one repeat over the longest side of the object's box, centred; each axis is weighted by the
/// fourth power of the normal's component.
pub(super) fn triplanar(
    (mesh, repeat): (&Mesh, &Repeat),
    triangle: u32,
    weights: [Single; 3],
    texture: &Texture,
    filter: Filter,
) -> Texel {
    let Some(corners) = mesh.corners(triangle) else {
        return UNKNOWN;
    };
    let point = blend(corners.map(exactly_single), weights);
    let normals = match mesh.corner_normals(triangle) {
        Some(normals) => normals.map(exactly_single),
        None => {
            let [a, b, c] = corners.map(|corner| exactly::<53>(corner.as_dvec3()));
            [to(unit(cross(minus(b, a), minus(c, a)))); 3]
        }
    };
    let normal = unit(blend(normals, weights));
    let centered: Vector<53> = minus(to(point), exactly(repeat.center));
    let [x, y, z] = centered.map(|c| c * Double::exactly(repeat.scale));
    let fourth = normal.map(|n| {
        let n = n.abs();
        n * n * (n * n)
    });
    let sum = fourth[0] + fourth[1] + fourth[2];
    let half = Double::exactly(0.5);
    let mut color: Texel = [Single::exactly(0.0); 4];
    for axis in 0..3 {
        let weight = (fourth[axis] / sum).max(0.0).min(1.0);
        let part = if normal[axis].contains(0.0) {
            // Either side may contribute, by the fourth power of a rounding at least.
            [Single {
                low: 0.0,
                high: 1.0,
            }; 4]
        } else {
            let turn = |c: Double| if normal[axis].high < 0.0 { -c } else { c };
            let (u, v) = match axis {
                0 => (turn(-z), y),
                1 => (x, turn(-z)),
                _ => (turn(x), y),
            };
            sample(texture, [u + half, v + half], filter)
        };
        color = std::array::from_fn(|i| color[i] + part[i] * weight);
    }
    color
}

/// Texture coordinates interpolated in single precision.
pub(super) fn blended([a, b, c]: [Vec2; 3], weights: [Single; 3]) -> [Single; 2] {
    let numbers = |uv: Vec2| uv.to_array().map(|number| Single::exactly(number.into()));
    blend([numbers(a), numbers(b), numbers(c)], weights)
}
