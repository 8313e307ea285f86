use glam::DVec3;
use std::fmt;
use std::str::FromStr;

/// Newton steps. Each doubles the digits that are right, from a start that is off by the distortion itself; five or six
/// do for calibrated lenses. Where the distortion folds back, a step halves the error at worst.
const STEPS: usize = 12;

/// How far from the place, of its size or one, the last step may have arrived: where a thousand pixels are a
/// radian, a millionth of a pixel. Places whose steps wander arrive nowhere near.
const ARRIVED: f64 = 1e-9;

/// The squared tangent up to which a distortion that never folds back is used: 89.9 degrees off the view axis.
const WIDEST: f64 = 1e6;

/// The distortion of a calibrated lens, in OpenCV's order k1, k2, p1, p2, k3: Brown, "Decentering Distortion of Lenses",
/// 1966; Conrady, "Decentred Lens-Systems", 1919.
///
/// A point in direction (x, y, 1) to the right, down and forward, with r² = x² + y², is seen at
///
/// ```text
/// x (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x y + p2 (r² + 2 x²)
/// y (1 + k1 r² + k2 r⁴ + k3 r⁶) + p1 (r² + 2 y²) + 2 p2 x y
/// ```
///
/// to the right of and below the picture's middle, where a unit is a radian. A picture has the places of directions
/// within the radius where r (1 + k1 r² + k2 r⁴ + k3 r⁶) rises; beyond it the lens would show everything twice.
#[derive(Clone, Copy, Debug)]
pub struct BrownConrady {
    coefficients: [f64; 5],
    /// r² where the radius begins to fall.
    end: f64,
}

/// Coefficients that are no numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected five finite numbers, k1,k2,p1,p2,k3")]
pub struct LensError;

impl BrownConrady {
    /// A lens with the coefficients k1, k2, p1, p2, k3.
    ///
    /// # Errors
    /// A coefficient that is not finite.
    pub fn new(coefficients: [f64; 5]) -> Result<Self, LensError> {
        if !coefficients
            .iter()
            .all(|coefficient| coefficient.is_finite())
        {
            return Err(LensError);
        }
        Ok(Self {
            coefficients,
            end: fold(coefficients),
        })
    }

    /// k1, k2, p1, p2, k3.
    pub fn coefficients(&self) -> [f64; 5] {
        self.coefficients
    }

    /// The tangent of the angle from the view axis where the picture ends.
    pub fn end(&self) -> f64 {
        self.end.sqrt()
    }

    /// Where a direction (x, y, 1) to the right, down and forward is seen; `None` beyond the lens's end.
    pub fn distort(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        (x * x + y * y < self.end).then(|| {
            let at = self.at(x, y);
            (at.x, at.y)
        })
    }

    /// The directions (x, y, 1) that are seen at some places, by Newton's method, and which of them there are.
    #[inline(always)]
    pub(crate) fn undistort<const N: usize>(
        &self,
        to_x: &[f64; N],
        to_y: &[f64; N],
    ) -> ([[f64; N]; 2], [bool; N]) {
        let (mut x, mut y) = (*to_x, *to_y);
        for _ in 0..STEPS {
            for lane in 0..N {
                let at = self.at(x[lane], y[lane]);
                let (off_x, off_y) = (at.x - to_x[lane], at.y - to_y[lane]);
                let inverse = 1.0 / at.determinant();
                x[lane] -= (at.yy * off_x - at.xy * off_y) * inverse;
                y[lane] -= (at.xx * off_y - at.xy * off_x) * inverse;
            }
        }
        let mut has = [false; N];
        for lane in 0..N {
            let at = self.at(x[lane], y[lane]);
            let size = 1.0 + to_x[lane].abs() + to_y[lane].abs();
            let off = (at.x - to_x[lane]).abs() + (at.y - to_y[lane]).abs();
            let is_inside = x[lane] * x[lane] + y[lane] * y[lane] < self.end;
            // NaN is neither near nor inside.
            has[lane] = (off <= ARRIVED * size) & is_inside & (at.determinant() > 0.0);
        }
        ([x, y], has)
    }

    /// Where (x, y) is seen, and how that changes.
    #[inline(always)]
    fn at(&self, x: f64, y: f64) -> Seen {
        let [k1, k2, p1, p2, k3] = self.coefficients;
        let squared = x * x + y * y;
        let radial = 1.0 + squared * (k1 + squared * (k2 + squared * k3));
        // Twice the derivative of that by r².
        let slope = 2.0 * (k1 + squared * (2.0 * k2 + squared * (3.0 * k3)));
        Seen {
            x: x * radial + 2.0 * p1 * (x * y) + p2 * (squared + 2.0 * (x * x)),
            y: y * radial + p1 * (squared + 2.0 * (y * y)) + 2.0 * p2 * (x * y),
            xx: radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
            xy: x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,
            yy: radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
        }
    }

    /// The direction, to the right, up and forward, that is seen `a` to the right of and `b` above the middle.
    pub(super) fn direction(&self, a: f64, b: f64) -> Option<DVec3> {
        let ([[x], [y]], [has]) = self.undistort(&[a], &[-b]);
        has.then(|| DVec3::new(x, -y, 1.0))
    }

    /// The derivatives of that along a and b.
    pub(super) fn derivatives(&self, a: f64, b: f64) -> [DVec3; 2] {
        let Some(direction) = self.direction(a, b) else {
            return [DVec3::ZERO; 2];
        };
        let at = self.at(direction.x, -direction.y);
        let inverse = 1.0 / at.determinant();
        [
            DVec3::new(at.yy, at.xy, 0.0) * inverse,
            DVec3::new(at.xy, at.xx, 0.0) * inverse,
        ]
    }

    /// The place, to the right and up, where a direction is seen.
    pub(super) fn place(&self, direction: DVec3) -> Option<(f64, f64)> {
        if direction.z <= 0.0 {
            return None;
        }
        let (x, y) = self.distort(direction.x / direction.z, -direction.y / direction.z)?;
        Some((x, -y))
    }
}

/// Where a point is seen, and the derivatives of that, a symmetric matrix.
struct Seen {
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Seen {
    #[inline(always)]
    fn determinant(&self) -> f64 {
        self.xx * self.yy - self.xy * self.xy
    }
}

/// The least r² where 1 + 3 k1 r² + 5 k2 r⁴ + 7 k3 r⁶, the derivative of the radius, is no more positive: between the
/// extremes of the cubic it is found by halving.
fn fold([k1, k2, _, _, k3]: [f64; 5]) -> f64 {
    let rise = |s: f64| 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * (7.0 * k3)));
    // Its derivative is c + 2 b s + a s².
    let (a, b, c) = (21.0 * k3, 5.0 * k2, 3.0 * k1);
    let root = (b * b - a * c).max(0.0).sqrt();
    // Without cancellation; those that are no numbers, or beyond the ends, are no extremes.
    let sum = if b < 0.0 { root - b } else { -(b + root) };
    let mut ends = [sum / a, c / sum, WIDEST];
    ends.sort_unstable_by(f64::total_cmp);
    let mut low = 0.0;
    for end in ends.into_iter().filter(|&end| end > 0.0 && end <= WIDEST) {
        // NaN does not rise.
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

impl PartialEq for BrownConrady {
    fn eq(&self, other: &Self) -> bool {
        self.coefficients == other.coefficients
    }
}

// Coefficients are finite.
impl Eq for BrownConrady {}

impl std::hash::Hash for BrownConrady {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        // Zeros are equal, whatever their sign.
        self.coefficients
            .map(|number| (number + 0.0).to_bits())
            .hash(state);
    }
}

impl fmt::Display for BrownConrady {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [k1, k2, p1, p2, k3] = self.coefficients;
        write!(f, "{k1},{k2},{p1},{p2},{k3}")
    }
}

impl FromStr for BrownConrady {
    type Err = LensError;

    fn from_str(text: &str) -> Result<Self, LensError> {
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|it| it.trim().parse()).collect();
        let numbers = numbers.map_err(|_| LensError)?;
        Self::new(numbers.try_into().map_err(|_| LensError)?)
    }
}

#[cfg(test)]
#[path = "brown_conrady_tests.rs"]
mod tests;
