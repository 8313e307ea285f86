//! The reference of depth keys: a number that keys are relative to, so that single precision distinguishes depths
//! that are far away and close together.
//!
//! A depth key has 24 bits. Where a scene is thin compared with its distance, as a distant mesh seen through a long
//! lens, the keys of all its triangles round to a few numbers. So set-up subtracts a number close to all keys from
//! each, in double precision, and the interval z-buffer orders the differences. All rays of a packet have one
//! reference: subtracting a constant from two keys keeps their order.
//!
//! So does subtracting any function of the ray. Where layers lie closer together than their depths differ from one end
//! of a packet to the other, the reference becomes the plane of one of them: to that the others are nearly parallel,
//! and what is left of their keys is as small as the layers are thin. Keys relative to a plane are multiplied by a
//! power of two, since layers may be thinner than single precision's least number ([`PLANE_KEY`]).
//!
//! Its exponent has eight bits. The inverse depths of triangles that pass the eye at 10⁻⁴⁰ overflow it, so near such
//! triangles depths are measured in a unit that is many times shorter ([`FURTHEST_KEY`]).

use super::linear::Linear;
use crate::bvh::tree::Box32;
use crate::camera::{Camera, Projection};
use crate::num::exact::power_of_two;
use crate::num::roundoff::EPSILON;
use glam::DVec3;

/// The thickness of the scene, relative to its distance, below which depth keys have a reference: 2⁻¹⁴.
///
/// Above it single precision distinguishes depths well enough, and small triangles, whose keys are computed in single
/// precision, are merged without set-up. Below it those keys, good to 2⁻¹⁹, decide little. With a smaller limit many
/// small triangles would be tested twice; with a greater one ordinary distant meshes would be set up triangle by
/// triangle.
const THIN: f64 = 1.0 / (1 << 14) as f64;

/// The exponent of the keys of the furthest triangles in the unit for those that pass the eye closely: 24 bits above
/// the least normal number, so that they keep their digits. All other numbers up to 2¹²⁸ are for nearer ones: planes
/// that pass the eye at 2⁻¹⁴⁹ and lie along the view have inverse depths of 2²⁰⁰. With a greater exponent those
/// overflow; with a lesser one far triangles lose their order, and leave it to exact arithmetic.
const FURTHEST_KEY: i32 = -102;

/// The factor by which a box must begin beyond hi-z to be skipped. The reciprocal of hi-z and the box's distance are
/// each rounded a few times by 2⁻²⁴, below 10⁻⁶ together. With a greater factor packets visit boxes that are
/// occluded; with one below the rounding hits are lost.
const BEYOND: f32 = 1.0 + 1e-5;

/// Boxes that begin closer to the eye are not skipped: a subnormal number is rounded by more than [`BEYOND`] allows.
/// Any greater limit below the depths of scenes is as good.
const LEAST_NEAR: f32 = 1e-30;

/// The greatest magnitude of a plane's key. Beyond it single precision would not hold differences from it.
const GREATEST_PLANE: f64 = 1e30;

/// The exponent of a plane's own key once it is multiplied. Layers of coordinates about one that are the least number
/// of single precision apart then have relative keys about 2⁻⁹⁰, which is 36 bits above its least normal number. With a
/// greater exponent triangles much nearer than the plane overflow, now those at 2⁻⁶⁸ of its depth; with a lesser one
/// layers of greater coordinates lose their order, and leave it to exact arithmetic.
const PLANE_KEY: i32 = 60;

/// The least and the greatest exponent of a plane's key that is multiplied, so that the factor is a number of single
/// precision.
const MULTIPLIED: std::ops::RangeInclusive<i32> = -60..=60;

/// The difference of two planes' keys, as a share of them, up to which one is the reference where the other would be.
/// With a greater one layers that are as thick keep fewer digits; with a lesser one exact distances are computed again
/// for thick layers.
const CLOSE: f64 = 1.0 / (1 << 16) as f64;

/// The depth key that others are relative to, zero where keys are absolute, and the unit of depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DepthReference {
    /// The reference; of a plane, a lower bound of it.
    key: f32,
    /// The reference; of a plane, an upper bound of it.
    most: f32,
    /// The plane, where that is the reference.
    plane: Option<ReferencePlane>,
    /// The factor of relative keys, a power of two: one unless the reference is a plane.
    factor: f32,
    /// Units of depth to one of the scene's: one, or more where triangles pass the eye closely.
    units: f64,
    /// [`BEYOND`] in the scene's units.
    beyond: f32,
}

/// A triangle's plane as the reference of a packet's depth keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ReferencePlane {
    pub(super) primitive: u32,
    /// Its depth key along the packet's rays, before it is multiplied, and the bound on its error.
    pub(super) key: (Linear, f64),
}

impl ReferencePlane {
    /// Whether it is as good a reference for what lies close to another plane.
    pub(super) fn is_close_to(&self, other: &Self) -> bool {
        let ((key, error), (other, other_error)) = (self.key, other.key);
        key.less(other).reach() <= CLOSE * key.reach() + error + other_error
    }
}

impl DepthReference {
    /// Absolute keys of the scene's own units.
    pub(super) const NONE: Self = Self {
        key: 0.0,
        most: 0.0,
        plane: None,
        factor: 1.0,
        units: 1.0,
        beyond: BEYOND,
    };

    /// The reference for triangles within boxes; boxes and `eye` are relative to the same point. Any number is
    /// correct: only accuracy depends on it.
    pub(super) fn of(boxes: impl Iterator<Item = Box32>, camera: &Camera, eye: DVec3) -> Self {
        let (near, far) = depths(boxes, camera, eye);
        let middle = (near + far) * 0.5;
        // NaN has no reference either.
        if !(near > 0.0 && far - near < THIN * middle) {
            return Self::NONE;
        }
        let key = match camera.projection() {
            Projection::Perspective | Projection::Panoramic(_) => 1.0 / middle,
            Projection::Orthographic => -middle,
        } as f32;
        let key = if key.is_normal() { key } else { 0.0 };
        Self {
            key,
            most: key,
            ..Self::NONE
        }
    }

    /// The unit for triangles that pass the eye so closely that their keys overflow single precision, with others
    /// within boxes.
    pub(super) fn close(boxes: impl Iterator<Item = Box32>, camera: &Camera, eye: DVec3) -> Self {
        let units = units_for(depths(boxes, camera, eye).1);
        Self {
            units,
            beyond: BEYOND / units as f32,
            ..Self::NONE
        }
    }

    /// Whether the unit of depth is the scene's.
    #[inline(always)]
    pub(super) fn is_in_scene_units(self) -> bool {
        self.units == 1.0
    }

    /// The same with a plane as the reference, for a packet whose last ray is in this column and row. `None` where it
    /// has one already, or the key is out of range.
    pub(super) fn with_plane(
        self,
        plane: ReferencePlane,
        (column, row): (f32, f32),
    ) -> Option<Self> {
        let (function, error) = plane.key;
        let steps = [function.x * f64::from(column), function.y * f64::from(row)];
        // Off by a few roundings of its terms besides.
        let error = error + 8.0 * EPSILON * function.reach();
        let least = steps
            .iter()
            .fold(function.constant - error, |sum, step| sum + step.min(0.0));
        let most = steps
            .iter()
            .fold(function.constant + error, |sum, step| sum + step.max(0.0));
        let key = (least as f32).next_down();
        // NaN fails the comparison.
        let is_useful =
            self.plane.is_none() && function.reach() + error < GREATEST_PLANE && key != 0.0;
        let exponent = (function.reach().to_bits() >> 52) as i32 - 1023;
        let is_multiplied = self.is_in_scene_units() && MULTIPLIED.contains(&exponent);
        is_useful.then_some(Self {
            key,
            most: (most as f32).next_up(),
            plane: Some(plane),
            factor: match is_multiplied {
                true => f32::from_bits(((127 + PLANE_KEY - exponent) as u32) << 23),
                false => 1.0,
            },
            ..self
        })
    }

    /// Whether relative keys are multiplied, so that those of much nearer triangles overflow.
    pub(super) fn is_multiplied(self) -> bool {
        self.factor != 1.0
    }

    /// The same without the factor.
    pub(super) fn not_multiplied(self) -> Self {
        Self {
            factor: 1.0,
            ..self
        }
    }

    /// Whether keys are absolute.
    #[inline(always)]
    pub(super) fn is_zero(self) -> bool {
        self.key == 0.0
    }

    /// Whether it is a plane.
    pub(super) fn is_plane(self) -> bool {
        self.plane.is_some()
    }

    /// The triangle whose plane it is.
    pub(super) fn plane(self) -> Option<u32> {
        self.plane.map(|plane| plane.primitive)
    }

    /// The reference along a packet's rays, multiplied by its factor, and the bound on its error: zero unless it is a
    /// plane.
    pub(super) fn function(self) -> (Linear, f64) {
        match self.plane {
            Some(ReferencePlane {
                key: (function, error),
                ..
            }) => (function.times(self.factor()), error * self.factor()),
            None => {
                let constant = Linear {
                    constant: self.key.into(),
                    x: 0.0,
                    y: 0.0,
                };
                (constant, 0.0)
            }
        }
    }

    /// The factor of relative keys, a power of two.
    pub(super) fn factor(self) -> f64 {
        self.factor.into()
    }

    /// Units of depth to one of the scene's, a power of two.
    pub(super) fn units(self) -> f64 {
        self.units
    }

    /// Bounds of the relative keys of an absolute key of zero.
    #[inline(always)]
    pub(super) fn relative_zero(self) -> [f32; 2] {
        [0.0 - self.most * self.factor, 0.0 - self.key * self.factor]
    }

    /// The absolute key of a relative one, or a lower bound of it, rounded once: what underflows is far below `key`'s
    /// last digit.
    #[inline(always)]
    pub(super) fn absolute(self, key: f32) -> f32 {
        key / self.factor + self.key
    }

    /// An upper bound of a relative key: the difference is off by half a unit in the last place, and is moved up by
    /// four.
    #[inline(always)]
    pub(super) fn relative_above(self, key: f32) -> f32 {
        if self.is_zero() {
            return key;
        }
        let relative = (key - self.key) * self.factor;
        relative + relative.abs() * (4.0 * f32::EPSILON)
    }

    /// An upper bound of the relative depth key of a box that begins at `near` along the view axis.
    #[inline(always)]
    pub(super) fn key_of_box(self, projection: Projection, near: f32) -> f32 {
        let key = match projection {
            Projection::Orthographic => near.abs() * (BEYOND - 1.0) - near,
            _ if near > LEAST_NEAR => self.beyond / near,
            _ => f32::INFINITY,
        };
        self.relative_above(key)
    }

    /// How far along the view axis a box may begin and still contain something nearer than `hi_z`, a relative key.
    #[inline(always)]
    pub(super) fn furthest(self, projection: Projection, hi_z: f32) -> f32 {
        let hi_z = self.absolute(hi_z);
        match projection {
            Projection::Orthographic => -hi_z + hi_z.abs() * (BEYOND - 1.0),
            // The depth key is the inverse depth.
            _ if hi_z > 0.0 => (self.beyond / hi_z).max(LEAST_NEAR),
            _ => f32::INFINITY,
        }
    }
}

/// The least and the greatest depth within boxes, which are relative to the same point as the eye.
fn depths(boxes: impl Iterator<Item = Box32>, camera: &Camera, eye: DVec3) -> (f64, f64) {
    let forward = camera.forward();
    let (mut near, mut far) = (f64::INFINITY, f64::NEG_INFINITY);
    for bounds in boxes {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let middle = ((min + max) * 0.5 - eye).dot(forward);
        let half = ((max - min) * 0.5).dot(forward.abs());
        near = near.min(middle - half);
        far = far.max(middle + half);
    }
    (near, far)
}

/// Units of depth to one of the scene's, by which the keys of triangles at `far` are about 2^[`FURTHEST_KEY`].
fn units_for(far: f64) -> f64 {
    // Zero and what is behind the eye have the least exponent.
    let exponent = (far.max(0.0).to_bits() >> 52) as i32 - 1023;
    // Of numbers beyond 2¹²⁶ single precision does not hold the reciprocal.
    let power = (-FURTHEST_KEY - exponent).clamp(0, 126);
    power_of_two(power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Pose};
    use crate::random::Random;
    use glam::Vec3;

    fn reference(side: f32, eye: DVec3, projection: Projection) -> DepthReference {
        let plane = ImagePlane::new(8, 8, 0.1).expect("a good plane");
        let pose = Pose {
            eye,
            target: DVec3::ZERO,
            up: DVec3::Y,
        };
        let camera = Camera::new(pose, projection, plane);
        let bounds = Box32 {
            min: Vec3::splat(-side),
            max: Vec3::splat(side),
        };
        DepthReference::of([bounds].into_iter(), &camera, eye)
    }

    #[test]
    fn scenes_thin_compared_with_their_distance_have_a_reference_close_to_their_keys() {
        let eye = DVec3::new(0.0, 0.0, 8.0);
        let thin = |projection| reference(1e-5, eye, projection).key;
        assert_eq!(thin(Projection::Perspective), 0.125);
        assert_eq!(thin(Projection::Orthographic), -8.0);
        for projection in [Projection::Perspective, Projection::Orthographic] {
            assert!(reference(1e-2, eye, projection).is_zero());
            // The box contains the eye.
            assert!(reference(1e-5, DVec3::Z * 1e-6, projection).is_zero());
            assert!(reference(f32::NAN, eye, projection).is_zero());
            // The key underflows, or overflows, single precision.
            assert!(reference(1.0, DVec3::Z * 1e40, projection).is_zero());
        }
    }

    /// The start of a box is itself off by some roundings. A box at the depth of hi-z, or nearer, is never skipped,
    /// with or without a reference; without [`BEYOND`] this fails.
    #[test]
    fn boxes_as_near_as_hi_z_are_not_occluded() {
        let mut random = Random(73);
        for round in 0..20_000 {
            let near = (0.5 + 7.5 * random.unit()) as f32;
            let off = near * (1.0 + 4.0 * f32::EPSILON * random.signed() as f32);
            for projection in [Projection::Perspective, Projection::Orthographic] {
                let exact = match projection {
                    Projection::Orthographic => -f64::from(near),
                    _ => 1.0 / f64::from(near),
                };
                let near_it = (exact * (1.0 + 1e-5 * random.signed())) as f32;
                let reference = DepthReference {
                    key: if round % 2 == 0 { 0.0 } else { near_it },
                    ..DepthReference::NONE
                };
                // A hit there surely has at least the key below its exact one.
                let relative = exact - f64::from(reference.key);
                let hi_z = (relative as f32).next_down();
                assert!(reference.furthest(projection, hi_z) >= off);
                assert!(reference.key_of_box(projection, off) >= hi_z);
            }
        }
    }

    /// With the ordinary and with the short unit of depth.
    #[test]
    fn boxes_at_subnormal_depths_are_not_occluded() {
        let close = DepthReference {
            units: units_for(1e-45),
            ..DepthReference::NONE
        };
        for reference in [close, DepthReference::NONE] {
            for near in [f32::from_bits(1), 1e-40, 1e-31] {
                let key = reference.key_of_box(Projection::Perspective, near);
                assert_eq!(key, f32::INFINITY);
                assert!(reference.furthest(Projection::Perspective, f32::MAX) >= near);
            }
        }
    }

    #[test]
    fn keys_of_far_triangles_are_normal_numbers_in_any_unit() {
        for exponent in -140..100 {
            let far = crate::math::pow(2.0, f64::from(exponent)) * 1.5;
            let units = units_for(far);
            let key = (1.0 / (far * units)) as f32;
            assert!(key.is_normal() && (1.0 / units as f32).is_normal(), "{far}");
            let is_limited = !(FURTHEST_KEY + 126..=-FURTHEST_KEY).contains(&exponent);
            assert!(
                is_limited || key <= crate::math::pow(2.0, -102.0) as f32,
                "{far}"
            );
        }
        for far in [0.0, -1.0, f64::NEG_INFINITY] {
            assert_eq!(units_for(far), (1u128 << 126) as f64);
        }
        assert_eq!(units_for(1.0), (1u128 << 102) as f64);
    }

    #[test]
    fn relative_upper_bounds_are_not_below() {
        let reference = DepthReference {
            key: 0.3,
            ..DepthReference::NONE
        };
        for key in [
            0.3f32,
            0.3f32.next_up(),
            0.1,
            7.0,
            1e-30,
            0.0,
            3e9,
            f32::INFINITY,
        ] {
            let exact = f64::from(key) - f64::from(reference.key);
            assert!(f64::from(reference.relative_above(key)) >= exact, "{key}");
        }
        let none = DepthReference::NONE;
        assert_eq!(none.relative_above(0.7), 0.7);
    }

    /// What is nearer than a relative key along some ray of the packet is neither skipped nor occluded.
    #[test]
    fn bounds_of_a_plane_hold_along_all_rays() {
        let mut random = Random(74);
        for round in 0..5000 {
            let slope = 0.1f64.powi((random.unit() * 8.0) as i32);
            let plane = Linear {
                constant: 1.0 + random.unit(),
                x: 0.01 * slope * random.signed(),
                y: 0.01 * slope * random.signed(),
            };
            let off = [0.0, 1e-4][round % 2];
            let of = |key: (Linear, f64)| ReferencePlane { primitive: 7, key };
            let known = of((plane, off));
            let reference = DepthReference::NONE.with_plane(known, (31.0, 15.0));
            let reference = reference.expect("in range");
            assert_eq!(reference.with_plane(known, (31.0, 31.0)), None);
            assert!(reference.is_plane() && !reference.is_zero());
            let factor = reference.factor();
            assert_eq!(reference.plane(), Some(7));
            assert_eq!(reference.function(), (plane.times(factor), off * factor));
            let [in_front, behind] = reference.relative_zero();
            for at in 0..32 * 16 {
                let (column, row) = (f64::from(at % 32), f64::from(at / 32));
                let here = plane.constant + plane.x * column + plane.y * row;
                let here = here + off * random.signed();
                let at_zero = -here * factor;
                assert!(f64::from(in_front) < at_zero && at_zero < f64::from(behind));
                let near = (0.5 + random.unit()) as f32;
                let key = 1.0 / f64::from(near);
                let relative = (key - here) * factor;
                let above = reference.key_of_box(Projection::Perspective, near);
                assert!(f64::from(above) >= relative);
                let hi_z = (relative as f32).next_down();
                assert!(reference.furthest(Projection::Perspective, hi_z) >= near);
            }
        }
        let huge = Linear {
            constant: 1e31,
            x: f64::NAN,
            y: 0.0,
        };
        let huge = ReferencePlane {
            primitive: 7,
            key: (huge, 0.0),
        };
        assert_eq!(DepthReference::NONE.with_plane(huge, (31.0, 31.0)), None);
    }
}
