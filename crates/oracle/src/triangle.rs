use glam::{DVec3, Vec3};

/// A triangle as stored; each corner is exactly `base + corner`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Its object's number.
    pub object: u32,
    /// Its number in the object.
    pub triangle: u32,
    /// Added to each corner, without rounding.
    pub base: DVec3,
    /// The corners, counter-clockwise as seen from the front.
    pub corners: [Vec3; 3],
}

impl Triangle {
    /// The corners, rounded to double precision.
    pub(crate) fn rounded(&self) -> [DVec3; 3] {
        self.corners.map(|corner| self.base + corner.as_dvec3())
    }

    /// Its rank among triangles at the same distance.
    pub(crate) fn number(&self) -> (u32, u32) {
        (self.object, self.triangle)
    }
}
