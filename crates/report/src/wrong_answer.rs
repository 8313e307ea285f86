//! How an answer differs from the truth.

use raycast_core::Hit;
use raycast_oracle::Truth;

/// The cosine between ray and normal below which distances and weights have no bound.
pub const GRAZING: f64 = 0.1;
/// The bound on the error of distances elsewhere, in units in the last place of single precision.
pub const T_BOUND: f64 = 4.0;
/// The bound on the error of weights elsewhere.
pub const UV_BOUND: f64 = 4.0 / (1 << 23) as f64;

/// How an answer differs from the truth.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum WrongAnswer {
    /// A leak, where there is a triangle.
    #[error("a miss where there is a hit")]
    Miss,
    /// A triangle where there is none.
    #[error("a hit where there is a miss")]
    Hit,
    /// Another triangle.
    #[error("the wrong triangle")]
    Triangle,
    /// Weights outside 0 to 1, or a distance of NaN.
    #[error("a number out of its range")]
    Range,
    /// The distance is off by this many units in the last place of single precision.
    #[error("t is off by {0} ulp")]
    Distance(f64),
    /// The weights are off by this.
    #[error("u or v is off by {0}")]
    Weights(f64),
    /// A channel of the picture is outside the range that rounding allows.
    #[error("{channel} is {found}, expected {low} to {high}")]
    Channel {
        /// Its name in an EXR; in an 8-bit picture `R`, `G`, `B` or `A`, 0 to 255.
        channel: &'static str,
        /// The picture's value.
        found: f64,
        /// The least allowed value.
        low: f64,
        /// The greatest allowed value.
        high: f64,
    },
}

/// Compares a hit with the truth: it must have the same triangle, and numbers within the bounds that the project
/// promises (t within 4 ulp of single precision and u, v within 4 · 2⁻²³, where the ray does not graze).
///
/// # Errors
/// The first difference.
pub fn compare(hit: Option<&Hit>, truth: Option<&Truth>) -> Result<(), WrongAnswer> {
    let (hit, truth) = match (hit, truth) {
        (None, None) => return Ok(()),
        (Some(hit), Some(truth)) => (hit, truth),
        (None, Some(_)) => return Err(WrongAnswer::Miss),
        (Some(_), None) => return Err(WrongAnswer::Hit),
    };
    if (hit.object, hit.triangle) != (truth.object, truth.triangle) {
        return Err(WrongAnswer::Triangle);
    }
    let weights = 0.0..=1.0;
    if !(hit.t.is_finite() && weights.contains(&hit.u) && weights.contains(&hit.v)) {
        return Err(WrongAnswer::Range);
    }
    if truth.cosine <= GRAZING {
        return Ok(());
    }
    let off = ulps(hit.t, truth.t);
    if off > T_BOUND {
        return Err(WrongAnswer::Distance(off));
    }
    let off = (hit.u - truth.u).abs().max((hit.v - truth.v).abs());
    if off > UV_BOUND {
        return Err(WrongAnswer::Weights(off));
    }
    Ok(())
}

/// Compares a pixel with the truth: it must have the same triangle, and a distance within the bound where the ray
/// does not graze. `u32::MAX` and infinity mean a miss.
///
/// # Errors
/// The first difference.
pub fn compare_pixel(
    object: u32,
    triangle: u32,
    depth: f32,
    truth: Option<&Truth>,
) -> Result<(), WrongAnswer> {
    let is_miss = (object, triangle) == (u32::MAX, u32::MAX);
    let hit = Hit {
        object,
        triangle,
        t: depth.into(),
        // A picture does not contain the weights.
        u: truth.map_or(0.0, |truth| truth.u),
        v: truth.map_or(0.0, |truth| truth.v),
    };
    if is_miss && truth.is_none() && depth != f32::INFINITY {
        return Err(WrongAnswer::Range);
    }
    compare((!is_miss).then_some(&hit), truth)
}

/// The error of a number in units in the last place of single precision.
pub fn ulps(found: f64, truth: f64) -> f64 {
    (found - truth).abs() / ulp(truth)
}

/// A unit in the last place of single precision, at a double.
pub(crate) fn ulp(x: f64) -> f64 {
    let power = f64::from_bits(x.abs().to_bits() & 0x7ff0_0000_0000_0000);
    (power * 2f64.powi(-23)).max(2f64.powi(-149))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRUTH: Truth = Truth {
        object: 0,
        triangle: 7,
        t: 3.0,
        u: 0.25,
        v: 0.5,
        cosine: 1.0,
    };
    const HIT: Hit = Hit {
        object: 0,
        triangle: 7,
        t: 3.0,
        u: 0.25,
        v: 0.5,
    };

    #[test]
    fn each_fault_is_reported() {
        let ulp = 2f64.powi(-22);
        assert_eq!(compare(None, None), Ok(()));
        assert_eq!(compare(Some(&HIT), Some(&TRUTH)), Ok(()));
        assert_eq!(compare(None, Some(&TRUTH)), Err(WrongAnswer::Miss));
        assert_eq!(compare(Some(&HIT), None), Err(WrongAnswer::Hit));
        for (hit, expected) in [
            (Hit { triangle: 6, ..HIT }, Err(WrongAnswer::Triangle)),
            (Hit { object: 1, ..HIT }, Err(WrongAnswer::Triangle)),
            (Hit { t: f64::NAN, ..HIT }, Err(WrongAnswer::Range)),
            (Hit { u: -1e-9, ..HIT }, Err(WrongAnswer::Range)),
            (
                Hit {
                    t: 3.0 + 4.0 * ulp,
                    ..HIT
                },
                Ok(()),
            ),
            (
                Hit {
                    t: 3.0 - 5.0 * ulp,
                    ..HIT
                },
                Err(WrongAnswer::Distance(5.0)),
            ),
            (
                Hit {
                    v: 0.5 + ulp,
                    ..HIT
                },
                Ok(()),
            ),
            (
                Hit {
                    v: 0.5 + 4.0 * ulp,
                    ..HIT
                },
                Err(WrongAnswer::Weights(4.0 * ulp)),
            ),
        ] {
            assert_eq!(compare(Some(&hit), Some(&TRUTH)), expected);
        }
        let grazing = Truth {
            cosine: 0.05,
            ..TRUTH
        };
        let off = Hit { t: 3.1, ..HIT };
        assert_eq!(compare(Some(&off), Some(&grazing)), Ok(()));
    }
}
