use crate::hit::{MISS, PrimitiveHit};

/// The closest hit so far, with a bound on the error of its parameter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundedHit {
    /// The triangle's primitive index, or [`MISS`].
    pub(crate) primitive: u32,
    /// The ray's parameter; infinity at a miss.
    pub(crate) t: f64,
    /// Bound on its error.
    pub(crate) t_error: f64,
    /// Weight of the second corner.
    pub(crate) u: f64,
    /// Weight of the third corner.
    pub(crate) v: f64,
}

impl BoundedHit {
    /// No hit yet.
    pub(crate) const NONE: Self = Self {
        primitive: MISS,
        t: f64::INFINITY,
        t_error: 0.0,
        u: 0.0,
        v: 0.0,
    };

    pub(crate) fn is_miss(&self) -> bool {
        self.primitive == MISS
    }

    /// Whether this hit is surely nearer than another.
    pub(crate) fn is_surely_before(&self, other: &Self) -> bool {
        // The rounding of the sums is less than the slack of a few per cent in either bound.
        self.t + self.t_error < other.t - other.t_error
    }

    /// The hit rounded to single precision.
    pub(crate) fn to_primitive_hit(self) -> PrimitiveHit {
        if self.is_miss() {
            return PrimitiveHit::NONE;
        }
        PrimitiveHit {
            primitive: self.primitive,
            t: self.t as f32,
            u: self.u as f32,
            v: self.v as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With either error at zero this fails.
    #[test]
    fn hits_whose_intervals_touch_are_not_ordered() {
        let at = |t: f64, t_error: f64| BoundedHit {
            primitive: 0,
            t,
            t_error,
            ..BoundedHit::NONE
        };
        let hit = at(2.0, 0.5);
        for (t, t_error) in [(3.0, 0.5), (2.25, 0.0), (2.0, 0.0), (1.0, 0.5), (1.75, 0.0)] {
            let other = at(t, t_error);
            assert!(!hit.is_surely_before(&other) && !other.is_surely_before(&hit));
        }
        assert!(hit.is_surely_before(&at(3.25, 0.5)) && hit.is_surely_before(&BoundedHit::NONE));
    }
}
