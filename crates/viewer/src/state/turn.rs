//! Rotating an object about one of its own axes or the scene's, with its rotation kept as three angles.

use raycast_core::glam::{DAffine3, DMat3, DVec3};
use raycast_core::math;
use raycast_core::scene::Transform;

/// By how much, and about whose axes, objects are rotated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turning {
    /// The angle in degrees.
    pub degrees: f64,
    /// Whether the axes are the object's own rather than the scene's.
    pub own: bool,
    /// Whether the factors of a scale change together.
    pub keeps_shape: bool,
}

impl Default for Turning {
    fn default() -> Self {
        Self {
            degrees: 90.0,
            own: false,
            keeps_shape: true,
        }
    }
}

/// A transform rotated by so many degrees about `axis`, a unit vector in the parent's space, or in the object's if
/// `own`. The point `middle`, in the object's space, is the centre of rotation.
///
/// A negative scale stays: mirroring is no rotation.
pub fn turned(
    transform: &Transform,
    axis: DVec3,
    own: bool,
    degrees: f64,
    middle: DVec3,
) -> Transform {
    let now = rotation(transform.rotate);
    let turn = about(axis, degrees);
    let rotate = angles(if own { now * turn } else { turn * now });
    let mut next = Transform {
        rotate,
        ..*transform
    };
    let place = |t: &Transform| t.parent_from_object().transform_point3(middle);
    let moved = place(transform) - place(&next);
    if moved.is_finite() {
        next.translate += moved;
    }
    next
}

/// A world axis in the space of a parent. Exact where `world_from_parent` is a rotation with a uniform scale; otherwise
/// the direction that is mapped to that axis.
pub fn axis_in(world_from_parent: &DAffine3, axis: DVec3) -> DVec3 {
    let inner = world_from_parent.matrix3.inverse() * axis;
    inner.try_normalize().unwrap_or(axis)
}

/// The rotation by angles about x, then y, then z in degrees.
pub(super) fn rotation(degrees: DVec3) -> DMat3 {
    let turn = Transform {
        rotate: degrees,
        ..Transform::IDENTITY
    };
    turn.parent_from_object().matrix3
}

/// A rotation about a unit vector (Rodrigues' formula).
fn about(axis: DVec3, degrees: f64) -> DMat3 {
    let (sin, cos) = math::sin_cos(degrees.to_radians());
    let DVec3 { x, y, z } = axis;
    let rest = 1.0 - cos;
    DMat3::from_cols(
        DVec3::new(
            rest * x * x + cos,
            rest * x * y + sin * z,
            rest * x * z - sin * y,
        ),
        DVec3::new(
            rest * x * y - sin * z,
            rest * y * y + cos,
            rest * y * z + sin * x,
        ),
        DVec3::new(
            rest * x * z + sin * y,
            rest * y * z - sin * x,
            rest * z * z + cos,
        ),
    )
}

/// The angles about x, then y, then z in degrees of a rotation (Shoemake, "Euler Angle Conversion", Graphics Gems IV,
/// 1994). Where y is a right angle only the sum or difference of the two others is determined: x is then zero.
pub(super) fn angles(m: DMat3) -> DVec3 {
    let across = (m.x_axis.x * m.x_axis.x + m.x_axis.y * m.x_axis.y).sqrt();
    // Rounding leaves some 1e-14 of a degree: a rotation by 90 is to read 90, and this is below any angle that is
    // entered.
    let tidy = |radians: f64| (radians.to_degrees() * 1e9).round() * 1e-9 + 0.0;
    let y = tidy(math::atan2(-m.x_axis.z, across));
    // Entries are off by some 2⁻⁵²: a cosine within a few of these of zero is that of a right angle.
    let x = if across > 64.0 * f64::EPSILON {
        tidy(math::atan2(m.y_axis.z, m.z_axis.z))
    } else {
        0.0
    };
    // What remains after the rotation about x is undone: near the right angle x is ill-conditioned, and z compensates.
    let (sin, cos) = math::sin_cos(x.to_radians());
    let left = m.y_axis * cos - m.z_axis * sin;
    DVec3::new(x, y, tidy(math::atan2(-left.x, left.y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: &DMat3, b: &DMat3) -> bool {
        let columns = [0, 1, 2].map(|c| a.col(c).distance(b.col(c)));
        columns.iter().all(|distance| *distance < 1e-10)
    }

    #[test]
    fn angles_make_the_rotation_that_they_came_from() {
        for x in [-170.0, -90.0, -1.0, 0.0, 33.0, 90.0, 180.0] {
            for y in [-90.0, -60.0, 0.0, 45.0, 89.9999, 90.0] {
                for z in [-120.0, 0.0, 15.0, 90.0, 179.0] {
                    let whole = rotation(DVec3::new(x, y, z));
                    let again = rotation(angles(whole));
                    assert!(close(&whole, &again), "{x} {y} {z}: {}", angles(whole));
                }
            }
        }
    }

    #[test]
    fn a_turn_is_about_the_axis_that_was_meant_and_keeps_the_middle() {
        let start = Transform {
            translate: DVec3::new(5.0, 1.0, -2.0),
            rotate: DVec3::new(0.0, 0.0, 90.0),
            scale: DVec3::new(2.0, 1.0, 1.0),
            ..Transform::IDENTITY
        };
        let middle = DVec3::new(3.0, 0.5, 0.25);
        let place = |t: &Transform, p: DVec3| t.parent_from_object().transform_point3(p);
        for own in [false, true] {
            let next = turned(&start, DVec3::X, own, 90.0, middle);
            assert!(place(&next, middle).distance(place(&start, middle)) < 1e-12);
            let axis = |t: &Transform| (place(t, middle + DVec3::X) - place(t, middle)) * 0.5;
            // The object's x lies along the scene's y: about its own x that stays, about the scene's it
            // goes to z.
            assert!(axis(&start).distance(DVec3::Y) < 1e-12);
            let there = if own { DVec3::Y } else { DVec3::Z };
            assert!(
                axis(&next).distance(there) < 1e-12,
                "{own}: {}",
                axis(&next)
            );
        }
    }

    #[test]
    fn right_angles_read_as_such() {
        let mut transform = Transform::IDENTITY;
        for _ in 0..4 {
            transform = turned(&transform, DVec3::Y, false, 90.0, DVec3::ONE);
        }
        assert_eq!(transform.rotate, DVec3::ZERO);
        let once = turned(&Transform::IDENTITY, DVec3::Z, true, 90.0, DVec3::ZERO);
        assert_eq!(once.rotate, DVec3::new(0.0, 0.0, 90.0));
    }

    #[test]
    fn the_scenes_axis_within_a_turned_parent() {
        let parent = DAffine3::from_mat3(rotation(DVec3::new(0.0, 0.0, 90.0)));
        assert!(axis_in(&parent, DVec3::Y).distance(DVec3::X) < 1e-15);
        assert_eq!(axis_in(&DAffine3::ZERO, DVec3::Y), DVec3::Y);
    }
}
