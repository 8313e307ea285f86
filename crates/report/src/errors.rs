//! A caster's answers compared with the truth.

use crate::casters::Caster;
use crate::stage::Stage;
use crate::timing::quantile;
use crate::wrong_answer::{GRAZING, ulps};
use raycast_core::camera::Ray;
use raycast_core::{Cull, PrimitiveHit};
use raycast_oracle::Truth;
use rayon::prelude::*;

/// A caster's errors over some rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Errors {
    /// Rays that were cast.
    pub rays: u64,
    /// Rays that hit something, by exact arithmetic.
    pub hits: u64,
    /// Misses where exact arithmetic finds a triangle: holes.
    pub leaks: u64,
    /// Hits where exact arithmetic finds nothing.
    pub phantoms: u64,
    /// Hits of a triangle that is not the closest, or that the ray misses.
    pub others: u64,
    /// Another triangle at exactly the same distance: right except for the rule that the lowest number wins. Not
    /// counted as wrong.
    pub ties: u64,
    /// The errors of `t` in units of single precision's last place, ascending.
    t_ulps: Vec<f64>,
    /// The largest error of a weight.
    pub weight: f64,
}

impl Errors {
    /// Compares answers to rays with the truth about these same rays.
    pub fn compare(
        stage: &Stage,
        caster: &dyn Caster,
        rays: &[Ray],
        truths: &[Option<Truth>],
        hits: &[PrimitiveHit],
    ) -> Self {
        let one = |((ray, truth), hit): ((&Ray, &Option<Truth>), &PrimitiveHit)| {
            let mut errors = Self {
                rays: 1,
                ..Self::default()
            };
            errors.add(stage, caster, ray, truth.as_ref(), hit);
            errors
        };
        let mut all = rays
            .par_iter()
            .zip(truths)
            .zip(hits)
            .with_min_len(1024)
            .map(one)
            .reduce(Self::default, Self::merged);
        all.t_ulps.par_sort_unstable_by(f64::total_cmp);
        all
    }

    fn add(
        &mut self,
        stage: &Stage,
        caster: &dyn Caster,
        ray: &Ray,
        truth: Option<&Truth>,
        hit: &PrimitiveHit,
    ) {
        let truth = match (truth, hit.is_miss()) {
            (None, true) => return,
            (None, false) => {
                self.phantoms += 1;
                return;
            }
            (Some(_), true) => {
                self.hits += 1;
                self.leaks += 1;
                return;
            }
            (Some(truth), false) => truth,
        };
        self.hits += 1;
        let found = caster.identify(hit.primitive);
        let mut closest = *truth;
        if found != (truth.object, truth.triangle) {
            // The oracle's distances are rounded to double precision, so equality within that is a tie.
            match stage.intersect(found, ray, Cull::None) {
                Some(other) if other.t == truth.t => {
                    self.ties += 1;
                    closest = other;
                }
                _ => {
                    self.others += 1;
                    return;
                }
            }
        }
        if closest.cosine > GRAZING {
            self.t_ulps.push(ulps(f64::from(hit.t), closest.t));
            let off = |found: f32, truth: f64| (f64::from(found) - truth).abs();
            self.weight = self
                .weight
                .max(off(hit.u, closest.u))
                .max(off(hit.v, closest.v));
        }
    }

    /// Both together; the caller, or [`Errors::sum`], sorts `t`'s errors again.
    fn merged(mut self, other: Self) -> Self {
        self.rays += other.rays;
        self.hits += other.hits;
        self.leaks += other.leaks;
        self.phantoms += other.phantoms;
        self.others += other.others;
        self.ties += other.ties;
        self.t_ulps.extend(other.t_ulps);
        self.weight = self.weight.max(other.weight);
        self
    }

    /// All of them together.
    pub fn sum(all: impl IntoIterator<Item = Self>) -> Self {
        let mut sum = all.into_iter().fold(Self::default(), Self::merged);
        sum.t_ulps.sort_unstable_by(f64::total_cmp);
        sum
    }

    /// Rays with a wrong answer.
    pub fn wrong(&self) -> u64 {
        self.leaks + self.phantoms + self.others
    }

    /// Wrong answers in a million rays.
    pub fn wrong_per_million(&self) -> f64 {
        self.wrong() as f64 / self.rays.max(1) as f64 * 1e6
    }

    /// The quantile of the errors of `t`, for a fraction of the answers from 0 to 1, in units of single precision's
    /// last place.
    pub fn t_ulps(&self, share: f64) -> f64 {
        quantile(&self.t_ulps, share)
    }

    /// The number of answers whose `t` was compared.
    pub fn t_count(&self) -> usize {
        self.t_ulps.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_of_everything() {
        let one = |leaks, others, t: f64| Errors {
            rays: 10,
            hits: 9,
            leaks,
            others,
            t_ulps: vec![t],
            weight: t,
            ..Errors::default()
        };
        let sum = Errors::sum([one(1, 0, 3.0), one(0, 2, 0.5)]);
        assert_eq!((sum.rays, sum.hits, sum.wrong()), (20, 18, 3));
        assert_eq!(
            (sum.t_ulps(0.0), sum.t_ulps(1.0), sum.weight),
            (0.5, 3.0, 3.0)
        );
        assert_eq!(sum.wrong_per_million(), 150_000.0);
    }
}
