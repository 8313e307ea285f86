use glam::DVec3;

/// A half-line, or a piece of one, in world space: the points `origin + t · direction` with
/// `t_min < t ≤ t_max`.
///
/// What only touches the origin of a ray that begins at zero is not met: a triangle whose plane holds
/// an eye is met by no ray from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where `t` is zero.
    pub origin: DVec3,
    /// Which way, and what one unit of `t` is: the direction keeps its own length.
    pub direction: DVec3,
    /// Where hits begin: their `t` is greater.
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

    /// Whether every number is finite (`t_max` may be +infinity) and the direction is not zero; any
    /// other ray is a miss.
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite()
            && self.direction.is_finite()
            && self.direction != DVec3::ZERO
            && self.t_min.is_finite()
            && self.t_max > f64::NEG_INFINITY
    }

    /// The point at `t`, rounded.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}
