use crate::math;
use glam::{DAffine3, DQuat, DVec3};

/// Where an object stands in its parent: scaled first, then rotated, then translated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Translation in the parent's units.
    pub translate: DVec3,
    /// Angles about the x, y and z axes in degrees, x first, then y, then z.
    pub rotate: DVec3,
    /// Factors along the axes; a negative one mirrors.
    pub scale: DVec3,
}

impl Transform {
    /// The transform that changes nothing.
    pub const IDENTITY: Self = Self {
        translate: DVec3::ZERO,
        rotate: DVec3::ZERO,
        scale: DVec3::ONE,
    };

    /// The transform as a map from the object's space to its parent's.
    pub fn parent_from_object(&self) -> DAffine3 {
        // A rotation of zero must not round anything.
        let rotation = if self.rotate == DVec3::ZERO {
            DQuat::IDENTITY
        } else {
            rotation(self.rotate)
        };
        DAffine3::from_scale_rotation_translation(self.scale, rotation, self.translate)
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        self.translate.is_finite() && self.rotate.is_finite() && self.scale.is_finite()
    }
}

/// The rotation by angles in degrees about x, then y, then z: q_z · q_y · q_x, multiplied out, each a
/// half angle's sine and cosine (Shoemake, "Euler Angle Conversion", Graphics Gems IV, 1994).
fn rotation(degrees: DVec3) -> DQuat {
    let half = |degrees: f64| math::sin_cos(degrees.to_radians() * 0.5);
    let (sin_x, cos_x) = half(degrees.x);
    let (sin_y, cos_y) = half(degrees.y);
    let (sin_z, cos_z) = half(degrees.z);
    DQuat::from_xyzw(
        cos_y * (cos_z * sin_x) - sin_y * (sin_z * cos_x),
        cos_y * (sin_z * sin_x) + sin_y * (cos_z * cos_x),
        cos_y * (sin_z * cos_x) - sin_y * (cos_z * sin_x),
        cos_y * (cos_z * cos_x) + sin_y * (sin_z * sin_x),
    )
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotates_about_x_before_y_before_z() {
        let transform = Transform {
            rotate: DVec3::new(90.0, 90.0, 0.0),
            ..Transform::IDENTITY
        };
        // +Y goes to +Z about x, and +Z to +X about y.
        let moved = transform.parent_from_object().transform_vector3(DVec3::Y);
        assert!((moved - DVec3::X).length() < 1e-15, "{moved}");
    }
}
