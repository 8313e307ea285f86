use crate::ranges::{self, OutOfRange};
use glam::DVec3;
use std::fmt;
use std::str::FromStr;

/// Newton steps. Each doubles the number of correct digits, from a start that is off by the distortion itself; five
/// or six suffice for calibrated lenses. Where the distortion folds back, a step halves the error at worst; fewer
/// steps than 12 would lose such directions, more would only repeat roundings.
pub(super) const STEPS: usize = 12;

/// The largest last step, relative to the place or to one, of an iteration that converged: with a thousand pixels a
/// radian, a millionth of a pixel. Iterations that do not converge end far from that.
const ARRIVED: f64 = 1e-9;

/// The squared tangent up to which a distortion that never folds back is used: to 89.9 degrees off the view axis.
const WIDEST: f64 = 1e6;

/// The distortion of a calibrated lens, in OpenCV's order k1, k2, p1, p2, k3: Brown, "Decentering Distortion of
/// Lenses", 1966; Conrady, "Decentred Lens-Systems", 1919.
///
/// A point in direction (x, y, 1) to the right, down and forward, with r² = x² + y², is seen at
///
/// ```text
/// x (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x y + p2 (r² + 2 x²)
/// y (1 + k1 r² + k2 r⁴ + k3 r⁶) + p1 (r² + 2 y²) + 2 p2 x y
/// ```
///
/// to the right of and below the picture's middle, in radians at the middle. The picture ends where r (1 + k1 r² + k2
/// r⁴ + k3 r⁶) stops rising: beyond that radius the lens would show everything twice.
#[derive(Clone, Copy, Debug)]
pub struct BrownConrady {
    coefficients: [f64; 5],
    /// The squared radius at which the distorted radius stops rising.
    end: f64,
    pub(super) well_behaved: WellBehaved,
}

/// Why there is no such lens.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LensError {
    /// Not five numbers.
    #[error("expected five lens coefficients, K1,K2,P1,P2,K3")]
    Count,
    /// A coefficient out of range.
    #[error(transparent)]
    Range(#[from] OutOfRange),
}

impl BrownConrady {
    /// A lens with the coefficients k1, k2, p1, p2, k3.
    ///
    /// # Errors
    /// A coefficient out of its range, [`ranges::lens`].
    pub fn new(coefficients: [f64; 5]) -> Result<Self, LensError> {
        let coefficients = ranges::lens(coefficients)?;
        let end = fold(coefficients);
        Ok(Self {
            coefficients,
            end,
            well_behaved: WellBehaved::new(coefficients, end),
        })
    }

    /// k1, k2, p1, p2, k3.
    pub fn coefficients(&self) -> [f64; 5] {
        self.coefficients
    }

    /// The tangent of the angle from the view axis at which the picture ends.
    pub fn end(&self) -> f64 {
        self.end.sqrt()
    }

    /// The place at which a direction (x, y, 1), to the right, down and forward, is seen; `None` beyond the lens's
    /// end.
    pub fn distort(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        (x * x + y * y < self.end).then(|| {
            let at = self.at(x, y);
            (at.x, at.y)
        })
    }

    /// The directions (x, y, 1) that are seen at these places, and which of them exist.
    #[inline(always)]
    fn undistort<const N: usize>(
        &self,
        to_x: &[f64; N],
        to_y: &[f64; N],
    ) -> ([[f64; N]; 2], [bool; N]) {
        let [x, y] = self.steps_towards(to_x, to_y);
        ([x, y], self.arrived([to_x, to_y], [&x, &y]))
    }

    /// Where Newton's steps towards some places lead from there.
    #[inline(always)]
    pub(super) fn steps_towards<const N: usize>(
        &self,
        to_x: &[f64; N],
        to_y: &[f64; N],
    ) -> [[f64; N]; 2] {
        let (mut x, mut y) = (*to_x, *to_y);
        // Once steps alternate between roundings of the root, or are zero, they repeat; the result after [`STEPS`]
        // steps is then known.
        let mut before = [[0.0; N]; 2];
        for step in 0..STEPS {
            let last = [x, y];
            for lane in 0..N {
                let at = self.at(x[lane], y[lane]);
                let (off_x, off_y) = (at.x - to_x[lane], at.y - to_y[lane]);
                let inverse = 1.0 / at.determinant();
                x[lane] -= (at.yy * off_x - at.xy * off_y) * inverse;
                y[lane] -= (at.xx * off_y - at.xy * off_x) * inverse;
            }
            if step > 1 && are_same(&x, &before[0]) && are_same(&y, &before[1]) {
                if (STEPS - step).is_multiple_of(2) {
                    [x, y] = last;
                }
                break;
            }
            before = last;
        }
        [x, y]
    }

    /// Which of some directions are seen at these places, within the lens's end.
    #[inline(always)]
    pub(super) fn arrived<const N: usize>(
        &self,
        [to_x, to_y]: [&[f64; N]; 2],
        [x, y]: [&[f64; N]; 2],
    ) -> [bool; N] {
        let mut has = [false; N];
        for lane in 0..N {
            let at = self.at(x[lane], y[lane]);
            let size = 1.0 + to_x[lane].abs() + to_y[lane].abs();
            let off = (at.x - to_x[lane]).abs() + (at.y - to_y[lane]).abs();
            let is_inside = x[lane] * x[lane] + y[lane] * y[lane] < self.end;
            // NaN fails these comparisons.
            has[lane] = (off <= ARRIVED * size) & is_inside & (at.determinant() > 0.0);
        }
        has
    }

    /// Whether the picture has the place `a` to the right of and `b` above its middle.
    pub(super) fn has_place(&self, a: f64, b: f64) -> bool {
        self.is_well_behaved(a, b) || self.direction(a, b).is_some()
    }

    /// As [`Self::has_place`], for several places at one height.
    pub(super) fn has_places<const N: usize>(&self, a: [f64; N], b: f64) -> [bool; N] {
        self.undistort(&a, &[-b; N]).1
    }

    /// Whether the picture surely has a place and all places closer to the middle, because Newton's method converges
    /// there.
    #[inline(always)]
    pub(super) fn is_well_behaved(&self, a: f64, b: f64) -> bool {
        a * a + b * b <= self.well_behaved.radius * self.well_behaved.radius
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

    /// The direction, to the right, up and forward, that is seen at the place `a` to the right of and `b` above the
    /// middle.
    pub(super) fn direction(&self, a: f64, b: f64) -> Option<DVec3> {
        let ([[x], [y]], [has]) = self.undistort(&[a], &[-b]);
        has.then(|| DVec3::new(x, -y, 1.0))
    }

    /// The derivatives of [`Self::direction`] by a and b.
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

    /// The place, to the right and up, at which a direction is seen.
    pub(super) fn place(&self, direction: DVec3) -> Option<(f64, f64)> {
        if direction.z <= 0.0 {
            return None;
        }
        let (x, y) = self.distort(direction.x / direction.z, -direction.y / direction.z)?;
        Some((x, -y))
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

/// Whether numbers are the same, bit for bit.
#[inline(always)]
fn are_same<const N: usize>(a: &[f64; N], b: &[f64; N]) -> bool {
    let mut differ = 0;
    for lane in 0..N {
        differ |= a[lane].to_bits() ^ b[lane].to_bits();
    }
    differ == 0
}

/// The radius of places within which Newton's method surely converges to the one direction that is seen there.
///
/// With f the distortion, r the radius of directions, a = |k1|, b = |k2|, c = |k3| and p = |p1| + |p2|:
///
/// * ‖f(x) − x‖ ≤ d(r) = a r³ + b r⁵ + c r⁷ + 3 p r²,
/// * ‖Df − 1‖ ≤ e(r) = 3 a r² + 5 b r⁴ + 7 c r⁶ + 6 p r,
/// * ‖D²f‖ ≤ l(r) = 6 a r + 20 b r³ + 42 c r⁵ + 6 p,
///
/// since |x|²ᵏ x has second derivatives up to 2k (2k + 1) r²ᵏ⁻¹, and the tangential part is |x|² q + 2 (q·x) x with q
/// = (p2, p1). Steps towards a place at radius R start there, and the first one is at most η = d(R)/(1 − e(R)) long.
/// Where h = η · l(R + 2η)/(1 − e(R)) ≤ ½ they converge to a root within 2η (Kantorovich, "Functional analysis and
/// applied mathematics", 1948); with h ≤ ¼ each is at most half as long as the one before, squared: twelve suffice,
/// except for rounding. Within R + 2η, where e < 1, f is one to one, and its derivative has no determinant of zero.
/// There ‖Dg‖ ≤ 1/(1 − e) for the inverse g, and ‖D²g‖ ≤ l/(1 − e)³.
///
/// From a start within R + 2η a step as long as L, towards a place in R, was off by (1 + e)/(1 − e)·L at most before, since
/// ‖f(x) − f(y)‖ is between (1 − e)‖x − y‖ and (1 + e)‖x − y‖, and is off by ½ l/(1 − e) times that squared behind: below 64ε
/// with L of ((1 − e)/(1 + e)) √(128ε (1 − e)/l).
/// Where the steps end, rounding is left. With e ≤ 0.9 the radial factor differs from one by 0.3 at most, and what is
/// added to it by 0.3·r: with r ≤ 2 each coordinate of f is rounded by less than 31ε, both by less than 45ε, and a step's
/// end by that over 1 − e and by ε of itself: 460ε, and with the 64ε less than 720ε.
#[derive(Clone, Copy, Debug)]
pub(super) struct WellBehaved {
    /// R, the greatest such radius, or slightly less.
    pub(super) radius: f64,
    /// ½ max ‖D²g‖ within the radius.
    pub(super) bend: f64,
    /// R + 2η.
    pub(super) reach: f64,
    /// The longest step behind which the direction is known.
    pub(super) settled: f64,
}

/// The greatest e in use: far enough below one to cover the rounding of all that is computed here.
const GREATEST_SLOPE: f64 = 0.9;

/// The greatest h in use.
const GREATEST_CURVATURE: f64 = 0.25;

/// The greatest tangent of a direction on the plane that a lens's packets share; the rounding bounds in
/// `packet/places` are proportional to it.
pub(crate) const FLATTEST: f64 = 2.0;

impl WellBehaved {
    fn new(coefficients: [f64; 5], end: f64) -> Self {
        let mut found = Self {
            radius: 0.0,
            bend: 0.0,
            reach: 0.0,
            settled: 0.0,
        };
        let mut beyond = FLATTEST;
        // Bisection, to a millionth of the greatest radius.
        for _ in 0..20 {
            let middle = (found.radius + beyond) * 0.5;
            match Self::within(coefficients, end, middle) {
                Some(all) => found = all,
                None => beyond = middle,
            }
        }
        found
    }

    /// What holds within a radius; `None` where the bounds do not.
    fn within(coefficients: [f64; 5], end: f64, radius: f64) -> Option<Self> {
        let [a, b, p1, p2, c] = coefficients.map(f64::abs);
        let p = p1 + p2;
        let off = |r: f64| r * r * (r * (a + r * r * (b + r * r * c)) + 3.0 * p);
        let slope = |r: f64| r * (r * (3.0 * a + r * r * (5.0 * b + r * r * 7.0 * c)) + 6.0 * p);
        let curvature = |r: f64| r * (6.0 * a + r * r * (20.0 * b + r * r * 42.0 * c)) + 6.0 * p;
        let rest = 1.0 - slope(radius);
        let first = off(radius) / rest;
        let reach = radius + 2.0 * first;
        // NaN and infinity fail these comparisons.
        let is_well_behaved = rest >= 1.0 - GREATEST_SLOPE
            && reach <= 0.999 * FLATTEST
            && reach * reach <= 0.999 * end
            && slope(reach) <= GREATEST_SLOPE
            && first * curvature(reach) <= GREATEST_CURVATURE * rest;
        let (least, most) = (1.0 - slope(reach), 1.0 + slope(reach));
        // Without curvature any step ends at the direction.
        let longest = (64.0 * f64::EPSILON * least / curvature(reach)).sqrt();
        is_well_behaved.then(|| Self {
            radius,
            bend: 0.5 * curvature(reach) / (least * least * least),
            reach,
            settled: (longest * least / most).min(FLATTEST),
        })
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

impl PartialEq for BrownConrady {
    fn eq(&self, other: &Self) -> bool {
        self.coefficients == other.coefficients
    }
}

// Coefficients are finite.
impl Eq for BrownConrady {}

impl std::hash::Hash for BrownConrady {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        // Minus zero equals zero.
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

impl TryFrom<&[f64]> for BrownConrady {
    type Error = LensError;

    fn try_from(coefficients: &[f64]) -> Result<Self, LensError> {
        Self::new(coefficients.try_into().map_err(|_| LensError::Count)?)
    }
}

impl FromStr for BrownConrady {
    type Err = LensError;

    fn from_str(text: &str) -> Result<Self, LensError> {
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|it| it.trim().parse()).collect();
        Self::try_from(&numbers.map_err(|_| LensError::Count)?[..])
    }
}

#[cfg(test)]
#[path = "brown_conrady_tests.rs"]
mod tests;
