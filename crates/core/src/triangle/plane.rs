//! The plane of a triangle, and on which side of it the corners of another triangle lie.
//!
//! Of two triangles that a ray hits, the one whose plane n·(p − a) = 0 separates the other's hit from the ray's origin
//! is nearer. The other's hit is a mean of its corners bₖ, so its signed distance from the plane is the same mean of
//! their distances sₖ = n·(bₖ − a); and where all of these have one sign, no matter which mean (the plane tests of
//! Newell, Newell, Sancha, "A Solution to the Hidden Surface Problem", 1972).
//!
//! The sₖ are accurate to their own size, however far away the ray starts: what cancels in them is the distance of the
//! triangles from one another, while two parameters of hits must first be known to the last digit to be compared.
//!
//! # Error bounds
//! ε = 2⁻⁵³.
//!
//! Edges are off by ε of themselves, a product of two by 3ε, a component of n by 4εp, p being the sum of its two
//! products' magnitudes. bₖ − a is off by ε of itself, a sum of three products by 3ε: to first order sₖ is off by
//! 8εΣp|bₖ − a|. The bound is 9εΣp|bₖ − a|: one ε more for higher orders and for the rounding of p. That of n·d is
//! 9εΣp|d|; a vector that is off by η more adds ηΣp.
//!
//! Where terms cancel by more than that, distances are computed exactly and rounded (`exact::distances_from_plane`):
//! those of triangles of a tilted plane whose corners are subnormal numbers off it, say.

use super::BoundedHit;
use super::componentwise::Determinant;
use super::exact::{self, OffsetTriangle};
use super::wide_determinants::{eye_distance, plane_distances};
use crate::num::roundoff::EPSILON;
use glam::{DVec3, Vec3};

/// Values below this may have lost digits to underflow, and their signs prove nothing.
///
/// Differences of single-precision coordinates are zero or at least 2⁻¹⁴⁹, so products of three of them do not
/// underflow. A product with an eye or an edge function, which are doubles, may be off by 2⁻¹⁰⁷⁵ times its other
/// factors: with coordinates up to 10¹⁸, by less than 10⁻²⁵⁰. A value above 10⁻¹³⁵ would leave planes undecided that
/// are subnormal numbers apart.
pub(crate) const LEAST_SURE: f64 = 1e-250;

/// The error of a hit's weights: they are rounded well in single precision, within 2⁻²⁶
/// ([`WELL_CONDITIONED`](super::edges::WELL_CONDITIONED)).
const WEIGHT_ERROR: f64 = 1.0 / (1u64 << 24) as f64;

/// The error of an eye's distance from a plane, relative to the distance: depths that are divided by the distance are
/// then known to more than single precision's 24 digits.
const MOST_ERROR: f64 = 1.0 / (1 << 28) as f64;

/// A triangle's plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    /// a.
    corner: DVec3,
    /// n.
    normal: DVec3,
    /// −1 where the normal was turned, else 1.
    turn: f64,
    /// p.
    magnitude: DVec3,
}

impl Plane {
    pub(crate) fn new(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let (u, v) = (b - a, c - a);
        let plus = DVec3::new(u.y * v.z, u.z * v.x, u.x * v.y);
        let minus = DVec3::new(u.z * v.y, u.x * v.z, u.y * v.x);
        Self {
            corner: a,
            normal: plus - minus,
            turn: 1.0,
            magnitude: plus.abs() + minus.abs(),
        }
    }

    /// The plane with its normal turned to the side that rays of a direction go to; the direction is off by at most
    /// `error`. `None` where that is not sure.
    pub(crate) fn turned_along(mut self, direction: DVec3, error: f64) -> Option<Self> {
        let value = self.normal.dot(direction);
        let error = self.error(direction.abs()) + error * self.magnitude.element_sum();
        self.turn = value.signum();
        self.normal *= self.turn;
        // NaN fails this comparison.
        (value.abs() > error + LEAST_SURE).then_some(self)
    }

    /// [`Plane::turned_along`] for rays that start at an eye, off by at most `error`, and hit the triangle.
    pub(crate) fn turned_from(self, eye: DVec3, error: f64) -> Option<Self> {
        self.turned_along(self.corner - eye, error)
    }

    /// [`Plane::turned_from`] with the corners at hand, decided exactly, for an eye that is not off: for planes that
    /// pass it more closely than roundings in double precision.
    pub(crate) fn turned_exactly_from(mut self, eye: DVec3, corners: [Vec3; 3]) -> Option<Self> {
        let triangle = OffsetTriangle {
            corners,
            origin: DVec3::ZERO,
        };
        let value = distance_of_eye(eye, &triangle).value;
        self.turn = value.signum();
        self.normal *= self.turn;
        (value != 0.0).then_some(self)
    }

    /// A point's signed distance times the normal's length, and the bound on its error.
    #[inline(always)]
    pub(crate) fn distance(&self, point: Vec3) -> (f64, f64) {
        let relative = point.as_dvec3() - self.corner;
        (self.normal.dot(relative), self.error(relative.abs()))
    }

    /// [`Plane::distance`] of a ray's origin that is off by at most `error` a coordinate.
    pub(crate) fn distance_of_origin(&self, origin: DVec3, error: f64) -> (f64, f64) {
        let relative = origin - self.corner;
        let off = error * self.magnitude.element_sum() * 1.01;
        (self.normal.dot(relative), self.error(relative.abs()) + off)
    }

    /// The distance of an eye, off by at most `error` a coordinate; `corners` are the plane's.
    pub(crate) fn distance_of_eye(&self, corners: [Vec3; 3], eye: DVec3, error: f64) -> (f64, f64) {
        if error > 0.0 {
            return self.distance_of_origin(eye, error);
        }
        let triangle = OffsetTriangle {
            corners,
            origin: DVec3::ZERO,
        };
        let Determinant { value, error } = distance_of_eye(eye, &triangle);
        (value * -self.turn, error)
    }

    /// The product of a direction and the normal, and the bound on its error.
    pub(crate) fn along(&self, direction: DVec3) -> (f64, f64) {
        (self.normal.dot(direction), self.error(direction.abs()))
    }

    /// [`Plane::distance`] of three points in double-double arithmetic; `corners` are the plane's.
    pub(crate) fn distances_in_double_double(
        &self,
        corners: [Vec3; 3],
        points: [Vec3; 3],
    ) -> [(f64, f64); 3] {
        plane_distances(points, corners)
            .map(|Determinant { value, error }| (value * self.turn, error))
    }

    /// Distances from [`exact::distances_from_plane`], as [`Plane::distance`] gives them.
    pub(crate) fn with_bounds(&self, distances: [f64; 3]) -> [(f64, f64); 3] {
        distances.map(|distance| (distance * self.turn, 2.0 * EPSILON * distance.abs()))
    }

    /// The bound on the error of a product with the normal.
    #[inline(always)]
    fn error(&self, factors: DVec3) -> f64 {
        9.0 * EPSILON * self.magnitude.dot(factors)
    }
}

/// On which side of a plane a triangle's hit lies, by the distances of its corners, each with its error: 1.0 where the
/// normal points to, or −1.0. `None` where that is not sure.
pub(super) fn side_of_plane(distances: [(f64, f64); 3], hit: &BoundedHit) -> Option<f64> {
    let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
    let (mut value, mut error) = (0.0, 0.0);
    let (mut is_before, mut is_behind) = (true, true);
    for ((distance, distance_error), weight) in distances.into_iter().zip(weights) {
        value += distance * weight;
        // The first weight has the errors of both others.
        error += distance.abs() * (2.0 * WEIGHT_ERROR) + distance_error * (1.0 + WEIGHT_ERROR);
        is_before &= distance > distance_error + LEAST_SURE;
        is_behind &= distance < -distance_error - LEAST_SURE;
    }
    match (is_before, is_behind) {
        (true, _) => Some(1.0),
        (_, true) => Some(-1.0),
        _ => (value.abs() > error * 1.01 + LEAST_SURE).then_some(value.signum()),
    }
}

/// The distance of an eye from a triangle's plane times the normal's length, positive where the normal points away from
/// the eye, with an error of [`MOST_ERROR`] of it at most. In double-double arithmetic where that suffices, else
/// exactly; zero only where the plane contains the eye, unless it is less than any double is.
pub(crate) fn distance_of_eye(eye: DVec3, triangle: &OffsetTriangle) -> Determinant {
    let wide = eye_distance(eye, triangle);
    // NaN fails this comparison, and so does zero unless it is surely so.
    if let Some(wide) = wide.filter(|wide| wide.error <= MOST_ERROR * wide.value.abs()) {
        return wide;
    }
    let value = exact::distance_of_eye(eye, triangle);
    Determinant {
        value,
        error: 4.0 * EPSILON * value.abs(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Whole numbers, which single precision holds and whose determinants 128-bit integers hold.
    fn whole(random: &mut Random, most: f64) -> [i128; 3] {
        [(); 3].map(|()| (random.signed() * most).round() as i128)
    }

    fn point(of: [i128; 3]) -> Vec3 {
        Vec3::from_array(of.map(|x| x as f32))
    }

    fn minus(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }

    fn determinant(a: [i128; 3], b: [i128; 3], c: [i128; 3]) -> i128 {
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    }

    /// Points in a plane but for roundings. With the bound at zero this fails.
    #[test]
    fn distances_are_within_their_bounds_of_those_in_integers() {
        let mut random = Random(71);
        let mut decided = 0;
        for _ in 0..20_000 {
            let most = f64::from(1 << 20);
            let [a, b, c] = [(); 3].map(|()| whole(&mut random, most));
            let (u, v) = (minus(b, a), minus(c, a));
            let (s, t) = (random.signed(), random.signed());
            let at = [0, 1, 2].map(|k| a[k] + (u[k] as f64 * s + v[k] as f64 * t) as i128);
            let truth = determinant(minus(at, a), u, v);
            let (value, error) = Plane::new([a, b, c].map(point)).distance(point(at));
            let off = (value as i128 - truth).unsigned_abs();
            assert!(off as f64 <= error + 0.5, "{a:?} {b:?} {c:?} {at:?}");
            decided += u32::from(value.abs() > error);
        }
        assert!(decided > 19_000, "{decided}");
    }

    /// As above, for distances that are rounded from exact ones. With their bound at zero this fails.
    #[test]
    fn exact_distances_are_within_their_bounds_of_those_in_integers() {
        let mut random = Random(75);
        let mut in_plane = 0;
        for round in 0..5000 {
            let most = f64::from(1 << [2, 20][round % 2]);
            let corners = [(); 3].map(|()| whole(&mut random, most));
            let points = [(); 3].map(|()| whole(&mut random, most));
            let [a, b, c] = corners;
            let normal_side = Plane::new(corners.map(point));
            let distances = exact::distances_from_plane(points.map(point), corners.map(point));
            for (at, (value, error)) in points.into_iter().zip(normal_side.with_bounds(distances)) {
                let truth = determinant(minus(at, a), minus(b, a), minus(c, a));
                let off = (value as i128 - truth).unsigned_abs();
                assert!(off as f64 <= error, "{corners:?} {at:?}");
                assert_eq!(value == 0.0, truth == 0);
                in_plane += u32::from(truth == 0);
            }
        }
        assert!(in_plane > 200, "{in_plane}");
    }

    /// Origins in a plane but for roundings, moved by as much as their error allows. With either term of the bound at
    /// zero this fails.
    #[test]
    fn origins_that_are_off_are_within_the_bounds_of_distances() {
        let mut random = Random(73);
        for round in 0..20_000 {
            let most = f64::from(1 << 20);
            let [a, b, c] = [(); 3].map(|()| whole(&mut random, most));
            let (u, v) = (minus(b, a), minus(c, a));
            let (s, t) = (random.signed(), random.signed());
            let at = [0, 1, 2].map(|k| a[k] + (u[k] as f64 * s + v[k] as f64 * t) as i128);
            let off = match round % 2 {
                0 => [0; 3],
                _ => whole(&mut random, 9.0),
            };
            let truth = determinant(minus(at, a), u, v);
            let seen = DVec3::from_array([0, 1, 2].map(|k| (at[k] + off[k]) as f64));
            let most = off.map(i128::abs).into_iter().max().unwrap_or(0);
            let plane = Plane::new([a, b, c].map(point));
            let (value, error) = plane.distance_of_origin(seen, most as f64);
            let off = (value as i128 - truth).unsigned_abs();
            assert!(off as f64 <= error + 0.5, "{a:?} {b:?} {c:?} {at:?}");
        }
    }

    /// Eyes in a plane but for roundings, and corners of very different sizes. With the bound of double-double
    /// arithmetic at zero this fails.
    #[test]
    fn distances_of_eyes_are_within_their_bounds_of_those_in_integers() {
        let mut random = Random(74);
        let mut wide = 0;
        for round in 0..20_000 {
            let corners = [(); 3].map(|()| {
                let size = crate::math::pow(2.0, 20.0 * random.signed());
                (random.point() * size).as_vec3()
            });
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let eye = match round % 4 {
                0 => a.with_x(a.x.next_up()),
                _ => a + (b - a) * random.signed() + (c - a) * random.signed(),
            };
            let triangle = OffsetTriangle {
                corners,
                origin: DVec3::ZERO,
            };
            let truth = exact::distance_of_eye(eye, &triangle);
            let Determinant { value, error } = distance_of_eye(eye, &triangle);
            let rounding = EPSILON * truth.abs();
            assert!(
                (value - truth).abs() <= error + rounding,
                "{corners:?} {eye}"
            );
            assert!(error <= MOST_ERROR * value.abs());
            let Some(first) = eye_distance(eye, &triangle) else {
                continue;
            };
            assert!(
                (first.value - truth).abs() <= first.error + rounding,
                "{corners:?} {eye}"
            );
            wide += u32::from(first.error <= MOST_ERROR * first.value.abs());
        }
        assert!(wide > 10_000 && wide < 20_000, "{wide}");
    }

    /// Directions that are parallel to a plane but for roundings. With either term of the bound at zero this fails.
    #[test]
    fn planes_turn_to_where_integers_say_that_rays_go() {
        let mut random = Random(72);
        let [mut turned, mut unsure] = [0; 2];
        for round in 0..20_000 {
            let most = f64::from(1 << 20);
            let [a, b, c] = [(); 3].map(|()| whole(&mut random, most));
            let (u, v) = (minus(b, a), minus(c, a));
            let (s, t) = (random.signed(), random.signed());
            let along = [0, 1, 2].map(|k| (u[k] as f64 * s + v[k] as f64 * t) as i128);
            // Some are exactly parallel, and some are moved by as much as their error allows.
            let [s, t] = [s, t].map(|s| (s * 1024.0) as i128);
            let (along, off) = match round % 3 {
                0 => (along, [0; 3]),
                1 => ([0, 1, 2].map(|k| u[k] * s + v[k] * t), [0; 3]),
                _ => (along, whole(&mut random, 9.0)),
            };
            let truth = determinant(along, u, v).signum();
            let seen = [0, 1, 2].map(|k| (along[k] + off[k]) as f64);
            let error = off.map(i128::abs).into_iter().max().unwrap_or(0);
            let plane = Plane::new([a, b, c].map(point));
            let normal = plane.normal;
            match plane.turned_along(DVec3::from_array(seen), error as f64) {
                Some(plane) if truth > 0 => assert_eq!(plane.normal, normal),
                Some(plane) => {
                    assert_eq!(plane.normal, -normal);
                    assert!(truth < 0);
                }
                None => unsure += 1,
            }
            turned += 1;
        }
        assert!(
            unsure > 100 && unsure < turned * 3 / 4,
            "{unsure} of {turned}"
        );
    }

    /// A hit on the line where two planes cross, with weights that are off by as much as they may be. With the error of
    /// weights at zero this fails.
    #[test]
    fn sides_of_hits_next_to_where_planes_cross_are_not_sure() {
        let plane = Plane::new([Vec3::ZERO, Vec3::X, Vec3::Y]);
        let corners = [
            Vec3::new(0.0, 0.0, -1.0),
            Vec3::new(1.0, 0.0, 1.0),
            Vec3::new(0.0, 1.0, 1.0),
        ];
        let side_of = |hit: &BoundedHit, corners: [Vec3; 3]| {
            side_of_plane(corners.map(|corner| plane.distance(corner)), hit)
        };
        let at = |u: f64, v: f64| BoundedHit {
            primitive: 0,
            t: 1.0,
            t_error: 0.0,
            u,
            v,
        };
        let off = 1.0 / f64::from(1 << 26);
        for (u, v) in [(off, off), (-off, -off), (off, 0.0), (0.0, 0.0)] {
            assert_eq!(side_of(&at(0.25 + u, 0.25 + v), corners), None);
        }
        assert_eq!(side_of(&at(0.26, 0.25), corners), Some(1.0));
        assert_eq!(side_of(&at(0.24, 0.25), corners), Some(-1.0));
        // All corners lie on one side: no weight matters.
        let above = corners.map(|corner| corner + Vec3::Z * 1.5);
        assert_eq!(side_of(&at(f64::NAN, 0.0), above), Some(1.0));
        assert_eq!(side_of(&at(f64::NAN, 0.0), above.map(|c| -c)), Some(-1.0));
    }
}
