//! Determinants of a ray and a triangle, and distances from its plane, in double-double arithmetic: they decide most of
//! what double precision leaves undecided. ε = 2⁻⁵³.

use super::componentwise::{Determinant, Determinants, Factor};
use super::exact::OffsetTriangle;
use crate::num::double_double::DoubleDouble;
use crate::num::roundoff::EPSILON;
use glam::{DVec3, Vec3, Vec3Swizzles};

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
    fn edge([from, to]: [Vec3; 2]) -> Self {
        let difference = |axis| DoubleDouble::difference(to[axis].into(), from[axis].into());
        Self::of([0, 1, 2].map(difference))
    }
}

/// A triangle's corners A, B and C relative to an eye, and the edges from A to B, B to C and C to A.
struct EyeFactors {
    corners: [WideFactor; 3],
    edges: [WideFactor; 3],
}

impl EyeFactors {
    /// `corners` are relative to `tree_origin`. `None` where a factor is out of [range](Factor::in_range).
    fn new(eye: DVec3, tree_origin: DVec3, corners: [Vec3; 3]) -> Option<Self> {
        let axes = [0, 1, 2];
        let tree_origin = axes.map(|axis| DoubleDouble::difference(tree_origin[axis], eye[axis]));
        let relative = |corner: Vec3| {
            let place = axes.map(|axis| tree_origin[axis] + f64::from(corner[axis]).into());
            WideFactor::of(place)
        };
        let [a, b, c] = corners;
        let edge = WideFactor::edge;
        // Without `map`, whose loop of such large items is not inlined.
        let factors = Self {
            corners: [relative(a), relative(b), relative(c)],
            edges: [edge([a, b]), edge([b, c]), edge([c, a])],
        };
        let mut all = factors.corners.iter().chain(&factors.edges);
        let in_range = all.all(|factor| factor.size.in_range().all());
        in_range.then_some(factors)
    }
}

/// A cross product in double-double arithmetic. That of two corners relative to an eye, times a ray's direction, is one
/// of its weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct WideCross {
    value: WideVector,
    /// Of each component, the sum of its products' magnitudes.
    terms: DVec3,
}

impl WideCross {
    /// The error of a determinant, as a share of its permanent (see [`WideDeterminants`]).
    const OFF: f64 = 32.0 * EPSILON * EPSILON;

    fn new(b: &WideFactor, c: &WideFactor) -> Self {
        Self {
            value: cross(b.value, c.value),
            terms: terms(b, c),
        }
    }

    /// A×C of two corners relative to an eye; `edge` is that from A to C. A×u and C×u are the same, with u = C − A: the one
    /// with the least terms is computed, so that triangles that are tiny compared with their distance are decided as
    /// well.
    fn of_corners(a: &WideFactor, c: &WideFactor, edge: &WideFactor) -> Self {
        let pairs = [(a, c), (a, edge), (c, edge)];
        let sums = pairs.map(|(b, c)| terms(b, c).element_sum());
        let mut best = 0;
        for other in 1..3 {
            if sums[other] < sums[best] {
                best = other;
            }
        }
        let (b, c) = pairs[best];
        Self::new(b, c)
    }

    /// The product with a third factor.
    fn times(&self, factor: &WideFactor) -> Determinant {
        // A thousandth covers the permanent's own rounding.
        let permanent = factor.size.size.dot(self.terms) * 1.001;
        let value = dot(factor.value, self.value).high;
        Determinant {
            value,
            error: Self::OFF * permanent + EPSILON * value.abs(),
        }
    }

    /// Rounded to double precision, and of each component the bound on its error before that (see [`eye_determinants`](super::eye_determinants)).
    pub(super) fn rounded(&self) -> (DVec3, DVec3) {
        let value = self.value.map(|x| x.high);
        let off = self.terms * (16.0 * EPSILON * EPSILON);
        (DVec3::from_array(value), off)
    }
}

/// The determinants of rays from one eye in double-double arithmetic, but for the direction.
///
/// A corner relative to the eye is off by 3.1ε² of itself, since the tree's origin relative to the eye is exact, as
/// differences of corners are; a product of two by 12ε² with its rounding, their difference by 3.1ε² more, the product
/// with the third factor by 5ε², or 8.1ε² where that is a coordinate too, and two sums by 6.2ε²: below 32ε² of the
/// permanent. The result is rounded to double precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct WideDeterminants {
    pub(super) crosses: [WideCross; 3],
    numerator: Determinant,
}

impl WideDeterminants {
    /// A·(B×C) is A·((B−A)×(C−A)) too: the form whose permanent is least is computed. `None` where a factor is out of
    /// [range](Factor::in_range).
    pub(super) fn new(eye: DVec3, triangle: &OffsetTriangle) -> Option<Self> {
        let EyeFactors {
            corners: [a, b, c],
            edges: [ab, bc, ca],
        } = EyeFactors::new(eye, triangle.origin, triangle.corners)?;
        let crosses = [
            WideCross::of_corners(&b, &c, &bc),
            WideCross::of_corners(&c, &a, &ca),
            WideCross::of_corners(&a, &b, &ab),
        ];
        let pairs = [(&b, &c), (&ca, &ab)];
        let permanents = pairs.map(|(b, c)| terms(b, c).dot(a.size.size));
        let (b, c) = pairs[usize::from(permanents[1] < permanents[0])];
        let numerator = WideCross::new(b, c).times(&a);
        Some(Self { crosses, numerator })
    }

    /// The determinants of a ray with this direction. `None` where that is out of [range](Factor::in_range).
    pub(super) fn of(&self, direction: DVec3) -> Option<Determinants> {
        let direction = WideFactor::of(direction.to_array().map(DoubleDouble::from));
        let [e, f, g] = &self.crosses;
        direction.size.in_range().all().then(|| Determinants {
            weights: [e, f, g].map(|cross| cross.times(&direction)),
            numerator: self.numerator,
        })
    }
}

/// (p−a)·((b−a)×(c−a)) in double-double arithmetic: the distances of three points from a triangle's plane times the
/// normal's length.
///
/// Differences of corners are exact, so that the bound of [`WideDeterminants`] holds.
pub(super) fn plane_distances([p, q, r]: [Vec3; 3], [a, b, c]: [Vec3; 3]) -> [Determinant; 3] {
    let from_a = |to| WideFactor::edge([a, to]);
    let normal = WideCross::new(&from_a(b), &from_a(c));
    [
        normal.times(&from_a(p)),
        normal.times(&from_a(q)),
        normal.times(&from_a(r)),
    ]
}

/// A·((B−A)×(C−A)) in double-double arithmetic, with corners relative to an eye: its distance from the plane times the
/// normal's length, positive where the normal points away from it. `None` where a factor is out of
/// [range](Factor::in_range).
///
/// A is the corner next to the eye, for which the terms are least. Its error is that of a corner in
/// [`WideDeterminants`], whose bound holds.
pub(super) fn eye_distance(
    eye: DVec3,
    tree_origin: DVec3,
    corners: [Vec3; 3],
) -> Option<Determinant> {
    let EyeFactors { corners, edges } = EyeFactors::new(eye, tree_origin, corners)?;
    let far = |corner: usize| corners[corner].size.size.max_element();
    let mut first = 0;
    for corner in 1..3 {
        if far(corner) < far(first) {
            first = corner;
        }
    }
    // (B−A)×(C−A) is (A−C)×(B−A): the edge to the corner times the edge from it.
    let normal = WideCross::new(&edges[(first + 2) % 3], &edges[first]);
    Some(normal.times(&corners[first]))
}

/// The cross product of two corners relative to an eye, each component within 2.01ε of itself. `None` where
/// double-double arithmetic does not suffice.
pub(super) fn cross_from(eye: DVec3, corners: [Vec3; 2]) -> Option<DVec3> {
    let relative = |corner: Vec3| {
        let difference = |axis| DoubleDouble::difference(corner[axis].into(), eye[axis]);
        WideFactor::of([0, 1, 2].map(difference))
    };
    let ([a, c], edge) = (corners.map(relative), WideFactor::edge(corners));
    let in_range = [&a, &c, &edge].map(|factor| factor.size.in_range().all());
    let (value, off) = WideCross::of_corners(&a, &c, &edge).rounded();
    // NaN fails this comparison.
    let is_close = off.cmple(value.abs() * EPSILON).all();
    (is_close && !in_range.contains(&false)).then_some(value)
}

/// Of each component of a cross product, the sum of its products' magnitudes.
fn terms(b: &WideFactor, c: &WideFactor) -> DVec3 {
    let (b, c) = (b.size.size, c.size.size);
    b.yzx() * c.zxy() + b.zxy() * c.yzx()
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
