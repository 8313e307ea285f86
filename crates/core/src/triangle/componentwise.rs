//! Determinants of a ray and a triangle in double precision, each with an error bound of its terms. They decide most
//! of what [`Edges`](super::edges::Edges), whose bounds are proportional to the triangle's greatest coordinate,
//! leaves undecided.
//!
//! The bound is relative to the determinant's permanent, the sum of its terms' magnitudes (Shewchuk, "Adaptive
//! Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997): it is as small as the terms are.
//! A large coordinate does not widen the bound of products without it, and where all terms are zero the determinant
//! is surely zero.
//!
//! # Error bounds
//! ε = 2⁻⁵³. A corner's coordinate x relative to the ray's origin is off by ε|x| + η, η the error of that origin:
//! by εx' with x' = |x| + η/ε. A product of two is off by (2ε + ε²)·x'y' and rounded; so are the difference of two
//! such, the product with the third factor, and two sums: 7ε times the permanent of the x' to first order, 8ε if
//! the third factor is a coordinate too. One more ε covers the higher orders and the permanent's own rounding:
//! 8ε, or 9ε.
//!
//! No term leaves double precision's range while its factors are zero or within 2^±300.

use crate::num::roundoff::EPSILON;
use glam::{BVec3, DVec3, Vec3, Vec3Swizzles};

/// The least and greatest magnitude of a factor other than zero.
pub(super) const FACTOR_RANGE: (f64, f64) = (1.0 / POWER_300, POWER_300);
const POWER_300: f64 = f64::from_bits((1023 + 300) << 52);

/// A determinant: its exact value is within `error` of `value`, and zero if `error` is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Determinant {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

impl Determinant {
    /// u·(b×c). `error` is its bound relative to the permanent.
    #[inline(always)]
    fn new(u: Factor, b: Factor, c: Factor, error: f64) -> Self {
        let products = |b: DVec3, c: DVec3| (b.yzx() * c.zxy(), b.zxy() * c.yzx());
        let (plus, minus) = products(b.value, c.value);
        let value = (plus - minus).dot(u.value);
        let (plus, minus) = products(b.size, c.size);
        let permanent = (plus + minus).dot(u.size);
        Self {
            value,
            error: error * permanent,
        }
    }

    /// −1, 0 or 1; `None` where it is undecided.
    #[inline(always)]
    pub(super) fn signum(self) -> Option<i32> {
        if self.value > self.error {
            Some(1)
        } else if self.value < -self.error {
            Some(-1)
        } else {
            (self.error == 0.0).then_some(0)
        }
    }
}

/// A vector, and for each component x the magnitude x' whose product with ε bounds its error.
#[derive(Clone, Copy)]
pub(super) struct Factor {
    value: DVec3,
    size: DVec3,
}

impl Factor {
    fn new(value: DVec3, off: f64) -> Self {
        Self {
            value,
            size: value.abs() + off,
        }
    }

    pub(super) fn exact(value: DVec3) -> Self {
        Self::new(value, 0.0)
    }

    /// The components whose products of three stay in range; NaN does not.
    pub(super) fn in_range(self) -> BVec3 {
        let (least, most) = FACTOR_RANGE;
        let within = self.size.cmpge(DVec3::splat(least)) & self.size.cmple(DVec3::splat(most));
        within | self.size.cmpeq(DVec3::ZERO)
    }
}

/// The determinants that decide whether and where a ray hits a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Determinants {
    /// d·(B×C), d·(C×A) and d·(A×B).
    pub(super) weights: [Determinant; 3],
    /// A·(B×C): divided by the weights' sum it is the ray's parameter.
    pub(super) numerator: Determinant,
}

impl Determinants {
    /// Whether the signs of all weights are sure.
    pub(super) fn have_sure_weights(&self) -> bool {
        let mut weights = self.weights.into_iter();
        weights.all(|weight| weight.signum().is_some())
    }

    /// The determinants of a ray's direction and a triangle's corners relative to the ray's origin, which is off by
    /// at most `off` · ε. `None` where a factor is out of [`FACTOR_RANGE`].
    pub(super) fn new(direction: DVec3, corners: [DVec3; 3], off: f64) -> Option<Self> {
        let d = Factor::exact(direction);
        let [a, b, c] = corners.map(|corner| Factor::new(corner, off));
        let in_range = d.in_range() & a.in_range() & b.in_range() & c.in_range();
        let weight = |b, c| Determinant::new(d, b, c, 8.0 * EPSILON);
        in_range.all().then(|| Self {
            weights: [weight(b, c), weight(c, a), weight(a, b)],
            numerator: numerator([a, b, c]),
        })
    }
}

fn numerator([a, b, c]: [Factor; 3]) -> Determinant {
    Determinant::new(a, b, c, 9.0 * EPSILON)
}

/// Whether the plane of a triangle surely misses the eye, which is off by at most `off` · ε. `None` where it is
/// undecided.
///
/// It does where A·(B×C) is not zero. That equals A·((B−A)×(C−A)), whose terms are smaller where the triangle is
/// small compared with its distance.
pub(super) fn plane_misses(corners: [DVec3; 3], eye: DVec3, off: f64) -> Option<bool> {
    let relative = corners.map(|corner| Factor::new(corner - eye, off));
    let [a, b, c] = corners;
    let [to_b, to_c] = [b - a, c - a].map(Factor::exact);
    let mut factors = relative.iter().chain([&to_b, &to_c]);
    if !factors.all(|factor| factor.in_range().all()) {
        return None;
    }
    let sign = numerator(relative).signum();
    let sign = sign.or_else(|| numerator([relative[0], to_b, to_c]).signum());
    sign.map(|sign| sign != 0)
}

/// Whether the plane of a triangle is surely not parallel to a direction; `None` where it is undecided.
///
/// Corners are exact, and their differences within ε of themselves: d·((b−a)×(c−a)) has the error bound of a weight.
pub(super) fn plane_crosses(direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<bool> {
    let factors = [direction, b - a, c - a].map(Factor::exact);
    let in_range = factors.iter().all(|factor| factor.in_range().all());
    let [d, b, c] = factors;
    let sign = in_range
        .then(|| Determinant::new(d, b, c, 8.0 * EPSILON))
        .and_then(Determinant::signum);
    sign.map(|sign| sign != 0)
}

/// Whether a point is surely off the plane of a triangle; `None` where it is undecided.
///
/// Corners are exact, and their differences within ε of themselves: (p−a)·((b−a)×(c−a)) has the error bound of a
/// numerator.
pub(super) fn is_off_plane(point: Vec3, corners: [Vec3; 3]) -> Option<bool> {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let factors = [b - a, c - a, point.as_dvec3() - a].map(Factor::exact);
    let in_range = factors.iter().all(|factor| factor.in_range().all());
    let sign = in_range
        .then(|| numerator(factors))
        .and_then(Determinant::signum);
    sign.map(|sign| sign != 0)
}
