//! Where a ray from far away comes close to a scene.
//!
//! Seen from there, errors of rounding are relative to the scene's size: what a ray hits is decided in double precision,
//! although its origin is so far away that double precision tells none of the triangles apart from there.

use crate::num::double_double::DoubleDouble;
use crate::num::roundoff::EPSILON;
use crate::ray::Ray;
use glam::DVec3;

/// The distance of a ray's origin, in lengths of the scene, beyond which it is measured from a point close to the scene.
/// From nearer, rounding errors are a few units of the scene's size, and no such point is needed; from further away errors
/// proportional to the distance would make rays enter boxes that they miss.
const FAR: f64 = 4.0;

/// The distance of a ray's origin, in lengths of the scene, up to which the start is computed in double precision. From there
/// it is off by less than single precision holds, in which boxes are tested; from further away by more.
const DOUBLE_SUFFICES: f64 = (1u64 << 20) as f64;

/// The distance from the point of the ray that is closest to the scene's centre, in lengths of the scene, above which the
/// start is computed again. With a greater one boxes' distances lose digits; with a lesser one it is computed for nothing.
const CLOSE: f64 = 1.0 / (1 << 24) as f64;

/// The point of a ray that is closest to a scene's centre, but for rounding: any point of the ray would be correct.
#[derive(Clone, Copy, Debug)]
pub(super) struct CloseStart {
    /// The ray's parameter there.
    pub(super) parameter: DoubleDouble,
    /// Relative to the point that corners are relative to, rounded.
    pub(super) point: DVec3,
    /// Bound on the error of its coordinates.
    pub(super) error: f64,
}

impl CloseStart {
    /// Of a ray whose origin relative to `tree_origin` is `origin`, off by at most `origin_error`. The box from `min` to `max`
    /// holds the scene. `None` where the origin is close, or a number overflows.
    pub(super) fn new(
        ray: &Ray,
        tree_origin: DVec3,
        (origin, origin_error): (DVec3, f64),
        [min, max]: [DVec3; 2],
    ) -> Option<Self> {
        let length = (max - min).max_element();
        let reach = (min - origin).abs().max((max - origin).abs()).max_element();
        // NaN is far, and overflows.
        if reach <= FAR * length {
            return None;
        }
        let longest = ray.direction.abs().max_element();
        let direction = ray.direction / longest;
        let center = (min + max) * 0.5;
        let squared = direction.length_squared() * longest;
        let way_from = |point: DVec3| (center - point).dot(direction) / squared;
        let far = way_from(origin);
        if reach <= DOUBLE_SUFFICES * length {
            let way = ray.direction * far;
            let point = origin + way;
            // Product and sum are off by ε of themselves; a hundredth covers second orders, and what underflows is far below
            // it, as the origin is away from the scene.
            let sizes = way.abs().max_element() + point.abs().max_element();
            return Self {
                parameter: far.into(),
                point,
                error: origin_error + 1.01 * EPSILON * sizes,
            }
            .if_finite();
        }
        let at = |parameter: DoubleDouble| {
            let place = |axis: usize| {
                let origin = DoubleDouble::difference(ray.origin[axis], tree_origin[axis]);
                (origin + parameter * ray.direction[axis].into()).high
            };
            DVec3::new(place(0), place(1), place(2))
        };
        let mut parameter = DoubleDouble::from(far);
        let mut point = at(parameter);
        // The way is rounded, and may lead past a scene that is tiny compared with its distance: a second step goes back.
        if reach * EPSILON > length * CLOSE {
            parameter = parameter + way_from(point).into();
            point = at(parameter);
        }
        // The product is off by 5ε², the sum by 3.1ε² of itself and by ε from rounding; what underflows, by less than the
        // least normal number.
        let skipped = (ray.direction * parameter.high).abs().max_element();
        let error = 6.0 * EPSILON * EPSILON * skipped
            + 1.01 * EPSILON * point.abs().max_element()
            + f64::MIN_POSITIVE;
        Self {
            parameter,
            point,
            error,
        }
        .if_finite()
    }

    fn if_finite(self) -> Option<Self> {
        let DoubleDouble { high, low } = self.parameter;
        (self.error.is_finite() && high.is_finite() && low.is_finite()).then_some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::pow;
    use crate::num::exact::decompose;
    use crate::random::Random;
    use crate::ray::relative_origin;
    use num_bigint::BigInt;

    /// A number times 2^2000, exactly.
    fn whole(x: f64) -> BigInt {
        let (mantissa, exponent) = decompose(x);
        BigInt::from(mantissa) << (exponent + 2000)
    }

    /// From up to 10²⁵ lengths of the scene. The truth is integer arithmetic; with a term of the error at zero this fails,
    /// but for underflow.
    #[test]
    fn starts_are_within_their_errors_of_the_ray_and_close_to_the_scene() {
        let mut random = Random(92);
        let mut most = [0.0f64; 3];
        for round in 0..4000 {
            let length = pow(10.0, 20.0 * random.signed());
            let away = length * pow(10.0, 1.0 + 24.0 * random.unit());
            let center = random.point() * length;
            let half = DVec3::splat(length * 0.5);
            let ray = Ray::new(random.point() * away, random.point());
            let target = center + random.point() * length;
            let direction = (target - ray.origin) * pow(10.0, 9.0 * random.signed());
            let ray = Ray { direction, ..ray };
            // Aside, the point closest to the centre may be as far away as the origin is.
            let ray = if round % 4 == 0 {
                Ray::new(ray.origin, random.point())
            } else {
                ray
            };
            let tree_origin = random.point() * length;
            let origin = relative_origin(ray.origin, tree_origin);
            let bounds = [center - half, center + half];
            let Some(start) = CloseStart::new(&ray, tree_origin, origin, bounds) else {
                let nearest = (origin.0 - center).abs().max_element();
                assert!(nearest <= 5.0 * length, "{ray:?}");
                continue;
            };
            let mut off = 0.0f64;
            for axis in 0..3 {
                let along = whole(ray.direction[axis]);
                let parameter = whole(start.parameter.high) + whole(start.parameter.low);
                let origin = whole(ray.origin[axis]) - whole(tree_origin[axis]);
                let exact = (origin << 2000u32) + along * parameter;
                let rest: BigInt = (whole(start.point[axis]) << 2000u32) - exact;
                let error = (whole(start.error) << 2000u32) + BigInt::from(1);
                let share: BigInt = (rest.magnitude() << 20u32).into();
                let share = u64::try_from(share / error).expect("within the bound");
                off = off.max(share as f64 / f64::from(1 << 20));
            }
            assert!(off <= 1.0, "{off}: {ray:?}");
            let term = match away <= DOUBLE_SUFFICES * length * 0.5 {
                true => 2,
                false => usize::from(start.error > 2.0 * EPSILON * start.point.abs().max_element()),
            };
            most[term] = most[term].max(off);
            // The closest point, wherever the direction's own rounding leads; with one step this fails.
            let to_center = center - start.point;
            let along = to_center.dot(ray.direction) / ray.direction.length();
            let limit = 1e-6 * (length + to_center.length());
            assert!(along.abs() <= limit, "{along}, {limit}: {ray:?}");
        }
        assert!(most[0] > 0.9 && most[1] > 0.05 && most[2] > 0.3, "{most:?}");
    }
}
