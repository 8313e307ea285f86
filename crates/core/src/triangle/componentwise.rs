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

use super::exact::{OffsetTriangle, crosses_from};
use crate::num::double_double::DoubleDouble;
use crate::num::roundoff::EPSILON;
use glam::{BVec3, DVec3, Vec3, Vec3Swizzles};

/// The least and greatest magnitude of a factor other than zero.
const FACTOR_RANGE: (f64, f64) = (1.0 / POWER_300, POWER_300);
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
struct Factor {
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

    fn exact(value: DVec3) -> Self {
        Self::new(value, 0.0)
    }

    /// The components whose products of three stay in range; NaN does not.
    fn in_range(self) -> BVec3 {
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

impl Determinants {
    /// The determinants in double-double arithmetic; corners are relative to `tree_origin`, a point in world space.
    /// `None` where a factor is out of [`FACTOR_RANGE`].
    ///
    /// B×C is B×u and C×u too, with u = C − B, and A·(B×C) is A·((B−A)×(C−A)): the form whose permanent is least is
    /// computed, so that triangles that are tiny compared with their distance are decided as well.
    ///
    /// A corner relative to the origin is off by 3.1ε² of itself, since the tree's origin relative to the ray's is
    /// exact, as differences of corners are; a product of two by 12ε² with its rounding, their difference by 3.1ε²
    /// more, the product with the third factor by 5ε², or 8.1ε² where that is a coordinate too, and two sums by 6.2ε²:
    /// below 32ε² of the permanent. The result is rounded to double precision.
    pub(super) fn in_double_double(
        origin: DVec3,
        direction: DVec3,
        corners: [Vec3; 3],
        tree_origin: DVec3,
    ) -> Option<Self> {
        let EyeFactors {
            corners: [a, b, c],
            ways: [ab, bc, ca],
        } = EyeFactors::new(origin, tree_origin, corners)?;
        let d = WideFactor::of(direction.to_array().map(DoubleDouble::from));
        if !d.size.in_range().all() {
            return None;
        }
        let weight = |from, to, way| best_determinant(&d, &[(from, to), (from, way), (to, way)]);
        Some(Self {
            weights: [
                weight(&b, &c, &bc),
                weight(&c, &a, &ca),
                weight(&a, &b, &ab),
            ],
            numerator: best_determinant(&a, &[(&b, &c), (&ca, &ab)]),
        })
    }
}

/// A vector in double-double precision, and rounded to double precision.
struct WideFactor {
    value: WideVector,
    size: Factor,
}

impl WideFactor {
    fn of(value: WideVector) -> Self {
        let rounded = DVec3::from_array(value.map(|x| x.high));
        Self {
            value,
            size: Factor::exact(rounded),
        }
    }

    /// From a corner to another.
    fn way([from, to]: [Vec3; 2]) -> Self {
        let difference = |axis| DoubleDouble::difference(to[axis].into(), from[axis].into());
        Self::of([0, 1, 2].map(difference))
    }
}

/// A triangle's corners A, B and C relative to an eye, and the ways from A to B, B to C and C to A.
struct EyeFactors {
    corners: [WideFactor; 3],
    ways: [WideFactor; 3],
}

impl EyeFactors {
    /// `corners` are relative to `tree_origin`. `None` where a factor is out of [`FACTOR_RANGE`].
    fn new(eye: DVec3, tree_origin: DVec3, corners: [Vec3; 3]) -> Option<Self> {
        let axes = [0, 1, 2];
        let tree_origin = axes.map(|axis| DoubleDouble::difference(tree_origin[axis], eye[axis]));
        let relative = |corner: Vec3| {
            let place = axes.map(|axis| tree_origin[axis] + f64::from(corner[axis]).into());
            WideFactor::of(place)
        };
        let [a, b, c] = corners;
        let factors = Self {
            corners: corners.map(relative),
            ways: [[a, b], [b, c], [c, a]].map(WideFactor::way),
        };
        let mut all = factors.corners.iter().chain(&factors.ways);
        let in_range = all.all(|factor| factor.size.in_range().all());
        in_range.then_some(factors)
    }
}

/// A cross product of two corners relative to an eye, computed in double-double arithmetic and rounded: the product
/// with a ray's direction is one of its weights.
///
/// With p the sum of a component's products' magnitudes, the component is off by 16ε²p (see
/// [`Determinants::in_double_double`]: twice 3.1ε² for the factors, 5ε² for their product, and 3.1ε² for the difference
/// of two) and by ε of itself from rounding. The three products with a direction and their two sums are off by 3ε of
/// the terms' magnitudes.
#[derive(Clone, Copy, Debug)]
struct EyeCross {
    value: DVec3,
    /// Of each component, the bound on its error and on the roundings of products with it.
    error: DVec3,
}

impl EyeCross {
    fn new(a: &WideFactor, c: &WideFactor, way: &WideFactor) -> Self {
        let (value, off) = rounded_cross(a, c, way);
        Self {
            value,
            error: off + value.abs() * (5.0 * EPSILON),
        }
    }

    /// The error of exact cross products, rounded to within a unit in the last place: 2ε of themselves, 3ε from
    /// products with a direction, and one ε for higher orders.
    const ROUNDED: f64 = 6.0 * EPSILON;

    /// Of an exact cross product, rounded.
    fn rounded(value: DVec3) -> Self {
        Self {
            value,
            error: value.abs() * Self::ROUNDED,
        }
    }

    fn weight(&self, direction: DVec3) -> Determinant {
        Determinant {
            value: direction.dot(self.value),
            error: direction.abs().dot(self.error),
        }
    }
}

/// The cross product of two factors, rounded to double precision, and of each component the bound on its error before
/// that rounding (see [`EyeCross`]). `way` leads from one to the other: of equal products the one with the least terms
/// is computed.
fn rounded_cross(a: &WideFactor, c: &WideFactor, way: &WideFactor) -> (DVec3, DVec3) {
    let pairs = [(a, c), (a, way), (c, way)];
    let terms = pairs.map(|(b, c)| {
        let (b, c) = (b.size.size, c.size.size);
        b.yzx() * c.zxy() + b.zxy() * c.yzx()
    });
    let sums = terms.map(|terms| terms.element_sum());
    let mut best = 0;
    for other in 1..3 {
        if sums[other] < sums[best] {
            best = other;
        }
    }
    let (b, c) = pairs[best];
    let value = cross(b.value, c.value).map(|x| x.high);
    let off = terms[best] * (16.0 * EPSILON * EPSILON);
    (DVec3::from_array(value), off)
}

/// The cross product of two corners relative to an eye, each component within 2.01ε of itself. `None` where
/// double-double arithmetic does not suffice.
pub(super) fn cross_from(eye: DVec3, corners: [Vec3; 2]) -> Option<DVec3> {
    let relative = |corner: Vec3| {
        let difference = |axis| DoubleDouble::difference(corner[axis].into(), eye[axis]);
        WideFactor::of([0, 1, 2].map(difference))
    };
    let ([a, c], way) = (corners.map(relative), WideFactor::way(corners));
    let in_range = [&a, &c, &way].map(|factor| factor.size.in_range().all());
    let (value, off) = rounded_cross(&a, &c, &way);
    // NaN fails this comparison.
    let is_close = off.cmple(value.abs() * EPSILON).all();
    (is_close && !in_range.contains(&false)).then_some(value)
}

/// What the determinants of rays from one eye share.
#[derive(Clone, Copy, Debug)]
pub(super) struct EyeDeterminants {
    crosses: [EyeCross; 3],
    numerator: Determinant,
}

impl EyeDeterminants {
    /// `numerator` is that of the eye. `None` where a factor is out of [`FACTOR_RANGE`].
    pub(super) fn new(
        eye: DVec3,
        triangle: &OffsetTriangle,
        numerator: Determinant,
    ) -> Option<Self> {
        let EyeFactors {
            corners: [a, b, c],
            ways: [ab, bc, ca],
        } = EyeFactors::new(eye, triangle.origin, triangle.corners)?;
        let crosses = [
            EyeCross::new(&b, &c, &bc),
            EyeCross::new(&c, &a, &ca),
            EyeCross::new(&a, &b, &ab),
        ];
        Some(Self { crosses, numerator })
    }

    /// The same from exact cross products, rounded.
    pub(super) fn exact(eye: DVec3, triangle: &OffsetTriangle, numerator: Determinant) -> Self {
        let crosses = crosses_from(eye, triangle).map(EyeCross::rounded);
        Self { crosses, numerator }
    }

    /// Whether every component of the cross products is known as well as an exact one that is rounded.
    pub(super) fn are_accurate(&self) -> bool {
        let is_accurate = |cross: &EyeCross| {
            let most = cross.value.abs() * EyeCross::ROUNDED;
            cross.error.cmple(most).all()
        };
        self.crosses.iter().all(is_accurate)
    }

    /// The determinants of a ray with this direction. `None` where that is out of [`FACTOR_RANGE`].
    pub(super) fn of(&self, direction: DVec3) -> Option<Determinants> {
        let in_range = Factor::exact(direction).in_range().all();
        in_range.then(|| Determinants {
            weights: self.crosses.map(|cross| cross.weight(direction)),
            numerator: self.numerator,
        })
    }
}

/// Computes, of several equal determinants u·(b×c), the one whose permanent is least.
fn best_determinant(u: &WideFactor, pairs: &[(&WideFactor, &WideFactor)]) -> Determinant {
    const OFF: f64 = 32.0 * EPSILON * EPSILON;
    let mut best: Option<(f64, &WideFactor, &WideFactor)> = None;
    for &(b, c) in pairs {
        // A thousandth covers the permanent's own rounding.
        let permanent = Determinant::new(u.size, b.size, c.size, 1.001).error;
        if best.is_none_or(|best| permanent < best.0) {
            best = Some((permanent, b, c));
        }
    }
    let Some((permanent, b, c)) = best else {
        return Determinant {
            value: 0.0,
            error: f64::INFINITY,
        };
    };
    let value = dot(u.value, cross(b.value, c.value)).high;
    Determinant {
        value,
        error: OFF * permanent + EPSILON * value.abs(),
    }
}

type WideVector = [DoubleDouble; 3];

fn cross(a: WideVector, b: WideVector) -> WideVector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

fn dot(a: WideVector, b: WideVector) -> DoubleDouble {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// (p−a)·((b−a)×(c−a)) in double-double arithmetic: the distance of p from a triangle's plane times the normal's
/// length.
///
/// Differences of corners are exact, so that the bound of [`Determinants::in_double_double`] holds.
pub(super) fn plane_distance(point: Vec3, [a, b, c]: [Vec3; 3]) -> Determinant {
    let from_a = |to: Vec3| {
        let difference = |axis| DoubleDouble::difference(to[axis].into(), a[axis].into());
        WideFactor::of([0, 1, 2].map(difference))
    };
    best_determinant(&from_a(point), &[(&from_a(b), &from_a(c))])
}

/// A·((B−A)×(C−A)) in double-double arithmetic, with corners relative to an eye: its distance from the plane times the
/// normal's length, positive where the normal points away from it. `None` where a factor is out of [`FACTOR_RANGE`].
///
/// A is the corner next to the eye, for which the terms are least. Its error is that of a corner in
/// [`Determinants::in_double_double`], whose bound holds.
pub(super) fn eye_distance(
    eye: DVec3,
    tree_origin: DVec3,
    corners: [Vec3; 3],
) -> Option<Determinant> {
    let EyeFactors { corners, ways } = EyeFactors::new(eye, tree_origin, corners)?;
    let far = |corner: usize| corners[corner].size.size.max_element();
    let mut first = 0;
    for corner in 1..3 {
        if far(corner) < far(first) {
            first = corner;
        }
    }
    // (B−A)×(C−A) is (A−C)×(B−A): the way to the corner times the way from it.
    let pair = (&ways[(first + 2) % 3], &ways[first]);
    Some(best_determinant(&corners[first], &[pair]))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::exact::{cross, decompose, dot, ratio, subtract};
    use crate::num::integer::Integer;
    use crate::random::Random;
    use num_bigint::BigInt;

    /// Whole numbers, whose determinants integers of any length hold. Eyes are next to the lines of edges but for
    /// rounding, and directions along their planes. With either share of the error in [`EyeCross`] at zero this fails,
    /// and with that of rounded ones.
    #[test]
    fn weights_from_an_eye_are_within_their_bounds_of_those_in_integers() {
        let whole = |x: f64| {
            let (mantissa, exponent) = decompose(x);
            BigInt::shifted(mantissa, exponent as u32)
        };
        let vector = |v: DVec3| v.to_array().map(whole);
        let mut random = Random(91);
        let mut sure = [0; 2];
        for round in 0..6000 {
            let coordinate =
                |random: &mut Random, unit: f32| (random.signed() * 8e6).round() as f32 * unit;
            let unit = if round % 4 == 3 { 2f32.powi(60) } else { 2e8 };
            let mut corners =
                [(); 3].map(|()| Vec3::from_array([(); 3].map(|()| coordinate(&mut random, unit))));
            if round % 4 == 3 {
                corners[2] = -corners[1];
            }
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let eye = match round % 4 {
                0 => a + (b - a) * (random.signed() * 3.0),
                1 => a + ((b - a) * random.unit() + (c - a) * random.unit()) * 0.5,
                2 => random.point() * 1e15,
                // Next to the line from B through zero to C, by a share of their lengths that only double-double has.
                _ => b * (random.signed() * 2f64.powi(-34)),
            };
            let eye = eye.round();
            let target = a + (b - a) * random.signed() + (c - a) * random.signed();
            let direction = (target - eye).round();
            let triangle = OffsetTriangle {
                corners,
                origin: DVec3::ZERO,
            };
            let numerator = Determinant {
                value: 1.0,
                error: 0.0,
            };
            let shared = EyeDeterminants::new(eye, &triangle, numerator).expect("in range");
            let exact = EyeDeterminants::exact(eye, &triangle, numerator);
            assert!(exact.are_accurate());
            let found = [shared, exact].map(|shared| shared.of(direction).expect("in range"));
            let [a, b, c] = [a, b, c].map(|corner| subtract(&vector(corner), &vector(eye)));
            let direction = vector(direction);
            for (at, (from, to)) in [(&b, &c), (&c, &a), (&a, &b)].into_iter().enumerate() {
                let truth = dot(&direction, &cross(from, to));
                for (found, sure) in found.iter().zip(&mut sure) {
                    let Determinant { value, error } = found.weights[at];
                    let off = ratio(&truth.minus(&whole(value)), &BigInt::shifted(1, 0), 0);
                    assert!(off.abs() <= error, "{off} {error}");
                    *sure += u32::from(value.abs() > error);
                }
            }
        }
        assert!(sure[0] > 10_000 && sure[1] > 9900, "{sure:?}");
    }
}
