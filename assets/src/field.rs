//! Solids as scalar fields: negative inside, zero on the surface, near the distance elsewhere.
//!
//! After A. Ricci, "A constructive geometry for computer graphics", 1973, with the blends of
//! J. C. Hart, "Sphere tracing", 1996.

use glam::DVec3;

/// The step of [`gradient`]'s differences: the third root of `f64`'s rounding error, where the
/// error of central differences is least for values near one.
const DIFFERENCE: f64 = 6e-6;

/// An ellipsoid with half axes `radii` around the origin. Only near its surface is the value a
/// distance; it is exact for a sphere.
pub(crate) fn ellipsoid(p: DVec3, radii: DVec3) -> f64 {
    let scaled = (p / radii).length();
    let slope = (p / (radii * radii)).length();
    if slope == 0.0 {
        -radii.min_element()
    } else {
        scaled * (scaled - 1.0) / slope
    }
}

/// A rod from `a` to `b` whose radius goes from `radius_a` to `radius_b`.
pub(crate) fn rod(p: DVec3, (a, radius_a): (DVec3, f64), (b, radius_b): (DVec3, f64)) -> f64 {
    let axis = b - a;
    let along = ((p - a).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
    p.distance(a + axis * along) - (radius_a + (radius_b - radius_a) * along)
}

/// Both solids, with a fillet of about `width` where they meet.
pub(crate) fn blend(a: f64, b: f64, width: f64) -> f64 {
    let overlap = (width - (a - b).abs()).max(0.0) / width;
    a.min(b) - overlap * overlap * width / 4.0
}

/// `solid` without `tool`, the edge rounded by about `width`.
pub(crate) fn carve(solid: f64, tool: f64, width: f64) -> f64 {
    -blend(-solid, tool, width)
}

/// The field's gradient, by central differences.
pub(crate) fn gradient(field: impl Fn(DVec3) -> f64, p: DVec3) -> DVec3 {
    DVec3::from_array(DVec3::AXES.map(|axis| {
        (field(p + axis * DIFFERENCE) - field(p - axis * DIFFERENCE)) / (2.0 * DIFFERENCE)
    }))
}

/// The point on the surface near `p`: a few steps of Newton's method along the gradient, none
/// longer than `reach`.
pub(crate) fn onto_surface(field: impl Fn(DVec3) -> f64, mut p: DVec3, reach: f64) -> DVec3 {
    for _ in 0..4 {
        let slope = gradient(&field, p);
        let step = slope * (field(p) / slope.length_squared().max(1e-6));
        let next = p - step.clamp_length_max(reach);
        if next == p {
            break;
        }
        p = next;
    }
    p
}
