//! A colour map prepared for pixels.

use super::srgb;
use crate::scene::{COLOR_MAP_STEPS, Color, ColorMap};
use glam::Vec3;

/// The colour where there is no number: grey, which no map contains.
pub(super) const NO_NUMBER: Color = Color([0x80; 3]);

/// The map's colours, linear light.
#[derive(Clone, Debug)]
pub(super) struct Ramp {
    colors: [Vec3; COLOR_MAP_STEPS],
    no_number: Vec3,
}

impl Ramp {
    pub(super) fn new(map: ColorMap) -> Self {
        Self {
            colors: map.colors().map(srgb::linear),
            no_number: srgb::linear(NO_NUMBER),
        }
    }

    /// The colour at a fraction of the range, clamped to 0 to 1; interpolated in linear light between two of the
    /// map's colours.
    #[inline(never)]
    pub(super) fn at(&self, share: f32) -> Vec3 {
        if share.is_nan() {
            return self.no_number;
        }
        let last = COLOR_MAP_STEPS - 1;
        let place = share.clamp(0.0, 1.0) * last as f32;
        let step = (place as usize).min(last - 1);
        let (low, high) = (self.colors[step], self.colors[step + 1]);
        low + (high - low) * (place - step as f32)
    }
}

/// The range of numbers that a ramp covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RampRange {
    pub(super) low: f64,
    /// One over the range's length; zero for an empty range.
    pub(super) per_unit: f64,
}

impl RampRange {
    /// For a range, low and high; `None` is an empty range at zero.
    pub(super) fn of(range: Option<[f64; 2]>) -> Self {
        let [low, high] = range.unwrap_or_default();
        let per_unit = 1.0 / (high - low);
        Self {
            low,
            per_unit: if high > low && per_unit.is_finite() {
                per_unit
            } else {
                0.0
            },
        }
    }

    /// The position of a number in the range: 0 at its low end, 1 at its high end.
    pub(super) fn share(&self, number: f64) -> f32 {
        ((number - self.low) * self.per_unit) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_has_the_maps_colors_and_their_means() {
        let ramp = Ramp::new(ColorMap::Viridis);
        let colors = ColorMap::Viridis.colors().map(srgb::linear);
        assert_eq!(ramp.at(-3.0), colors[0]);
        assert_eq!(ramp.at(2.0), colors[255]);
        assert_eq!(ramp.at(51.0 / 255.0), colors[51]);
        let middle = ramp.at(100.5 / 255.0);
        assert!(middle.distance((colors[100] + colors[101]) * 0.5) < 1e-5);
        assert_eq!(ramp.at(f32::NAN), srgb::linear(NO_NUMBER));
    }

    #[test]
    fn spans_without_length_have_one_share() {
        assert_eq!(RampRange::of(Some([2.0, 6.0])).share(3.0), 0.25);
        for range in [None, Some([1.0, 1.0]), Some([0.0, 1e-320])] {
            assert_eq!(RampRange::of(range).share(1.0), 0.0);
        }
    }
}
