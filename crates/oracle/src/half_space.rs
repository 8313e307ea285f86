use glam::DVec3;

/// The points p with `normal · p ≥ offset`, both as given: what a clipping plane keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Into it. Finite.
    pub normal: DVec3,
    /// Where it begins. Finite.
    pub offset: f64,
}
