//! Choosing the first pass's stride, so that it is ready in time.

use raycast_core::render::{Pass, Passes};
use std::time::Duration;

/// The time of the first pass: with the window's own work, 30 pictures a second follow the hand; a coarse pass that is
/// soon replaced by a finer one costs more in total than the full picture.
const BUDGET: Duration = Duration::from_millis(30);
/// The longest time of a first pass where leaving out rays saves little. With a longer one fewer than 30 pictures a
/// second follow the hand on average; with a shorter one rays are left out in vain.
pub const LONGEST: Duration = Duration::from_millis(37);
/// A sparser pass saves little if it takes more than this part of the denser one's time. Of a mesh with several
/// triangles a ray, every 4th ray in both directions takes three quarters of the time of every 2nd (`bench --passes`),
/// and shows a quarter of the rays. With a greater part rays are left out in vain; with a lesser one a pass that would
/// save half is not made.
const SAVES_LITTLE: f64 = 0.7;
/// A full picture that takes at most this long follows the first pass immediately: passes between would hardly be
/// visible, and sparse rays cost more each.
const AT_ONCE: Duration = Duration::from_millis(150);
/// The coarsest first pass: every 32nd ray in both directions.
const COARSEST: usize = 5;
/// By how much denser passes are believed to cost less with each picture that is made without them, so that one that was
/// slow, at a distance or while the machine was busy, is tried again: within a second or two where it just missed the budget.
const HOPE: f64 = 0.99;
/// The initial estimate of nanoseconds a ray, as on a slow machine.
const FIRST_GUESS: f64 = 60.0;

/// Measured times of passes, by stride.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    nanoseconds_per_ray: [Option<f64>; COARSEST + 1],
}

impl Pace {
    /// Records a finished pass.
    pub fn learn(&mut self, pass: Pass, rays: u64, time: Duration) {
        let level = pass.stride.trailing_zeros() as usize;
        if pass.samples > 1 || level > COARSEST || rays == 0 {
            return;
        }
        let measured = time.as_nanos() as f64 / rays as f64;
        for (other, known) in self.nanoseconds_per_ray.iter_mut().enumerate() {
            let Some(cost) = known else { continue };
            if other == level {
                // Half the weight is on the newest: a camera that approaches soon casts costlier rays.
                *cost = 0.5 * (*cost + measured);
            } else {
                // A measurement of long ago, or of a machine that was busy, is not believed against the newest: the
                // sparser of two passes costs more a ray, and takes no longer.
                let fewer = 4_f64.powi(other as i32 - level as i32);
                *cost = cost.clamp(measured * fewer.min(1.0), measured * fewer.max(1.0));
                if other < level {
                    *cost *= HOPE;
                }
            }
        }
        self.nanoseconds_per_ray[level].get_or_insert(measured);
    }

    /// Forgets all measurements, for another scene or number of threads.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// The passes of a picture of `pixels`.
    pub fn plan(&self, pixels: u64, samples: u32) -> Vec<Pass> {
        let first = self.first_stride(pixels);
        let full = pixels as f64 * self.cost(0);
        let mut passes = Passes::plan(first, samples);
        if full <= AT_ONCE.as_nanos() as f64 {
            passes.retain(|pass| pass.stride == first || pass.stride == 1);
        }
        passes
    }

    /// The finest first stride whose pass fits the budget for a picture of `pixels`, or just misses it where leaving out
    /// rays saves little.
    pub fn first_stride(&self, pixels: u64) -> u32 {
        let budget = BUDGET.as_nanos() as f64;
        let time = |level: usize| {
            let rays = pixels as f64 / f64::from(1_u32 << (2 * level));
            rays * self.cost(level)
        };
        let fits = (0..=COARSEST).find(|&level| time(level) <= budget);
        let mut level = fits.unwrap_or(COARSEST);
        while level > 0
            && time(level - 1) <= LONGEST.as_nanos() as f64
            && time(level) > SAVES_LITTLE * time(level - 1)
        {
            level -= 1;
        }
        1 << level
    }

    /// Nanoseconds a ray at a stride: measured there, else at the nearest measured stride, with the assumption that
    /// doubling the stride doubles the cost (fewer rays share a tile).
    fn cost(&self, level: usize) -> f64 {
        (0..=COARSEST)
            .filter_map(|known| Some((known, self.nanoseconds_per_ray[known]?)))
            .min_by_key(|(known, _)| known.abs_diff(level))
            .map_or(FIRST_GUESS, |(known, cost)| {
                cost * 2_f64.powi(level as i32 - known as i32)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MEGAPIXELS: u64 = 1_600_000;

    fn pass(stride: u32) -> Pass {
        Pass { stride, samples: 1 }
    }

    #[test]
    fn starts_fine_where_there_is_time_and_coarse_where_there_is_not() {
        let mut pace = Pace::default();
        assert!(pace.first_stride(MEGAPIXELS) > 1, "nothing is known yet");
        pace.learn(pass(1), MEGAPIXELS, Duration::from_millis(10));
        assert_eq!(pace.first_stride(MEGAPIXELS), 1);
        pace.forget();
        pace.learn(pass(1), MEGAPIXELS, Duration::from_millis(100));
        assert_eq!(pace.first_stride(MEGAPIXELS), 4);
        pace.learn(pass(2), MEGAPIXELS / 4, Duration::from_millis(20));
        assert_eq!(pace.first_stride(MEGAPIXELS), 2, "measured beats guessed");
    }

    #[test]
    fn passes_between_the_first_and_the_last_are_for_slow_pictures() {
        let strides = |pace: &Pace| {
            let passes = pace.plan(MEGAPIXELS, 2);
            assert_eq!(passes.last().map(|pass| pass.samples), Some(2));
            passes.iter().map(|pass| pass.stride).collect::<Vec<_>>()
        };
        let mut pace = Pace::default();
        pace.learn(pass(1), MEGAPIXELS, Duration::from_millis(130));
        pace.learn(pass(4), MEGAPIXELS / 16, Duration::from_millis(30));
        pace.learn(pass(2), MEGAPIXELS / 4, Duration::from_millis(60));
        assert_eq!(strides(&pace), [4, 1, 1]);
        pace.forget();
        pace.learn(pass(1), MEGAPIXELS, Duration::from_millis(200));
        assert_eq!(strides(&pace), [8, 4, 2, 1, 1]);
    }

    /// All were slow at first; then only the sparsest is made, until it shows that the next one must be cheaper.
    #[test]
    fn a_pass_that_was_slow_once_is_tried_again() {
        let mut pace = Pace::default();
        pace.learn(pass(2), MEGAPIXELS / 4, Duration::from_millis(70));
        pace.learn(pass(4), MEGAPIXELS / 16, Duration::from_millis(60));
        pace.learn(pass(8), MEGAPIXELS / 64, Duration::from_millis(20));
        assert_eq!(pace.first_stride(MEGAPIXELS), 8);
        for _ in 0..3 {
            pace.learn(pass(8), MEGAPIXELS / 64, Duration::from_millis(3));
        }
        assert_eq!(pace.first_stride(MEGAPIXELS), 4);
        // And one that was fast once is not believed to be so for ever.
        pace.learn(pass(2), MEGAPIXELS / 4, Duration::from_millis(12));
        pace.learn(pass(4), MEGAPIXELS / 16, Duration::from_millis(8));
        assert_eq!(pace.first_stride(MEGAPIXELS), 2);
        pace.learn(pass(4), MEGAPIXELS / 16, Duration::from_millis(35));
        assert_eq!(pace.first_stride(MEGAPIXELS), 4);
        // Too slow by a third: tried again after some pictures, and given up at once.
        pace.forget();
        pace.learn(pass(2), MEGAPIXELS / 4, Duration::from_millis(44));
        let mut tried = 0;
        for _ in 0..300 {
            let stride = pace.first_stride(MEGAPIXELS);
            let time = if stride == 2 { 44 } else { 12 };
            pace.learn(
                pass(stride),
                MEGAPIXELS / u64::from(stride * stride),
                Duration::from_millis(time),
            );
            tried += u32::from(stride == 2);
        }
        assert!((3..30).contains(&tried), "{tried}");
    }

    #[test]
    fn rays_are_left_out_only_where_that_saves_time() {
        let mut pace = Pace::default();
        let mut measured = |times: [(u32, u64); 2]| {
            pace.forget();
            for (stride, time) in times {
                let rays = MEGAPIXELS / u64::from(stride * stride);
                pace.learn(pass(stride), rays, Duration::from_millis(time));
            }
            pace.first_stride(MEGAPIXELS)
        };
        assert_eq!(measured([(2, 36), (4, 28)]), 2, "saves little");
        assert_eq!(measured([(2, 36), (4, 20)]), 4, "saves much");
        assert_eq!(measured([(2, 42), (4, 30)]), 4, "far beyond the budget");
        assert_eq!(measured([(1, 36), (2, 20)]), 2);
    }

    #[test]
    fn the_slowest_scene_still_gets_a_stride() {
        let mut pace = Pace::default();
        pace.learn(pass(32), 10, Duration::from_secs(10));
        assert_eq!(pace.first_stride(MEGAPIXELS), 32);
        assert_eq!(pace.first_stride(0), 1);
    }
}
