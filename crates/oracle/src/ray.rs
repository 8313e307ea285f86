use glam::DVec3;

/// The points `origin + t · direction` with `t_min < t ≤ t_max`, exactly as given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at `t` = 0.
    pub origin: DVec3,
    /// The direction; one unit of `t` is its length.
    pub direction: DVec3,
    /// Hits have a greater `t` than this.
    pub t_min: f64,
    /// The greatest `t` of a hit, inclusive; +infinity is no limit.
    pub t_max: f64,
}

impl Ray {
    /// The ray from `origin` with no end.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self {
            origin,
            direction,
            t_min: 0.0,
            t_max: f64::INFINITY,
        }
    }

    /// Whether the ray can hit anything; any other ray misses.
    pub(crate) fn is_valid(&self) -> bool {
        self.origin.is_finite()
            && self.direction.is_finite()
            && self.direction != DVec3::ZERO
            && self.t_min.is_finite()
            && self.t_max > f64::NEG_INFINITY
    }
}
