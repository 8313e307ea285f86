//! Interpolates t, u and v where eight rays of a row hit the triangles that they are known to hit, in double
//! precision, side by side.
//!
//! Each lane does what [`PreparedRay`](super::PreparedRay) does for one ray, operation by operation: the bits are
//! the same.

use super::watertight::{Edges, axes, greater, major_axis};
use crate::camera::{Camera, Projection};
use glam::DVec3;

/// Rays side by side.
pub(crate) const LANES: usize = 8;

/// Corners of eight triangles in structure-of-arrays order.
pub(crate) type Corners = [[f32; LANES]; 9];

/// Eight hits.
pub(crate) struct RowHits {
    pub(crate) t: [f32; LANES],
    pub(crate) u: [f32; LANES],
    pub(crate) v: [f32; LANES],
    /// Whether the lane is sure; one that is not must be interpolated alone.
    pub(crate) sure: [bool; LANES],
}

/// Interpolates each ray's hit of the triangle in its lane. Ray `lane` goes through (x + lane · stride, y) of the
/// picture; corners are relative to `frame`.
#[inline(always)]
pub(crate) fn meet_row(
    camera: &Camera,
    frame: DVec3,
    place: (f64, f64),
    stride: f64,
    corners: &Corners,
) -> RowHits {
    let DVec3 { x, y, z } = camera.direction(place.0, place.1);
    // Neighbouring rays nearly always share their major axis; a lane that does not is not sure.
    match (major_axis(x, y, z), camera.projection()) {
        (0, Projection::Perspective) => meet::<0, true>(camera, frame, place, stride, corners),
        (1, Projection::Perspective) => meet::<1, true>(camera, frame, place, stride, corners),
        (_, Projection::Perspective) => meet::<2, true>(camera, frame, place, stride, corners),
        (0, _) => meet::<0, false>(camera, frame, place, stride, corners),
        (1, _) => meet::<1, false>(camera, frame, place, stride, corners),
        (_, _) => meet::<2, false>(camera, frame, place, stride, corners),
    }
}

/// One loop over plain numbers, which compilers vectorise.
#[inline(always)]
#[allow(
    clippy::needless_range_loop,
    reason = "a lane is an index into all the arrays at once"
)]
fn meet<const MAJOR: usize, const PERSPECTIVE: bool>(
    camera: &Camera,
    frame: DVec3,
    (x, y): (f64, f64),
    stride: f64,
    corners: &Corners,
) -> RowHits {
    let [kx, ky, kz] = const { axes(MAJOR) };
    let [right, up, forward] =
        [camera.right(), camera.up(), camera.forward()].map(|v| v.to_array());
    let eye = camera.placement().eye.to_array();
    let frame = frame.to_array();
    let off = if frame == [0.0; 3] { 0.0 } else { 1.0 };
    let distance = camera.distance();
    let mut hits = RowHits {
        t: [0.0; LANES],
        u: [0.0; LANES],
        v: [0.0; LANES],
        sure: [false; LANES],
    };
    for lane in 0..LANES {
        // `Camera::ray`, a coordinate at a time.
        let (across, along) = camera.across_and_along(x + lane as f64 * stride, y);
        let mut origin = eye;
        let mut direction = forward;
        for axis in 0..3 {
            let on_plane = right[axis] * across + up[axis] * along;
            if PERSPECTIVE {
                direction[axis] = on_plane + forward[axis] * distance;
            } else {
                origin[axis] = eye[axis] + on_plane;
            }
        }
        if PERSPECTIVE {
            let [x, y, z] = direction;
            let length = (x * x + y * y + z * z).sqrt();
            direction = [x / length, y / length, z / length];
        }
        let [x, y, z] = direction;
        let same_major = major_axis(x, y, z) == MAJOR;
        let o = [
            origin[0] - frame[0],
            origin[1] - frame[1],
            origin[2] - frame[2],
        ];
        let far = greater(greater(o[0].abs(), o[1].abs()), o[2].abs());
        let origin_error = far * (f64::EPSILON / 2.0) * off;

        let advance = direction[kz];
        let shear = [direction[kx] / advance, direction[ky] / advance];
        let at = |axis: usize, corner: usize| f64::from(corners[3 * corner + axis][lane]) - o[axis];
        let edges = Edges::new(
            [at(kx, 0), at(kx, 1), at(kx, 2)],
            [at(ky, 0), at(ky, 1), at(ky, 2)],
            [at(kz, 0), at(kz, 1), at(kz, 2)],
            shear,
            origin_error,
        );
        let [t, u, v] = edges.weights(advance);
        // A camera's rays begin behind zero and have no end. What is off by far less than itself has its own sign.
        hits.sure[lane] = same_major & edges.surely_inside() & edges.surely_single() & (t > 0.0);
        hits.t[lane] = t as f32;
        hits.u[lane] = u as f32;
        hits.v[lane] = v as f32;
    }
    hits
}
