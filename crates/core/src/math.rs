//! Sine, tangent, power and their like, with the same bits on any machine.
//!
//! The standard library asks the platform's C library for these, and that may answer by processor:
//! glibc has one sine for processors with fused multiply-add and another for those without, a last bit
//! apart. Wherever a byte of a picture hangs on one of them (a camera's angles, an object's rotation,
//! the tables of sRGB) they come from the `libm` crate instead, which is Rust alone: additions,
//! multiplications and divisions in one order, each correctly rounded. `clippy.toml` refuses the
//! platform's. Square roots, roundings and remainders are exact everywhere, and need no replacement.
//!
//! Errors are below one unit in the last place, as the C library's are; angles are in radians; NaN, and arguments
//! outside a function's domain, give NaN.

/// √(a² + b²), however large or small the two are.
pub fn hypot(a: f64, b: f64) -> f64 {
    libm::hypot(a, b)
}

/// The sine of an angle: −1 to 1.
pub fn sin(angle: f64) -> f64 {
    libm::sin(angle)
}

/// The cosine of an angle: −1 to 1.
pub fn cos(angle: f64) -> f64 {
    libm::cos(angle)
}

/// The sine and the cosine of an angle.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    libm::sincos(angle)
}

/// The tangent of an angle.
pub fn tan(angle: f64) -> f64 {
    libm::tan(angle)
}

/// The angle with this sine, −π/2 to π/2; NaN outside −1 to 1.
pub fn asin(sine: f64) -> f64 {
    libm::asin(sine)
}

/// The angle with this tangent, −π/2 to π/2.
pub fn atan(tangent: f64) -> f64 {
    libm::atan(tangent)
}

/// The angle of the point (x, y) from the positive x axis, −π to π; zero for (0, 0).
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// The error function: 2/√π times the integral of e^(−x²) from 0.
pub fn erf(number: f64) -> f64 {
    libm::erf(number)
}

/// The exponential function.
pub fn exp(exponent: f64) -> f64 {
    libm::exp(exponent)
}

/// The logarithm to the base 2; minus infinity for 0, NaN below.
pub fn log2(number: f64) -> f64 {
    libm::log2(number)
}

/// `base` to the power of `exponent`; NaN for a negative base and an exponent that is not whole.
pub fn pow(base: f64, exponent: f64) -> f64 {
    libm::pow(base, exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bits that must not change from machine to machine, nor from one version of `libm` to the next:
    /// pictures made before would no longer stitch with those made after. The values were checked
    /// against a C library's to one unit in the last place by the test below.
    #[test]
    fn bits_are_these_everywhere() {
        let mut sum = 0u64;
        for i in -2000..2000 {
            let x = f64::from(i) * 0.017_3;
            let share = (f64::from(i) + 0.5) / 2000.0;
            let (sine, cosine) = sin_cos(x);
            assert_eq!((sine, cosine), (sin(x), cos(x)));
            for value in [
                sine,
                cosine,
                tan(x),
                asin(share),
                atan(x),
                atan2(x, share),
                pow(share.abs(), 2.4),
            ] {
                sum = sum.rotate_left(5) ^ value.to_bits();
            }
        }
        assert_eq!(sum, 0x81c4_a83d_137e_7527, "{sum:#x}");
    }

    /// The truth is the platform's C library, itself good to a unit in the last place.
    #[test]
    #[allow(clippy::disallowed_methods, reason = "they are what is compared with")]
    fn values_are_those_of_the_platform() {
        for i in -2000..2000 {
            let x = f64::from(i) * 0.017_3;
            let share = (f64::from(i) + 0.5) / 2000.0;
            for (found, expected) in [
                (sin(x), x.sin()),
                (cos(x), x.cos()),
                (tan(x), x.tan()),
                (asin(share), share.asin()),
                (atan(x), x.atan()),
                (atan2(x, share), x.atan2(share)),
                (pow(share.abs(), 2.4), share.abs().powf(2.4)),
                (exp(x), x.exp()),
                (log2(share.abs()), share.abs().log2()),
            ] {
                let apart = found.to_bits().abs_diff(expected.to_bits());
                assert!(apart <= 2, "{found} for {expected} at {x}");
            }
        }
    }
}
