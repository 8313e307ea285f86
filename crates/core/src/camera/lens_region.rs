//! Where Newton's method leads for all places of a rectangle of a picture through a lens: to one direction for each, within
//! a known disc. Then a packet's directions can be iterated from nearby ones, and a rectangle beside the scene is known to
//! be beside it before any of its directions is.
//!
//! Near the picture's middle [`BrownConrady::is_well_behaved`] says so. Elsewhere the steps of the rectangle's middle are
//! followed, with a bound on how far those of its other places are from them:
//!
//! # Error bound
//! f is the distortion, J and T its first and second derivative, symmetric since f is a gradient. c is the middle's iterate,
//! and the others' are within r of it, at first the rectangle's half diagonal ρ. β = ‖J(c)⁻¹‖, s = J(c)⁻¹(f(c) − to) is the
//! middle's step, and L bounds ‖T‖ within r.
//!
//! * **L.** ‖T‖ at c is at most the root of its components' squares, and differs by less than l₃ r within r. f is the
//!   gradient of k₁|x|⁴/4 + k₂|x|⁶/6 + k₃|x|⁸/8 and of a cubic. The derivatives of a homogeneous polynomial are bounded by
//!   its greatest value on the unit sphere (Banach, "Über homogene Polynome in (L²)", 1938): l₃ = 6|k₁| + 60|k₂|R² +
//!   210|k₃|R⁴ for |x| ≤ R.
//! * **One step.** For x within r and its place off the middle by δ, |δ| ≤ ρ: f(x) is off its linearisation by e ≤ ½Lr²,
//!   and J(x) = J(c)(1 + E) with ‖E‖ ≤ q = βLr. With v = J(c)⁻¹(f(x) − to − δ) = s + (x − c) + J(c)⁻¹(e − δ), x's step is
//!   (1 + E)⁻¹v, at most t = |v|/(1 − q) long, and the iterates behind it are apart by J(c)⁻¹(δ − e) and at most q t: by
//!   less than r' = β(ρ + ½Lr²) + q t.
//! * **|v|** is at most |s| + r + β(ρ + ½Lr²). At first x − c = δ, and it is at most |s| + β(‖J(c) − 1‖ρ + ½Lr²). Later a
//!   step of length t before left a residual of ½Lt² at most: |v| ≤ ½βLt², with L for the segment of that step.
//! * **Convergence.** Where h = β/(1 − q)·L·t ≤ ¼, L within 2t of x, the steps converge to a root within 2t of it, and six
//!   more suffice except for rounding (Kantorovich 1948, as at [`WellBehaved`](super::brown_conrady)). All roots are within
//!   r + 2t of c; where βL of that is at most ½, no derivative there has a determinant of zero, f is one to one, and its
//!   inverse has derivatives up to β' = 2β and Lβ'³.
//! * **Rounding.** With S = 1 + |k₁|R² + |k₂|R⁴ + |k₃|R⁶ + 6(|p₁| + |p₂|)R, both coordinates of f are rounded by less than
//!   16εSR, and a step's end by β' of that and by ε of itself: below 460ε where SRβ' ≤ 28. With 64ε from the last step's
//!   length it is less than 720ε, as `packet/places` supposes.
//! * **Dominated terms.** βL·(r + 2t) ≤ ½ leaves little beyond h ≤ ¼, and the other way round; where the lens ends J has
//!   no positive determinant, and next to it β is large. The conditions on h, on the end and on rounding close the proof,
//!   and no test needs it; the terms of one step are each compared with the steps themselves.

use super::brown_conrady::{BrownConrady, FLATTEST, STEPS, WellBehaved};

/// Newton steps from near a direction: three more than a start that is off by a millionth needs.
const NEAR_STEPS: usize = 4;

/// The greatest q of the steps that are followed, and of the disc in which directions are. Any value below one is correct,
/// and leaves room for the rounding of all that is computed here. With a greater one discs are so wide that packets' start
/// values may not converge; with a lesser one more rectangles are not followed.
const MOST_TURN: f64 = 0.5;

/// The greatest h.
const MOST_CURVATURE: f64 = 0.25;

/// The steps that suffice from where h is at most that: (2h)^(2⁶) is below 2⁻⁶³.
const LAST_STEPS: usize = 6;

/// The greatest S·R·β'.
const MOST_ROUNDING: f64 = 28.0;

/// What is known of the directions of a rectangle's places.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LensRegion {
    /// A disc that contains all of them, in the lens's axes: to the right and down.
    centre: [f64; 2],
    reach: f64,
    /// The longest step within the disc behind which a direction is known.
    settled: f64,
    /// ½ max ‖D²g‖ of the lens's inverse g within the rectangle.
    bend: f64,
}

impl LensRegion {
    /// The disc's centre.
    pub(super) fn centre(&self) -> [f64; 2] {
        self.centre
    }

    /// ½ max ‖D²g‖.
    pub(super) fn bend(&self) -> f64 {
        self.bend
    }

    /// The squared distance of a direction (x, y, 1) from the disc's centre, and the greatest within it.
    #[inline(always)]
    fn off_centre(&self, x: f64, y: f64) -> (f64, f64) {
        let (x, y) = (x - self.centre[0], y - self.centre[1]);
        (x * x + y * y, self.reach * self.reach)
    }

    /// Follows Newton's steps for the places within `radius` of a place to the right of and below the middle.
    fn follow(lens: &BrownConrady, place: [f64; 2], radius: f64) -> Option<Self> {
        let mut iterates = Iterates {
            centre: place,
            within: radius,
            step: f64::INFINITY,
        };
        for _ in 0..=STEPS - LAST_STEPS {
            let (near, next) = iterates.next(lens, place, radius)?;
            // Far more than the rounding of iterates.
            let reach = iterates.within + 2.0 * next.step + 1e-9;
            let found = near.disc(lens, reach, next.step);
            if found.is_some() {
                return found;
            }
            iterates = next;
        }
        None
    }
}

/// The iterates of all places of a rectangle behind the same number of Newton's steps.
#[derive(Clone, Copy, Debug)]
struct Iterates {
    /// c, and r.
    centre: [f64; 2],
    within: f64,
    /// t of the step that led here; infinite at the start.
    step: f64,
}

impl Iterates {
    /// What is known of the lens at c, and the iterates behind the next step. `None` where q is too great.
    fn next(&self, lens: &BrownConrady, place: [f64; 2], radius: f64) -> Option<(Near, Self)> {
        let ([x, y], r, before) = (self.centre, self.within, self.step);
        let near = Near::of(lens, x, y)?;
        let bent = near.curvature(lens, r);
        let turn = near.beta * bent * r;
        // NaN fails this.
        let is_near = turn <= MOST_TURN;
        if !is_near {
            return None;
        }
        let [by_x, by_y] = near.step(place);
        let (length, curved) = ((by_x * by_x + by_y * by_y).sqrt(), 0.5 * bent * r * r);
        let v = if before.is_finite() {
            let segment = near.curvature(lens, r + before);
            let by_residual = 0.5 * near.beta * segment * before * before;
            (length + r + near.beta * (radius + curved)).min(by_residual)
        } else {
            length + near.beta * (near.distortion * radius + curved)
        };
        let step = v / (1.0 - turn);
        let next = Self {
            centre: [x - by_x, y - by_y],
            within: near.beta * (radius + curved) + turn * step,
            step,
        };
        Some((near, next))
    }
}

impl BrownConrady {
    /// What is known of the directions of a rectangle of places, to the right and up; `None` where Newton's method is not
    /// known to converge for all of them.
    pub(crate) fn region(
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
        let (across, along) = ((right - left) * 0.5, (high - low) * 0.5);
        let middle = [left + across, -(low + along)];
        LensRegion::follow(self, middle, (across * across + along * along).sqrt())
    }

    /// The directions (x, y, 1) that are seen at places of a region, by Newton's method from near them: off by less than 720ε,
    /// ε = 2⁻⁵³, as are those of all of Newton's steps. `None` where they are not near enough.
    #[inline(always)]
    pub(crate) fn undistort_from<const N: usize>(
        &self,
        region: &LensRegion,
        [to_x, to_y]: [&[f64; N]; 2],
        [mut x, mut y]: [[f64; N]; 2],
    ) -> Option<[[f64; N]; 2]> {
        let (settled, (_, most)) = (region.settled, region.off_centre(0.0, 0.0));
        for _ in 0..NEAR_STEPS {
            let (mut furthest, mut longest) = ([0.0; N], [0.0; N]);
            for lane in 0..N {
                let at = self.at(x[lane], y[lane]);
                let (off_x, off_y) = (at.x - to_x[lane], at.y - to_y[lane]);
                let inverse = 1.0 / at.determinant();
                let by_x = (at.yy * off_x - at.xy * off_y) * inverse;
                let by_y = (at.xx * off_y - at.xy * off_x) * inverse;
                furthest[lane] = region.off_centre(x[lane], y[lane]).0;
                longest[lane] = by_x * by_x + by_y * by_y;
                x[lane] -= by_x;
                y[lane] -= by_y;
            }
            let (mut is_near, mut has_settled) = (true, true);
            for lane in 0..N {
                // NaN is neither.
                is_near &= furthest[lane] <= most;
                has_settled &= longest[lane] <= settled * settled;
            }
            if !is_near {
                return None;
            }
            if has_settled {
                return Some([x, y]);
            }
        }
        None
    }
}

/// A lens at a direction (x, y, 1).
pub(super) struct Near {
    pub(super) x: f64,
    pub(super) y: f64,
    /// f.
    seen: [f64; 2],
    /// J.
    xx: f64,
    xy: f64,
    yy: f64,
    /// ‖J⁻¹‖, ‖J‖ and ‖J − 1‖.
    pub(super) beta: f64,
    slope: f64,
    distortion: f64,
    /// A bound of ‖T‖.
    bent: f64,
}

impl Near {
    /// `None` where J is not positive definite.
    pub(super) fn of(lens: &BrownConrady, x: f64, y: f64) -> Option<Self> {
        let at = lens.at(x, y);
        let (middle, half) = ((at.xx + at.yy) * 0.5, (at.xx - at.yy) * 0.5);
        let spread = (half * half + at.xy * at.xy).sqrt();
        let (least, most) = (middle - spread, middle + spread);
        (least > 0.0).then(|| Self {
            x,
            y,
            seen: [at.x, at.y],
            xx: at.xx,
            xy: at.xy,
            yy: at.yy,
            beta: 1.0 / least,
            slope: most,
            distortion: (least - 1.0).abs().max((most - 1.0).abs()),
            bent: second_derivative(lens, x, y),
        })
    }

    /// s.
    fn step(&self, [to_x, to_y]: [f64; 2]) -> [f64; 2] {
        let (off_x, off_y) = (self.seen[0] - to_x, self.seen[1] - to_y);
        let inverse = 1.0 / (self.xx * self.yy - self.xy * self.xy);
        [
            (self.yy * off_x - self.xy * off_y) * inverse,
            (self.xx * off_y - self.xy * off_x) * inverse,
        ]
    }

    /// J⁻¹: xx, xy, yy.
    pub(super) fn inverse(&self) -> [f64; 3] {
        let inverse = 1.0 / (self.xx * self.yy - self.xy * self.xy);
        [self.yy, -self.xy, self.xx].map(|it| it * inverse)
    }

    /// L within some distance.
    pub(super) fn curvature(&self, lens: &BrownConrady, within: f64) -> f64 {
        self.bent + self.third(lens, within) * within
    }

    /// l₃ within some distance.
    pub(super) fn third(&self, lens: &BrownConrady, within: f64) -> f64 {
        let [k1, k2, _, _, k3] = lens.coefficients().map(f64::abs);
        let squared = self.furthest(within) * self.furthest(within);
        6.0 * k1 + squared * (60.0 * k2 + squared * (210.0 * k3))
    }

    /// R within some distance.
    pub(super) fn furthest(&self, within: f64) -> f64 {
        (self.x * self.x + self.y * self.y).sqrt() + within
    }

    /// Whether all within some distance is in the lens's picture, and rounded as is said above. `inverse` is a bound of
    /// ‖J⁻¹‖ there.
    pub(super) fn is_precise(&self, lens: &BrownConrady, within: f64, inverse: f64) -> bool {
        let [a, b, p1, p2, c] = lens.coefficients().map(f64::abs);
        let furthest = self.furthest(within);
        let squared = furthest * furthest;
        let sum = 1.0 + squared * (a + squared * (b + squared * c)) + 6.0 * (p1 + p2) * furthest;
        furthest <= 0.999 * FLATTEST
            && furthest <= 0.999 * lens.end()
            && sum * furthest * inverse <= MOST_ROUNDING
    }

    /// The disc of this radius, if Newton's steps, of which the next is at most `longest` long, surely end in it.
    fn disc(&self, lens: &BrownConrady, reach: f64, longest: f64) -> Option<LensRegion> {
        let bent = self.curvature(lens, reach);
        let (turn, inverse) = (self.beta * bent * reach, 2.0 * self.beta);
        let ends = turn <= MOST_TURN
            && inverse * bent * longest <= MOST_CURVATURE
            && self.is_precise(lens, reach, inverse);
        // Without curvature any step ends at the direction.
        let settled = (64.0 * f64::EPSILON / (inverse * bent)).sqrt();
        let slope = self.slope + bent * reach;
        ends.then(|| LensRegion {
            centre: [self.x, self.y],
            reach,
            settled: (settled / (inverse * slope)).min(FLATTEST),
            bend: 0.5 * bent * inverse * inverse * inverse,
        })
    }
}

/// A bound of ‖T‖ at a direction (x, y, 1). With s = x² + y² and g(s) = 1 + k1 s + k2 s² + k3 s³,
///
/// T(i, j, k) = 2g'(xᵢδⱼₖ + xⱼδᵢₖ + xₖδᵢⱼ) + 4g''xᵢxⱼxₖ + 2(qᵢδⱼₖ + qⱼδᵢₖ + qₖδᵢⱼ), with q = (p2, p1).
fn second_derivative(lens: &BrownConrady, x: f64, y: f64) -> f64 {
    let [k1, k2, p1, p2, k3] = lens.coefficients();
    let squared = x * x + y * y;
    let first = k1 + squared * (2.0 * k2 + squared * (3.0 * k3));
    let second = 2.0 * k2 + squared * (6.0 * k3);
    let (right, down) = (2.0 * (first * x + p2), 2.0 * (first * y + p1));
    let cube = 4.0 * second;
    let xxx = 3.0 * right + cube * (x * x * x);
    let xxy = down + cube * (x * x * y);
    let xyy = right + cube * (x * y * y);
    let yyy = 3.0 * down + cube * (y * y * y);
    (xxx * xxx + 3.0 * (xxy * xxy) + 3.0 * (xyy * xyy) + yyy * yyy).sqrt()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::math;
    use crate::random::Random;
    use glam::DVec2;

    /// Calibrated and arbitrary lenses.
    pub(in crate::camera) fn lenses() -> impl Iterator<Item = BrownConrady> {
        let mut random = Random(47);
        let known = [
            [-0.28, 0.07, 0.0002, 0.00002, 0.0],
            [-0.4, 0.2, 0.001, -0.002, -0.05],
            [0.3, 0.1, -0.02, 0.01, 0.05],
        ];
        let made = (0..150).map(move |_| {
            let size = math::pow(2.0, random.signed() * 3.0 - 3.0);
            let [a, b, c] = (random.point() * size).to_array();
            let decentred = random.point() * 0.05 * size;
            [a, b, decentred.x, decentred.y, c]
        });
        let all = known.into_iter().chain(made);
        all.map(|coefficients| BrownConrady::new(coefficients).expect("finite"))
    }

    /// The truth is the definition, all of Newton's steps for each place: it has a direction, within the disc, which
    /// steps from nearby reach. Places are beyond where a lens is well-behaved.
    #[test]
    fn followed_rectangles_have_the_directions_of_their_places() {
        let mut random = Random(48);
        let (mut count, mut beyond) = (0, 0);
        for lens in lenses() {
            for _ in 0..60 {
                let middle = random.point() * 1.6;
                let half = random.point().abs() * math::pow(10.0, -1.0 - 3.0 * random.unit());
                let across = (middle.x - half.x, middle.x + half.x);
                let along = (middle.y - half.y, middle.y + half.y);
                let Some(region) = lens.region(across, along) else {
                    continue;
                };
                beyond += usize::from(!lens.is_well_behaved(middle.x, middle.y));
                for _ in 0..20 {
                    // Corners, too.
                    let mut side = || (2.0 * random.signed()).clamp(-1.0, 1.0);
                    let (a, b) = (middle.x + half.x * side(), middle.y + half.y * side());
                    let found = lens.direction(a, b);
                    let found = found.unwrap_or_else(|| panic!("{lens} at {a} {b}: {region:?}"));
                    let (off, most) = region.off_centre(found.x, -found.y);
                    assert!(off <= most, "{lens} {a} {b}: {region:?}");
                    let start = random.point() * region.reach * 0.1;
                    let start = [[found.x + start.x], [-found.y + start.y]];
                    if let Some([[x], [y]]) = lens.undistort_from(&region, [&[a], &[-b]], start) {
                        let off = DVec2::new(x - found.x, y + found.y).length();
                        assert!(off < 720.0 * f64::EPSILON, "{lens} {a} {b}: {off:e}");
                        count += 1;
                    }
                }
            }
        }
        assert!(count > 40_000 && beyond > 500, "{count} {beyond}");
    }

    /// The truth is Newton's steps for each of the places.
    #[test]
    fn iterates_are_as_near_and_steps_as_short_as_is_said() {
        let mut random = Random(50);
        let (mut furthest, mut longest) = ([0.0_f64; 4], [0.0_f64; 4]);
        for lens in lenses() {
            for _ in 0..60 {
                let place = [(); 2].map(|()| 1.6 * random.signed());
                let radius = math::pow(10.0, -1.0 - 2.0 * random.unit());
                let places = [(); 40].map(|()| {
                    let (sin, cos) = math::sin_cos(random.signed() * 3.2);
                    [place[0] + radius * cos, place[1] + radius * sin]
                });
                let mut each = places;
                let mut iterates = Iterates {
                    centre: place,
                    within: radius,
                    step: f64::INFINITY,
                };
                for step in 0..furthest.len() {
                    let Some((near, next)) = iterates.next(&lens, place, radius) else {
                        break;
                    };
                    let rounding = 1e-13 * near.beta;
                    for (at, &to) in each.iter_mut().zip(&places) {
                        let near = Near::of(&lens, at[0], at[1]).expect("J is definite within r");
                        let by = near.step(to);
                        let length = DVec2::from_array(by).length();
                        assert!(length <= next.step + rounding, "{lens} {place:?} {step}");
                        *at = [at[0] - by[0], at[1] - by[1]];
                        let off = DVec2::from_array(*at).distance(next.centre.into());
                        assert!(off <= next.within + rounding, "{lens} {place:?} {step}");
                        if next.step > 1e-9 {
                            longest[step] = longest[step].max(length / next.step);
                            furthest[step] = furthest[step].max(off / next.within);
                        }
                    }
                    iterates = next;
                }
            }
        }
        let are_close = furthest.into_iter().chain(longest).all(|ratio| ratio > 0.6);
        assert!(are_close, "{furthest:?} {longest:?}");
    }

    /// The truth is differences of the first derivative, along the direction in which it changes most of some hundred.
    #[test]
    fn curvatures_are_no_less_than_differences_of_derivatives() {
        let mut random = Random(49);
        let mut closest = 0.0_f64;
        for lens in lenses() {
            for _ in 0..20 {
                let (x, y) = (random.signed(), random.signed());
                let near = Near::of(&lens, x, y);
                let Some(near) = near else { continue };
                let within = math::pow(10.0, -4.0 + 3.0 * random.unit());
                let bound = near.curvature(&lens, within);
                for turn in 0..24 {
                    let (sin, cos) = math::sin_cos(f64::from(turn) * 0.2618);
                    let to = lens.at(x + cos * within, y + sin * within);
                    let (xx, xy, yy) = (to.xx - near.xx, to.xy - near.xy, to.yy - near.yy);
                    let (middle, half) = ((xx + yy) * 0.5, (xx - yy) * 0.5);
                    let norm = middle.abs() + (half * half + xy * xy).sqrt();
                    assert!(norm <= bound * within * (1.0 + 1e-9), "{lens} {x} {y}");
                    closest = closest.max(norm / (bound * within));
                }
            }
        }
        assert!(closest > 0.8, "{closest}");
    }
}
