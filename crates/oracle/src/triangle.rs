use glam::{DVec3, Vec3};

/// A triangle as stored: each corner is exactly `base + corner`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Its object's number.
    pub object: u32,
    /// Its own number in the object.
    pub triangle: u32,
    /// What is added, without rounding, to each corner.
    pub base: DVec3,
    /// The corners. Counter-clockwise from the front.
    pub corners: [Vec3; 3],
}

impl Triangle {
    /// The corners, rounded to double precision.
    pub(crate) fn rounded(&self) -> [DVec3; 3] {
        self.corners.map(|corner| self.base + corner.as_dvec3())
    }

    /// What comes first among equals.
    pub(crate) fn number(&self) -> (u32, u32) {
        (self.object, self.triangle)
    }
}
