//! Decisions by exact arithmetic, for the few that rounded arithmetic leaves open.
//!
//! Every coordinate is a binary floating point number, hence an integer times a power of two: over
//! a common power the determinants of a ray and a triangle are integers, and every question about
//! them is the sign of one.

use super::Nearest;
use crate::hit::Cull;
use crate::ray::Ray;
use glam::{DVec3, Vec3};
use num_bigint::{BigInt, Sign};
use num_traits::Zero;
use std::cmp::Ordering;

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

/// The largest exponent over which all of `numbers` are integers; zero if all are zero.
fn common_exponent(numbers: impl IntoIterator<Item = f64>) -> i32 {
    numbers
        .into_iter()
        .filter(|x| *x != 0.0)
        .map(|x| decompose(x).1)
        .min()
        .unwrap_or(0)
}

/// `x / 2^exponent`, which must be an integer.
fn integer(x: f64, exponent: i32) -> BigInt {
    let (mantissa, own) = decompose(x);
    if mantissa == 0 {
        BigInt::ZERO
    } else {
        BigInt::from(mantissa) << (own - exponent) as u32
    }
}

type Vector = [BigInt; 3];

fn vector(v: DVec3, exponent: i32) -> Vector {
    v.to_array().map(|x| integer(x, exponent))
}

fn subtract(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] - &b[i])
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &a[j] * &b[k] - &a[k] * &b[j]
    })
}

fn dot(a: &Vector, b: &Vector) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// A hit known exactly: its parameter is `numerator / denominator · 2^exponent`.
#[derive(Clone, Debug)]
pub(crate) struct ExactHit {
    numerator: BigInt,
    /// Positive.
    denominator: BigInt,
    exponent: i32,
    u: f64,
    v: f64,
}

impl ExactHit {
    /// Where `ray` meets the triangle with these corners, relative to `origin`; `None` where it
    /// does not, or not within its range.
    ///
    /// With A, B, C the corners relative to the ray's origin and d its direction, the point lies
    /// inside where d·(B×C), d·(C×A) and d·(A×B) are all ≥ 0 or all ≤ 0, and not all zero. Their
    /// sum is d·n, with n = (B−A)×(C−A), and the parameter A·(B×C) / (d·n).
    pub(crate) fn new(ray: &Ray, corners: [Vec3; 3], origin: DVec3, cull: Cull) -> Option<Self> {
        let corners = corners.map(Vec3::as_dvec3);
        let lengths = common_exponent(
            corners
                .iter()
                .chain([&origin, &ray.origin])
                .flat_map(|v| v.to_array()),
        );
        let directions = common_exponent(ray.direction.to_array());
        let d = vector(ray.direction, directions);
        let eye = subtract(&vector(ray.origin, lengths), &vector(origin, lengths));
        let [a, b, c] = corners.map(|corner| subtract(&vector(corner, lengths), &eye));

        let b_cross_c = cross(&b, &c);
        let weights = [
            dot(&d, &b_cross_c),
            dot(&d, &cross(&c, &a)),
            dot(&d, &cross(&a, &b)),
        ];
        let has = |sign| weights.iter().any(|w| w.sign() == sign);
        let mut denominator = &weights[0] + &weights[1] + &weights[2];
        let inside = has(Sign::Plus) != has(Sign::Minus);
        // A front turns its normal against the ray.
        let culled = cull == Cull::Back && denominator.sign() != Sign::Minus;
        if !inside || culled {
            return None;
        }
        let mut numerator = dot(&a, &b_cross_c);
        let u = ratio(&weights[1], &denominator, 0);
        let v = ratio(&weights[2], &denominator, 0);
        if denominator.sign() == Sign::Minus {
            numerator = -numerator;
            denominator = -denominator;
        }
        let hit = Self {
            numerator,
            denominator,
            exponent: lengths - directions,
            u,
            v,
        };
        let within = hit.compare_to(ray.t_min) != Ordering::Less
            && hit.compare_to(ray.t_max) != Ordering::Greater;
        within.then_some(hit)
    }

    /// Which of two hits of one ray is nearer.
    pub(crate) fn compare(&self, other: &Self) -> Ordering {
        compare_scaled(
            &self.numerator * &other.denominator,
            self.exponent,
            &other.numerator * &self.denominator,
            other.exponent,
        )
    }

    /// The parameter against a finite number.
    fn compare_to(&self, t: f64) -> Ordering {
        let (mantissa, exponent) = decompose(t);
        compare_scaled(
            self.numerator.clone(),
            self.exponent,
            &self.denominator * mantissa,
            exponent,
        )
    }

    /// The hit rounded: parameter and weights within one unit in the last place or so.
    pub(crate) fn rounded(&self, slot: u32) -> Nearest {
        let t = ratio(&self.numerator, &self.denominator, self.exponent);
        // Two roundings of at most 2^-53 each in `ratio`.
        Nearest {
            slot,
            t,
            t_error: t.abs() * 2f64.powi(-51),
            u: self.u,
            v: self.v,
        }
    }
}

/// `a · 2^i` against `b · 2^j`.
fn compare_scaled(a: BigInt, i: i32, b: BigInt, j: i32) -> Ordering {
    // Signs and lengths decide most, and spare shifts by thousands of bits.
    let by_sign = a.sign().cmp(&b.sign());
    if by_sign != Ordering::Equal || a.is_zero() {
        return by_sign;
    }
    let lengths = (a.bits() as i64 + i64::from(i)).cmp(&(b.bits() as i64 + i64::from(j)));
    match (lengths, a.sign()) {
        (Ordering::Equal, _) if i >= j => (a << (i - j) as u32).cmp(&b),
        (Ordering::Equal, _) => a.cmp(&(b << (j - i) as u32)),
        (order, Sign::Minus) => order.reverse(),
        (order, _) => order,
    }
}

/// `numerator / denominator · 2^exponent`, rounded; the denominator is not zero.
fn ratio(numerator: &BigInt, denominator: &BigInt, exponent: i32) -> f64 {
    if numerator.is_zero() {
        return 0.0;
    }
    // A quotient of at least 64 bits keeps what is cut off far below a double's last place.
    let shift = 64 + denominator.bits() as i64 - numerator.bits() as i64;
    let quotient = if shift >= 0 {
        (numerator << shift as u64) / denominator
    } else {
        numerator / (denominator << (-shift) as u64)
    };
    let bits: i128 = quotient.try_into().unwrap_or(0);
    scale(bits as f64, i64::from(exponent) - shift)
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
    let exponent = common_exponent(points.iter().flat_map(|p| p.to_array()));
    let [a, b, c] = points.map(|p| vector(p, exponent));
    cross(&subtract(&b, &a), &subtract(&c, &a))
        .iter()
        .all(BigInt::is_zero)
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let got = ratio(&p.into(), &q.into(), e);
            assert!(((got - expected) / expected).abs() < 1e-15, "{p}/{q}");
        }
    }

    #[test]
    fn compares_across_scales() {
        let big = |x: i64| BigInt::from(x);
        assert_eq!(compare_scaled(big(1), 3, big(8), 0), Ordering::Equal);
        assert_eq!(compare_scaled(big(-1), 3, big(-9), 0), Ordering::Greater);
        assert_eq!(compare_scaled(big(-1), 2000, big(1), -2000), Ordering::Less);
        assert_eq!(compare_scaled(big(3), -1, big(1), 0), Ordering::Greater);
        assert_eq!(compare_scaled(big(0), 5, big(0), -5), Ordering::Equal);
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

    #[test]
    fn finds_the_point_it_must() {
        let corners = [Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0];
        let ray = Ray::new(DVec3::new(1.0, 2.0, 5.0), DVec3::NEG_Z * 2.0);
        let hit = ExactHit::new(&ray, corners, DVec3::ZERO, Cull::None)
            .expect("a hit")
            .rounded(0);
        assert_eq!((hit.t, hit.u, hit.v), (2.5, 0.25, 0.5));
        assert!(ExactHit::new(&ray, corners, DVec3::ZERO, Cull::Back).is_some());
        let [a, b, c] = corners;
        assert!(ExactHit::new(&ray, [a, c, b], DVec3::ZERO, Cull::Back).is_none());
        let shifted = ExactHit::new(&ray, corners, DVec3::Z, Cull::None).expect("a hit");
        assert_eq!(shifted.rounded(0).t, 2.0);
        let short = Ray { t_max: 2.0, ..ray };
        assert!(ExactHit::new(&short, corners, DVec3::Z, Cull::None).is_some());
        assert!(ExactHit::new(&short, corners, DVec3::ZERO, Cull::None).is_none());
    }
}
