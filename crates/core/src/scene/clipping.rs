use glam::DVec3;

/// The most planes at a time: as many as a graphics interface has to offer, and more than a section needs.
pub const CLIPPING_PLANES: usize = 8;

/// A clipping plane: what lies on the side that its normal points to is kept, and what lies on it.
///
/// A point p, in world coordinates as files give them, is kept where `normal · p − offset` is not negative, by
/// exact arithmetic on these numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClippingPlane {
    /// Towards what is kept: some 1e-154 to 1e154 long, so that its square is a normal number.
    pub normal: DVec3,
    /// `normal · p` of the plane's points; finite. For a normal of length one its distance from zero, in scene units.
    pub offset: f64,
    /// Whether it clips.
    pub enabled: bool,
}

/// Why there is no such clipping plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ClippingError {
    /// A normal that points nowhere.
    #[error("a clipping plane's normal must not be zero")]
    ZeroNormal,
    /// A normal whose length double precision cannot square.
    #[error("a clipping plane's normal must be 1e-150 to 1e150 long")]
    OddLength,
    /// A normal or an offset that is no number, or infinite.
    #[error("a clipping plane's numbers must be finite")]
    NotFinite,
    /// One more than [`CLIPPING_PLANES`].
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

    /// The plane through a point, whose offset is rounded.
    ///
    /// # Errors
    /// As [`ClippingPlane::new`].
    pub fn through(point: DVec3, normal: DVec3) -> Result<Self, ClippingError> {
        Self::new(normal, normal.dot(point))
    }

    /// The same plane, keeping the other side. Both keep what lies on it.
    #[must_use]
    pub fn flipped(self) -> Self {
        // Zeros stay positive: they are written without a sign.
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

/// Clipping planes, in order: what each of those that are enabled keeps is kept.
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

    /// These planes.
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

    /// Adds a plane behind the others.
    ///
    /// # Errors
    /// An invalid plane, or one too many.
    pub fn push(&mut self, plane: ClippingPlane) -> Result<(), ClippingError> {
        plane.check()?;
        let place = self.planes.get_mut(self.count);
        // A zero's sign decides nothing, and is not to tell two pictures apart.
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

    /// Those that clip.
    pub fn enabled(&self) -> impl Iterator<Item = &ClippingPlane> {
        self.all().iter().filter(|plane| plane.enabled)
    }

    /// The same planes, of which only those that clip are left: what decides a picture.
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
    fn what_is_no_plane_is_refused_and_so_is_one_too_many() {
        let new = |normal, offset| ClippingPlane::new(normal, offset).map(|_| ());
        assert_eq!(new(DVec3::ZERO, 1.0), Err(ClippingError::ZeroNormal));
        assert_eq!(new(DVec3::X * f64::NAN, 1.0), Err(ClippingError::NotFinite));
        assert_eq!(new(DVec3::X, f64::INFINITY), Err(ClippingError::NotFinite));
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
    fn planes_that_are_switched_off_decide_nothing() {
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
