//! A frustum against boxes: four sides, what lies behind the eye, and how near a box begins.

use super::simd::{LANES, Lanes};
use super::tree::{Box32, BoxPair};
use crate::camera::{Camera, Projection};
use glam::DVec3;

/// Which plane's value is the distance of a box's nearest point along the view axis, negated.
const NEAREST: usize = 5;
/// Planes that cut boxes off, as bits.
const SIDES: u32 = 0b1_1111;

/// A rectangle of the image plane, in scene units from the view axis at the target: what
/// [`Camera::direction`] is linear in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    /// Least and greatest place to the right.
    pub(crate) across: (f64, f64),
    /// Least and greatest place up.
    pub(crate) along: (f64, f64),
}

/// All points in front of the camera whose rays go through a window.
///
/// The value of a plane at a box is the greatest over its corners of N·p + c, rounded; c holds enough
/// slack that it is never below the true one.
#[derive(Clone, Debug)]
pub(crate) struct Frustum {
    /// The positive parts of the normals, by axis: they meet a box's highest corner.
    positive: [[f32; LANES]; 3],
    /// The negative parts: they meet its lowest.
    negative: [[f32; LANES]; 3],
    offset: [f32; LANES],
}

impl Frustum {
    /// `eye` is the camera's relative to what boxes are relative to, off by at most `eye_error` a
    /// coordinate; `bounds` holds all boxes.
    pub(crate) fn new(
        camera: &Camera,
        eye: DVec3,
        eye_error: f64,
        window: &Window,
        bounds: &Box32,
    ) -> Self {
        let (right, up, forward) = (camera.right(), camera.up(), camera.forward());
        let distance = camera.distance();
        // Normals point inwards; each plane holds the point `eye + shift`.
        let planes: [(DVec3, DVec3); LANES] = {
            let none = (DVec3::ZERO, DVec3::ZERO);
            let (left, right_end) = window.across;
            let (bottom, top) = window.along;
            let sides = match camera.projection() {
                Projection::Perspective => [
                    (right * distance - forward * left, DVec3::ZERO),
                    (forward * right_end - right * distance, DVec3::ZERO),
                    (up * distance - forward * bottom, DVec3::ZERO),
                    (forward * top - up * distance, DVec3::ZERO),
                ],
                Projection::Orthographic => [
                    (right, right * left),
                    (-right, right * right_end),
                    (up, up * bottom),
                    (-up, up * top),
                ],
            };
            let [a, b, c, d] = sides;
            [
                a,
                b,
                c,
                d,
                (forward, DVec3::ZERO),
                (-forward, DVec3::ZERO),
                none,
                none,
            ]
        };
        let reach = bounds.min.abs().max(bounds.max.abs()).as_dvec3();
        let mut frustum = Self {
            positive: [[0.0; LANES]; 3],
            negative: [[0.0; LANES]; 3],
            offset: [0.0; LANES],
        };
        for (lane, (normal, shift)) in planes.into_iter().enumerate() {
            let length = normal.length();
            let normal = if length > 0.0 {
                normal / length
            } else {
                normal
            };
            let at = eye + shift;
            let offset = -normal.dot(at);
            // Six products, six sums and the rounding of normal and offset, each by at most 2^-24 of
            // the sum of magnitudes; doubled. The eye's own error, and double rounding, on top.
            let magnitude = normal.abs().dot(reach) + normal.abs().dot(at.abs());
            let slack = magnitude * (32.0 / (1 << 24) as f64) + 3.0 * eye_error;
            frustum.offset[lane] = (offset + slack) as f32;
            for axis in 0..3 {
                let component = normal[axis] as f32;
                frustum.positive[axis][lane] = component.max(0.0);
                frustum.negative[axis][lane] = component.min(0.0);
            }
        }
        frustum
    }

    /// For each of two boxes: how near it begins along the view axis, and whether any of it may
    /// be inside the frustum.
    #[inline(always)]
    pub(crate) fn enter(&self, lanes: impl Lanes, boxes: &BoxPair) -> [(f32, bool); 2] {
        [
            self.enter_one(lanes, boxes, 0),
            self.enter_one(lanes, boxes, 1),
        ]
    }

    #[inline(always)]
    fn enter_one(&self, lanes: impl Lanes, boxes: &BoxPair, which: usize) -> (f32, bool) {
        let mut value = lanes.load(&self.offset);
        for axis in 0..3 {
            let low = lanes.splat(boxes.min[axis][which]);
            let high = lanes.splat(boxes.max[axis][which]);
            let part = lanes.add(
                lanes.mul(lanes.load(&self.positive[axis]), high),
                lanes.mul(lanes.load(&self.negative[axis]), low),
            );
            value = lanes.add(value, part);
        }
        let outside = lanes.bits(lanes.less(value, lanes.splat(0.0))) & SIDES;
        let mut values = [0.0; LANES];
        lanes.store(value, &mut values);
        (-values[NEAREST], outside == 0)
    }
}
