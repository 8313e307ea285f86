//! Frusta against boxes: four sides, the plane through the eye, and the nearest depth of a box.

use super::params::CELLS;
use crate::bvh::tree::{Box32, BoxPair};
use crate::camera::{Camera, Projection};
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use glam::DVec3;

/// The index of the plane whose value is the nearest depth of a box, negated.
const NEAREST: usize = 5;
/// The planes that cull boxes, as bits.
const SIDES: u32 = 0b1_1111;

/// The least positive number of single precision, 2⁻¹⁴⁹.
const LEAST_SUBNORMAL: f64 = f32::from_bits(1) as f64;

/// A rectangle of the image plane, in scene units from the view axis at the target; [`Camera::direction`] is
/// linear in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    /// Least and greatest coordinate to the right.
    pub(crate) across: (f64, f64),
    /// Least and greatest coordinate upwards.
    pub(crate) along: (f64, f64),
}

impl Window {
    /// The window enlarged by this on each side.
    pub(super) fn grown(&self, by: f64) -> Self {
        let grown = |(least, most): (f64, f64)| (least - by, most + by);
        Self {
            across: grown(self.across),
            along: grown(self.along),
        }
    }
}

/// Eight planes with normals that point inwards.
///
/// A plane's value at a box is the maximum over the box of N·p + c, at the corner furthest along N (Greene, "Detecting
/// Intersection of a Rectangular Solid and a Convex Polyhedron", Graphics Gems IV, 1994). c includes slack for
/// rounding, so that the value is never below the true maximum: a negative value proves the box outside.
#[derive(Clone, Debug)]
struct Planes {
    /// Positive parts of the normals by axis; they multiply a box's greatest corner.
    positive: [[f32; LANES]; 3],
    /// Negative parts of the normals; they multiply the box's least corner.
    negative: [[f32; LANES]; 3],
    offset: [f32; LANES],
}

/// The point that planes are seen from.
#[derive(Clone, Copy)]
pub(super) struct Viewpoint<'a> {
    pub(super) camera: &'a Camera,
    /// The camera's eye, relative to the point that boxes are relative to.
    pub(super) eye: DVec3,
    /// Bound on the error of its coordinates.
    pub(super) eye_error: f64,
    /// A box around all boxes.
    pub(super) bounds: &'a Box32,
}

/// A normal, and a point of the plane relative to the eye.
type FrustumPlane = (DVec3, DVec3);

impl Planes {
    fn new(from: Viewpoint<'_>, planes: [FrustumPlane; LANES]) -> Self {
        let reach = from.bounds.min.abs().max(from.bounds.max.abs()).as_dvec3();
        let mut all = Self {
            positive: [[0.0; LANES]; 3],
            negative: [[0.0; LANES]; 3],
            offset: [0.0; LANES],
        };
        for (lane, (normal, shift)) in planes.into_iter().enumerate() {
            let at = from.eye + shift;
            let offset = -normal.dot(at);
            // With u = 2⁻²⁴: six products, six sums, and the rounding of normal and offset, each at most u of the sum of
            // magnitudes: below 16u, doubled. Of numbers too small for that, components of the normal are off by half of the
            // least subnormal number, and the products and the offset by that once each: ½ Σ reach + 3½ such numbers,
            // doubled. The eye's own error, doubled for rounding, is added.
            let magnitude = normal.abs().dot(reach) + normal.abs().dot(at.abs());
            let slack = magnitude * (32.0 / (1 << 24) as f64)
                + (reach.element_sum() + 8.0) * LEAST_SUBNORMAL
                + normal.abs().element_sum() * 2.0 * from.eye_error;
            all.offset[lane] = (offset + slack) as f32;
            for axis in 0..3 {
                let component = normal[axis] as f32;
                all.positive[axis][lane] = component.max(0.0);
                all.negative[axis][lane] = component.min(0.0);
            }
        }
        all
    }

    /// The values of the planes at one of two boxes.
    #[inline(always)]
    fn values<L: Lanes>(&self, lanes: L, boxes: &BoxPair, which: usize) -> L::F32 {
        let mut values = lanes.load(&self.offset);
        for axis in 0..3 {
            let low = lanes.splat(boxes.min[axis][which]);
            let high = lanes.splat(boxes.max[axis][which]);
            let part =
                lanes.load(&self.positive[axis]) * high + lanes.load(&self.negative[axis]) * low;
            values = values + part;
        }
        values
    }
}

impl Viewpoint<'_> {
    /// The planes through the rays at a coordinate to the right: the one that bounds what lies right of it, and the
    /// one for what lies left of it.
    fn beside(&self, across: f64) -> [FrustumPlane; 2] {
        self.through(self.camera.right(), across)
    }

    /// The planes through the rays at a coordinate upwards: the one that bounds what lies above it, and the one for
    /// what lies below it.
    fn above(&self, along: f64) -> [FrustumPlane; 2] {
        self.through(self.camera.up(), along)
    }

    fn through(&self, axis_in_world: DVec3, place: f64) -> [FrustumPlane; 2] {
        let (normal, shift) = match self.camera.projection() {
            Projection::Perspective | Projection::Panoramic(_) => {
                let normal = axis_in_world * self.camera.distance() - self.camera.forward() * place;
                (normal.normalize_or_zero(), DVec3::ZERO)
            }
            Projection::Orthographic => (axis_in_world, axis_in_world * place),
        };
        [(normal, shift), (-normal, shift)]
    }
}

/// The points in front of the camera on rays through a window.
#[derive(Clone, Debug)]
pub(super) struct Frustum(Planes);

impl Frustum {
    pub(super) fn new(from: Viewpoint<'_>, window: &Window) -> Self {
        let ([left, _], [_, right]) = (from.beside(window.across.0), from.beside(window.across.1));
        let ([bottom, _], [_, top]) = (from.above(window.along.0), from.above(window.along.1));
        let forward = from.camera.forward();
        let (front, nearest) = ((forward, DVec3::ZERO), (-forward, DVec3::ZERO));
        let none = (DVec3::ZERO, DVec3::ZERO);
        Self(Planes::new(
            from,
            [left, right, bottom, top, front, nearest, none, none],
        ))
    }

    /// For each of two boxes: its nearest depth along the view axis, and whether it may touch the frustum.
    #[inline(always)]
    pub(super) fn enter(&self, lanes: impl Lanes, boxes: &BoxPair) -> [(f32, bool); 2] {
        [
            self.enter_one(lanes, boxes, 0),
            self.enter_one(lanes, boxes, 1),
        ]
    }

    #[inline(always)]
    fn enter_one(&self, lanes: impl Lanes, boxes: &BoxPair, which: usize) -> (f32, bool) {
        let value = self.0.values(lanes, boxes, which);
        let outside = value.lt(lanes.splat(0.0)).bits() & SIDES;
        let mut values = [0.0; LANES];
        value.store(&mut values);
        (-values[NEAREST], outside == 0)
    }
}

/// The frusta of a packet's four columns of cells, and of its four rows.
#[derive(Clone, Debug)]
pub(super) struct CellFrusta {
    columns: Planes,
    rows: Planes,
}

impl CellFrusta {
    /// `diagonal` are the windows of the cells on the packet's diagonal.
    pub(super) fn new(from: Viewpoint<'_>, diagonal: &[Window; CELLS]) -> Self {
        let mut columns = [(DVec3::ZERO, DVec3::ZERO); LANES];
        let mut rows = columns;
        for (cell, window) in diagonal.iter().enumerate() {
            columns[cell] = from.beside(window.across.0)[0];
            columns[cell + CELLS] = from.beside(window.across.1)[1];
            rows[cell] = from.above(window.along.0)[0];
            rows[cell + CELLS] = from.above(window.along.1)[1];
        }
        Self {
            columns: Planes::new(from, columns),
            rows: Planes::new(from, rows),
        }
    }

    /// The cells whose frusta one of two boxes may touch, as bits, row by row.
    #[inline(always)]
    pub(super) fn touched(&self, lanes: impl Lanes, boxes: &BoxPair, which: usize) -> u32 {
        let zero = lanes.splat(0.0);
        let columns = self.columns.values(lanes, boxes, which).lt(zero);
        let rows = self.rows.values(lanes, boxes, which).lt(zero);
        let (columns, rows) = (columns.bits(), rows.bits());
        let columns = !(columns | columns >> CELLS) & 0xf;
        let rows = !(rows | rows >> CELLS) & 0xf;
        // A row's bit at the start of its four cells, times the four columns.
        let spread = (rows & 1) | (rows & 2) << 3 | (rows & 4) << 6 | (rows & 8) << 9;
        columns * spread
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Orbit, Pose};
    use crate::num::simd::Plain;
    use crate::packet::params::{ROW, SIDE};
    use crate::scene::Bounds;
    use glam::Vec3;

    #[test]
    fn boxes_touch_the_cells_whose_rays_go_through_them() {
        let orbit = Orbit {
            pivot: DVec3::new(3.0, -2.0, 5.0),
            yaw: 40.0,
            pitch: -25.0,
            distance: 4.0,
        };
        let plane = ImagePlane::new(SIDE as u32, SIDE as u32, 0.05).expect("a good plane");
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = Camera::new(orbit.pose(), projection, plane);
            let reach = Box32 {
                min: Vec3::splat(-20.0),
                max: Vec3::splat(20.0),
            };
            let from = Viewpoint {
                camera: &camera,
                eye: orbit.pose().eye,
                eye_error: 0.0,
                bounds: &reach,
            };
            let window = |cell: usize| {
                let (first, last) = ((cell * ROW) as f64, (cell * ROW + ROW - 1) as f64);
                let (left, top) = camera.across_and_along(first, first);
                let (right, bottom) = camera.across_and_along(last, last);
                Window {
                    across: (left, right),
                    along: (bottom, top),
                }
            };
            let cells = CellFrusta::new(from, &std::array::from_fn(window));
            let at = |x: f64, y: f64| {
                let ray = camera.ray(x, y);
                let depth = ray.direction.dot(camera.forward());
                (ray.origin + ray.direction * (6.0 / depth)).as_vec3()
            };
            let touched = |min: Vec3, max: Vec3| {
                let one = Box32 { min, max };
                cells.touched(Plain, &BoxPair::of([one, one]), 1)
            };
            for y in 0..SIDE {
                for x in 0..SIDE {
                    let point = at(x as f64, y as f64);
                    let own = 1 << (y / ROW * CELLS + x / ROW);
                    assert_eq!(touched(point, point), own, "{x} {y} {projection:?}");
                }
            }
            let between = at(7.5, 3.0);
            assert_eq!(touched(between, between), 0, "no ray's");
            let (a, b) = (at(10.0, 12.0), at(21.0, 20.0));
            let around = touched(a.min(b), a.max(b));
            assert_eq!(around & 0x0660, 0x0660, "all between its corners");
            assert_eq!(touched(reach.min, reach.max), 0xffff);
        }
    }

    /// The camera's right has a part of 10⁻⁵⁸, which single precision has not; times 10¹⁸ it is as much as the box is high.
    #[test]
    fn a_normal_below_single_precision_loses_no_box() {
        let pose = Pose {
            eye: DVec3::new(
                4.999999999999893e17,
                4.999999999999893e17,
                4.999999999999893e-41,
            ),
            target: DVec3::new(5e17, 5e17, 5e-41),
            up: DVec3::Y,
        };
        let plane = ImagePlane::new(2, 1, 1e-13).expect("a good plane");
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let around = Box32 {
            min: Vec3::ZERO,
            max: Vec3::new(1e18, 1e18, 1e-40),
        };
        let from = Viewpoint {
            camera: &camera,
            eye: pose.eye,
            eye_error: 0.0,
            bounds: &around,
        };
        let small = camera.right().x.abs();
        assert!(small > 0.0 && small < LEAST_SUBNORMAL && small * 1e18 > 1e-41);
        let (left, top) = camera.across_and_along(0.0, 0.0);
        let (right, _) = camera.across_and_along(1.0, 0.0);
        let window = Window {
            across: (left, right),
            along: (top, top),
        };
        let frustum = Frustum::new(from, &window);
        // The eye is in the box.
        let [(_, is_touched), _] = frustum.enter(Plain, &BoxPair::of([around, around]));
        assert!(is_touched);
    }

    /// The eye that planes are made from may be off by its error: boxes that rays of the true eye go through are
    /// touched.
    #[test]
    fn an_eye_that_is_off_loses_no_box() {
        let plane = ImagePlane::new(SIDE as u32, SIDE as u32, 0.05).expect("a good plane");
        let orbit = Orbit {
            pivot: DVec3::ZERO,
            yaw: 40.0,
            pitch: -25.0,
            distance: 4.0,
        };
        let reach = Box32 {
            min: Vec3::splat(-20.0),
            max: Vec3::splat(20.0),
        };
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = Camera::new(orbit.pose(), projection, plane);
            for corner in Bounds::around([DVec3::NEG_ONE, DVec3::ONE]).corners() {
                let from = Viewpoint {
                    camera: &camera,
                    eye: orbit.pose().eye + corner * 0.01,
                    eye_error: 0.01,
                    bounds: &reach,
                };
                let last = (SIDE - 1) as f64;
                let (left, top) = camera.across_and_along(0.0, 0.0);
                let (right, bottom) = camera.across_and_along(last, last);
                let window = Window {
                    across: (left, right),
                    along: (bottom, top),
                };
                let frustum = Frustum::new(from, &window);
                for (x, y) in [(0.0, 0.0), (last, 0.0), (0.0, last), (last, last)] {
                    let point = camera.ray(x, y).at(6.0).as_vec3();
                    let one = Box32 {
                        min: point,
                        max: point,
                    };
                    let [_, (_, is_touched)] = frustum.enter(Plain, &BoxPair::of([one, one]));
                    assert!(
                        is_touched,
                        "{projection:?}: ({x}, {y}), eye off by {corner}"
                    );
                }
            }
        }
    }
}
