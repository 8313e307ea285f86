//! Directions of an equidistant fisheye, up to rounding: cos ρ and sin ρ/ρ of the angle ρ from the view axis are functions
//! of t = ρ² without a singularity, and need no angle of their own.

use crate::num::simd::LANES;
use std::f64::consts::PI;

/// Number of terms of the series below: the first one omitted, (π/4)¹⁸/18!, is below ε/16.
const TERMS: usize = 9;

/// Coefficients of cos √s and of sin √s / √s as series of s: (−1)ᵏ/(2k)! and (−1)ᵏ/(2k + 1)!.
const COSINE: [f64; TERMS] = series(0);
const SINE_SHARE: [f64; TERMS] = series(1);

const fn series(first: usize) -> [f64; TERMS] {
    let mut all = [0.0; TERMS];
    let (mut value, mut k) = (1.0, 0);
    while k < TERMS {
        all[k] = value;
        let next = (2 * k + first) as f64;
        value /= -((next + 1.0) * (next + 2.0));
        k += 1;
    }
    all
}

/// Directions of an equidistant fisheye: sine and cosine by series for a quarter of the angle, then two angle
/// doublings.
///
/// Error bound: Horner's scheme, with its coefficients, rounds the k-th term at most 4k + 1 times. With terms below
/// 1, 0.31, 0.02, … and the truncation, this is less than 3ε for cos ρ/4 and 2ε for (sin ρ/4)/(ρ/4).
/// cos 2x = 2 cos² x − 1 has four times the error of cos x plus 3ε: 15ε, then 63ε.
/// sin 2x / 2x = (sin x / x) cos x has the sum of both errors plus ε: 6ε, then 22ε; it is multiplied by at most π.
/// All are below 320ε.
#[inline(always)]
pub(super) fn equidistant(
    a: &[f64; LANES],
    b: f64,
    squared: &[f64; LANES],
    out: &mut [[f64; LANES]; 3],
) {
    let [mut share, mut cosine] = [[0.0; LANES]; 2];
    for k in (0..TERMS).rev() {
        for lane in 0..LANES {
            let s = if squared[lane] < PI * PI {
                squared[lane]
            } else {
                PI * PI
            };
            let s = s * (1.0 / 16.0);
            cosine[lane] = cosine[lane] * s + COSINE[k];
            share[lane] = share[lane] * s + SINE_SHARE[k];
        }
    }
    for lane in 0..LANES {
        let half = 2.0 * (cosine[lane] * cosine[lane]) - 1.0;
        let share = share[lane] * cosine[lane] * half;
        out[0][lane] = a[lane] * share;
        out[1][lane] = b * share;
        out[2][lane] = 2.0 * (half * half) - 1.0;
    }
}

/// Terms of a packet's expansion. With fewer, packets of wide pictures are too large for it; with more, each ray takes
/// longer.
const NEAR_TERMS: usize = 6;

/// The greatest t of an expansion. With a greater one its coefficients are rounded by more than is said below.
const FURTHEST: f64 = 4.0;

/// The greatest h: h⁶/12! is 9·10⁻¹⁶, below 9ε.
const WIDEST: f64 = 0.087;

/// Terms of the coefficients of an expansion: the first one omitted, 4¹³/26!, is below ε/100.
const FAR_TERMS: usize = 13;

/// The j-th derivatives of the two series above, over j!, as series: factors of their terms.
const COSINE_ABOUT: [[f64; FAR_TERMS]; NEAR_TERMS] = about(0);
const SHARE_ABOUT: [[f64; FAR_TERMS]; NEAR_TERMS] = about(1);

const fn about(first: usize) -> [[f64; FAR_TERMS]; NEAR_TERMS] {
    let mut all = [[0.0; FAR_TERMS]; NEAR_TERMS];
    // (−1)ⁿ/(2n + first)! for n = j + i, times the binomial of n and j.
    let (mut n, mut value) = (0, 1.0);
    while n < FAR_TERMS + NEAR_TERMS {
        let (mut j, mut binomial) = (0, 1.0);
        while j < NEAR_TERMS && j <= n {
            if n - j < FAR_TERMS {
                all[j][n - j] = value * binomial;
            }
            binomial = binomial * (n - j) as f64 / (j + 1) as f64;
            j += 1;
        }
        let next = (2 * n + first) as f64;
        value /= -((next + 1.0) * (next + 2.0));
        n += 1;
    }
    all
}

/// The Taylor polynomials of cos √t and of sin √t / √t about the middle of a packet's t.
///
/// Error bound: each derivative is (−½)ʲ times a mean of cosines, since d/dt cos(u√t) = −½u² ∫₀¹ cos(uv√t) dv; so the j-th
/// is greatest in magnitude at t = 0, j!/(2j)! or j!/(2j + 1)!. With t within h of the middle the remainder is at most
/// h⁶/12!, 9ε. The coefficients' terms add up to cosh 2 and sinh 2/2 for j = 0; Horner's scheme rounds each 26 times at most,
/// so that they are off by 98ε and 48ε, and the next ones, times h, by 3ε. With what evaluating and the products round, all
/// coordinates are off by less than 160ε.
pub(crate) struct Expansion {
    middle: f64,
    cosine: [f64; NEAR_TERMS],
    share: [f64; NEAR_TERMS],
}

impl Expansion {
    /// For t between these two; `None` where they are too far apart, or from zero.
    pub(super) fn new(least: f64, most: f64) -> Option<Self> {
        let middle = 0.5 * (least + most);
        // NaN fails the comparisons.
        let serves = most <= FURTHEST && 0.5 * (most - least) <= 0.999 * WIDEST;
        if !serves {
            return None;
        }
        let of = |all: &[[f64; FAR_TERMS]; NEAR_TERMS]| {
            let mut sums = [0.0; NEAR_TERMS];
            for i in (0..FAR_TERMS).rev() {
                for (sum, terms) in sums.iter_mut().zip(all) {
                    *sum = *sum * middle + terms[i];
                }
            }
            sums
        };
        Some(Self {
            middle,
            cosine: of(&COSINE_ABOUT),
            share: of(&SHARE_ABOUT),
        })
    }

    /// The directions of eight places (a, b) of these t.
    #[inline(always)]
    pub(super) fn directions(
        &self,
        a: &[f64; LANES],
        b: f64,
        squared: &[f64; LANES],
        out: &mut [[f64; LANES]; 3],
    ) {
        let mut share = [self.share[NEAR_TERMS - 1]; LANES];
        let mut cosine = [self.cosine[NEAR_TERMS - 1]; LANES];
        for k in (0..NEAR_TERMS - 1).rev() {
            for lane in 0..LANES {
                let h = squared[lane] - self.middle;
                cosine[lane] = cosine[lane] * h + self.cosine[k];
                share[lane] = share[lane] * h + self.share[k];
            }
        }
        for lane in 0..LANES {
            out[0][lane] = a[lane] * share[lane];
            out[1][lane] = b * share[lane];
        }
        out[2] = cosine;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;
    use crate::random::Random;

    /// The truth is the sine and cosine of `math`, whose errors are below ε.
    #[test]
    fn expansions_are_off_by_less_than_160_epsilon() {
        let mut random = Random(91);
        let (mut count, mut worst) = (0, 0.0_f64);
        for _ in 0..20_000 {
            let most = FURTHEST * random.unit();
            let least = (most - 2.0 * WIDEST * random.unit()).max(0.0);
            let Some(expansion) = Expansion::new(least, most) else {
                continue;
            };
            let squared = [(); LANES].map(|()| least + (most - least) * random.unit());
            let b = least.sqrt() * random.signed();
            let a = squared.map(|squared| (squared - b * b).max(0.0).sqrt());
            let mut out = [[0.0; LANES]; 3];
            expansion.directions(&a, b, &squared, &mut out);
            for lane in 0..LANES {
                let angle = squared[lane].sqrt();
                let (sin, cos) = math::sin_cos(angle);
                let share = if angle > 0.0 { sin / angle } else { 1.0 };
                let off = [
                    out[0][lane] - a[lane] * share,
                    out[1][lane] - b * share,
                    out[2][lane] - cos,
                ];
                worst = off.iter().fold(worst, |worst, off| worst.max(off.abs()));
                count += 1;
            }
        }
        let worst = worst / (f64::EPSILON * 0.5);
        assert!(
            count > 100_000 && (8.0..160.0).contains(&worst),
            "{count} {worst}"
        );
        assert!(Expansion::new(0.0, 2.1 * WIDEST).is_none());
        assert!(Expansion::new(3.9, 4.01).is_none());
        assert!(Expansion::new(f64::NAN, 1.0).is_none());
    }
}
