use crate::num::double_double::DoubleDouble;
use crate::num::roundoff::EPSILON;
use glam::DVec3;

/// A half-line, or a piece of one, in world space: the points `origin + t · direction` with `t_min < t ≤ t_max`.
///
/// A triangle that only touches the origin of a ray with `t_min` = 0 is not hit: a triangle whose plane holds an
/// eye is hit by no ray from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at t = 0.
    pub origin: DVec3,
    /// The direction; one unit of t is its length.
    pub direction: DVec3,
    /// Hits have t > `t_min`.
    pub t_min: f64,
    /// Hits have t ≤ `t_max`; +infinity is no limit.
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

    /// Whether the ray can hit anything: every number is finite (`t_max` may be +infinity) and the direction is not
    /// zero. A ray that is not valid is a miss.
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite()
            && self.direction.is_finite()
            && self.direction != DVec3::ZERO
            && self.t_min.is_finite()
            && self.t_max > f64::NEG_INFINITY
    }

    /// The point at t, rounded.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// The origin of rays relative to `frame`, the point that corners are relative to: rounded, and a bound on the error
/// of each coordinate (half a unit in the last place of the greatest), zero where the difference is exact.
pub(crate) fn relative_origin(origin: DVec3, frame: DVec3) -> (DVec3, f64) {
    let (relative, error) = rounded_origin(origin, frame);
    let is_exact = frame == DVec3::ZERO
        || (0..3).all(|axis| DoubleDouble::difference(origin[axis], frame[axis]).low == 0.0);
    (relative, if is_exact { 0.0 } else { error })
}

/// [`relative_origin`], with the bound of a difference that is rounded where it is exact too.
#[inline(always)]
pub(crate) fn rounded_origin(origin: DVec3, frame: DVec3) -> (DVec3, f64) {
    let relative = origin - frame;
    (relative, relative.abs().max_element() * EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// The truth is the rounding error of the difference (Knuth's two-sum). With half the bound this fails.
    #[test]
    fn relative_origins_are_within_their_error() {
        let mut random = Random(31);
        let mut most: f64 = 0.0;
        for _ in 0..10_000 {
            let (origin, frame) = (random.point() * 1e3, random.point());
            let (relative, error) = relative_origin(origin, frame);
            let added = relative - origin;
            let rest = (origin - (relative - added)) + (-frame - added);
            let off = rest.abs().max_element();
            assert!(off <= error, "{origin} {frame}");
            most = most.max(off / error);
        }
        assert!(most > 0.5, "{most}");
        assert_eq!(relative_origin(DVec3::ONE, DVec3::ZERO), (DVec3::ONE, 0.0));
        let exact = relative_origin(DVec3::splat(0.75), DVec3::splat(1e3));
        assert_eq!(exact, (DVec3::splat(-999.25), 0.0));
    }
}
