use glam::DVec3;

/// The most planes at a time: as many as graphics interfaces guarantee (eight), and more than sections need.
pub const CLIPPING_PLANES: usize = 8;

/// A clipping plane: it keeps the points on the side that its normal points to, and the points on it.
///
/// A point p, in world coordinates as files give them, is kept where `normal · p − offset ≥ 0`, by exact arithmetic
/// on these numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClippingPlane {
    /// Points towards the kept side. Need not be of unit length: from 1.5e-154 to 1.3e154, so that its squared length
    /// is a normal number.
    pub normal: DVec3,
    /// `normal · p` of the plane's points; finite. With a unit normal it is the plane's signed distance from the
    /// origin, in scene units.
    pub offset: f64,
    /// Whether it clips.
    pub enabled: bool,
}

/// Why a clipping plane is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ClippingError {
    /// A normal of length zero.
    #[error("a clipping plane's normal must not be zero")]
    ZeroNormal,
    /// A normal whose squared length overflows or underflows double precision.
    #[error("a clipping plane's normal must be 1.5e-154 to 1.3e154 long")]
    OddLength,
    /// A normal or an offset that is NaN or infinite.
    #[error("a clipping plane's numbers must be finite")]
    NotFinite,
    /// More than [`CLIPPING_PLANES`] planes.
    #[error("there can be at most {CLIPPING_PLANES} clipping planes")]
    TooMany,
}

impl ClippingPlane {
    /// The plane of the points p with `normal · p = offset`, which keeps what its normal points to.
    ///
    /// # Errors
    /// A normal that is zero, or too short or long; numbers that are not finite.
    pub fn new(normal: DVec3, offset: f64) -> Result<Self, ClippingError> {
        let plane = Self {
            normal,
            offset,
            enabled: true,
        };
        plane.check()?;
        Ok(plane)
    }

    /// The plane through a point. Its offset is rounded.
    ///
    /// # Errors
    /// As [`ClippingPlane::new`].
    pub fn through(point: DVec3, normal: DVec3) -> Result<Self, ClippingError> {
        Self::new(normal, normal.dot(point))
    }

    /// The same plane, keeping the other side. Points on the plane are kept by both.
    #[must_use]
    pub fn flipped(self) -> Self {
        // Avoids minus zero, which would be written with its sign.
        Self {
            normal: DVec3::ZERO - self.normal,
            offset: 0.0 - self.offset,
            ..self
        }
    }

    fn check(&self) -> Result<(), ClippingError> {
        if !self.normal.is_finite() || !self.offset.is_finite() {
            Err(ClippingError::NotFinite)
        } else if self.normal == DVec3::ZERO {
            Err(ClippingError::ZeroNormal)
        } else if !self.normal.length_squared().is_normal() {
            Err(ClippingError::OddLength)
        } else {
            Ok(())
        }
    }
}

/// An ordered list of clipping planes. A point is kept where every enabled plane keeps it.
#[derive(Clone, Copy, PartialEq)]
pub struct ClippingPlanes {
    planes: [ClippingPlane; CLIPPING_PLANES],
    count: usize,
}

impl ClippingPlanes {
    /// No planes: everything is kept.
    pub const NONE: Self = Self {
        planes: [ClippingPlane {
            normal: DVec3::X,
            offset: 0.0,
            enabled: false,
        }; CLIPPING_PLANES],
        count: 0,
    };

    /// The list of these planes.
    ///
    /// # Errors
    /// An invalid plane, or one too many.
    pub fn new(planes: &[ClippingPlane]) -> Result<Self, ClippingError> {
        let mut all = Self::NONE;
        for &plane in planes {
            all.push(plane)?;
        }
        Ok(all)
    }

    /// Appends a plane.
    ///
    /// # Errors
    /// An invalid plane, or one too many.
    pub fn push(&mut self, plane: ClippingPlane) -> Result<(), ClippingError> {
        plane.check()?;
        let place = self.planes.get_mut(self.count);
        // Without minus zeros, which change no picture but would change its checksum.
        *place.ok_or(ClippingError::TooMany)? = ClippingPlane {
            normal: plane.normal + DVec3::ZERO,
            offset: plane.offset + 0.0,
            ..plane
        };
        self.count += 1;
        Ok(())
    }

    /// All planes, enabled or not.
    pub fn all(&self) -> &[ClippingPlane] {
        &self.planes[..self.count]
    }

    /// The enabled planes.
    pub fn enabled(&self) -> impl Iterator<Item = &ClippingPlane> {
        self.all().iter().filter(|plane| plane.enabled)
    }

    /// The list without disabled planes: what decides a picture.
    #[must_use]
    pub fn only_enabled(&self) -> Self {
        let mut enabled = Self::NONE;
        for plane in self.enabled() {
            enabled.planes[enabled.count] = *plane;
            enabled.count += 1;
        }
        enabled
    }
}

impl Default for ClippingPlanes {
    fn default() -> Self {
        Self::NONE
    }
}

impl std::fmt::Debug for ClippingPlanes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.all()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_planes_are_refused_and_so_is_one_too_many() {
        let new = |normal, offset| ClippingPlane::new(normal, offset).map(|_| ());
        assert_eq!(new(DVec3::ZERO, 1.0), Err(ClippingError::ZeroNormal));
        assert_eq!(new(DVec3::X * f64::NAN, 1.0), Err(ClippingError::NotFinite));
        assert_eq!(new(DVec3::X, f64::INFINITY), Err(ClippingError::NotFinite));
        // The lengths that the message gives are valid, those beyond them by their last digit are not.
        for valid in [1.5e-154, 1.3e154] {
            assert_eq!(new(DVec3::X * valid, 1.0), Ok(()), "{valid}");
        }
        for invalid in [1.4e-154, 1.4e154] {
            let refused = new(DVec3::X * invalid, 1.0);
            assert_eq!(refused, Err(ClippingError::OddLength), "{invalid}");
        }
        let message = ClippingError::OddLength.to_string();
        assert!(message.ends_with("1.5e-154 to 1.3e154 long"), "{message}");
        let plane = ClippingPlane::new(DVec3::X, 2.0).expect("a plane");
        assert!(ClippingPlanes::new(&[plane; CLIPPING_PLANES]).is_ok());
        assert_eq!(
            ClippingPlanes::new(&[plane; CLIPPING_PLANES + 1]),
            Err(ClippingError::TooMany)
        );
        let bad = ClippingPlane {
            normal: DVec3::ZERO,
            ..plane
        };
        assert_eq!(ClippingPlanes::new(&[bad]), Err(ClippingError::ZeroNormal));
    }

    #[test]
    fn disabled_planes_are_not_among_those_that_decide_a_picture() {
        let plane = ClippingPlane::new(DVec3::X, 2.0).expect("a plane");
        let off = ClippingPlane {
            enabled: false,
            ..plane.flipped()
        };
        let planes = ClippingPlanes::new(&[off, plane]).expect("two planes");
        assert_eq!(planes.all(), [off, plane]);
        assert_eq!(planes.only_enabled().all(), [plane]);
        assert_eq!(off.normal, DVec3::NEG_X);
        assert_eq!(plane.flipped().flipped(), plane);
    }
}
