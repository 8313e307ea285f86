//! Where Newton's method leads for all places of a rectangle of a picture through a lens: to one direction for each, within
//! a known disc. Then a packet's directions can be iterated from nearby ones, and a rectangle beside the scene is known to
//! be beside it before any of its directions is.
//!
//! Near the picture's middle [`BrownConrady`](super::BrownConrady) says so. Elsewhere the steps of one place are followed,
//! with a bound on how far those of places around it are from them. Without its tangential part a lens is the same in all
//! directions from the middle, and the steps of one place are those of all on a circle: so whole rings of places are
//! followed, once for a lens ([`convergence_radius`]). Where the tangential part is so great that this proves nothing, a
//! rectangle's middle is followed.
//!
//! # Error bound
//! f is the distortion, J and T its first and second derivative, symmetric since f is a gradient. c is the middle's iterate,
//! and the others' are within r of it, at first the rectangle's half diagonal or the ring's half width ρ. β = ‖J(c)⁻¹‖, s =
//! J(c)⁻¹(f(c) − to) is the middle's step, and L bounds ‖T‖ within r.
//!
//! * **Tangential part.** For rings f, J, T, c and s are those of the lens without it. It is |x|²q + 2(q·x)x with q = (p₂,
//!   p₁): at most 3|q|R² for |x| ≤ R, its first derivative at most 6|q|R, its second 6|q|. The first is added to what an
//!   iterate is off by (to ρ below, except where ρ is |x − c|), the second, times β, to q, the third to L. Of the middle
//!   of a rectangle all of f is followed, and |q| is zero.
//! * **L.** ‖T‖ at c is at most the root of its components' squares, and differs by less than l₃ r within r. The norm of a
//!   symmetric form is its greatest value at one unit vector (Banach, "Über homogene Polynome in (L²)", 1938). f is the
//!   gradient of P = k₁|x|⁴/4 + k₂|x|⁶/6 + k₃|x|⁸/8 and of a cubic. P's fourth derivative along a unit vector at an angle
//!   with x = c whose squared cosine is C is aC² + 2bC(1 − C) + d(1 − C)², between the least and the greatest of a = 6k₁ +
//!   60k₂|x|² + 210k₃|x|⁴, b = 6k₁ + 36k₂|x|² + 90k₃|x|⁴ and d = 6k₁ + 12k₂|x|² + 18k₃|x|⁴. Its fifth is that of homogeneous
//!   polynomials, which have their greatest value along x, too: l₄ = 120|k₂|R + 840|k₃|R³ for |x| ≤ R. So l₃ is the greatest
//!   of |a|, |b| and |d|, and l₄ r.
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

use super::distortion::{Distortion, FLATTEST, STEPS};

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

/// Around a known direction others are in a disc of R, a multiple of βρ, where βLR is at most one less one over that factor
/// (as [`lens_patch`](super::lens_patch) has it). With a greater factor the bounds of derivatives are those of a greater
/// disc; with a lesser one the disc contains fewer patches.
pub(super) const REACH_FACTOR: f64 = 1.5;
pub(super) const MOST_CONTRACTION: f64 = 1.0 - 1.0 / REACH_FACTOR;

/// What is known of the directions of a rectangle's places.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LensRegion {
    /// A disc that contains all of them, in the lens's axes: to the right and down.
    pub(super) centre: [f64; 2],
    pub(super) reach: f64,
    /// The longest step within the disc behind which a direction is known.
    pub(super) settled: f64,
    /// ½ max ‖D²g‖ of the lens's inverse g within the rectangle.
    pub(super) bend: f64,
}

impl LensRegion {
    /// The squared distance of a direction (x, y, 1) from the disc's centre, and the greatest within it.
    #[inline(always)]
    fn off_centre(&self, x: f64, y: f64) -> (f64, f64) {
        let (x, y) = (x - self.centre[0], y - self.centre[1]);
        (x * x + y * y, self.reach * self.reach)
    }

    /// The directions (x, y, 1) that are seen at places of a region, by Newton's method from near them: off by less than 720ε,
    /// ε = 2⁻⁵³, as are those of all of Newton's steps. `None` where they are not near enough.
    #[inline(always)]
    pub(super) fn undistort_from<const N: usize>(
        &self,
        lens: &Distortion,
        [to_x, to_y]: [&[f64; N]; 2],
        [mut x, mut y]: [[f64; N]; 2],
    ) -> Option<[[f64; N]; 2]> {
        let (settled, (_, most)) = (self.settled, self.off_centre(0.0, 0.0));
        for _ in 0..NEAR_STEPS {
            let (mut furthest, mut longest) = ([0.0; N], [0.0; N]);
            for lane in 0..N {
                let at = lens.at(x[lane], y[lane]);
                let (off_x, off_y) = (at.x - to_x[lane], at.y - to_y[lane]);
                let inverse = 1.0 / at.determinant();
                let by_x = (at.yy * off_x - at.xy * off_y) * inverse;
                let by_y = (at.xx * off_y - at.xy * off_x) * inverse;
                furthest[lane] = self.off_centre(x[lane], y[lane]).0;
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

    /// What is known of the places within `radius` of one whose direction is known, where Newton's steps converge for all.
    pub(super) fn around(lens: &Distortion, direction: [f64; 2], radius: f64) -> Option<Self> {
        let [x, y] = direction;
        let near = Near::of(lens, x, y, 0.0)?;
        // Enlarged by far more than rounding.
        let reach = REACH_FACTOR * near.beta * radius * (1.0 + 1e-9) + 1e-9;
        let is_near = near.turn(lens, reach) <= MOST_CONTRACTION;
        is_near.then(|| near.disc(lens, reach, 0.0)).flatten()
    }

    /// Follows Newton's steps for the places within `radius` of a place to the right of and below the middle; where
    /// `decentring` is not zero, of a lens that is `lens` and a tangential part of that |q|.
    pub(super) fn follow(
        lens: &Distortion,
        place: [f64; 2],
        radius: f64,
        decentring: f64,
    ) -> Option<Self> {
        let mut iterates = Iterates {
            centre: place,
            within: radius,
            step: f64::INFINITY,
        };
        for _ in 0..=STEPS - LAST_STEPS {
            let (near, next) = iterates.next(lens, place, radius, decentring)?;
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
    fn next(
        &self,
        lens: &Distortion,
        place: [f64; 2],
        radius: f64,
        decentring: f64,
    ) -> Option<(Near, Self)> {
        let ([x, y], r, before) = (self.centre, self.within, self.step);
        let near = Near::of(lens, x, y, decentring)?;
        let turn = near.turn(lens, r);
        // NaN fails this.
        let is_near = turn <= MOST_TURN;
        if !is_near {
            return None;
        }
        let [by_x, by_y] = near.step(place);
        let furthest = near.furthest(r);
        let off = 0.5 * near.curvature(lens, r) * r * r + 3.0 * decentring * furthest * furthest;
        let length = (by_x * by_x + by_y * by_y).sqrt();
        let v = if before.is_finite() {
            let segment = near.curvature(lens, r + before);
            let by_residual = 0.5 * near.beta * segment * before * before;
            (length + r + near.beta * (radius + off)).min(by_residual)
        } else {
            length + near.beta * (near.distortion * radius + off)
        };
        let step = v / (1.0 - turn);
        let next = Self {
            centre: [x - by_x, y - by_y],
            within: near.beta * (radius + off) + turn * step,
            step,
        };
        Some((near, next))
    }
}

/// The width of the first ring that is followed, and the least. With a wider first one time is lost on rings that prove
/// nothing, with a narrower one on many rings; with a lesser least width the last rings add nothing that is seen.
const FIRST_WIDTH: f64 = 1.0 / 32.0;
const LEAST_WIDTH: f64 = 1.0 / 2048.0;

/// The radius of places up to which Newton's steps surely converge to the one direction that is seen there, given one up to
/// which they do.
pub(super) fn convergence_radius(lens: &Distortion, known: f64) -> f64 {
    let [_, _, p1, p2, _] = lens.coefficients;
    let (radial, decentring) = (lens.radial(), (p1 * p1 + p2 * p2).sqrt());
    let (mut radius, mut width) = (known, FIRST_WIDTH);
    while width >= LEAST_WIDTH && radius < FLATTEST {
        let half = 0.5 * width;
        if LensRegion::follow(&radial, [radius + half, 0.0], half, decentring).is_some() {
            radius += width;
        } else {
            width = half;
        }
    }
    // Sums and places are rounded.
    radius * (1.0 - 1e-12)
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
    /// |q|, where the tangential part is not known.
    decentring: f64,
}

impl Near {
    /// `None` where J is not positive definite.
    pub(super) fn of(lens: &Distortion, x: f64, y: f64, decentring: f64) -> Option<Self> {
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
            bent: second_derivative(lens, x, y) + 6.0 * decentring,
            decentring,
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
    pub(super) fn curvature(&self, lens: &Distortion, within: f64) -> f64 {
        self.bent + self.third(lens, within) * within
    }

    /// q = ‖E‖ within some distance.
    fn turn(&self, lens: &Distortion, within: f64) -> f64 {
        let tangential = 6.0 * self.decentring * self.furthest(within);
        self.beta * (self.curvature(lens, within) * within + tangential)
    }

    /// l₃ within some distance.
    pub(super) fn third(&self, lens: &Distortion, within: f64) -> f64 {
        let [k1, k2, _, _, k3] = lens.coefficients;
        let squared = self.x * self.x + self.y * self.y;
        let along = 6.0 * k1 + squared * (60.0 * k2 + squared * (210.0 * k3));
        let mixed = 6.0 * k1 + squared * (36.0 * k2 + squared * (90.0 * k3));
        let across = 6.0 * k1 + squared * (12.0 * k2 + squared * (18.0 * k3));
        let greatest = along.abs().max(mixed.abs()).max(across.abs());
        greatest + self.fourth(lens, within) * within
    }

    /// l₄ within some distance.
    pub(super) fn fourth(&self, lens: &Distortion, within: f64) -> f64 {
        let [_, k2, _, _, k3] = lens.coefficients.map(f64::abs);
        let furthest = self.furthest(within);
        furthest * (120.0 * k2 + furthest * furthest * (840.0 * k3))
    }

    /// R within some distance.
    pub(super) fn furthest(&self, within: f64) -> f64 {
        (self.x * self.x + self.y * self.y).sqrt() + within
    }

    /// Whether all within some distance is in the lens's picture, and rounded as is said above. `inverse` is a bound of
    /// ‖J⁻¹‖ there.
    pub(super) fn is_precise(&self, lens: &Distortion, within: f64, inverse: f64) -> bool {
        let [a, b, p1, p2, c] = lens.coefficients.map(f64::abs);
        let furthest = self.furthest(within);
        let squared = furthest * furthest;
        let sum = 1.0
            + squared * (a + squared * (b + squared * c))
            + 6.0 * (p1 + p2 + 2.0 * self.decentring) * furthest;
        furthest <= 0.999 * FLATTEST
            && furthest <= 0.999 * lens.end.sqrt()
            && sum * furthest * inverse <= MOST_ROUNDING
    }

    /// The disc of this radius, if Newton's steps, of which the next is at most `longest` long, surely end in it.
    fn disc(&self, lens: &Distortion, reach: f64, longest: f64) -> Option<LensRegion> {
        let bent = self.curvature(lens, reach);
        let (turn, inverse) = (self.turn(lens, reach), 2.0 * self.beta);
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
fn second_derivative(lens: &Distortion, x: f64, y: f64) -> f64 {
    let [k1, k2, p1, p2, k3] = lens.coefficients;
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
#[path = "lens_region_tests.rs"]
pub(super) mod tests;
