//! Decisions by exact arithmetic, for the few that rounded arithmetic leaves open.
//!
//! Every coordinate is a binary floating point number, hence an integer times a power of two: over
//! a common power the determinants of a ray and a triangle are integers, and every question about
//! them is the sign of one. How long they can get is reckoned from the numbers' exponents: nearly all
//! fit integers of a fixed length, which need no memory of their own.

use super::integer::Integer;
use super::wide::Wide;
use super::{Cull, Nearest};
use crate::camera::Ray;
use glam::{DVec3, Vec3};
use num_bigint::BigInt;
use std::cmp::Ordering;

/// What corners of 24 digits within a factor of a million, and rays of 53 digits, need; and what all
/// the range of single precision does.
type Short = Wide<10>;
type Long = Wide<32>;

/// A number as `mantissa · 2^exponent`, the mantissa odd or zero.
fn decompose(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let biased = ((bits >> 52) & 0x7ff) as i32;
    let fraction = (bits & 0x000f_ffff_ffff_ffff) as i64;
    let (mantissa, exponent) = if biased == 0 {
        (fraction, -1074)
    } else {
        (fraction | (1 << 52), biased - 1075)
    };
    if mantissa == 0 {
        return (0, 0);
    }
    let zeros = mantissa.trailing_zeros();
    let mantissa = mantissa >> zeros;
    (
        if x < 0.0 { -mantissa } else { mantissa },
        exponent + zeros as i32,
    )
}

/// Numbers over a common power of two: all are below 2^(exponent + bits), and integers times
/// 2^exponent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Scale {
    exponent: i32,
    bits: u32,
}

impl Scale {
    fn of(numbers: impl IntoIterator<Item = f64>) -> Self {
        let (mut lowest, mut highest) = (i32::MAX, i32::MIN);
        for (mantissa, exponent) in numbers.into_iter().map(decompose) {
            if mantissa != 0 {
                let digits = i64::BITS - mantissa.unsigned_abs().leading_zeros();
                lowest = lowest.min(exponent);
                highest = highest.max(exponent + digits as i32);
            }
        }
        if lowest > highest {
            return Self {
                exponent: 0,
                bits: 0,
            };
        }
        Self {
            exponent: lowest,
            bits: (highest - lowest) as u32,
        }
    }

    fn of_vectors<'v>(vectors: impl IntoIterator<Item = &'v DVec3>) -> Self {
        Self::of(vectors.into_iter().flat_map(|v| v.to_array()))
    }

    fn vector<I: Integer>(self, v: DVec3) -> Vector<I> {
        v.to_array().map(|x| {
            let (mantissa, own) = decompose(x);
            if mantissa == 0 {
                I::shifted(0, 0)
            } else {
                I::shifted(mantissa, (own - self.exponent) as u32)
            }
        })
    }
}

type Vector<I> = [I; 3];

fn subtract<I: Integer>(a: &Vector<I>, b: &Vector<I>) -> Vector<I> {
    std::array::from_fn(|i| a[i].minus(&b[i]))
}

fn cross<I: Integer>(a: &Vector<I>, b: &Vector<I>) -> Vector<I> {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j].times(&b[k]).minus(&a[k].times(&b[j]))
    })
}

fn dot<I: Integer>(a: &Vector<I>, b: &Vector<I>) -> I {
    let [x, y, z] = [0, 1, 2].map(|i| a[i].times(&b[i]));
    x.plus(&y).plus(&z)
}

/// Three corners in single precision relative to a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) corners: [Vec3; 3],
    pub(crate) origin: DVec3,
}

impl Placed {
    fn vectors(&self) -> [DVec3; 4] {
        let [a, b, c] = self.corners.map(Vec3::as_dvec3);
        [a, b, c, self.origin]
    }

    /// Corners relative to `eye`.
    fn relative_to<I: Integer>(&self, eye: DVec3, scale: Scale) -> [Vector<I>; 3] {
        let eye = subtract(&scale.vector(eye), &scale.vector(self.origin));
        self.corners
            .map(|corner| subtract(&scale.vector(corner.as_dvec3()), &eye))
    }
}

/// How long integers get: runs a piece of work with a kind that holds them.
///
/// With corners and eye below 2^L over their power of two, relative corners are below 2^(L+2), their
/// cross products below 2^(2L+5), det(A, B, C) below 2^(3L+9), and with directions below 2^D weights
/// are below 2^(2L+D+7) and their sum 2^(2L+D+9). The longest are products of a numerator and a
/// denominator, and of a denominator and a mantissa of 53 digits; two limbs more hold each factor's
/// last one, and what a shift to the same length takes.
macro_rules! sized {
    ($lengths:expr, $directions:expr, $work:ident($($argument:expr),*)) => {{
        let (lengths, directions): (Scale, Scale) = ($lengths, $directions);
        let (l, d) = (u64::from(lengths.bits), u64::from(directions.bits));
        let digits = (5 * l + d + 18).max(2 * l + d + 9 + 53) + 2 * 64;
        if digits <= 10 * 64 {
            $work::<Short>($($argument),*)
        } else if digits <= 32 * 64 {
            $work::<Long>($($argument),*)
        } else {
            $work::<BigInt>($($argument),*)
        }
    }};
}

/// Where `ray` meets a triangle, rounded: parameter and weights within a unit in the last place.
/// `None` where it does not, or not within its range.
pub(crate) fn hit(ray: &Ray, placed: &Placed, cull: Cull, slot: u32) -> Option<Nearest> {
    fn of<I: Integer>(
        ray: &Ray,
        placed: &Placed,
        cull: Cull,
        slot: u32,
        (lengths, directions): (Scale, Scale),
    ) -> Option<Nearest> {
        ExactHit::<I>::new(ray, placed, cull, lengths, directions).map(|hit| hit.rounded(slot))
    }
    let (lengths, directions) = scales(ray, &[placed]);
    sized!(
        lengths,
        directions,
        of(ray, placed, cull, slot, (lengths, directions))
    )
}

/// Which of two triangles `ray` meets first, `None` where it does not meet both.
pub(crate) fn compare(ray: &Ray, a: &Placed, b: &Placed, cull: Cull) -> Option<Ordering> {
    fn of<I: Integer>(
        ray: &Ray,
        [a, b]: [&Placed; 2],
        cull: Cull,
        (lengths, directions): (Scale, Scale),
    ) -> Option<Ordering> {
        let a = ExactHit::<I>::new(ray, a, cull, lengths, directions)?;
        let b = ExactHit::<I>::new(ray, b, cull, lengths, directions)?;
        Some(a.compare(&b))
    }
    let (lengths, directions) = scales(ray, &[a, b]);
    sized!(
        lengths,
        directions,
        of(ray, [a, b], cull, (lengths, directions))
    )
}

fn scales(ray: &Ray, all: &[&Placed]) -> (Scale, Scale) {
    let corners = all.iter().flat_map(|placed| placed.vectors());
    let lengths = corners.chain([ray.origin]).flat_map(|v| v.to_array());
    (Scale::of(lengths), Scale::of_vectors([&ray.direction]))
}

/// Whether the plane of a triangle holds `eye`: det(A, B, C) is zero, the corners taken from there.
///
/// It is the numerator of every hit's parameter (see [`ExactHit`]): rays from there meet such a triangle
/// at t = 0 or, where their three weights are zero, nowhere.
pub(crate) fn plane_holds(eye: DVec3, placed: &Placed) -> bool {
    fn of<I: Integer>(eye: DVec3, placed: &Placed, lengths: Scale) -> bool {
        let [a, b, c] = placed.relative_to::<I>(eye, lengths);
        dot(&a, &cross(&b, &c)).sign() == Ordering::Equal
    }
    let lengths = Scale::of_vectors(placed.vectors().iter().chain([&eye]));
    let none = Scale::of([]);
    sized!(lengths, none, of(eye, placed, lengths))
}

/// Whether the plane of a triangle is parallel to `direction`: the sum of the three weights of every
/// such ray is zero, so that they are of both signs or all zero, and it meets the triangle nowhere.
pub(crate) fn plane_is_along(direction: DVec3, corners: [Vec3; 3]) -> bool {
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
    sized!(
        lengths,
        directions,
        of(direction, corners, (lengths, directions))
    )
}

/// A hit known exactly: its parameter is `numerator / denominator · 2^exponent`.
#[derive(Clone, Debug)]
struct ExactHit<I> {
    numerator: I,
    /// Not zero, and of any sign, as the numerator.
    denominator: I,
    exponent: i32,
    /// The numerators of the second and third corner's weights, with the same denominator.
    weights: [I; 2],
}

impl<I: Integer> ExactHit<I> {
    /// Where `ray` meets a triangle; `None` where it does not, or not within its range.
    ///
    /// With A, B, C the corners relative to the ray's origin and d its direction, the point lies
    /// inside where d·(B×C), d·(C×A) and d·(A×B) are all ≥ 0 or all ≤ 0, and not all zero. Their
    /// sum is d·n, with n = (B−A)×(C−A), and the parameter A·(B×C) / (d·n).
    fn new(
        ray: &Ray,
        placed: &Placed,
        cull: Cull,
        lengths: Scale,
        directions: Scale,
    ) -> Option<Self> {
        let d = directions.vector(ray.direction);
        let [a, b, c] = placed.relative_to::<I>(ray.origin, lengths);

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
        // A front turns its normal against the ray.
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

    /// Which of two hits of one ray is nearer.
    fn compare(&self, other: &Self) -> Ordering {
        let order = compare_scaled(
            &self.numerator.times(&other.denominator),
            self.exponent,
            &other.numerator.times(&self.denominator),
            other.exponent,
        );
        // Both sides were multiplied by both denominators.
        if self.denominator.sign() == other.denominator.sign() {
            order
        } else {
            order.reverse()
        }
    }

    /// The parameter against a finite number.
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

    /// The hit rounded: parameter and weights within a unit in the last place.
    fn rounded(&self, slot: u32) -> Nearest {
        let t = ratio(&self.numerator, &self.denominator, self.exponent);
        let [u, v] = self
            .weights
            .each_ref()
            .map(|weight| ratio(weight, &self.denominator, 0));
        // Twice what `ratio` may be off by, and more.
        Nearest {
            slot,
            t,
            t_error: t.abs() * 2f64.powi(-51),
            u,
            v,
        }
    }
}

/// `a · 2^i` against `b · 2^j`.
fn compare_scaled<I: Integer>(a: &I, i: i32, b: &I, j: i32) -> Ordering {
    // Signs and lengths decide most, and spare shifts by thousands of bits.
    let by_sign = a.sign().cmp(&b.sign());
    if by_sign != Ordering::Equal || a.sign() == Ordering::Equal {
        return by_sign;
    }
    let lengths = (i64::from(a.bits()) + i64::from(i)).cmp(&(i64::from(b.bits()) + i64::from(j)));
    match (lengths, a.sign()) {
        (Ordering::Equal, _) if i >= j => a.compare_shifted((i - j) as u32, b),
        (Ordering::Equal, _) => b.compare_shifted((j - i) as u32, a).reverse(),
        (order, Ordering::Less) => order.reverse(),
        (order, _) => order,
    }
}

/// `numerator / denominator · 2^exponent`, rounded; the denominator is not zero.
///
/// Either's highest 64 digits are within 2^-63 of it, the whole part of the quotient has 64 digits or one
/// more, and is rounded to a double: off by less than (1 + 2^-8) · 2^-53, and right where the quotient is
/// a double.
fn ratio<I: Integer>(numerator: &I, denominator: &I, exponent: i32) -> f64 {
    if numerator.sign() == Ordering::Equal {
        return 0.0;
    }
    // As fractions of 2^64, one half at least.
    let [n, d] = [numerator, denominator].map(|x| {
        let highest = x.highest();
        u128::from(highest << highest.leading_zeros())
    });
    let quotient = (n << 64) / d;
    let lengths = i64::from(numerator.bits()) - i64::from(denominator.bits());
    let magnitude = scale(quotient as f64, i64::from(exponent) + lengths - 64);
    if numerator.sign() == denominator.sign() {
        magnitude
    } else {
        -magnitude
    }
}

/// `x · 2^exponent`, in steps that neither overflow nor underflow before the result does.
fn scale(mut x: f64, mut exponent: i64) -> f64 {
    while exponent > 0 {
        let step = exponent.min(1000);
        x *= 2f64.powi(step as i32);
        exponent -= step;
        if x.is_infinite() {
            break;
        }
    }
    while exponent < 0 {
        let step = exponent.max(-1000);
        x *= 2f64.powi(step as i32);
        exponent -= step;
        if x == 0.0 {
            break;
        }
    }
    x
}

/// Whether three finite points lie exactly on a line, or in one place.
pub(crate) fn is_collinear(a: Vec3, b: Vec3, c: Vec3) -> bool {
    let (ab, ac) = (b.as_dvec3() - a.as_dvec3(), c.as_dvec3() - a.as_dvec3());
    let normal = ab.cross(ac);
    // Each component is a difference of two products of rounded differences: with ε = 2^-53 its
    // error is below (2·2 + 1 + 1)·ε times the products' absolute sum, higher orders included in 8.
    let sum = |x: f64, y: f64, z: f64, w: f64| (x * y).abs() + (z * w).abs();
    let bound = DVec3::new(
        sum(ab.y, ac.z, ab.z, ac.y),
        sum(ab.z, ac.x, ab.x, ac.z),
        sum(ab.x, ac.y, ab.y, ac.x),
    ) * (8.0 * 2f64.powi(-53));
    if normal.abs().cmpgt(bound).any() {
        return false;
    }
    let points = [a, b, c].map(Vec3::as_dvec3);
    fn of<I: Integer>(points: [DVec3; 3], lengths: Scale) -> bool {
        let [a, b, c] = points.map(|p| lengths.vector::<I>(p));
        let normal = cross(&subtract(&b, &a), &subtract(&c, &a));
        normal.iter().all(|x| x.sign() == Ordering::Equal)
    }
    let lengths = Scale::of_vectors(&points);
    sized!(lengths, Scale::of([]), of(points, lengths))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn decomposes_into_odd_mantissas() {
        for x in [
            0.0,
            -0.0,
            1.0,
            -3.5,
            0.1,
            f64::MAX,
            f64::MIN_POSITIVE,
            5e-324,
            -1e-310,
        ] {
            let (mantissa, exponent) = decompose(x);
            assert_eq!(scale(mantissa as f64, exponent.into()), x);
            assert!(mantissa == 0 || mantissa % 2 != 0);
        }
    }

    #[test]
    fn ratios_round_well() {
        for (p, q, e) in [
            (1i64, 3i64, 0),
            (-2, 7, 5),
            (i64::MAX, 3, -70),
            (1, i64::MAX, 1),
        ] {
            let expected = p as f64 / q as f64 * 2f64.powi(e);
            let got = ratio(&BigInt::from(p), &q.into(), e);
            assert!(((got - expected) / expected).abs() < 1e-15, "{p}/{q}");
            let got = ratio(&Short::shifted(p, 0), &Short::shifted(q, 0), e);
            assert!(((got - expected) / expected).abs() < 1e-15, "{p}/{q}");
        }
    }

    #[test]
    fn compares_across_scales() {
        fn check<I: Integer>() {
            let compare = |a, i, b, j| compare_scaled(&I::shifted(a, 0), i, &I::shifted(b, 0), j);
            assert_eq!(compare(1, 3, 8, 0), Ordering::Equal);
            assert_eq!(compare(8, 0, 1, 3), Ordering::Equal);
            assert_eq!(compare(-1, 3, -9, 0), Ordering::Greater);
            assert_eq!(compare(-1, 2000, 1, -2000), Ordering::Less);
            assert_eq!(compare(3, -1, 1, 0), Ordering::Greater);
            assert_eq!(compare(0, 5, 0, -5), Ordering::Equal);
        }
        check::<BigInt>();
        check::<Short>();
    }

    #[test]
    fn collinear_means_exactly() {
        let a = Vec3::new(0.1, 0.2, 0.3);
        let d = Vec3::new(0.25, -0.5, 1.0);
        assert!(is_collinear(Vec3::ZERO, d, d * 3.0));
        let nudged = Vec3::new(0.75, -1.5, f32::from_bits(3f32.to_bits() + 1));
        assert!(!is_collinear(Vec3::ZERO, d, nudged));
        assert!(is_collinear(a, a, d));
        assert!(!is_collinear(
            Vec3::splat(1e18),
            Vec3::ZERO,
            Vec3::splat(1e-30).with_x(2e-30)
        ));
    }

    fn placed(corners: [Vec3; 3], origin: DVec3) -> Placed {
        Placed { corners, origin }
    }

    #[test]
    fn finds_the_point_it_must() {
        let corners = [Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0];
        let here = placed(corners, DVec3::ZERO);
        let ray = Ray::new(DVec3::new(1.0, 2.0, 5.0), DVec3::NEG_Z * 2.0);
        let found = hit(&ray, &here, Cull::None, 0).expect("a hit");
        assert_eq!((found.t, found.u, found.v), (2.5, 0.25, 0.5));
        assert!(hit(&ray, &here, Cull::Back, 0).is_some());
        let [a, b, c] = corners;
        let turned = placed([a, c, b], DVec3::ZERO);
        assert!(hit(&ray, &turned, Cull::Back, 0).is_none());
        let shifted = placed(corners, DVec3::Z);
        assert_eq!(hit(&ray, &shifted, Cull::None, 0).expect("a hit").t, 2.0);
        let within = |t_min, t_max, placed| {
            let ray = Ray {
                t_min,
                t_max,
                ..ray
            };
            [placed, &turned].map(|placed| hit(&ray, placed, Cull::None, 0).is_some())
        };
        assert_eq!(within(0.0, 2.0, &shifted), [true, false]);
        assert_eq!(within(0.0, 2.0, &here), [false; 2]);
        assert_eq!(within(2.5f64.next_down(), 2.5, &here), [true; 2]);
        assert_eq!(within(2.5, f64::INFINITY, &here), [false; 2]);
        let order = |a, b| compare(&ray, a, b, Cull::None);
        assert_eq!(order(&here, &turned), Some(Ordering::Equal));
        assert_eq!(order(&here, &shifted), Some(Ordering::Greater));
        assert_eq!(order(&shifted, &turned), Some(Ordering::Less));
        let aside = placed(corners, DVec3::X * 9.0);
        assert_eq!(order(&aside, &here), None);
    }

    /// The same decisions whatever kind of integer makes them: from what fits the shortest to what only
    /// fits the longest.
    #[test]
    fn every_length_decides_the_same() {
        let mut random = Random(5);
        let mut hits = [0; 3];
        for spread in [1.0, 10.0, 60.0, 120.0] {
            for _ in 0..3000 {
                let decade = |random: &mut Random| 2f64.powf(spread * random.signed());
                let point = |random: &mut Random| random.point() * decade(random);
                let corners = [(); 3].map(|()| point(&mut random).as_vec3());
                // Tiny ones keep the ray's aim.
                let origin = point(&mut random) * 2f64.powf(-2.0 * spread * random.unit());
                let inside = corners
                    .map(|c| c.as_dvec3() * random.unit())
                    .iter()
                    .sum::<DVec3>();
                let ray = Ray::new(origin, inside - origin);
                let here = placed(corners, DVec3::ZERO);
                let (lengths, directions) = scales(&ray, &[&here]);
                let long = |hit: Option<Nearest>| hit.map(|hit| (hit.t, hit.u, hit.v));
                let big = ExactHit::<BigInt>::new(&ray, &here, Cull::None, lengths, directions);
                let big = big.map(|hit| hit.rounded(0));
                assert_eq!(long(hit(&ray, &here, Cull::None, 0)), long(big));
                let digits = 5 * lengths.bits + directions.bits;
                let kind = usize::from(digits > 490) + usize::from(digits > 1890);
                hits[kind] += usize::from(big.is_some());
            }
        }
        assert!(hits.iter().all(|&hits| hits > 100), "{hits:?}");
    }

    #[test]
    fn planes_that_hold_an_eye_are_told_from_those_next_to_it() {
        let corners = [
            Vec3::ZERO,
            Vec3::new(3.0, 1.0, 0.5),
            Vec3::new(0.25, 2.0, 7.0),
        ];
        let [_, b, c] = corners.map(Vec3::as_dvec3);
        for origin in [DVec3::ZERO, DVec3::new(1e7, -3e5, 0.125)] {
            let here = placed(corners, origin);
            for eye in [DVec3::ZERO, b, b * 2.0, b + c, c * 0.5 - b] {
                assert!(plane_holds(origin + eye, &here));
                let next = (origin + eye).x.next_up();
                assert!(!plane_holds((origin + eye).with_x(next), &here));
            }
        }
        assert!(plane_is_along(b - c * 0.125, corners) && plane_is_along(c, corners));
        assert!(!plane_is_along(b.with_y(b.y.next_up()), corners));
    }
}
