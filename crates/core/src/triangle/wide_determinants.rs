//! Determinants of a ray and a triangle, and distances from its plane, in double-double arithmetic: they decide most of
//! what double precision leaves undecided. ε = 2⁻⁵³. On the widest instruction set that the machine has, since the bits
//! are the same on each.

use super::componentwise::{Determinant, Determinants};
use super::exact::OffsetTriangle;
use super::wide_vectors::{
    Cross, WideCross, WideFactor, determinant, determinants, load, sum, terms,
};
use crate::num::double_double::DoubleDouble;
use crate::num::roundoff::EPSILON;
use crate::num::simd::{F64x4, Lanes, Simd, Work, dispatch};
use glam::{DVec3, Vec3};

/// A triangle's corners A, B and C relative to an eye, and the edges from A to B, B to C and C to A.
struct EyeFactors<L: Lanes> {
    corners: [WideFactor<L>; 3],
    edges: [WideFactor<L>; 3],
}

impl<L: Lanes> EyeFactors<L> {
    /// `None` where a factor is out of range.
    #[inline(always)]
    fn new(lanes: L, eye: DVec3, triangle: &OffsetTriangle) -> Option<Self> {
        let tree_origin = DoubleDouble::difference(load(lanes, triangle.origin), load(lanes, eye));
        let [a, b, c] = triangle.corners;
        // Without closures: what is called in one would not be compiled for the instruction set.
        let factors = Self {
            corners: [
                WideFactor::relative(lanes, a, tree_origin),
                WideFactor::relative(lanes, b, tree_origin),
                WideFactor::relative(lanes, c, tree_origin),
            ],
            edges: [
                WideFactor::edge(lanes, [a, b]),
                WideFactor::edge(lanes, [b, c]),
                WideFactor::edge(lanes, [c, a]),
            ],
        };
        let mut are_in_range = true;
        for factor in factors.corners.iter().chain(&factors.edges) {
            are_in_range &= factor.is_in_range();
        }
        are_in_range.then_some(factors)
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
    /// range.
    pub(super) fn new(eye: DVec3, triangle: &OffsetTriangle) -> Option<Self> {
        let mut found = None;
        let work = FromEye {
            eye,
            triangle,
            found: &mut found,
        };
        dispatch(Simd::best(), work);
        found
    }

    /// The determinants of a ray with this direction. `None` where that is out of range.
    pub(super) fn of(&self, direction: DVec3) -> Option<Determinants> {
        let mut weights = None;
        let work = Weights {
            crosses: &self.crosses,
            direction,
            found: &mut weights,
        };
        dispatch(Simd::best(), work);
        weights.map(|weights| Determinants {
            weights,
            numerator: self.numerator,
        })
    }
}

/// [`WideDeterminants::new`].
struct FromEye<'a> {
    eye: DVec3,
    triangle: &'a OffsetTriangle,
    found: &'a mut Option<WideDeterminants>,
}

impl Work for FromEye<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Some(EyeFactors {
            corners: [a, b, c],
            edges: [ab, bc, ca],
        }) = EyeFactors::new(lanes, self.eye, self.triangle)
        else {
            return;
        };
        let crosses = [
            Cross::of_corners(&b, &c, &bc),
            Cross::of_corners(&c, &a, &ca),
            Cross::of_corners(&a, &b, &ab),
        ];
        let permanents = [sum(terms(&b, &c) * a.size), sum(terms(&ca, &ab) * a.size)];
        let (from, to) = match permanents[1] < permanents[0] {
            true => (ca, ab),
            false => (b, c),
        };
        let normal = Cross::new(&from, &to);
        let mut are_in_range = normal.is_in_range();
        for cross in &crosses {
            are_in_range &= cross.is_in_range();
        }
        *self.found = are_in_range.then(|| WideDeterminants {
            crosses: [crosses[0].store(), crosses[1].store(), crosses[2].store()],
            numerator: determinant(lanes, normal, &a),
        });
    }
}

/// The weights of [`WideDeterminants::of`].
struct Weights<'a> {
    crosses: &'a [WideCross; 3],
    direction: DVec3,
    found: &'a mut Option<[Determinant; 3]>,
}

impl Work for Weights<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let direction = WideFactor::exact(lanes, self.direction);
        if direction.is_in_range() {
            let [e, f, g] = self.crosses;
            let crosses = [
                Cross::load(lanes, e),
                Cross::load(lanes, f),
                Cross::load(lanes, g),
            ];
            *self.found = Some(determinants(lanes, &crosses, [&direction; 3]));
        }
    }
}

/// (p−a)·((b−a)×(c−a)) in double-double arithmetic: the distances of three points from a triangle's plane times the
/// normal's length.
///
/// Differences of corners are exact and at least 2⁻¹⁴⁹, so that the bound of [`WideDeterminants`] holds.
pub(super) fn plane_distances(points: [Vec3; 3], corners: [Vec3; 3]) -> [Determinant; 3] {
    let mut found = [Determinant {
        value: 0.0,
        error: f64::INFINITY,
    }; 3];
    let work = PlaneDistances {
        points,
        corners,
        found: &mut found,
    };
    dispatch(Simd::best(), work);
    found
}

/// [`plane_distances`].
struct PlaneDistances<'a> {
    points: [Vec3; 3],
    corners: [Vec3; 3],
    found: &'a mut [Determinant; 3],
}

impl Work for PlaneDistances<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let ([p, q, r], [a, b, c]) = (self.points, self.corners);
        let normal = Cross::new(
            &WideFactor::edge(lanes, [a, b]),
            &WideFactor::edge(lanes, [a, c]),
        );
        let factors = [
            &WideFactor::edge(lanes, [a, p]),
            &WideFactor::edge(lanes, [a, q]),
            &WideFactor::edge(lanes, [a, r]),
        ];
        *self.found = determinants(lanes, &[normal; 3], factors);
    }
}

/// A·((B−A)×(C−A)) in double-double arithmetic, with corners relative to an eye: its distance from the plane times the
/// normal's length, positive where the normal points away from it. `None` where a factor is out of range.
///
/// A is the corner next to the eye, for which the terms are least. Its error is that of a corner in
/// [`WideDeterminants`], whose bound holds.
pub(super) fn eye_distance(eye: DVec3, triangle: &OffsetTriangle) -> Option<Determinant> {
    let mut found = None;
    let work = EyeDistance {
        eye,
        triangle,
        found: &mut found,
    };
    dispatch(Simd::best(), work);
    found
}

/// [`eye_distance`].
struct EyeDistance<'a> {
    eye: DVec3,
    triangle: &'a OffsetTriangle,
    found: &'a mut Option<Determinant>,
}

impl Work for EyeDistance<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Some(EyeFactors { corners, edges }) = EyeFactors::new(lanes, self.eye, self.triangle)
        else {
            return;
        };
        let (mut first, mut least) = (0, f64::INFINITY);
        for (corner, factor) in corners.iter().enumerate() {
            let [x, y, z, _] = factor.size.to_array();
            let far = x.max(y).max(z);
            if far < least {
                (first, least) = (corner, far);
            }
        }
        // (B−A)×(C−A) is (A−C)×(B−A): the edge to the corner times the edge from it.
        let normal = Cross::new(&edges[(first + 2) % 3], &edges[first]);
        if normal.is_in_range() {
            *self.found = Some(determinant(lanes, normal, &corners[first]));
        }
    }
}

/// The cross product of two corners relative to an eye, each component within 2.01ε of itself. `None` where
/// double-double arithmetic does not suffice.
pub(super) fn cross_from(eye: DVec3, corners: [Vec3; 2]) -> Option<DVec3> {
    let mut found = None;
    let work = CrossFrom {
        eye,
        corners,
        found: &mut found,
    };
    dispatch(Simd::best(), work);
    let (value, off) = found?.rounded();
    // NaN fails this comparison.
    let is_close = off.cmple(value.abs() * EPSILON).all();
    is_close.then_some(value)
}

/// [`cross_from`].
struct CrossFrom<'a> {
    eye: DVec3,
    corners: [Vec3; 2],
    found: &'a mut Option<WideCross>,
}

impl Work for CrossFrom<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let [a, c] = self.corners;
        let a = WideFactor::difference(lanes, a.as_dvec3(), self.eye);
        let c = WideFactor::difference(lanes, c.as_dvec3(), self.eye);
        let edge = WideFactor::edge(lanes, self.corners);
        if a.is_in_range() & c.is_in_range() & edge.is_in_range() {
            *self.found = Some(Cross::of_corners(&a, &c, &edge).store());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    type Bits = Vec<Option<Vec<u64>>>;

    fn bits_of(determinants: &[Determinant]) -> Vec<u64> {
        let bits = |it: &Determinant| [it.value.to_bits(), it.error.to_bits()];
        determinants.iter().flat_map(bits).collect()
    }

    /// All of an eye, a triangle, and points of which the first is a direction.
    fn bits(simd: Simd, eye: DVec3, triangle: &OffsetTriangle, points: [Vec3; 3]) -> Bits {
        let (mut from_eye, mut distance, mut cross) = (None, None, None);
        let mut weights = None;
        let work = FromEye {
            eye,
            triangle,
            found: &mut from_eye,
        };
        dispatch(simd, work);
        let work = EyeDistance {
            eye,
            triangle,
            found: &mut distance,
        };
        dispatch(simd, work);
        let [a, b, _] = triangle.corners;
        let work = CrossFrom {
            eye,
            corners: [a, b],
            found: &mut cross,
        };
        dispatch(simd, work);
        let known: Option<WideDeterminants> = from_eye;
        if let Some(known) = &known {
            let work = Weights {
                crosses: &known.crosses,
                direction: points[0].as_dvec3(),
                found: &mut weights,
            };
            dispatch(simd, work);
        }
        let mut distances = [Determinant {
            value: 0.0,
            error: 0.0,
        }; 3];
        let work = PlaneDistances {
            points,
            corners: triangle.corners,
            found: &mut distances,
        };
        dispatch(simd, work);
        let of_cross = |cross: WideCross| {
            let numbers = [cross.high, cross.low, cross.terms].into_iter().flatten();
            numbers.map(f64::to_bits).collect()
        };
        vec![
            known.map(|known| bits_of(&[known.numerator])),
            distance.map(|distance| bits_of(&[distance])),
            cross.map(of_cross),
            weights.map(|weights| bits_of(&weights)),
            Some(bits_of(&distances)),
        ]
    }

    /// Of all sizes: some are out of range, and terms cancel where the eye is close to the plane.
    #[test]
    fn each_instruction_set_computes_the_same_bits() {
        let mut random = Random(97);
        let mut known = [0; 5];
        for round in 0..20_000 {
            let mut size = || crate::math::pow(2.0, 126.0 * random.signed());
            let (one, other) = match round % 2 {
                0 => (1.0, 1.0),
                _ => (size(), size()),
            };
            let corners = [(); 3].map(|()| (random.point() * one).as_vec3());
            let points = [(); 3].map(|()| (random.point() * other).as_vec3());
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let beside = random.point() * crate::math::pow(10.0, -320.0 * random.unit());
            let eye = match round % 3 {
                0 => a + (b - a) * random.signed() + (c - a) * random.signed(),
                1 => beside,
                _ => random.point() * other,
            };
            let triangle = OffsetTriangle {
                corners,
                origin: random.point() * (round % 5) as f64,
            };
            let plain = bits(Simd::Plain, eye, &triangle, points);
            assert_eq!(
                bits(Simd::best(), eye, &triangle, points),
                plain,
                "{eye} {triangle:?}"
            );
            for (known, bits) in known.iter_mut().zip(plain) {
                *known += usize::from(bits.is_some());
            }
        }
        let (least, most) = (known.iter().min(), known.iter().max());
        assert!(least > Some(&9_000) && most == Some(&20_000), "{known:?}");
    }
}
