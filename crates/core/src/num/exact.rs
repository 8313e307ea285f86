//! Exact arithmetic on floating point numbers.
//!
//! Every coordinate is a binary floating point number, hence an integer times a power of two: over a common power the
//! determinants of a ray and a triangle are integers, and every decision is the sign of one. Bounds on their lengths
//! follow from the numbers' exponents: nearly all fit integers of a fixed length, which need no heap allocation.

use super::integer::Integer;
use super::wide::Wide;
use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// Long enough for corners of 24 bits whose magnitudes differ by a factor of a million at most, and rays of 53 bits;
/// [`Medium`] for magnitudes that differ by a factor of 10³⁶. [`Long`] holds what the whole range of single precision
/// needs.
pub(crate) type Short = Wide<10>;
pub(crate) type Medium = Wide<16>;
pub(crate) type Long = Wide<32>;

/// A number as `mantissa · 2^exponent`, the mantissa odd or zero.
pub(crate) fn decompose(x: f64) -> (i64, i32) {
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

/// 2^exponent, for exponents of normal numbers.
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// A common power of two for a set of numbers: each is an integer times 2^exponent, and below 2^(exponent + bits).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Scale {
    pub(crate) exponent: i32,
    pub(crate) bits: u32,
}

impl Scale {
    pub(crate) fn of(numbers: impl IntoIterator<Item = f64>) -> Self {
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

    pub(crate) fn of_vectors<'v>(vectors: impl IntoIterator<Item = &'v DVec3>) -> Self {
        Self::of(vectors.into_iter().flat_map(|v| v.to_array()))
    }

    fn integer<I: Integer>(self, x: f64) -> I {
        let (mantissa, own) = decompose(x);
        if mantissa == 0 {
            I::shifted(0, 0)
        } else {
            I::shifted(mantissa, (own - self.exponent) as u32)
        }
    }

    pub(crate) fn vector<I: Integer>(self, v: DVec3) -> Vector<I> {
        [self.integer(v.x), self.integer(v.y), self.integer(v.z)]
    }
}

// What follows names each component, since mapping arrays moves their long integers several times: exact hits took
// two and a half times as long.

pub(crate) type Vector<I> = [I; 3];

pub(crate) fn subtract<I: Integer>(a: &Vector<I>, b: &Vector<I>) -> Vector<I> {
    [a[0].minus(&b[0]), a[1].minus(&b[1]), a[2].minus(&b[2])]
}

pub(crate) fn cross<I: Integer>(a: &Vector<I>, b: &Vector<I>) -> Vector<I> {
    let component = |j: usize, k: usize| a[j].times(&b[k]).minus(&a[k].times(&b[j]));
    [component(1, 2), component(2, 0), component(0, 1)]
}

pub(crate) fn dot<I: Integer>(a: &Vector<I>, b: &Vector<I>) -> I {
    let in_plane = a[0].times(&b[0]).plus(&a[1].times(&b[1]));
    in_plane.plus(&a[2].times(&b[2]))
}

/// The most binary digits of a determinant of corners relative to an eye.
///
/// With corners and eye below 2^L over their power of two, relative corners are below 2^(L+2), their cross products
/// below 2^(2L+5) and det(A, B, C) below 2^(3L+9).
pub(crate) fn determinant_digits(lengths: Scale) -> u64 {
    3 * u64::from(lengths.bits) + 9
}

/// The most binary digits of a hit: of its parameter's numerator, a determinant, and of the denominator times a
/// mantissa of 53 digits. With directions below 2^D weights are below 2^(2L+D+7) and the denominator, their sum, below
/// 2^(2L+D+9).
pub(crate) fn hit_digits(lengths: Scale, directions: Scale) -> u64 {
    let denominator = 2 * u64::from(lengths.bits) + u64::from(directions.bits) + 9;
    determinant_digits(lengths).max(denominator + 53)
}

/// The most binary digits of two hits, and of the products of one's numerator and the other's denominator.
pub(crate) fn comparison_digits(lengths: Scale, directions: Scale) -> u64 {
    let (l, d) = (u64::from(lengths.bits), u64::from(directions.bits));
    hit_digits(lengths, directions).max(5 * l + d + 18)
}

/// Runs a function with integers long enough for numbers of so many binary digits. Two limbs more hold the last limb of
/// each factor of a product, and the shift to a common length.
macro_rules! sized {
    ($digits:expr, $work:ident($($argument:expr),*)) => {{
        let digits: u64 = $digits + 2 * 64;
        if digits <= 10 * 64 {
            $work::<$crate::num::exact::Short>($($argument),*)
        } else if digits <= 16 * 64 {
            $work::<$crate::num::exact::Medium>($($argument),*)
        } else if digits <= 32 * 64 {
            $work::<$crate::num::exact::Long>($($argument),*)
        } else {
            $work::<num_bigint::BigInt>($($argument),*)
        }
    }};
}

pub(crate) use sized;

/// `a · 2^i` against `b · 2^j`.
pub(crate) fn compare_scaled<I: Integer>(a: &I, i: i32, b: &I, j: i32) -> Ordering {
    // Sign and length decide most comparisons; shifts by thousands of bits are slow.
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
/// The highest 64 bits of each are within a relative error of 2⁻⁶³. The integer part of the quotient has 64 or 65
/// bits and is rounded to a double: the relative error is below (1 + 2⁻⁸)ε, and zero where the quotient is a double.
pub(crate) fn ratio<I: Integer>(numerator: &I, denominator: &I, exponent: i32) -> f64 {
    if numerator.sign() == Ordering::Equal {
        return 0.0;
    }
    // Both as fractions of 2^64, at least one half.
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

/// Whether three finite points lie exactly on a line (or coincide).
pub(crate) fn is_collinear(a: Vec3, b: Vec3, c: Vec3) -> bool {
    let (ab, ac) = (b.as_dvec3() - a.as_dvec3(), c.as_dvec3() - a.as_dvec3());
    let normal = ab.cross(ac);
    // Each component is a difference of two products of rounded differences: with ε = 2⁻⁵³ its error is below
    // (2·2 + 1 + 1)ε times the sum of the products' magnitudes; 8 includes higher orders.
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
    sized!(determinant_digits(lengths), of(points, lengths))
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;

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
        // Differences are rounded, each coordinate differently.
        let few = Vec3::new(3.0, 5.0, 11.0);
        assert!(is_collinear(few, few * (1u64 << 51) as f32, few * -3.0));
        assert!(!is_collinear(
            Vec3::splat(1e18),
            Vec3::ZERO,
            Vec3::splat(1e-30).with_x(2e-30)
        ));
    }
}
