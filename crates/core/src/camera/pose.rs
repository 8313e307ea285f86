use glam::DVec3;

/// The position and orientation of a camera, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The eye.
    pub eye: DVec3,
    /// The point on the view axis at which the step is measured.
    pub target: DVec3,
    /// Which way is up in the picture; need not be perpendicular to the view axis.
    pub up: DVec3,
}

/// Why a pose defines no view direction, or no up direction.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// A coordinate that is not finite, or points so far apart that their distance is not.
    #[error(
        "a camera cannot stand at {:?} and look at {:?}: expected finite numbers, and a finite distance",
        .eye.to_array(),
        .target.to_array()
    )]
    NotFinite {
        /// The eye.
        eye: DVec3,
        /// The target.
        target: DVec3,
    },
    /// An eye that equals the target.
    #[error(
        "a camera cannot look from {:?} at the same point: expected a target away from the eye",
        .eye.to_array()
    )]
    NoDirection {
        /// Eye and target.
        eye: DVec3,
    },
    /// An up vector that is zero or not finite.
    #[error("an up of {:?} cannot be used: expected a direction", .up.to_array())]
    NoUp {
        /// The up vector.
        up: DVec3,
    },
    /// An up vector along the view axis.
    #[error(
        "an up of {:?} cannot be used: it lies along the view, from {:?} to {:?}",
        .up.to_array(),
        .eye.to_array(),
        .target.to_array()
    )]
    UpAlongView {
        /// The up vector.
        up: DVec3,
        /// The eye.
        eye: DVec3,
        /// The target.
        target: DVec3,
    },
}

impl Pose {
    /// The least sine of the angle between up and the view axis. Coordinates of unit vectors are rounded by some
    /// 1e-16, so that at this limit a ten-millionth of the component across the axis is rounding.
    pub(super) const LEAST_SINE: f64 = 1e-9;

    /// A camera at `eye` with +Y up, or −Z up where it looks along that.
    pub fn towards(eye: DVec3, target: DVec3) -> Self {
        let upright = Self {
            eye,
            target,
            up: DVec3::Y,
        };
        match upright.check() {
            Err(PoseError::UpAlongView { .. }) => Self {
                up: DVec3::NEG_Z,
                ..upright
            },
            _ => upright,
        }
    }

    /// Whether the pose defines a view direction and an up direction.
    ///
    /// [`super::Camera::new`] accepts any pose; this tells a person that theirs would be replaced.
    ///
    /// # Errors
    /// What is wrong, in one line.
    pub fn check(&self) -> Result<(), PoseError> {
        let Self { eye, target, up } = *self;
        let sight = target - eye;
        if !(eye.is_finite() && target.is_finite() && sight.length().is_finite()) {
            return Err(PoseError::NotFinite { eye, target });
        }
        if sight.length() == 0.0 {
            return Err(PoseError::NoDirection { eye });
        }
        let unit_up = up.normalize_or_zero();
        if unit_up == DVec3::ZERO {
            return Err(PoseError::NoUp { up });
        }
        let across = (sight / sight.length()).cross(unit_up);
        if across.length() <= Self::LEAST_SINE {
            return Err(PoseError::UpAlongView { up, eye, target });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, ImagePlane, Projection};

    /// Between zero and the least corner there are eyes; much nearer to zero there are none.
    #[test]
    fn an_eye_much_nearer_to_zero_than_any_corner_is_at_zero() {
        let least_corner = f64::from(f32::from_bits(1));
        let plane = ImagePlane::new(8, 8, 0.1).expect("a good plane");
        for (x, expected) in [
            (5e-324, 0.0),
            (-1e-60, -0.0),
            (least_corner / 1024.0, least_corner / 1024.0),
            (-least_corner, -least_corner),
            (f64::INFINITY, f64::INFINITY),
        ] {
            let eye = DVec3::new(1.0, x, -2.0);
            let pose = Pose::towards(eye, DVec3::ONE);
            let camera = Camera::new(pose, Projection::Perspective, plane);
            let found = camera.pose().eye;
            assert_eq!(
                found.to_array().map(f64::to_bits),
                eye.with_y(expected).to_array().map(f64::to_bits)
            );
        }
    }

    #[test]
    fn faults_of_placements_are_named() {
        let check = |eye: DVec3, target: DVec3, up: DVec3| {
            let error = Pose { eye, target, up }.check().err();
            error.map(|error| error.to_string())
        };
        let (eye, zero) = (DVec3::new(0.0, 5.0, 0.0), DVec3::ZERO);
        assert_eq!(check(eye, zero, DVec3::Z), None);
        assert_eq!(check(eye, zero, DVec3::new(1e-6, 1.0, 0.0)), None);
        assert_eq!(
            check(eye, eye, DVec3::Z).as_deref(),
            Some(
                "a camera cannot look from [0.0, 5.0, 0.0] at the same point: expected a target away \
                 from the eye"
            )
        );
        assert_eq!(
            check(eye, zero, zero).as_deref(),
            Some("an up of [0.0, 0.0, 0.0] cannot be used: expected a direction")
        );
        for up in [DVec3::Y, DVec3::NEG_Y, DVec3::new(1e-10, 3.0, 0.0)] {
            let message = check(eye, zero, up).expect("along the view");
            assert!(message.contains("lies along the view"), "{message}");
        }
        assert!(check(eye, DVec3::NAN, DVec3::Z).is_some());
        assert!(check(eye, zero, DVec3::NAN).is_some());
        assert!(check(DVec3::splat(1e308), DVec3::splat(-1e308), DVec3::Z).is_some());
        // Tiny and huge vectors have directions, too.
        assert_eq!(check(eye, eye + DVec3::X * 1e-12, DVec3::Y * 1e-100), None);
    }

    #[test]
    fn up_is_y_or_minus_z_by_default() {
        let down = Pose::towards(DVec3::Y, DVec3::ZERO);
        assert_eq!(down.up, DVec3::NEG_Z);
        assert_eq!(down.check(), Ok(()));
        assert_eq!(Pose::towards(DVec3::Z, DVec3::ZERO).up, DVec3::Y);
    }
}
