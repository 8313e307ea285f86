//! Valid ranges of the numbers that people choose, in one place so that the command line, scene files and the window
//! agree.

use std::fmt;

/// The most samples a pixel: 64 × 64, beyond which eight bits a channel show nothing more.
pub const MOST_SAMPLES: u32 = 4096;

/// The widest that lines are drawn, in pixels.
pub const WIDEST_LINE: f32 = 100.0;

/// An eye's coordinate that is nearer to zero than this is taken for zero. Corners are multiples of 2⁻¹⁴⁹, and eyes still
/// fit between them. Beside a corner at zero an eye is then 2⁻¹⁶⁰ away or more, and beside any other a unit in its own last
/// place, 2⁻²⁰¹ or more: products of three such distances lose no digits in double precision. Those of the least number
/// do, and each ray would be decided in integers of thousands of bits.
pub const LEAST_EYE: f64 = f64::from_bits((1023 - 160) << 52);

/// The narrowest vertical field of view, in degrees: 1.7e-11 radians, so that neighbouring rays of a picture of
/// 1000 rows differ by some 80 roundings of a unit direction (2⁻⁵³). Much narrower, all rays are one ray in double
/// precision, every triangle near it needs exact arithmetic, and the picture shows nothing.
pub const NARROWEST_FOV: f64 = 1e-9;

/// The end of the range of vertical fields of view in degrees, exclusive: at 180° a perspective picture would be
/// infinitely high.
pub const FOV_END: f64 = 180.0;

/// The furthest that a frame's middle may be shifted off the view axis, in heights of the frame.
pub const FURTHEST_SHIFT: f64 = 1000.0;

/// The largest coefficient of a lens's distortion, of either sign. A coefficient matters from where its term of the
/// relative distortion (k1 r², k2 r⁴, k3 r⁶ with r the tangent of the angle off the view axis) is near one: k1 = −10⁴
/// ends the picture 0.33 degrees off the axis, k3 = −10⁴ at 9 degrees. Calibrated lenses stay below 10³ by far; a larger
/// limit would let in mistyped numbers whose pictures show nothing.
pub const MOST_DISTORTION: f64 = 1e4;

/// The furthest that the two eyes of a stereo picture are apart: as far as a scene's coordinates go. Much further, rays
/// would start where no double is.
pub const WIDEST_EYES: f64 = 1e18;

/// The furthest that the ground lies from zero: as far as a scene's coordinates go.
pub const FURTHEST_GROUND: f64 = 1e18;

/// A number as messages show it: a power of ten in place of many zeros.
fn number(number: impl Into<f64> + Copy + fmt::Display + fmt::LowerExp) -> String {
    let size = number.into().abs();
    if (1e-6..1e9).contains(&size) || size == 0.0 || !size.is_finite() {
        number.to_string()
    } else {
        format!("{number:e}")
    }
}

/// A number that is out of its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OutOfRange {
    /// Samples a pixel.
    #[error("expected 1 to {MOST_SAMPLES} samples, found {0}")]
    Samples(u32),
    /// A line's width in pixels.
    #[error("expected a width above 0 and at most {WIDEST_LINE} pixels, found {}", number(*.0))]
    LineWidth(f32),
    /// A vertical field of view.
    #[error(
        "expected a field of view from {NARROWEST_FOV:e} to below {FOV_END} degrees, found {}",
        number(*.0)
    )]
    Fov(f64),
    /// A vertical field of view that is too wide for a curved (panoramic) picture.
    #[error("expected a field of view of {most} degrees at most for {name}, found {}", number(*.found))]
    WideFov {
        /// The name of the projection.
        name: &'static str,
        /// The widest field of view that the projection has, in degrees.
        most: f64,
        /// The field of view that was given, in degrees.
        found: f64,
    },
    /// A shift of the frame off the view axis.
    #[error("expected a shift within {FURTHEST_SHIFT} heights of the frame, found {},{}", number(*.0), number(*.1))]
    Shift(f64, f64),
    /// A lens's distortion.
    #[error(
        "expected lens coefficients K1,K2,P1,P2,K3 within {MOST_DISTORTION} of zero, found {}",
        found.map(number).join(",")
    )]
    Lens {
        /// k1, k2, p1, p2, k3.
        found: [f64; 5],
    },
    /// The distance between the eyes of a stereo picture.
    #[error("expected a distance between the eyes above 0 and at most {WIDEST_EYES:e}, found {}", number(*.0))]
    EyeDistance(f64),
    /// The distance at which the views of a stereo pair coincide.
    #[error("expected a distance of convergence above 0, or inf, found {}", number(*.0))]
    Convergence(f64),
    /// The height of the ground.
    #[error("expected a ground height within {FURTHEST_GROUND:e} of zero, found {}", number(*.0))]
    Ground(f64),
    /// A share of texture in a surface's colour.
    #[error("expected a blend from 0 to 1, found {}", number(*.0))]
    Blend(f32),
    /// An angle between neighbouring triangles.
    #[error("expected a crease angle from 0 to 180 degrees, found {}", number(*.0))]
    Crease(f32),
    /// How strongly hidden lines show.
    #[error("expected 0 to 1 of hidden lines, found {}", number(*.0))]
    HiddenLines(f32),
    /// How much of what lies behind it a surface hides.
    #[error("expected an opacity from 0 to 1, found {}", number(*.0))]
    Opacity(f32),
    /// The ends of a color scale.
    #[error("expected a low end below a high one, found {} and {}", number(*.0), number(*.1))]
    ColorRange(f64, f64),
}

/// Samples a pixel, from 1 to [`MOST_SAMPLES`].
///
/// # Errors
/// Any other number.
pub fn samples(count: u32) -> Result<u32, OutOfRange> {
    let fits = (1..=MOST_SAMPLES).contains(&count);
    fits.then_some(count).ok_or(OutOfRange::Samples(count))
}

/// The shift of a frame off the view axis, to the right and up, in heights of the frame: at most [`FURTHEST_SHIFT`]
/// each.
///
/// # Errors
/// Any other number.
pub fn shift(shift: [f64; 2]) -> Result<[f64; 2], OutOfRange> {
    let fits = shift.iter().all(|part| part.abs() <= FURTHEST_SHIFT);
    fits.then_some(shift)
        .ok_or(OutOfRange::Shift(shift[0], shift[1]))
}

/// The coefficients k1, k2, p1, p2, k3 of a lens's distortion, each within [`MOST_DISTORTION`] of zero.
///
/// # Errors
/// Any other number.
pub fn lens(coefficients: [f64; 5]) -> Result<[f64; 5], OutOfRange> {
    let fits = coefficients
        .iter()
        .all(|number| number.abs() <= MOST_DISTORTION);
    fits.then_some(coefficients).ok_or(OutOfRange::Lens {
        found: coefficients,
    })
}

/// The distance between the eyes of a stereo picture in scene units, above 0 and at most [`WIDEST_EYES`].
///
/// # Errors
/// Any other number.
pub fn eye_distance(distance: f64) -> Result<f64, OutOfRange> {
    let fits = distance > 0.0 && distance <= WIDEST_EYES;
    fits.then_some(distance)
        .ok_or(OutOfRange::EyeDistance(distance))
}

/// The distance at which the views of a stereo pair coincide in scene units, above 0; infinite for parallel view axes.
///
/// # Errors
/// Any other number.
pub fn convergence(distance: f64) -> Result<f64, OutOfRange> {
    // NaN fails this comparison.
    (distance > 0.0)
        .then_some(distance)
        .ok_or(OutOfRange::Convergence(distance))
}

/// The height of the ground in scene units, within [`FURTHEST_GROUND`] of zero.
///
/// # Errors
/// Any other number.
pub fn ground_height(height: f64) -> Result<f64, OutOfRange> {
    let fits = height.abs() <= FURTHEST_GROUND;
    fits.then_some(height).ok_or(OutOfRange::Ground(height))
}

/// A line's width in pixels, above 0 and at most [`WIDEST_LINE`].
///
/// # Errors
/// Any other number.
pub fn line_width(pixels: f32) -> Result<f32, OutOfRange> {
    let fits = pixels > 0.0 && pixels <= WIDEST_LINE;
    fits.then_some(pixels).ok_or(OutOfRange::LineWidth(pixels))
}

/// A vertical field of view in degrees, from [`NARROWEST_FOV`] to below [`FOV_END`].
///
/// # Errors
/// Any other number.
pub fn fov(degrees: f64) -> Result<f64, OutOfRange> {
    let fits = (NARROWEST_FOV..FOV_END).contains(&degrees);
    fits.then_some(degrees).ok_or(OutOfRange::Fov(degrees))
}

/// A share of texture, 0 to 1.
///
/// # Errors
/// Any other number.
pub fn blend(share: f32) -> Result<f32, OutOfRange> {
    let fits = (0.0..=1.0).contains(&share);
    fits.then_some(share).ok_or(OutOfRange::Blend(share))
}

/// A crease angle in degrees, 0 to 180.
///
/// # Errors
/// Any other number.
pub fn crease(degrees: f32) -> Result<f32, OutOfRange> {
    let fits = (0.0..=180.0).contains(&degrees);
    fits.then_some(degrees).ok_or(OutOfRange::Crease(degrees))
}

/// How strongly hidden lines show, 0 to 1.
///
/// # Errors
/// Any other number.
pub fn hidden_lines(share: f32) -> Result<f32, OutOfRange> {
    let fits = (0.0..=1.0).contains(&share);
    fits.then_some(share).ok_or(OutOfRange::HiddenLines(share))
}

/// How much of what lies behind it a surface hides, from 0 to 1.
///
/// # Errors
/// Any other number.
pub fn opacity(share: f32) -> Result<f32, OutOfRange> {
    let fits = (0.0..=1.0).contains(&share);
    fits.then_some(share).ok_or(OutOfRange::Opacity(share))
}

/// The numbers at the ends of a color scale: finite, the first below the second, a finite distance apart.
///
/// # Errors
/// Any other numbers.
pub fn color_range([low, high]: [f64; 2]) -> Result<[f64; 2], OutOfRange> {
    let fits = low < high && (high - low).is_finite();
    fits.then_some([low, high])
        .ok_or(OutOfRange::ColorRange(low, high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_accept_their_ends_and_refuse_what_is_beyond() {
        assert!(samples(1).is_ok() && samples(4096).is_ok());
        assert!(samples(0).is_err());
        let message = samples(4097).expect_err("too many").to_string();
        assert_eq!(message, "expected 1 to 4096 samples, found 4097");
        assert!(line_width(0.01).is_ok() && line_width(100.0).is_ok());
        for width in [0.0, -1.0, 100.01, f32::NAN, f32::INFINITY] {
            assert!(line_width(width).is_err(), "{width}");
        }
        assert!(fov(1e-9).is_ok() && fov(179.9).is_ok());
        for degrees in [0.0, -1.0, 1e-10, 180.0, f64::NAN, f64::INFINITY] {
            assert!(fov(degrees).is_err(), "{degrees}");
        }
        for (degrees, found) in [
            (180.0, "180"),
            (1e-300, "1e-300"),
            (-1e300, "-1e300"),
            (0.0, "0"),
        ] {
            let message = fov(degrees).expect_err("no field of view").to_string();
            assert!(message.ends_with(&format!("found {found}")), "{message}");
        }
        assert!(lens([1e4, -1e4, 0.0, 0.0, -1e4]).is_ok());
        let message = lens([0.0, 1e308, 0.0, 0.0, 0.5]).expect_err("too large");
        assert_eq!(
            message.to_string(),
            "expected lens coefficients K1,K2,P1,P2,K3 within 10000 of zero, found 0,1e308,0,0,0.5"
        );
        for coefficient in [f64::NAN, f64::NEG_INFINITY, -10_001.0] {
            assert!(lens([0.0, 0.0, 0.0, 0.0, coefficient]).is_err());
        }
        assert!(eye_distance(1e18).is_ok() && convergence(f64::INFINITY).is_ok());
        assert!(ground_height(-1e18).is_ok());
        for bad in [f64::NAN, f64::NEG_INFINITY, -1.01e18] {
            assert!(eye_distance(bad).is_err() && convergence(bad).is_err());
            assert!(ground_height(bad).is_err(), "{bad}");
        }
        assert!(eye_distance(0.0).is_err() && convergence(0.0).is_err());
        let message = eye_distance(-1.0).expect_err("negative").to_string();
        assert!(message.ends_with("at most 1e18, found -1"), "{message}");
        assert!(blend(0.0).is_ok() && blend(1.0).is_ok());
        for share in [-0.1, 1.1, f32::NAN] {
            assert!(
                blend(share).is_err() && hidden_lines(share).is_err(),
                "{share}"
            );
        }
    }
}
