//! A ray and a triangle in exact arithmetic, for the few cases that rounded arithmetic leaves undecided.

use super::BoundedHit;
use crate::hit::Cull;
use crate::num::accumulator::{Accumulator, Number};
use crate::num::double_double::DoubleDouble;
use crate::num::exact::{
    Scale, Vector, compare_scaled, comparison_digits, cross, decompose, determinant_digits, dot,
    hit_digits, power_of_two, ratio, sized, subtract,
};
use crate::num::integer::Integer;
use crate::ray::Ray;
use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// Three corners in single precision, relative to a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OffsetTriangle {
    pub(crate) corners: [Vec3; 3],
    pub(crate) origin: DVec3,
}

impl OffsetTriangle {
    fn vectors(&self) -> [DVec3; 4] {
        let [a, b, c] = self.corners.map(Vec3::as_dvec3);
        [a, b, c, self.origin]
    }

    /// A point relative to the one that the corners are relative to. `None` where that is not a double: it mostly is,
    /// and then with far fewer digits than its two terms have between them.
    fn local(&self, point: DVec3) -> Option<DVec3> {
        let lost = |axis| DoubleDouble::difference(point[axis], self.origin[axis]).low != 0.0;
        (!(0..3).any(lost)).then(|| point - self.origin)
    }

    /// A common power of two for all its numbers and a point's.
    fn scale_with(&self, point: DVec3) -> Scale {
        Scale::of_vectors(self.vectors().iter().chain([&point]))
    }

    /// Corners relative to `eye`.
    fn relative_to<I: Integer>(&self, eye: DVec3, scale: Scale) -> [Vector<I>; 3] {
        let eye = subtract(&scale.vector(eye), &scale.vector(self.origin));
        let relative = |corner: Vec3| subtract(&scale.vector(corner.as_dvec3()), &eye);
        let [a, b, c] = self.corners;
        [relative(a), relative(b), relative(c)]
    }
}

/// [`hit_and_corner`] without the corner.
#[cfg(test)]
pub(crate) fn hit(
    ray: &Ray,
    triangle: &OffsetTriangle,
    cull: Cull,
    primitive: u32,
) -> Option<BoundedHit> {
    hit_and_corner(ray, triangle, cull, primitive).map(|(hit, _)| hit)
}

/// Where `ray` hits a triangle: parameter and weights, rounded to within a unit in the last place, and the corner that
/// it hits exactly, if it does. `None` where it misses, or hits outside the ray's range.
pub(super) fn hit_and_corner(
    ray: &Ray,
    triangle: &OffsetTriangle,
    cull: Cull,
    primitive: u32,
) -> Option<(BoundedHit, Option<Vec3>)> {
    fn of<I: Integer>(
        ray: &Ray,
        triangle: &OffsetTriangle,
        cull: Cull,
        primitive: u32,
        (lengths, directions): (Scale, Scale),
    ) -> Option<(BoundedHit, Option<Vec3>)> {
        let hit = ExactHit::<I>::new(ray, triangle, cull, lengths, directions)?;
        let corner = hit.corner().map(|corner| triangle.corners[corner]);
        Some((hit.rounded(primitive), corner))
    }
    let (lengths, directions) = scales(ray, &[triangle]);
    sized!(
        hit_digits(lengths, directions),
        of(ray, triangle, cull, primitive, (lengths, directions))
    )
}

/// Which of two triangles `ray` hits first; `None` unless it hits both.
pub(crate) fn compare(
    ray: &Ray,
    a: &OffsetTriangle,
    b: &OffsetTriangle,
    cull: Cull,
) -> Option<Ordering> {
    fn of<I: Integer>(
        ray: &Ray,
        [a, b]: [&OffsetTriangle; 2],
        cull: Cull,
        (lengths, directions): (Scale, Scale),
    ) -> Option<Ordering> {
        let a = ExactHit::<I>::new(ray, a, cull, lengths, directions)?;
        let b = ExactHit::<I>::new(ray, b, cull, lengths, directions)?;
        Some(a.compare(&b))
    }
    let (lengths, directions) = scales(ray, &[a, b]);
    sized!(
        comparison_digits(lengths, directions),
        of(ray, [a, b], cull, (lengths, directions))
    )
}

fn scales(ray: &Ray, all: &[&OffsetTriangle]) -> (Scale, Scale) {
    let corners = all.iter().flat_map(|triangle| triangle.vectors());
    let lengths = corners.chain([ray.origin]).flat_map(|v| v.to_array());
    (Scale::of(lengths), Scale::of_vectors([&ray.direction]))
}

/// Whether the plane of a triangle contains `eye`: det(A, B, C) is zero, with corners relative to the eye.
///
/// It is the numerator of every hit's parameter (see [`ExactHit`]): rays from the eye hit such a triangle at t = 0
/// or, where all three weights are zero, not at all.
pub(crate) fn plane_contains(eye: DVec3, triangle: &OffsetTriangle) -> bool {
    fn of<I: Integer>(eye: DVec3, triangle: &OffsetTriangle, lengths: Scale) -> bool {
        let [a, b, c] = triangle.relative_to::<I>(eye, lengths);
        dot(&a, &cross(&b, &c)).sign() == Ordering::Equal
    }
    if let Some(point) = triangle.local(eye) {
        return lies_in_plane(point, triangle.corners);
    }
    let lengths = triangle.scale_with(eye);
    sized!(determinant_digits(lengths), of(eye, triangle, lengths))
}

/// Whether the plane of a triangle is parallel to `direction`: the three weights of every such ray sum to zero, so
/// they differ in sign or are all zero, and no such ray hits the triangle.
pub(crate) fn plane_is_parallel(direction: DVec3, corners: [Vec3; 3]) -> bool {
    fn of<I: Integer>(
        direction: DVec3,
        corners: [DVec3; 3],
        (lengths, directions): (Scale, Scale),
    ) -> bool {
        let [a, b, c] = corners.map(|corner| lengths.vector::<I>(corner));
        let normal = cross(&subtract(&b, &a), &subtract(&c, &a));
        dot(&directions.vector(direction), &normal).sign() == Ordering::Equal
    }
    let corners = corners.map(Vec3::as_dvec3);
    let (lengths, directions) = (Scale::of_vectors(&corners), Scale::of_vectors([&direction]));
    if lengths.bits <= I128_BITS && directions.bits <= 2 * HALF_BITS {
        let [a, b, c] = corners.map(|corner| lengths.vector::<i128>(corner));
        let normal = cross(&subtract(&b, &a), &subtract(&c, &a));
        return is_perpendicular(&directions.vector(direction), &normal);
    }
    sized!(
        hit_digits(lengths, directions),
        of(direction, corners, (lengths, directions))
    )
}

/// The length, in bits, of the lower halves of directions' components in [`is_perpendicular`].
const HALF_BITS: u32 = 32;

/// Whether d·n is zero, for n below 2^(2L+3) with L at most [`I128_BITS`], and components of d below 2^64. With d = 2³²h + l,
/// h·n and l·n are below 2^(2L+3+32+2), and d·n is zero where l·n is −2³² times h·n.
fn is_perpendicular(direction: &Vector<i128>, normal: &Vector<i128>) -> bool {
    const LOW: i128 = (1 << HALF_BITS) - 1;
    let high = dot(&direction.map(|component| component >> HALF_BITS), normal);
    let low = dot(&direction.map(|component| component & LOW), normal);
    low & LOW == 0 && low >> HALF_BITS == -high
}

/// The longest coordinates, in bits, for which what planes decide fits 128-bit integers: differences are below
/// 2^(L+1), their cross products below 2^(2L+3), and the determinant below 2^(3L+6).
const I128_BITS: u32 = 40;

/// det(b − a, c − a, p − a), which is zero where p lies in the plane of a, b and c.
fn plane_determinant<I: Integer>(points: [DVec3; 4], lengths: Scale) -> I {
    let [a, b, c, p] = points.map(|point| lengths.vector::<I>(point));
    let normal = cross(&subtract(&b, &a), &subtract(&c, &a));
    dot(&subtract(&p, &a), &normal)
}

/// The distance of an eye from the plane of a triangle times the normal's length, positive where the normal points away
/// from the eye, rounded to within a unit in the last place. Zero only where the plane holds the eye, unless it is less
/// than any double is.
pub(crate) fn distance_of_eye(eye: DVec3, triangle: &OffsetTriangle) -> f64 {
    fn of<I: Integer>(points: [DVec3; 4], lengths: Scale) -> f64 {
        let determinant = plane_determinant::<I>(points, lengths);
        -ratio(&determinant, &I::shifted(1, 0), 3 * lengths.exponent)
    }
    fn of_far<I: Integer>(eye: DVec3, triangle: &OffsetTriangle, lengths: Scale) -> f64 {
        let [a, b, c] = triangle.relative_to::<I>(eye, lengths);
        let determinant = dot(&a, &cross(&b, &c));
        ratio(&determinant, &I::shifted(1, 0), 3 * lengths.exponent)
    }
    let Some(eye) = triangle.local(eye) else {
        let lengths = triangle.scale_with(eye);
        return sized!(determinant_digits(lengths), of_far(eye, triangle, lengths));
    };
    let [a, b, c] = triangle.corners.map(Vec3::as_dvec3);
    let points = [a, b, c, eye];
    let lengths = Scale::of_vectors(&points);
    if lengths.bits <= I128_BITS {
        return of::<i128>(points, lengths);
    }
    sized!(determinant_digits(lengths), of(points, lengths))
}

/// The cross product of two corners relative to an eye, each component rounded to within a unit in the last place.
pub(super) fn cross_from(eye: DVec3, corners: [Vec3; 2]) -> DVec3 {
    fn of<I: Integer>(points: [DVec3; 3], lengths: Scale) -> DVec3 {
        let [p, q, eye] = points.map(|point| lengths.vector::<I>(point));
        rounded_cross(&subtract(&p, &eye), &subtract(&q, &eye), lengths)
    }
    let [p, q] = corners.map(Vec3::as_dvec3);
    let points = [p, q, eye];
    let lengths = Scale::of_vectors(&points);
    if lengths.bits <= I128_BITS {
        return of::<i128>(points, lengths);
    }
    sized!(determinant_digits(lengths), of(points, lengths))
}

/// B×C, C×A and A×B of a triangle's corners relative to an eye, as [`cross_from`].
pub(super) fn crosses_from(eye: DVec3, triangle: &OffsetTriangle) -> [DVec3; 3] {
    fn of<I: Integer>(eye: DVec3, triangle: &OffsetTriangle, lengths: Scale) -> [DVec3; 3] {
        let [a, b, c] = triangle.relative_to::<I>(eye, lengths);
        let cross = |p, q| rounded_cross::<I>(p, q, lengths);
        [cross(&b, &c), cross(&c, &a), cross(&a, &b)]
    }
    let lengths = triangle.scale_with(eye);
    sized!(determinant_digits(lengths), of(eye, triangle, lengths))
}

fn rounded_cross<I: Integer>(p: &Vector<I>, q: &Vector<I>, lengths: Scale) -> DVec3 {
    let [x, y, z] = cross(p, q);
    let one = I::shifted(1, 0);
    let rounded = |component| ratio(component, &one, 2 * lengths.exponent);
    DVec3::new(rounded(&x), rounded(&y), rounded(&z))
}

/// The distances of points from the plane of a triangle times the normal's length, positive where the normal points to;
/// each rounded to within a unit in the last place, and zero only where the plane contains the point: a distance of
/// single-precision coordinates is at least 2⁻⁴⁴⁷.
///
/// With A, B, C the corners and P a point, its distance is P·N − A·(B×C), N = A×B + B×C + C×A: sums of products of
/// three coordinates.
pub(crate) fn distances_from_plane(points: [Vec3; 3], corners: [Vec3; 3]) -> [f64; 3] {
    let vectors = [corners, points].map(|vectors| vectors.map(Vec3::as_dvec3));
    let lengths = Scale::of_vectors(vectors.as_flattened());
    match lengths.bits <= I128_BITS {
        true => distances_in_integers(vectors, lengths),
        false => distances_in_fixed_point(points, corners),
    }
}

/// [`distances_from_plane`] of points from the plane of corners, whose coordinates are at most [`I128_BITS`] long.
fn distances_in_integers([corners, points]: [[DVec3; 3]; 2], lengths: Scale) -> [f64; 3] {
    // Whole numbers of at most 2⁴⁰ units, so that 64 bits hold their differences, and 128 products of two and of three.
    let per_unit = power_of_two(-lengths.exponent);
    let vector = |point: DVec3| (point * per_unit).as_i64vec3();
    let [a, b, c] = corners.map(vector);
    let (u, v) = (b - a, c - a);
    let product = |p: i64, q: i64| i128::from(p) * i128::from(q);
    let x = product(u.y, v.z) - product(u.z, v.y);
    let y = product(u.z, v.x) - product(u.x, v.z);
    let z = product(u.x, v.y) - product(u.y, v.x);
    // From 2⁻⁴⁴⁷ to 2³⁸¹.
    let unit = power_of_two(3 * lengths.exponent);
    points.map(|point| {
        let p = vector(point) - a;
        let distance = i128::from(p.x) * x + i128::from(p.y) * y + i128::from(p.z) * z;
        distance as f64 * unit
    })
}

/// [`distances_from_plane`] of any coordinates.
fn distances_in_fixed_point(points: [Vec3; 3], corners: [Vec3; 3]) -> [f64; 3] {
    const PAIRS: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];
    let numbers = |vector: Vec3| vector.to_array().map(Number::of);
    let corners = corners.map(numbers);
    // For each component of N six products, those of B×C first.
    let mut normal = [[Number::of(0.0); 6]; 3];
    for (products, [i, j]) in normal.iter_mut().zip(PAIRS) {
        for (products, [p, q]) in products.as_chunks_mut().0.iter_mut().zip(PAIRS) {
            let (p, q) = (&corners[p], &corners[q]);
            *products = [p[i].times(q[j]), p[j].times(q[i].negated())];
        }
    }
    let mut of_plane = Accumulator::ZERO;
    for (coordinate, products) in corners[0].iter().zip(&normal) {
        for product in &products[..2] {
            of_plane.add(coordinate.negated(), *product);
        }
    }
    points.map(|point| {
        let mut distance = of_plane.clone();
        for (coordinate, products) in numbers(point).iter().zip(&normal) {
            for product in products {
                distance.add(*coordinate, *product);
            }
        }
        distance.rounded()
    })
}

/// Whether a point lies in the plane of a triangle.
pub(super) fn lies_in_plane(point: DVec3, corners: [Vec3; 3]) -> bool {
    fn of<I: Integer>(points: [DVec3; 4], lengths: Scale) -> bool {
        plane_determinant::<I>(points, lengths).sign() == Ordering::Equal
    }
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let points = [a, b, c, point];
    let lengths = Scale::of_vectors(&points);
    if lengths.bits <= I128_BITS {
        return of::<i128>(points, lengths);
    }
    sized!(determinant_digits(lengths), of(points, lengths))
}

/// An exact hit: its parameter is `numerator / denominator · 2^exponent`.
#[derive(Clone, Debug)]
struct ExactHit<I> {
    numerator: I,
    /// Never zero; it may have either sign, like the numerator.
    denominator: I,
    exponent: i32,
    /// Numerators of the second and third corner's weights, over the same denominator.
    weights: [I; 2],
}

impl<I: Integer> ExactHit<I> {
    /// Where `ray` hits a triangle; `None` where it misses, or hits outside its range.
    ///
    /// With A, B, C the corners relative to the ray's origin and d its direction, the point is inside where d·(B×C),
    /// d·(C×A) and d·(A×B) are all ≥ 0 or all ≤ 0, and not all zero. Their sum is d·n, with n = (B−A)×(C−A), and the
    /// parameter is A·(B×C) / (d·n).
    fn new(
        ray: &Ray,
        triangle: &OffsetTriangle,
        cull: Cull,
        lengths: Scale,
        directions: Scale,
    ) -> Option<Self> {
        let d = directions.vector(ray.direction);
        let [a, b, c] = triangle.relative_to::<I>(ray.origin, lengths);

        let b_cross_c = cross(&b, &c);
        let first = dot(&d, &b_cross_c);
        let second = dot(&d, &cross(&c, &a));
        if (first.sign() as i8) * (second.sign() as i8) < 0 {
            return None;
        }
        let third = dot(&d, &cross(&a, &b));
        let signs = [first.sign(), second.sign(), third.sign()];
        let is_inside = signs.contains(&Ordering::Greater) != signs.contains(&Ordering::Less);
        let denominator = first.plus(&second).plus(&third);
        // The normal of a front face points against the ray.
        let is_culled = cull == Cull::Back && denominator.sign() != Ordering::Less;
        if !is_inside || is_culled {
            return None;
        }
        let hit = Self {
            numerator: dot(&a, &b_cross_c),
            denominator,
            exponent: lengths.exponent - directions.exponent,
            weights: [second, third],
        };
        let has_begun = hit.compare_to(ray.t_min) == Ordering::Greater;
        let has_ended = ray.t_max < f64::INFINITY && hit.compare_to(ray.t_max) == Ordering::Greater;
        (has_begun && !has_ended).then_some(hit)
    }

    /// The corner that the ray hits exactly, if it does: where both other weights are zero.
    fn corner(&self) -> Option<usize> {
        let [second, third] = &self.weights;
        let first = self.denominator.minus(second).minus(third);
        let is_zero = [&first, second, third].map(|weight| weight.sign() == Ordering::Equal);
        match is_zero {
            [_, true, true] => Some(0),
            [true, _, true] => Some(1),
            [true, true, _] => Some(2),
            _ => None,
        }
    }

    /// Which of two hits of one ray is nearer.
    fn compare(&self, other: &Self) -> Ordering {
        let order = compare_scaled(
            &self.numerator.times(&other.denominator),
            self.exponent,
            &other.numerator.times(&self.denominator),
            other.exponent,
        );
        // Both sides were multiplied by both denominators, which reverses the order if their signs differ.
        if self.denominator.sign() == other.denominator.sign() {
            order
        } else {
            order.reverse()
        }
    }

    /// Compares the parameter with a finite number.
    fn compare_to(&self, t: f64) -> Ordering {
        let (mantissa, exponent) = decompose(t);
        let order = compare_scaled(
            &self.numerator,
            self.exponent,
            &self.denominator.times(&I::shifted(mantissa, 0)),
            exponent,
        );
        if self.denominator.sign() == Ordering::Less {
            order.reverse()
        } else {
            order
        }
    }

    /// Parameter and weights rounded to within a unit in the last place.
    fn rounded(&self, primitive: u32) -> BoundedHit {
        let t = ratio(&self.numerator, &self.denominator, self.exponent);
        let [u, v] = self
            .weights
            .each_ref()
            .map(|weight| ratio(weight, &self.denominator, 0));
        // More than twice the error of `ratio`.
        BoundedHit {
            primitive,
            t,
            t_error: t.abs() * 2f64.powi(-51),
            u,
            v,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use num_bigint::BigInt;

    fn triangle(corners: [Vec3; 3], origin: DVec3) -> OffsetTriangle {
        OffsetTriangle { corners, origin }
    }

    /// Normals and directions as long as they may be, perpendicular and not by one unit.
    #[test]
    fn perpendicular_directions_are_those_in_integers_of_any_length() {
        let mut random = Random(32);
        let mut perpendicular = 0;
        for round in 0..4000 {
            let (short, wide) = (2f64.powi(round as i32 % 41), 2f64.powi(22));
            let mut vector = |most: f64| {
                let place = random.point() * most;
                place.to_array().map(|x| x as i128)
            };
            let (normal, beside) = (vector(short), vector(wide));
            let mut direction = cross(&normal, &beside);
            direction[round % 3] += (round as i128 / 3) % 3 - 1;
            // Where it is short, products less than a half of a direction's component.
            let shift = if round % 2 == 0 { 43 } else { 0 };
            let normal = normal.map(|component| component << shift);
            let [d, n] = [direction, normal].map(|vector| vector.map(BigInt::from));
            let expected = Integer::sign(&dot(&d, &n)) == Ordering::Equal;
            assert_eq!(
                is_perpendicular(&direction, &normal),
                expected,
                "{direction:?} {normal:?}"
            );
            perpendicular += usize::from(expected);
        }
        assert!((1000..2500).contains(&perpendicular), "{perpendicular}");
    }

    /// Short coordinates whose distances are doubles, and longer ones, of triangles anywhere and of one plane.
    #[test]
    fn distances_in_integers_are_those_in_fixed_point() {
        let mut random = Random(31);
        let (mut zeros, mut others) = (0, 0);
        for round in 0..4000 {
            let bits = [10, 13, 24][round % 3];
            let unit = 2f64.powi(-bits - round as i32 % 60);
            let mut point = || {
                let place = random.point() * 2f64.powi(bits);
                let place = match round % 2 {
                    0 => place.round(),
                    _ => {
                        DVec3::new(4.0, 1.0, -2.0) * (place.x / 8.0).round()
                            + DVec3::new(-1.0, 4.0, 3.0) * (place.y / 8.0).round()
                    }
                };
                (place * unit).as_vec3()
            };
            let [points, corners] = [(); 2].map(|()| [(); 3].map(|()| point()));
            let vectors = [corners, points].map(|vectors| vectors.map(Vec3::as_dvec3));
            let lengths = Scale::of_vectors(vectors.as_flattened());
            assert!(lengths.bits <= I128_BITS);
            let found = distances_in_integers(vectors, lengths);
            let expected = distances_in_fixed_point(points, corners);
            for (found, expected) in found.into_iter().zip(expected) {
                let most = if bits < 24 {
                    0.0
                } else {
                    expected.abs() * f64::EPSILON
                };
                assert!((found - expected).abs() <= most, "{found} {expected}");
                zeros += u32::from(found == 0.0);
                others += u32::from(found != 0.0);
            }
        }
        assert!(zeros > 3000 && others > 3000, "{zeros} {others}");
    }

    #[test]
    fn an_exact_hit_is_at_the_known_point() {
        let corners = [Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0];
        let here = triangle(corners, DVec3::ZERO);
        let ray = Ray::new(DVec3::new(1.0, 2.0, 5.0), DVec3::NEG_Z * 2.0);
        let found = hit(&ray, &here, Cull::None, 0).expect("a hit");
        assert_eq!((found.t, found.u, found.v), (2.5, 0.25, 0.5));
        assert!(hit(&ray, &here, Cull::Back, 0).is_some());
        // The third weight exceeds the nearest double by 2e-17.
        let third = Ray::new(DVec3::new(1.0, 2.0, 1.0), DVec3::NEG_Z * 3.0);
        let third = hit(&third, &here, Cull::None, 0).expect("a hit");
        assert!(third.t == 1.0 / 3.0 && third.t_error > 2e-17);
        let [a, b, c] = corners;
        let turned = triangle([a, c, b], DVec3::ZERO);
        assert!(hit(&ray, &turned, Cull::Back, 0).is_none());
        let shifted = triangle(corners, DVec3::Z);
        assert_eq!(hit(&ray, &shifted, Cull::None, 0).expect("a hit").t, 2.0);
        let within = |t_min, t_max, triangle| {
            let ray = Ray {
                t_min,
                t_max,
                ..ray
            };
            [triangle, &turned].map(|triangle| hit(&ray, triangle, Cull::None, 0).is_some())
        };
        assert_eq!(within(0.0, 2.0, &shifted), [true, false]);
        assert_eq!(within(0.0, 2.0, &here), [false; 2]);
        assert_eq!(within(2.5f64.next_down(), 2.5, &here), [true; 2]);
        assert_eq!(within(2.5, f64::INFINITY, &here), [false; 2]);
        let order = |a, b| compare(&ray, a, b, Cull::None);
        assert_eq!(order(&here, &turned), Some(Ordering::Equal));
        assert_eq!(order(&here, &shifted), Some(Ordering::Greater));
        assert_eq!(order(&shifted, &turned), Some(Ordering::Less));
        let aside = triangle(corners, DVec3::X * 9.0);
        assert_eq!(order(&aside, &here), None);
    }

    /// Integers of every length make the same decisions, on numbers that fit the shortest to numbers that fit only
    /// the longest.
    #[test]
    fn every_length_decides_the_same() {
        let mut random = Random(5);
        let mut hits = [0; 4];
        for spread in [1.0, 10.0, 30.0, 60.0, 120.0] {
            for _ in 0..3000 {
                let decade = |random: &mut Random| crate::math::pow(2.0, spread * random.signed());
                let point = |random: &mut Random| random.point() * decade(random);
                let corners = [(); 3].map(|()| point(&mut random).as_vec3());
                // Close origins keep rays aimed at tiny triangles.
                let origin =
                    point(&mut random) * crate::math::pow(2.0, -2.0 * spread * random.unit());
                let inside = corners
                    .map(|c| c.as_dvec3() * random.unit())
                    .iter()
                    .sum::<DVec3>();
                let ray = Ray::new(origin, inside - origin);
                let here = triangle(corners, DVec3::ZERO);
                let (lengths, directions) = scales(&ray, &[&here]);
                let long = |hit: Option<BoundedHit>| hit.map(|hit| (hit.t, hit.u, hit.v));
                let big = ExactHit::<BigInt>::new(&ray, &here, Cull::None, lengths, directions);
                let big = big.map(|hit| hit.rounded(0));
                assert_eq!(long(hit(&ray, &here, Cull::None, 0)), long(big));
                let digits = 5 * lengths.bits + directions.bits;
                let kind = [490, 870, 1890].iter().filter(|&&most| digits > most);
                hits[kind.count()] += usize::from(big.is_some());
            }
        }
        assert!(hits.iter().all(|&hits| hits > 100), "{hits:?}");
    }

    #[test]
    fn planes_through_an_eye_and_those_next_to_it_are_distinguished() {
        let corners = [
            Vec3::ZERO,
            Vec3::new(3.0, 1.0, 0.5),
            Vec3::new(0.25, 2.0, 7.0),
        ];
        let [_, b, c] = corners.map(Vec3::as_dvec3);
        for origin in [DVec3::ZERO, DVec3::new(1e7, -3e5, 0.125)] {
            let here = triangle(corners, origin);
            for eye in [DVec3::ZERO, b, b * 2.0, b + c, c * 0.5 - b] {
                assert!(plane_contains(origin + eye, &here));
                let next = (origin + eye).x.next_up();
                assert!(!plane_contains((origin + eye).with_x(next), &here));
            }
        }
        // The difference of eye and origin is not a double; the plane is y = z.
        let corners_of_y = [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 1.0)];
        let here = triangle(corners_of_y, DVec3::X * 2f64.powi(-80));
        let eye = DVec3::new(1.0, 5.0, 5.0);
        assert!(plane_contains(eye, &here));
        assert!(!plane_contains(eye.with_z(5f64.next_up()), &here));
        assert!(plane_is_parallel(b - c * 0.125, corners) && plane_is_parallel(c, corners));
        assert!(!plane_is_parallel(b.with_y(b.y.next_up()), corners));
    }

    /// A plane and an edge that pass the eye by the least number of single precision: the truth is worked out by hand.
    #[test]
    fn distances_and_products_from_an_eye_keep_all_digits() {
        let least = f64::from(f32::from_bits(1));
        let eye = DVec3::new(0.0, 0.0, 3.0 * least);
        let far = 2f32.powi(20);
        // In the plane z = x; the normal is (−1, 0, 1) times 2⁴¹.
        let corners = [
            Vec3::new(-far, -far, -far),
            Vec3::new(far, -far, far),
            Vec3::new(-far, far / 2.0, -far),
        ];
        let [ab, ac] = [1, 2].map(|k| (corners[k] - corners[0]).as_dvec3());
        assert_eq!(
            ab.cross(ac),
            DVec3::new(-1.0, 0.0, 1.0) * (3.0 * 2f64.powi(40))
        );
        let here = triangle(corners, DVec3::ZERO);
        assert_eq!(distance_of_eye(eye, &here), -9.0 * least * 2f64.powi(40));
        assert_eq!(distance_of_eye(DVec3::ZERO, &here), 0.0);
        let [a, b, c] = corners;
        let turned = triangle([a, c, b], DVec3::ZERO);
        assert_eq!(distance_of_eye(eye, &turned), 9.0 * least * 2f64.powi(40));
        // The difference of eye and origin is not a double; the plane is y = z.
        let corners_of_y = [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 1.0)];
        let moved = triangle(corners_of_y, DVec3::X * 2f64.powi(-80));
        assert_eq!(distance_of_eye(DVec3::new(1.0, 5.0, 4.0), &moved), 1.0);
        assert_eq!(distance_of_eye(DVec3::new(1.0, 4.0, 4.5), &moved), -0.5);
        // (−f, −f, −f − 3s) × (f, f, f − 3s) with s the least number.
        let product = cross_from(eye, [a, -a]);
        let expected = DVec3::new(6.0, -6.0, 0.0) * (least * f64::from(far));
        assert_eq!(product, expected);
    }
}
