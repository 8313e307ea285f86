//! Linear functions of a ray's place in a packet.

use super::params::{ROW, SIDE};
use super::ray_box::RayBox;
use crate::num::simd::LANES;

/// The furthest place from a packet's first ray at which functions are evaluated; rows of lanes may reach beyond the
/// packet.
pub(super) const REACH: f64 = (SIDE + ROW) as f64;

/// Where a triangle's functions start, and how far they are evaluated from there.
#[derive(Clone, Copy)]
pub(super) struct FunctionDomain {
    pub(super) column: i32,
    pub(super) row: i32,
    pub(super) i: f64,
    pub(super) j: f64,
    pub(super) across: f64,
    pub(super) along: f64,
}

impl FunctionDomain {
    /// A whole packet.
    pub(super) const PACKET: Self = Self {
        column: 0,
        row: 0,
        i: 0.0,
        j: 0.0,
        across: REACH,
        along: REACH,
    };

    /// Functions start at the left of the bounds; for wide bounds at a multiple of a row.
    #[inline(always)]
    pub(super) fn of(bounds: &RayBox) -> Self {
        let RayBox {
            left,
            right,
            top,
            bottom,
        } = *bounds;
        let narrow = bounds.is_narrow();
        let most = (SIDE - ROW) as i32;
        let column = if narrow {
            if left < most { left } else { most }
        } else {
            left & !(ROW as i32 - 1)
        };
        let row = if narrow { top } else { top & !(ROW as i32 - 1) };
        Self {
            column,
            row,
            i: f64::from(column),
            j: f64::from(row),
            across: f64::from(right - column + ROW as i32),
            along: f64::from(bottom - row + ROW as i32),
        }
    }
}

/// A linear function of a ray's place. Its slopes, which are read together, lie in one half of 32 bytes as they are
/// copied: read across two halves that were just written, they would be waited for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Linear {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) constant: f64,
}

impl Linear {
    pub(super) const ZERO: Self = Self {
        constant: 0.0,
        x: 0.0,
        y: 0.0,
    };

    /// Of eight neighbours in a row, the first of which is at this place, as bits: those where the function, which is off
    /// by at most `error`, the roundings of evaluating it here among that, is surely positive, and those where it is surely
    /// negative.
    pub(super) fn signs_in_row(&self, (column, row): (f64, f64), error: f64) -> [u32; 2] {
        const ALL: u32 = (1 << LANES) - 1;
        let from = self.constant + self.y * row;
        let value = |lane: usize| from + self.x * (column + lane as f64);
        // Roundings are monotonic: values between two that are sure are sure.
        let (first, last) = (value(0), value(LANES - 1));
        if first > error && last > error {
            return [ALL, 0];
        }
        if first < -error && last < -error {
            return [0, ALL];
        }
        let [mut positive, mut negative] = [0; 2];
        for lane in 0..LANES {
            positive |= u32::from(value(lane) > error) << lane;
            negative |= u32::from(value(lane) < -error) << lane;
        }
        [positive, negative]
    }

    /// The same function relative to a span's first ray.
    #[inline(always)]
    pub(super) fn moved(self, span: &FunctionDomain) -> Self {
        Self {
            constant: self.constant + self.x * span.i + self.y * span.j,
            ..self
        }
    }

    /// The function times a constant.
    #[inline(always)]
    pub(super) fn times(self, factor: f64) -> Self {
        Self {
            constant: self.constant * factor,
            x: self.x * factor,
            y: self.y * factor,
        }
    }

    /// The function minus another.
    #[inline(always)]
    pub(super) fn less(self, other: Self) -> Self {
        Self {
            constant: self.constant - other.constant,
            x: self.x - other.x,
            y: self.y - other.y,
        }
    }

    /// The sum of the terms' greatest magnitudes over a span.
    #[inline(always)]
    pub(super) fn size(self, span: &FunctionDomain) -> f64 {
        self.constant.abs() + self.x.abs() * span.across + self.y.abs() * span.along
    }

    /// The function without its terms that contribute less than `least` to its size over a span.
    #[inline(always)]
    pub(super) fn without_terms_below(self, least: f64, span: &FunctionDomain) -> Self {
        let Self { constant, x, y } = self;
        Self {
            constant: if constant.abs() < least {
                0.0
            } else {
                constant
            },
            x: if x.abs() * span.across < least {
                0.0
            } else {
                x
            },
            y: if y.abs() * span.along < least { 0.0 } else { y },
        }
    }

    /// The greatest magnitude in a packet.
    #[inline(always)]
    pub(super) fn reach(self) -> f64 {
        self.constant.abs() + REACH * self.slope()
    }

    /// The greatest change from ray to ray.
    #[inline(always)]
    pub(super) fn slope(self) -> f64 {
        self.x.abs() + self.y.abs()
    }
}
