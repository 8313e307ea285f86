//! Where eight rays of a row meet the triangles that they are known to meet, in doubles side by side.
//!
//! Each lane does what [`PreparedRay`](super::PreparedRay) does for one ray, operation by operation,
//! so that the bits are the same.

use super::triangle::{Edges, axes, major_axis};
use crate::camera::{Camera, Ray};
use glam::DVec3;

/// Rays side by side.
pub(crate) const LANES: usize = 8;

/// Eight triangles' corners: coordinates side by side.
pub(crate) type Corners = [[f32; LANES]; 9];

/// Eight hits.
pub(crate) struct RowHits {
    pub(crate) t: [f32; LANES],
    pub(crate) u: [f32; LANES],
    pub(crate) v: [f32; LANES],
    /// Whether the lane is sure; one that is not must be asked for alone.
    pub(crate) sure: [bool; LANES],
}

/// Meets each ray with the triangle in its lane. The rays go through (x + lane · stride, y) of the
/// picture; corners are relative to `frame`.
#[inline(always)]
pub(crate) fn meet_row(
    camera: &Camera,
    frame: DVec3,
    (x, y): (f64, f64),
    stride: f64,
    corners: &Corners,
) -> RowHits {
    let mut origin = [[0.0; LANES]; 3];
    let mut direction = [[0.0; LANES]; 3];
    let mut origin_error = [0.0; LANES];
    let mut majors = [0; LANES];
    let off = if frame == DVec3::ZERO { 0.0 } else { 1.0 };
    for lane in 0..LANES {
        let Ray {
            origin: o,
            direction: d,
            ..
        } = camera.ray(x + lane as f64 * stride, y);
        let o = o - frame;
        origin_error[lane] = o.abs().max_element() * (f64::EPSILON / 2.0) * off;
        for (axis, (o, d)) in o.to_array().into_iter().zip(d.to_array()).enumerate() {
            origin[axis][lane] = o;
            direction[axis][lane] = d;
        }
        majors[lane] = major_axis(d.x, d.y, d.z);
    }
    // Rays this near each other nearly always share their major axis.
    let major = majors[0];
    let mut hits = match major {
        0 => meet::<0>(&origin, &direction, &origin_error, corners),
        1 => meet::<1>(&origin, &direction, &origin_error, corners),
        _ => meet::<2>(&origin, &direction, &origin_error, corners),
    };
    for lane in 0..LANES {
        hits.sure[lane] &= majors[lane] == major;
    }
    hits
}

#[inline(always)]
fn meet<const MAJOR: usize>(
    origin: &[[f64; LANES]; 3],
    direction: &[[f64; LANES]; 3],
    origin_error: &[f64; LANES],
    corners: &Corners,
) -> RowHits {
    let [kx, ky, kz] = const { axes(MAJOR) };
    let mut hits = RowHits {
        t: [0.0; LANES],
        u: [0.0; LANES],
        v: [0.0; LANES],
        sure: [false; LANES],
    };
    for lane in 0..LANES {
        let advance = direction[kz][lane];
        let shear = [direction[kx][lane] / advance, direction[ky][lane] / advance];
        let relative = |axis: usize| {
            [0, 3, 6].map(|corner| f64::from(corners[corner + axis][lane]) - origin[axis][lane])
        };
        let edges = Edges::new(
            relative(kx),
            relative(ky),
            relative(kz),
            shear,
            origin_error[lane],
        );
        let point = edges.point(advance);
        // A camera's rays begin at zero and have no end.
        hits.sure[lane] =
            edges.surely_inside() & point.is_single() & (point.t - point.t_error >= 0.0);
        hits.t[lane] = point.t as f32;
        hits.u[lane] = point.u as f32;
        hits.v[lane] = point.v as f32;
    }
    hits
}
