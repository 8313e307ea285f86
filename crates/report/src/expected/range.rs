use raycast_core::glam::{DVec3, Vec3};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The numbers from `low` to `high`: the possible results of computing with numbers of `DIGITS` bits instead of real
/// numbers.
///
/// Interval arithmetic (Moore, "Interval Analysis", 1966). If each operand of an operation lies in its range, the
/// rounded result lies in the range that the operation gives: the exact result's, widened at both ends by 2^(1 −
/// `DIGITS`) of its magnitude. Rounding to nearest needs half of that; the other half covers this type's own rounding
/// (in double precision, which is far finer) and sums taken in another order. Underflow is covered by the precision's
/// smallest normal number; what may overflow is unknown.
///
/// A range with an end that is NaN is unknown: [`Range::is_known`] is `false`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range<const DIGITS: i32> {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// The possible results in single precision.
pub(crate) type Single = Range<24>;

/// The possible results in double precision.
pub(crate) type Double = Range<53>;

impl<const DIGITS: i32> Range<DIGITS> {
    /// A single number.
    pub(crate) const fn exactly(number: f64) -> Self {
        Self {
            low: number,
            high: number,
        }
    }

    /// The numbers within `reach` of a number.
    pub(crate) fn around(number: f64, reach: f64) -> Self {
        Self {
            low: number - reach,
            high: number + reach,
        }
    }

    /// Any number.
    pub(crate) const UNKNOWN: Self = Self::exactly(f64::NAN);

    /// Whether both ends are finite numbers.
    pub(crate) fn is_known(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// Whether a number is in the range.
    pub(crate) fn contains(self, number: f64) -> bool {
        self.low <= number && number <= self.high
    }

    /// From the least to the greatest of some numbers; unknown if one of them is NaN.
    pub(crate) fn over(numbers: impl IntoIterator<Item = f64>) -> Self {
        let mut all: Option<Self> = None;
        for number in numbers {
            if number.is_nan() {
                return Self::UNKNOWN;
            }
            let before = all.unwrap_or(Self::exactly(number));
            all = Some(Self {
                low: before.low.min(number),
                high: before.high.max(number),
            });
        }
        all.unwrap_or(Self::UNKNOWN)
    }

    /// The range after one rounding.
    pub(crate) fn rounded(self) -> Self {
        let unit = f64::from_bits(((1024 - DIGITS) as u64) << 52);
        let (least, most) = if DIGITS > 24 {
            (f64::MIN_POSITIVE, f64::MAX)
        } else {
            (f32::MIN_POSITIVE.into(), f32::MAX.into())
        };
        if self.low < -most || self.high > most {
            return Self::UNKNOWN;
        }
        Self {
            low: self.low - (self.low.abs() * unit + least),
            high: self.high + (self.high.abs() * unit + least),
        }
    }

    /// The same numbers, rounded to another precision.
    pub(crate) fn to<const OTHER: i32>(self) -> Range<OTHER> {
        Range {
            low: self.low,
            high: self.high,
        }
        .rounded()
    }

    pub(crate) fn sqrt(self) -> Self {
        // What rounding has made negative was zero or more.
        Self {
            low: self.low.max(0.0).sqrt(),
            high: self.high.sqrt(),
        }
        .rounded()
    }

    pub(crate) fn abs(self) -> Self {
        if self.contains(0.0) {
            Self {
                low: 0.0,
                high: self.high.max(-self.low),
            }
        } else {
            Self::over([self.low.abs(), self.high.abs()])
        }
    }

    /// Each number, but at least `least`.
    pub(crate) fn max(self, least: f64) -> Self {
        self.each(|number| if number < least { least } else { number })
    }

    /// Each number, but at most `most`.
    pub(crate) fn min(self, most: f64) -> Self {
        self.each(|number| if number > most { most } else { number })
    }

    /// The lesser of each number and each of another range.
    pub(crate) fn at_most(self, most: Self) -> Self {
        Self {
            low: if self.low > most.low {
                most.low
            } else {
                self.low
            },
            high: if self.high > most.high {
                most.high
            } else {
                self.high
            },
        }
    }

    /// The results of a non-decreasing function, without rounding.
    pub(crate) fn each(self, rising: impl Fn(f64) -> f64) -> Self {
        Self {
            low: rising(self.low),
            high: rising(self.high),
        }
    }
}

impl<const DIGITS: i32> Add for Range<DIGITS> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            low: self.low + other.low,
            high: self.high + other.high,
        }
        .rounded()
    }
}

impl<const DIGITS: i32> Sub for Range<DIGITS> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            low: self.low - other.high,
            high: self.high - other.low,
        }
        .rounded()
    }
}

impl<const DIGITS: i32> Neg for Range<DIGITS> {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
        }
    }
}

impl<const DIGITS: i32> Mul for Range<DIGITS> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let ends = [self.low * other.low, self.low * other.high];
        let more = [self.high * other.low, self.high * other.high];
        Self::over(ends.into_iter().chain(more)).rounded()
    }
}

impl<const DIGITS: i32> Div for Range<DIGITS> {
    type Output = Self;

    /// Unknown where the divisor may be zero.
    fn div(self, other: Self) -> Self {
        if other.contains(0.0) {
            return Self::UNKNOWN;
        }
        let ends = [self.low / other.low, self.low / other.high];
        let more = [self.high / other.low, self.high / other.high];
        Self::over(ends.into_iter().chain(more)).rounded()
    }
}

/// Three ranges.
pub(crate) type Vector<const DIGITS: i32> = [Range<DIGITS>; 3];

/// A vector of known numbers.
pub(crate) fn exactly<const DIGITS: i32>(vector: DVec3) -> Vector<DIGITS> {
    vector.to_array().map(Range::exactly)
}

/// A vector of known single-precision numbers.
pub(crate) fn exactly_single(vector: Vec3) -> Vector<24> {
    exactly(vector.as_dvec3())
}

pub(crate) fn plus<const D: i32>(a: Vector<D>, b: Vector<D>) -> Vector<D> {
    std::array::from_fn(|i| a[i] + b[i])
}

pub(crate) fn minus<const D: i32>(a: Vector<D>, b: Vector<D>) -> Vector<D> {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(crate) fn scaled<const D: i32>(a: Vector<D>, factor: Range<D>) -> Vector<D> {
    a.map(|a| a * factor)
}

pub(crate) fn dot<const D: i32>(a: Vector<D>, b: Vector<D>) -> Range<D> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross<const D: i32>(a: Vector<D>, b: Vector<D>) -> Vector<D> {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

pub(crate) fn length<const D: i32>(a: Vector<D>) -> Range<D> {
    // The square of one range, not the product of two independent ones.
    let square = |a: Range<D>| {
        let a = a.abs();
        Range {
            low: a.low * a.low,
            high: a.high * a.high,
        }
        .rounded()
    };
    (square(a[0]) + square(a[1]) + square(a[2])).sqrt()
}

/// A vector of unit length; unknown where it may be zero.
pub(crate) fn unit<const D: i32>(a: Vector<D>) -> Vector<D> {
    let length = length(a);
    a.map(|a| a / length)
}

/// The same vector, rounded to another precision.
pub(crate) fn to<const D: i32, const OTHER: i32>(a: Vector<D>) -> Vector<OTHER> {
    a.map(Range::to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_oracle::random::Random;

    /// The truth is single precision itself: its results lie in the range, and the range is narrow.
    #[test]
    fn single_precision_stays_in_its_ranges() {
        let mut random = Random::new(7);
        for _ in 0..20_000 {
            let mut number = || (random.in_cube().x * random.decade(-6.0, 6.0)) as f32;
            let [a, b, c] = [number(), number(), number()];
            let [x, y, z] = [a, b, c].map(|number| Single::exactly(number.into()));
            for (range, found) in [
                (x + y, a + b),
                (x - y, a - b),
                (x * y, a * b),
                (x / y, a / b),
                (x * y + z, a * b + c),
                ((x * x + y * y).sqrt(), (a * a + b * b).sqrt()),
                ((x - y).abs(), (a - b).abs()),
                (x.max(0.5).min(2.0), a.clamp(0.5, 2.0)),
                (unit([x, y, z])[1], Vec3::new(a, b, c).normalize().y),
                (
                    dot([x, y, z], [z, x, y]),
                    Vec3::new(a, b, c).dot(Vec3::new(c, a, b)),
                ),
                (
                    cross([x, y, z], [z, x, y])[2],
                    Vec3::new(a, b, c).cross(Vec3::new(c, a, b)).z,
                ),
            ] {
                assert!(range.contains(found.into()), "{found} is not in {range:?}");
            }
            let product = x * y;
            assert!(product.high - product.low <= f64::from((a * b).abs()) * 5e-7 + 1e-37);
        }
    }

    #[test]
    fn what_may_overflow_is_unknown() {
        let large = Single::exactly(1e30);
        assert!(!(large * large).is_known() && !(-large * large).is_known());
        assert!((Double::exactly(1e30) * Double::exactly(1e30)).is_known());
    }

    #[test]
    fn what_may_be_divided_by_zero_is_unknown() {
        let about_zero = Single::around(0.0, 1e-9);
        assert!(!(Single::exactly(1.0) / about_zero).is_known());
        assert!(!unit([about_zero; 3])[0].is_known());
        assert!(!Single::UNKNOWN.contains(0.0));
    }
}
