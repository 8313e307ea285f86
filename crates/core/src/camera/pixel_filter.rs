use crate::math;
use std::f64::consts::{FRAC_PI_2, SQRT_2};
use std::fmt;
use std::str::FromStr;

/// How a pixel weighs the light around its centre: a separable reconstruction filter, the product of one function of
/// x and the same function of y (Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, 2023, section
/// 8.8).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PixelFilter {
    /// Constant over the pixel's square.
    #[default]
    Box,
    /// 1 − |x|, as far as the neighbouring pixels' centres.
    Tent,
    /// The cubic with B = C = ⅓, of radius two pixels, negative beyond 8/7: sharp edges with little ringing (Mitchell
    /// and Netravali, "Reconstruction Filters in Computer Graphics", 1988).
    Mitchell,
    /// e^(−2x²), a standard deviation of half a pixel, minus its value at the end, a pixel and a half from the
    /// centre.
    Gaussian,
}

impl PixelFilter {
    /// Every filter, and its name.
    pub const ALL: [(&'static str, Self); 4] = [
        ("box", Self::Box),
        ("tent", Self::Tent),
        ("mitchell", Self::Mitchell),
        ("gaussian", Self::Gaussian),
    ];

    /// The radius, in pixels.
    pub fn radius(self) -> f64 {
        match self {
            Self::Box => 0.5,
            Self::Tent => 1.0,
            Self::Mitchell => 2.0,
            Self::Gaussian => 1.5,
        }
    }

    /// Whether the weight is negative `distance` pixels from the centre.
    pub fn is_negative(self, distance: f64) -> bool {
        self == Self::Mitchell && distance.abs() > MITCHELL_ZERO
    }

    /// The signed distance from the centre up to which a `share` (0 to 1) of the filter's absolute weight lies.
    /// Uniform shares map to importance-sampled places (Ernst, Stamminger and Greiner, "Filter Importance Sampling",
    /// 2006).
    pub fn place(self, share: f64) -> f64 {
        let (mut near, mut far) = (0.0, self.radius());
        let wanted = (2.0 * share - 1.0).abs() * self.magnitude(far);
        // Bisection: more steps than a double has bits.
        for _ in 0..64 {
            let middle = (near + far) * 0.5;
            if self.magnitude(middle) < wanted {
                near = middle;
            } else {
                far = middle;
            }
        }
        if share < 0.5 { -far } else { far }
    }

    /// The integral of the absolute weight from the centre to `x`, from 0 to the radius.
    fn magnitude(self, x: f64) -> f64 {
        match self {
            Self::Box => x,
            Self::Tent => x - x * x * 0.5,
            Self::Gaussian => {
                let bell = 0.5 * FRAC_PI_2.sqrt() * math::erf(x * SQRT_2);
                bell - x * math::exp(-2.0 * 1.5 * 1.5)
            }
            Self::Mitchell => {
                let inner = |x: f64| {
                    (x * x * x * x * (7.0 / 4.0) - x * x * x * 4.0 + x * (16.0 / 3.0)) / 6.0
                };
                let outer = |x: f64| {
                    let (square, cube) = (x * x, x * x * x);
                    (cube * 4.0 - cube * x * (7.0 / 12.0) - square * 10.0 + x * (32.0 / 3.0)) / 6.0
                };
                let one = inner(1.0) - outer(1.0);
                if x <= 1.0 {
                    inner(x)
                } else if x <= MITCHELL_ZERO {
                    one + outer(x)
                } else {
                    one + 2.0 * outer(MITCHELL_ZERO) - outer(x)
                }
            }
        }
    }
}

/// Where the Mitchell filter turns negative: its outer piece is −7/18 (x − 2)² (x − 8/7).
const MITCHELL_ZERO: f64 = 8.0 / 7.0;

impl fmt::Display for PixelFilter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::ALL.iter().find(|(_, it)| it == self);
        f.write_str(name.map_or("", |(name, _)| name))
    }
}

impl FromStr for PixelFilter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(name, _)| *name == text);
        found.map(|(_, filter)| *filter).ok_or_else(|| {
            let names = Self::ALL.map(|(name, _)| name).join(", ");
            format!(
                "expected one of {names}, found {}",
                crate::quote::quote(text)
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The filters in their authors' formulas, as functions of a distance.
    fn height(filter: PixelFilter, x: f64) -> f64 {
        let x = x.abs();
        let (b, c) = (1.0 / 3.0, 1.0 / 3.0);
        match filter {
            PixelFilter::Box => 1.0,
            PixelFilter::Tent => 1.0 - x,
            PixelFilter::Gaussian => math::exp(-x * x / 0.5) - math::exp(-4.5),
            PixelFilter::Mitchell if x < 1.0 => {
                ((12.0 - 9.0 * b - 6.0 * c) * x.powi(3)
                    + (12.0 * b + 6.0 * c - 18.0) * x.powi(2)
                    + 6.0
                    - 2.0 * b)
                    / 6.0
            }
            PixelFilter::Mitchell => {
                ((-b - 6.0 * c) * x.powi(3) + (6.0 * b + 30.0 * c) * x.powi(2)
                    - (12.0 * b + 48.0 * c) * x
                    + 8.0 * b
                    + 24.0 * c)
                    / 6.0
            }
        }
    }

    #[test]
    fn shares_of_the_magnitude_lie_before_their_places() {
        const CELLS: usize = 200_000;
        for (name, filter) in PixelFilter::ALL {
            let radius = filter.radius();
            let cell = 2.0 * radius / CELLS as f64;
            let middles = (0..CELLS).map(|i| (i as f64 + 0.5) * cell - radius);
            let mut sum = 0.0;
            let mut sums = Vec::new();
            for x in middles {
                let height = height(filter, x);
                assert_eq!(
                    height < -1e-12,
                    filter.is_negative(x) && height.abs() > 1e-12,
                    "{name} {x}"
                );
                sum += height.abs();
                sums.push(sum);
            }
            for step in 0..=100 {
                let share = f64::from(step) / 100.0;
                let place = filter.place(share);
                let index = (((place + radius) / cell) as usize).min(CELLS - 1);
                assert!(
                    (sums[index] / sum - share).abs() < 1e-4,
                    "{name} {share} {place}"
                );
            }
            assert!(filter.place(0.5) < 1e-15, "{name}");
            assert!((filter.place(0.0) + radius).abs() < 1e-4, "{name}");
            assert_eq!(name.parse(), Ok(filter));
        }
    }
}
