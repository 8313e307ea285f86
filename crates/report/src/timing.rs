//! Measures several tasks alternately, with robust statistics.

use std::time::{Duration, Instant};

/// The least duration of a measurement; shorter tasks are repeated. The clock's resolution is below a thousandth of
/// it. A longer one makes the report slower, a shorter one its times noisier.
const MIN_DURATION: Duration = Duration::from_millis(20);

/// Median and median absolute deviation of measurements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// The median absolute deviation.
    pub deviation: f64,
    /// The number of measurements.
    pub count: usize,
}

impl Spread {
    /// Statistics of numbers in any order; zeros if there are none.
    pub fn from_samples(numbers: &[f64]) -> Self {
        let middle = median(numbers);
        let distances: Vec<f64> = numbers
            .iter()
            .map(|number| (number - middle).abs())
            .collect();
        Self {
            median: middle,
            deviation: median(&distances),
            count: numbers.len(),
        }
    }

    /// Converts times to rates, for `amount` units of work each.
    pub fn rate(self, amount: f64) -> Self {
        let median = amount / self.median;
        Self {
            median,
            deviation: median * self.deviation / self.median,
            ..self
        }
    }

    /// The same, multiplied by a factor.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            median: self.median * factor,
            deviation: self.deviation * factor,
            ..self
        }
    }
}

/// The median; for an even count the mean of the two middle numbers; 0 without any.
pub fn median(numbers: &[f64]) -> f64 {
    let mut sorted = numbers.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    match (sorted.get(sorted.len() / 2), sorted.len() % 2) {
        (None, _) => 0.0,
        (Some(&middle), 1) => middle,
        (Some(&upper), _) => (sorted[sorted.len() / 2 - 1] + upper) / 2.0,
    }
}

/// The quantile `share` (0 to 1) of sorted numbers; 0 if there are none.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    let at = (share * last as f64).ceil() as usize;
    sorted.get(at.min(last)).copied().unwrap_or(0.0)
}

/// The geometric mean, for rates over several meshes; 0 if there are no numbers.
pub fn geometric_mean(numbers: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for number in numbers {
        sum += number.ln();
        count += 1;
    }
    if count == 0 {
        0.0
    } else {
        (sum / f64::from(count)).exp()
    }
}

/// The seconds that each task takes. Tasks run in turn for `rounds` rounds, so that a change of the machine's clock
/// rate affects all of them; a warm-up round before is not counted. Short tasks are repeated until a measurement
/// takes 20 ms.
pub fn interleaved<'a>(
    rounds: usize,
    works: &mut [Box<dyn FnMut() + Send + 'a>],
    done: &dyn Fn(),
) -> Vec<Spread> {
    let mut times = vec![Vec::with_capacity(rounds); works.len()];
    for round in 0..=rounds {
        for (work, times) in works.iter_mut().zip(&mut times) {
            let (started, mut frames) = (Instant::now(), 0u32);
            // The warm-up round runs each task once.
            while frames == 0 || (round > 0 && started.elapsed() < MIN_DURATION) {
                work();
                frames += 1;
            }
            if round > 0 {
                times.push(started.elapsed().as_secs_f64() / f64::from(frames));
            }
            done();
        }
    }
    times
        .iter()
        .map(|times| Spread::from_samples(times))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn medians_and_deviations() {
        assert_eq!(median(&[]), 0.0);
        assert_eq!(median(&[5.0, 1.0, 3.0]), 3.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 9.0]), 3.0);
        let spread = Spread::from_samples(&[1.0, 2.0, 3.0, 4.0, 100.0]);
        assert_eq!(
            (spread.median, spread.deviation, spread.count),
            (3.0, 1.0, 5)
        );
        assert_eq!(spread.scaled(2.0).median, 6.0);
    }

    #[test]
    fn quantiles_are_numbers_of_the_list() {
        let numbers: Vec<f64> = (0..=1000).map(f64::from).collect();
        assert_eq!(quantile(&numbers, 0.0), 0.0);
        assert_eq!(quantile(&numbers, 0.5), 500.0);
        assert_eq!(quantile(&numbers, 0.999), 999.0);
        assert_eq!(quantile(&numbers, 1.0), 1000.0);
        assert_eq!(quantile(&[], 0.5), 0.0);
    }

    #[test]
    fn rates_are_averaged_by_their_logarithms() {
        assert!((geometric_mean([1.0, 100.0]) - 10.0).abs() < 1e-12);
        assert_eq!(geometric_mean([]), 0.0);
    }

    #[test]
    fn works_take_turns() {
        let order = Mutex::new(String::new());
        let work = |name: char, time| {
            let order = &order;
            Box::new(move || {
                order.lock().expect("one thread").push(name);
                std::thread::sleep(time);
            }) as Box<dyn FnMut() + Send>
        };
        let mut works = [work('a', MIN_DURATION), work('b', MIN_DURATION * 2)];
        let spreads = interleaved(2, &mut works, &|| ());
        drop(works);
        assert_eq!(order.into_inner().expect("one thread"), "ababab");
        assert!(spreads[0].median >= 0.02 && spreads[1].median >= 0.04);
        assert_eq!(spreads[0].count, 2);
    }
}
