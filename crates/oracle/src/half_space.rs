use glam::DVec3;

/// The points p with `normal · p ≥ offset`, both exactly as given: what a clipping plane keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Points into it. Finite.
    pub normal: DVec3,
    /// `normal · p` of the points p on its border. Finite.
    pub offset: f64,
}
