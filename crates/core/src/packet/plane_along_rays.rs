//! Clipping planes along the rays of a packet that start at one eye.
//!
//! At depth z along a ray of direction d(i, j), D deep, a plane's function is g + z·n·d(i, j)/D, with g = n·eye − c. So
//! it has the sign of D·g/z + n·d(i, j): a multiple of the depth key, and a linear function of the ray's place. Next to
//! the eye, where the mean of the values at a triangle's corners is a small difference of great numbers, this sign is
//! sure: if the eye lies on the plane, it goes by the ray alone.
//!
//! # Error bound
//! u = 2⁻²⁴. The depth key is off by κ and at most K in its triangle's bounds, relative to its reference ρ, which becomes
//! a part of the linear function. That has the magnitude N, and is evaluated within [`LINEAR_ERROR`]·N; to this comes the
//! error of products with directions ([`componentwise_setup`](super::componentwise_setup)). The factor of the key, its
//! product, and the sum are rounded once each: with G the factor, 3u·G·K + u·(G·K + N), to which come G·κ and the error of
//! g by K + κ + ρ. All is divided by G·K + N, so that single precision's range holds it.
//!
//! Where the sum is close to zero G·K and N are equal, and 4u·G·K is a twelfth of what evaluation takes: no test shows
//! it.

use super::setup::{LINEAR_ERROR, Linear, PacketSpace, REACH};
use crate::num::roundoff::EPSILON;
use crate::num::roundoff::U;
use crate::triangle::clip::AtEye;

/// The greatest K, and the greatest factor of the key. Beyond them the factor would leave the normal numbers of single
/// precision: keys that are all next to zero want a huge one.
const GREATEST_KEY: f64 = 1e30;
const GREATEST_FACTOR: f64 = 1e30;

/// A plane's function along a packet's rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneAlongRays {
    /// n·d(i, j), and what rays' directions move it by.
    function: Linear,
    error: f64,
    /// G, and the bound on its error.
    by_key: f64,
    by_key_error: f64,
    /// ρ.
    reference: Linear,
}

/// The same over the bounds of a triangle, for the triangle's depth key.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneAtKey {
    /// The linear function: the value at the triangle's first ray, and the steps per column and row.
    pub(super) function: [f32; 3],
    pub(super) by_key: f32,
    /// NaN or infinite where nothing is sure.
    pub(super) error: f32,
}

impl PacketSpace {
    /// A plane's function along the packet's rays.
    pub(super) fn along_rays(&self, plane: &AtEye) -> PlaneAlongRays {
        let (d, [a, b], n) = (self.rays.direction, self.rays.steps, plane.normal);
        let depth = self.rays.distance * self.units / self.key_factor;
        let by_key = plane.value * depth;
        PlaneAlongRays {
            function: Linear {
                constant: d.dot(n),
                x: a.dot(n),
                y: b.dot(n),
            },
            error: self.rays.error.dot(n.abs()) + by_key.abs() * self.reference_error,
            by_key,
            by_key_error: (plane.error + 4.0 * EPSILON * plane.value.abs()) * depth,
            reference: self.reference,
        }
    }
}

impl PlaneAtKey {
    /// Nothing is sure.
    pub(super) const UNKNOWN: Self = Self {
        function: [0.0; 3],
        by_key: 0.0,
        error: f32::INFINITY,
    };
}

impl PlaneAlongRays {
    /// For a triangle's depth key, which is off by `key_error`; its first ray lies in column `i` and row `j`.
    pub(super) fn at_key(&self, key: [f32; 3], key_error: f32, (i, j): (f64, f64)) -> PlaneAtKey {
        let [constant, x, y] = key.map(f64::from);
        let greatest = constant.abs() + REACH * (x.abs() + y.abs());
        // NaN fails this.
        let is_in_range = greatest < GREATEST_KEY;
        if !is_in_range {
            return PlaneAtKey::UNKNOWN;
        }
        let Linear { constant, x, y } = self.function;
        let reference = self.reference.times(self.by_key);
        let (x, y) = (x + reference.x, y + reference.y);
        let constant = (constant + reference.constant) + x * i + y * j;
        let size = constant.abs() + REACH * (x.abs() + y.abs());
        let (key_error, by_key) = (f64::from(key_error), self.by_key.abs());
        let error = by_key * (key_error + 4.0 * U * greatest)
            + self.by_key_error * (greatest + key_error + self.reference.reach())
            + size * (LINEAR_ERROR + U)
            + self.error;
        // The terms of the sum may be greater than it.
        let size = size + by_key * (greatest + 2.0 * self.reference.reach());
        let unit = 1.0 / size;
        let factor = self.by_key * unit;
        // NaN fails this too.
        let is_in_range = factor.abs() < GREATEST_FACTOR;
        if !is_in_range {
            return PlaneAtKey::UNKNOWN;
        }
        PlaneAtKey {
            function: [constant, x, y].map(|number| (number * unit) as f32),
            by_key: factor as f32,
            error: ((error + size * 1e-12) * unit * 1.01) as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::depth_reference::{DepthReference, ReferencePlane};
    use super::super::setup_tests::space;
    use super::*;
    use crate::camera::{Camera, ImagePlane, Pose, Projection};
    use crate::hit::Cull;
    use crate::random::Random;
    use glam::DVec3;

    /// Keys that are all next to zero: their factor is at most its limit, or nothing is sure. At 1e-39 single precision
    /// cannot hold it.
    #[test]
    fn factors_of_tiny_keys_stay_within_single_precision() {
        let plane = ImagePlane::new(32, 32, 0.02).expect("a good plane");
        let pose = Pose::towards(DVec3::ZERO, -DVec3::Z);
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let space = space(&camera, DVec3::ZERO, Cull::None);
        // Far from the plane, so that keys outweigh directions.
        let along = space.along_rays(&AtEye {
            normal: DVec3::X,
            value: 1e40,
            error: 0.0,
        });
        let (mut known, mut unknown) = (0, 0);
        for exponent in 0..46 {
            let key = crate::math::pow(10.0, -f64::from(exponent)) as f32;
            let found = along.at_key([key, 0.0, 0.0], key * 1e-7, (15.5, 15.5));
            assert!(found.by_key.abs() <= GREATEST_FACTOR as f32, "{found:?}");
            match found.error < 1.0 {
                true => known += 1,
                false => unknown += 1,
            }
        }
        assert!(known > 10 && unknown > 5, "{known} {unknown}");
    }

    /// The truth is the plane's function at points of known depth along the camera's rays, of which the eye is on the
    /// plane or a given distance beside it.
    #[test]
    fn planes_along_rays_have_the_sign_of_their_points() {
        let mut random = Random(83);
        let (mut sure, mut close) = (0, 0);
        for round in 0..6000 {
            // Narrow views, too, in which directions are rounded by more than they differ.
            let pitch = 0.02 * 0.1f64.powi((random.unit() * 12.0) as i32);
            let plane = ImagePlane::new(32, 32, pitch).expect("a good plane");
            let eye = random.point();
            let pose = Pose::towards(eye, eye + random.point().normalize());
            let camera = Camera::new(pose, Projection::Perspective, plane);
            let space = space(&camera, DVec3::ZERO, Cull::None);
            let (column, row) = (
                (random.unit() * 31.0).floor(),
                (random.unit() * 31.0).floor(),
            );
            let ray = camera.ray(column + 0.5, row + 0.5);
            let depth = 0.1f64.powi((random.unit() * 18.0) as i32);
            let along = ray.direction * (depth / ray.direction.dot(camera.forward()));
            // A plane through the eye, through the point, or between them; nearly parallel to the ray at times.
            let normal = match round / 20 % 2 {
                0 => random.point(),
                _ => random.point().cross(ray.direction) + random.point() * 1e-6,
            };
            let share = [0.0, 0.5, 1.0, 1e-7, 1e7][round % 5];
            let value = -normal.dot(along) * share;
            let truth = value + normal.dot(along);
            let error = value.abs() * [0.0, 1e-3][round / 5 % 2];
            let at_eye = AtEye {
                normal,
                value: value + error * random.signed().signum(),
                error,
            };
            let off = [U, 1e-4][round / 10 % 2];
            let key = (1.0 + off * random.signed()) / depth;
            // Keys are relative to nothing, or to the plane of a layer that may lie close by.
            let (space, reference, factor) = match round / 40 % 2 {
                0 => (space, 0.0, 1.0),
                _ => {
                    let mut slope = || random.signed() * 0.01 / depth;
                    let plane = Linear {
                        constant: [0.5, 0.9999][round / 80 % 2] / depth,
                        x: slope(),
                        y: slope(),
                    };
                    // The reference is off by as much as is said.
                    let error = [0.0, 1e-3][round / 160 % 2] / depth;
                    let here = plane.constant + plane.x * column + plane.y * row;
                    let plane = ReferencePlane {
                        primitive: 0,
                        key: (plane, error),
                    };
                    let reference = DepthReference::NONE.with_plane(plane, (31.0, 31.0));
                    let reference = reference.expect("a key in range");
                    let space = space.relative_to(reference);
                    (space, here + error * random.signed(), reference.factor())
                }
            };
            let key = [((key - reference) * factor) as f32, 0.0, 0.0];
            let key_error = ((off + 2.0 * U) / depth * factor) as f32;
            let (i, j) = ((column / 2.0).floor(), (row / 2.0).floor());
            let found = space.along_rays(&at_eye).at_key(key, key_error, (i, j));
            let [constant, x, y] = found.function;
            let place = constant + x * (column - i) as f32 + y * (row - j) as f32;
            let value = found.by_key * key[0] + place;
            if share == 1.0 {
                // The point lies on the plane except for rounding.
                assert!(value.abs() <= found.error, "{value} {found:?}");
                close += 1;
            } else if value.abs() > found.error {
                assert_eq!(value > 0.0, truth > 0.0, "{value} {truth} {found:?}");
                sure += 1;
            }
        }
        assert!(sure > 2500 && close > 1000, "{sure} {close}");
    }
}
