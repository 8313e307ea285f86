//! One ray and one triangle, without rounding.

use crate::exact::{self, Dyadic, Vector};
use crate::{HalfSpace, Ray, Triangle, Truth};
use std::cmp::Ordering;

/// A ray in exact numbers.
pub(crate) struct ExactRay {
    origin: Vector,
    direction: Vector,
    t_min: Dyadic,
    /// `None` where the ray is unbounded.
    t_max: Option<Dyadic>,
}

/// A hit with the exact numbers that its order is decided by.
pub(crate) struct ExactHit<'a> {
    triangle: &'a Triangle,
    /// `w_b`, `w_c` and their sum with `w_a`: the weights' numerators and denominator.
    second: Dyadic,
    third: Dyadic,
    sum: Dyadic,
    /// `det(A, B, C)`: with `sum` as its denominator, `t`.
    depth: Dyadic,
}

impl ExactRay {
    /// The ray must be valid.
    pub(crate) fn new(ray: &Ray) -> Self {
        Self {
            origin: exact::vector(ray.origin.to_array()),
            direction: exact::vector(ray.direction.to_array()),
            t_min: Dyadic::new(ray.t_min),
            t_max: (ray.t_max < f64::INFINITY).then(|| Dyadic::new(ray.t_max)),
        }
    }

    /// The rule: with corners A, B, C relative to the origin, w_a = d·(B × C), w_b = d·(C × A),
    /// w_c = d·(A × B) must all be ≥ 0 or all ≤ 0, and not all 0. Their sum is d·n, with
    /// n = (b − a) × (c − a) the side from which the corners run counter-clockwise: a ray hits
    /// the front where it goes against n. And t = A·(B × C) / (d·n), since n·A = A·(B × C).
    pub(crate) fn hit<'a>(&self, triangle: &'a Triangle, cull_backs: bool) -> Option<ExactHit<'a>> {
        let base = exact::vector(triangle.base.to_array());
        let [a, b, c] = triangle.corners.map(|corner| {
            let corner = exact::vector(corner.as_dvec3().to_array());
            exact::difference(&exact::sum(&base, &corner), &self.origin)
        });
        let b_cross_c = exact::cross(&b, &c);
        let first = exact::dot(&self.direction, &b_cross_c);
        let second = exact::dot(&self.direction, &exact::cross(&c, &a));
        if first.signum() * second.signum() < 0 {
            return None;
        }
        let third = exact::dot(&self.direction, &exact::cross(&a, &b));
        let signs = [first.signum(), second.signum(), third.signum()];
        if signs.contains(&1) == signs.contains(&-1) {
            return None;
        }
        let sum = &(&first + &second) + &third;
        if cull_backs && sum.signum() > 0 {
            return None;
        }
        let depth = exact::dot(&a, &b_cross_c);
        // t_min < depth / sum ≤ t_max, multiplied by the sum.
        let is_along = sum.signum() > 0;
        let against = |t: &Dyadic| {
            let order = depth.cmp(&(t * &sum));
            if is_along { order } else { order.reverse() }
        };
        let has_begun = against(&self.t_min) == Ordering::Greater;
        let has_ended = |t_max| against(t_max) == Ordering::Greater;
        let is_within = has_begun && !self.t_max.as_ref().is_some_and(has_ended);
        is_within.then_some(ExactHit {
            triangle,
            second,
            third,
            sum,
            depth,
        })
    }
}

impl ExactHit<'_> {
    /// Whether the hit's point is in all of these half-spaces: n·(o + t·d) ≥ c, multiplied by the sum that is the
    /// denominator of t.
    pub(crate) fn is_in(&self, ray: &ExactRay, half_spaces: &[HalfSpace]) -> bool {
        half_spaces.iter().all(|half_space| {
            let normal = exact::vector(half_space.normal.to_array());
            let ahead = &exact::dot(&normal, &ray.direction) * &self.depth;
            let start = &exact::dot(&normal, &ray.origin) - &Dyadic::new(half_space.offset);
            let value = &(&start * &self.sum) + &ahead;
            value.signum() * self.sum.signum() >= 0
        })
    }

    /// Nearest first; equal distances by number.
    pub(crate) fn order(&self, other: &Self) -> Ordering {
        // Compares depth / sum with depth' / sum', both multiplied by sum · sum', whose sign may reverse the order.
        let (left, right) = (&self.depth * &other.sum, &other.depth * &self.sum);
        let by_distance = if self.sum.signum() == other.sum.signum() {
            left.cmp(&right)
        } else {
            right.cmp(&left)
        };
        by_distance.then(self.triangle.number().cmp(&other.triangle.number()))
    }

    /// The hit, rounded to double precision.
    pub(crate) fn rounded(&self, ray: &Ray) -> Truth {
        let [a, b, c] = self.triangle.rounded();
        let normal = (b - a).cross(c - a).normalize_or_zero();
        Truth {
            object: self.triangle.object,
            triangle: self.triangle.triangle,
            t: self.depth.quotient(&self.sum),
            u: self.second.quotient(&self.sum),
            v: self.third.quotient(&self.sum),
            cosine: normal.dot(ray.direction.normalize_or_zero()).abs(),
        }
    }
}
