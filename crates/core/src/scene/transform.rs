use crate::math;
use glam::{DAffine3, DQuat, DVec3};

/// An object's transform to its parent: the matrix first, then scale, rotation and translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Translation in the parent's units.
    pub translate: DVec3,
    /// Angles about the x, y and z axes in degrees, applied in that order.
    pub rotate: DVec3,
    /// Factors along the axes; a negative one mirrors.
    pub scale: DVec3,
    /// An affine map before the scale, for files that place meshes by matrices, which need not be products of the
    /// three others.
    pub matrix: DAffine3,
}

impl Transform {
    /// The transform that changes nothing.
    pub const IDENTITY: Self = Self {
        translate: DVec3::ZERO,
        rotate: DVec3::ZERO,
        scale: DVec3::ONE,
        matrix: DAffine3::IDENTITY,
    };

    /// The transform of a matrix; it keeps the matrix to the last bit.
    pub fn from_matrix(matrix: DAffine3) -> Self {
        Self {
            matrix,
            ..Self::IDENTITY
        }
    }

    /// The transform as a map from the object's space to its parent's.
    pub fn parent_from_object(&self) -> DAffine3 {
        let is_matrix = Self {
            matrix: DAffine3::IDENTITY,
            ..*self
        } == Self::IDENTITY;
        if is_matrix {
            return self.matrix;
        }
        // A rotation of zero must not round anything.
        let rotation = if self.rotate == DVec3::ZERO {
            DQuat::IDENTITY
        } else {
            rotation(self.rotate)
        };
        let placed =
            DAffine3::from_scale_rotation_translation(self.scale, rotation, self.translate);
        if self.matrix == DAffine3::IDENTITY {
            placed
        } else {
            placed * self.matrix
        }
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        self.translate.is_finite()
            && self.rotate.is_finite()
            && self.scale.is_finite()
            && self.matrix.is_finite()
    }
}

/// The rotation by angles in degrees about x, then y, then z: q_z · q_y · q_x expanded, each with the sine and cosine
/// of half its angle (Shoemake, "Euler Angle Conversion", Graphics Gems IV, 1994).
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

    #[test]
    fn a_matrix_keeps_its_bits_and_stands_before_the_scale() {
        let matrix = DAffine3::from_cols_array(&[
            0.1, 0.2, -0.0, 1e-300, 0.7, 3.0, 0.3, 1.0, 1e9, 0.1, 0.2, 0.3,
        ]);
        let alone = Transform::from_matrix(matrix);
        let bits = |map: DAffine3| map.to_cols_array().map(f64::to_bits);
        assert_eq!(bits(alone.parent_from_object()), bits(matrix));
        let scaled = Transform {
            scale: DVec3::splat(2.0),
            translate: DVec3::X,
            ..alone
        };
        let point = DVec3::new(1.0, 2.0, 3.0);
        let expected = matrix.transform_point3(point) * 2.0 + DVec3::X;
        let found = scaled.parent_from_object().transform_point3(point);
        assert!(
            (found - expected).length() <= 1e-15 * expected.length(),
            "{found}"
        );
    }
}
