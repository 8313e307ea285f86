//! The distortion of a lens as a function of directions, with its derivatives.

/// Newton steps. Each doubles the number of correct digits, from a start that is off by the distortion itself; five
/// or six suffice for calibrated lenses. Where the distortion folds back, a step halves the error at worst; fewer
/// steps than 12 would lose such directions, more would only repeat roundings.
pub(super) const STEPS: usize = 12;

/// The squared tangent up to which a distortion that never folds back is used: to 89.9 degrees off the view axis.
const WIDEST: f64 = 1e6;

/// The greatest tangent of a direction on the plane that a lens's packets share; the rounding bounds in
/// `packet/places` are proportional to it.
pub(crate) const FLATTEST: f64 = 2.0;

/// The function of [`BrownConrady`](super::BrownConrady).
#[derive(Clone, Copy, Debug)]
pub(super) struct Distortion {
    /// k1, k2, p1, p2, k3.
    pub(super) coefficients: [f64; 5],
    /// The squared radius at which the distorted radius stops rising.
    pub(super) end: f64,
}

impl Distortion {
    pub(super) fn new(coefficients: [f64; 5]) -> Self {
        Self {
            coefficients,
            end: fold(coefficients),
        }
    }

    /// The same without its tangential part.
    pub(super) fn radial(&self) -> Self {
        let [k1, k2, _, _, k3] = self.coefficients;
        Self {
            coefficients: [k1, k2, 0.0, 0.0, k3],
            ..*self
        }
    }

    /// The place where (x, y) is seen, and its derivatives.
    #[inline(always)]
    pub(super) fn at(&self, x: f64, y: f64) -> Seen {
        let [k1, k2, p1, p2, k3] = self.coefficients;
        let squared = x * x + y * y;
        let radial = 1.0 + squared * (k1 + squared * (k2 + squared * k3));
        // Twice the derivative of the scale by r².
        let slope = 2.0 * (k1 + squared * (2.0 * k2 + squared * (3.0 * k3)));
        Seen {
            x: x * radial + 2.0 * p1 * (x * y) + p2 * (squared + 2.0 * (x * x)),
            y: y * radial + p1 * (squared + 2.0 * (y * y)) + 2.0 * p2 * (x * y),
            xx: radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
            xy: x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,
            yy: radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
        }
    }
}

/// The place at which a point is seen, and its derivatives, a symmetric matrix.
pub(super) struct Seen {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) xx: f64,
    pub(super) xy: f64,
    pub(super) yy: f64,
}

impl Seen {
    #[inline(always)]
    pub(super) fn determinant(&self) -> f64 {
        self.xx * self.yy - self.xy * self.xy
    }
}

/// The least r² where 1 + 3 k1 r² + 5 k2 r⁴ + 7 k3 r⁶, the derivative of the distorted radius, stops being positive;
/// by bisection between the extremes of the cubic.
fn fold([k1, k2, _, _, k3]: [f64; 5]) -> f64 {
    let rise = |s: f64| 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * (7.0 * k3)));
    // The derivative of the cubic is c + 2 b s + a s².
    let (a, b, c) = (21.0 * k3, 5.0 * k2, 3.0 * k1);
    let root = (b * b - a * c).max(0.0).sqrt();
    // The roots without cancellation; NaN roots, or roots beyond the ends, are no extremes.
    let sum = if b < 0.0 { root - b } else { -(b + root) };
    let mut ends = [sum / a, c / sum, WIDEST];
    ends.sort_unstable_by(f64::total_cmp);
    let mut low = 0.0;
    for end in ends.into_iter().filter(|&end| end > 0.0 && end <= WIDEST) {
        // NaN counts as not rising.
        let rises = rise(end) > 0.0;
        if rises {
            low = end;
            continue;
        }
        let mut high = end;
        for _ in 0..128 {
            let middle = (low + high) * 0.5;
            if rise(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        return low;
    }
    WIDEST
}
