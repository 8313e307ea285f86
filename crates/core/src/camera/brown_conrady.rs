use super::distortion::{Distortion, FLATTEST, STEPS};
use super::lens_region::{LensRegion, convergence_radius};
use crate::ranges::{self, OutOfRange};
use glam::DVec3;
use std::fmt;
use std::str::FromStr;

/// The largest last step, relative to the place or to one, of an iteration that converged: with a thousand pixels a
/// radian, a millionth of a pixel. Iterations that do not converge end far from that.
const ARRIVED: f64 = 1e-9;

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
    pub(super) distortion: Distortion,
    pub(super) well_behaved: WellBehaved,
    /// The radius of places up to which Newton's steps surely converge to the one direction that is seen.
    pub(super) convergence: f64,
    /// The radius of places beyond which none is seen.
    rim: f64,
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
        let distortion = Distortion::new(coefficients);
        let well_behaved = WellBehaved::new(coefficients, distortion.end);
        Ok(Self {
            distortion,
            well_behaved,
            convergence: convergence_radius(&distortion, well_behaved.radius),
            rim: rim(&distortion),
        })
    }

    /// k1, k2, p1, p2, k3.
    pub fn coefficients(&self) -> [f64; 5] {
        self.distortion.coefficients
    }

    /// The tangent of the angle from the view axis at which the picture ends.
    pub fn end(&self) -> f64 {
        self.distortion.end.sqrt()
    }

    /// The place at which a direction (x, y, 1), to the right, down and forward, is seen; `None` beyond the lens's
    /// end.
    pub fn distort(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        (x * x + y * y < self.distortion.end).then(|| {
            let at = self.distortion.at(x, y);
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
                let at = self.distortion.at(x[lane], y[lane]);
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
            let at = self.distortion.at(x[lane], y[lane]);
            let size = 1.0 + to_x[lane].abs() + to_y[lane].abs();
            let off = (at.x - to_x[lane]).abs() + (at.y - to_y[lane]).abs();
            let is_inside = x[lane] * x[lane] + y[lane] * y[lane] < self.distortion.end;
            // NaN fails these comparisons.
            has[lane] = (off <= ARRIVED * size) & is_inside & (at.determinant() > 0.0);
        }
        has
    }

    /// Whether the picture has the place `a` to the right of and `b` above its middle.
    pub(super) fn has_place(&self, a: f64, b: f64) -> bool {
        self.surely_has_place(a, b) || (!self.surely_lacks(a, b) && self.direction(a, b).is_some())
    }

    /// As [`Self::has_place`], for several places at one height.
    pub(super) fn has_places<const N: usize>(&self, a: [f64; N], b: f64) -> [bool; N] {
        if a.iter().all(|&a| self.surely_lacks(a, b)) {
            return [false; N];
        }
        self.undistort(&a, &[-b; N]).1
    }

    /// Whether the picture surely has a place and all places closer to the middle, because Newton's method converges
    /// there.
    #[inline(always)]
    pub(super) fn surely_has_place(&self, a: f64, b: f64) -> bool {
        a * a + b * b <= self.convergence * self.convergence
    }

    /// Whether the picture surely has no place that is as far from its middle as (a, b), or further.
    pub(super) fn surely_lacks(&self, a: f64, b: f64) -> bool {
        a * a + b * b > self.rim * self.rim
    }

    /// Whether a place is within the radius of [`WellBehaved`].
    #[inline(always)]
    pub(super) fn is_well_behaved(&self, a: f64, b: f64) -> bool {
        a * a + b * b <= self.well_behaved.radius * self.well_behaved.radius
    }

    /// What is known of the directions of a rectangle of places, to the right and up; `None` where Newton's method is not
    /// known to converge for all of them.
    pub(super) fn region(
        &self,
        (left, right): (f64, f64),
        (low, high): (f64, f64),
    ) -> Option<LensRegion> {
        let furthest = [left.abs().max(right.abs()), low.abs().max(high.abs())];
        if self.is_well_behaved(furthest[0], furthest[1]) {
            let WellBehaved {
                bend,
                reach,
                settled,
                ..
            } = self.well_behaved;
            return Some(LensRegion {
                centre: [0.0; 2],
                reach,
                settled,
                bend,
            });
        }
        let half = [(right - left) * 0.5, (high - low) * 0.5];
        let middle = [left + half[0], -(low + half[1])];
        let radius = (half[0] * half[0] + half[1] * half[1]).sqrt();
        if self.surely_has_place(furthest[0], furthest[1]) {
            let [[x], [y]] = self.steps_towards(&[middle[0]], &[middle[1]]);
            return LensRegion::around(&self.distortion, [x, y], radius);
        }
        LensRegion::follow(&self.distortion, middle, radius, 0.0)
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
        let at = self.distortion.at(direction.x, -direction.y);
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

/// A radius of places beyond which none is seen. The distorted radius rises up to the lens's end, to r (1 + k1 r² + k2 r⁴ +
/// k3 r⁶), and the tangential part moves a place there by at most 3|q|r², q = (p2, p1). A place has a ray where it is within
/// 2·10⁻⁹ of itself, and of one, of where a direction within the end is seen ([`ARRIVED`]): 10⁻⁷ is more than that and all
/// rounding.
fn rim(distortion: &Distortion) -> f64 {
    let ([k1, k2, p1, p2, k3], squared) = (distortion.coefficients, distortion.end);
    let radial = 1.0 + squared * (k1 + squared * (k2 + squared * k3));
    let tangential = 3.0 * (p1 * p1 + p2 * p2).sqrt() * squared;
    (squared.sqrt() * radial + tangential) * (1.0 + 1e-7) + 1e-7
}

impl PartialEq for BrownConrady {
    fn eq(&self, other: &Self) -> bool {
        self.distortion.coefficients == other.distortion.coefficients
    }
}

// Coefficients are finite.
impl Eq for BrownConrady {}

impl std::hash::Hash for BrownConrady {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        // Minus zero equals zero.
        self.distortion
            .coefficients
            .map(|number| (number + 0.0).to_bits())
            .hash(state);
    }
}

impl fmt::Display for BrownConrady {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [k1, k2, p1, p2, k3] = self.distortion.coefficients;
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
