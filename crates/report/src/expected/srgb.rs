//! Conversion between sRGB and linear light by the standard's formulas (IEC 61966-2-1), in double precision.

use super::range::{Single, Vector};
use raycast_core::math;
use raycast_core::scene::Color;

/// Linear light from an sRGB value, both 0 to 1.
pub(super) fn to_linear(value: f64) -> f64 {
    if value <= 0.04045 {
        value / 12.92
    } else {
        math::pow((value + 0.055) / 1.055, 2.4)
    }
}

/// The sRGB value of linear light, both 0 to 1.
fn from_linear(light: f64) -> f64 {
    if light <= 0.04045 / 12.92 {
        light * 12.92
    } else {
        1.055 * math::pow(light, 1.0 / 2.4) - 0.055
    }
}

/// A byte's light, within rounding to single precision.
pub(super) fn byte_to_linear(byte: u8) -> Single {
    Single::exactly(to_linear(f64::from(byte) / 255.0)).rounded()
}

/// A colour's light.
pub(super) fn linear(color: Color) -> Vector<24> {
    color.0.map(byte_to_linear)
}

/// The first and the last byte that light in a range may be rounded to.
pub(super) fn byte_range(light: Single) -> Option<[u8; 2]> {
    // The formulas err by some 1e-15 of a byte; a millionth of a byte is far more than that.
    let byte = |light: f64, slack: f64| {
        (from_linear(light.clamp(0.0, 1.0)) * 255.0 + 0.5 + slack).clamp(0.0, 255.0) as u8
    };
    light
        .is_known()
        .then(|| [byte(light.low, -1e-6), byte(light.high, 1e-6)])
}

/// The light of a value between 0 and 1 that is rounded to the nearest byte.
pub(super) fn displayed(value: Single) -> Single {
    let value = value * Single::exactly(255.0) + Single::exactly(0.5);
    if !value.is_known() {
        return Single::UNKNOWN;
    }
    value
        .each(|value| to_linear(f64::from(value.clamp(0.0, 255.0) as u8) / 255.0))
        .rounded()
}
