//! Where a hit lies in a photograph, and whether its camera sees it, computed independently.

use super::mask::closest_visible;
use super::range::{Double, Single, Vector, cross, dot, exactly, minus, plus, scaled, unit};
use crate::stage::Stage;
use raycast_core::Cull;
use raycast_core::camera::Ray;
use raycast_core::glam::{DVec2, DVec3};
use raycast_core::math;
use raycast_core::scene::{Photograph, Texture};

/// The part of a photograph that a hit shows.
pub(super) enum ShownPart {
    /// None: the hit is outside the frame, or hidden.
    None,
    /// These texture coordinates.
    At([Double; 2]),
    /// Rounding may decide.
    Unknown,
}

/// The least weight of a corner in the point that must be visible: 2⁻²⁴.
const LEAST_WEIGHT: f64 = 1.0 / (1 << 24) as f64;

/// The part of an image that a hit of a triangle shows, at weights within these ranges.
pub(super) fn place(
    (stage, cull): (&Stage, Cull),
    numbers: (u32, u32),
    weights: [Single; 3],
    photograph: &Photograph,
    texture: &Texture,
) -> ShownPart {
    let [_, u, v] = weights;
    if photograph.lens.is_some() || !(u.is_known() && v.is_known()) {
        // Lenses are not computed independently.
        return ShownPart::Unknown;
    }
    let Some(uv) = in_frame(
        stage,
        numbers,
        [u, v].map(|weight| weight.to()),
        photograph,
        texture,
    ) else {
        return ShownPart::None;
    };
    let sides = [texture.width(), texture.height()];
    if !uv
        .iter()
        .all(|range| range.is_known() && range.low >= 0.0 && range.high <= 1.0)
    {
        return ShownPart::Unknown;
    }
    // Except at a corner of an occluder, what hides any point of so small a parallelogram hides one of its corners.
    let middle = |range: Single| (range.low + range.high) * 0.5;
    let points = [
        (middle(u), middle(v)),
        (u.low, v.low),
        (u.low, v.high),
        (u.high, v.low),
        (u.high, v.high),
    ];
    let is_seen = |(u, v)| is_seen(stage, cull, numbers, DVec2::new(u, v), photograph.eye);
    let first = is_seen(points[0]);
    match first {
        Some(seen) if points.into_iter().all(|point| is_seen(point) == first) => {
            if !seen {
                return ShownPart::None;
            }
            // Clamped to the centres of the outermost texels.
            let inside = |at: usize| {
                let half = Double::exactly(0.5 / f64::from(sides[at])).rounded();
                uv[at].max(half.low).min(1.0 - half.low)
            };
            ShownPart::At([inside(0), inside(1)])
        }
        _ => ShownPart::Unknown,
    }
}

/// The texture coordinates of a point between a triangle's corners; `None` where it is surely outside the frame, or
/// behind the camera.
fn in_frame(
    stage: &Stage,
    (object, triangle): (u32, u32),
    [u, v]: [Double; 2],
    photograph: &Photograph,
    texture: &Texture,
) -> Option<[Double; 2]> {
    let unknown = Some([Double::UNKNOWN; 2]);
    let Some(triangle) = stage.oracle.triangle(object, triangle) else {
        return unknown;
    };
    let eye = minus(exactly(photograph.eye), exactly(triangle.base));
    let [a, b, c]: [Vector<53>; 3] = triangle
        .corners
        .map(|corner| minus(exactly(corner.as_dvec3()), eye));
    let point = plus(a, plus(scaled(minus(b, a), u), scaled(minus(c, a), v)));
    let forward = unit(minus(exactly(photograph.target), exactly(photograph.eye)));
    let right = unit(cross(forward, exactly(photograph.up)));
    let up = cross(right, forward);
    let [x, y, z] = [right, up, forward].map(|axis| dot(point, axis));
    if z.high <= 0.0 {
        return None;
    }
    if z.low <= 0.0 || !z.is_known() {
        return unknown;
    }
    // Halving the angle, converting it to radians and taking the tangent round by some units in the last place.
    let slope = math::tan(photograph.fov.to_radians() * 0.5);
    let height = Double::around(2.0 * slope, slope * 2f64.powi(-48)) * z;
    // Principal points are rounded to 2⁻²⁴ pixels of a picture of two rows.
    let shift = photograph.shift.map(|shift| match shift {
        0.0 => Double::exactly(0.0),
        shift => Double::around(shift, 2f64.powi(-25)),
    });
    let aspect = Double::exactly(texture.height().into()) / Double::exactly(texture.width().into());
    let half = Double::exactly(0.5);
    let across = (x / height - shift[0]) * aspect + half;
    let along = y / height - shift[1] + half;
    let is_beyond = |range: Double| range.high < 0.0 || range.low > 1.0;
    (!is_beyond(across) && !is_beyond(along)).then_some([across, along])
}

/// Whether an eye sees the point of a triangle at the weights u and v: whether the ray to the point hits nothing that
/// is nearer than the triangle. `None` where it misses the triangle, or hits another one that may or may not be
/// nearer.
fn is_seen(
    stage: &Stage,
    cull: Cull,
    (object, triangle): (u32, u32),
    weights: DVec2,
    eye: DVec3,
) -> Option<bool> {
    let corners = stage.oracle.triangle(object, triangle)?;
    let [a, b, c] = corners
        .corners
        .map(|corner| corner.as_dvec3() + (corners.base - eye));
    let all = [1.0 - weights.x - weights.y, weights.x, weights.y];
    let [of_a, of_b, of_c] = all.map(|weight| weight.max(LEAST_WEIGHT));
    let ray = Ray::new(eye, (a * of_a + b * of_b + c * of_c) / (of_a + of_b + of_c));
    let own = stage.intersect((object, triangle), &ray, cull)?;
    let Some(nearest) = closest_visible(stage, &ray, cull)? else {
        return Some(true);
    };
    if (nearest.object, nearest.triangle) == (object, triangle) || nearest.t > own.t {
        return Some(true);
    }
    (nearest.t < own.t).then_some(false)
}
