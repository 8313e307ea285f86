//! Maps numbers to positions along an axis.

/// The scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Proportional to the number.
    Linear,
    /// Proportional to its logarithm.
    Log,
}

/// An axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it measures, with its unit.
    pub label: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// The number at its beginning.
    pub low: f64,
    /// The number at its end.
    pub high: f64,
    /// A region for zero on a logarithmic axis, which has no position for it otherwise.
    pub zero: Option<Zero>,
    /// Whether it is reversed: from the highest number to the lowest.
    pub falls: bool,
}

/// A region for zero, before the start of a logarithmic axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Zero {
    /// Its tick label.
    pub text: String,
    /// The fraction of the axis that it takes.
    pub share: f64,
}

/// The fraction above which the region for zero has room for the labels of the dots in it.
const ROOMY: f64 = 0.3;

impl Axis {
    /// A linear axis from zero to just above the largest number.
    pub fn linear(label: &str, numbers: impl IntoIterator<Item = f64>) -> Self {
        let highest = numbers
            .into_iter()
            .filter(|n| n.is_finite())
            .fold(0.0, f64::max);
        Self {
            label: label.to_owned(),
            scale: Scale::Linear,
            low: 0.0,
            high: if highest > 0.0 { highest * 1.08 } else { 1.0 },
            zero: None,
            falls: false,
        }
    }

    /// A logarithmic axis around the positive numbers.
    pub fn log(label: &str, numbers: impl IntoIterator<Item = f64>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, 0.0f64);
        for number in numbers.into_iter().filter(|n| n.is_finite() && *n > 0.0) {
            low = low.min(number);
            high = high.max(number);
        }
        if low > high {
            (low, high) = (1.0, 10.0);
        }
        Self {
            label: label.to_owned(),
            scale: Scale::Log,
            low: low / 1.6,
            high: high * 1.6,
            zero: None,
            falls: false,
        }
    }

    /// The same from `low` to `high`.
    pub fn from_to(self, low: f64, high: f64) -> Self {
        Self { low, high, ..self }
    }

    /// The same, reversed.
    pub fn falling(self) -> Self {
        Self {
            falls: true,
            ..self
        }
    }

    /// The same with a region for zero, and its tick label.
    pub fn with_zero(self, text: &str) -> Self {
        self.with_zero_of(text, 0.14)
    }

    /// The same with a region for zero that has room for labels.
    pub fn with_roomy_zero(self, text: &str) -> Self {
        self.with_zero_of(text, 0.4)
    }

    fn with_zero_of(self, text: &str, share: f64) -> Self {
        let text = text.to_owned();
        Self {
            zero: Some(Zero { text, share }),
            ..self
        }
    }

    /// The position of a number, from 0 to 1 along the axis.
    pub fn position(&self, number: f64) -> f64 {
        let place = self.rising_position(number);
        if self.falls { 1.0 - place } else { place }
    }

    fn rising_position(&self, number: f64) -> f64 {
        match self.scale {
            Scale::Linear => (number - self.low) / (self.high - self.low),
            Scale::Log => {
                let share = self.zero_end().unwrap_or(0.0);
                if number > 0.0 {
                    let along = (number / self.low).log10() / (self.high / self.low).log10();
                    (share + (1.0 - share) * along).max(share)
                } else if self.has_room_at_zero() {
                    0.03
                } else {
                    share * 0.5
                }
            }
        }
    }

    /// The end of the region for zero.
    pub fn zero_end(&self) -> Option<f64> {
        self.zero.as_ref().map(|zero| zero.share)
    }

    /// Whether the region for zero has room for labels.
    pub fn has_room_at_zero(&self) -> bool {
        self.zero.as_ref().is_some_and(|zero| zero.share > ROOMY)
    }

    /// Ticks with their labels; an empty label draws only a grid line.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        match self.scale {
            Scale::Linear => {
                let step = round_step((self.high - self.low) / 5.0);
                let first = (self.low / step).ceil() as i64;
                let last = (self.high / step).floor() as i64;
                (first..=last)
                    .map(|at| (at as f64 * step, number(at as f64 * step)))
                    .collect()
            }
            Scale::Log => {
                let (low, high) = (self.low.log10(), self.high.log10());
                let decades = (high - low).max(1e-9);
                let every = (decades / 9.0).ceil().max(1.0) as i32;
                let mut ticks = Vec::new();
                for power in low.floor() as i32..=high.ceil() as i32 {
                    for digit in 1..10 {
                        let at = f64::from(digit) * 10f64.powi(power);
                        if at < self.low * 0.999_999 || at > self.high * 1.000_001 {
                            continue;
                        }
                        let named = match digit {
                            1 => power.rem_euclid(every) == 0,
                            2 | 5 => decades < 2.2,
                            3 | 7 => decades < 0.9,
                            _ => decades < 0.45,
                        };
                        ticks.push((at, if named { number(at) } else { String::new() }));
                    }
                }
                ticks
            }
        }
    }
}

/// The next larger round number: 1, 2 or 5 times a power of ten.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    let digit = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|digit| digit * power >= step * 0.999_999)
        .unwrap_or(10.0);
    digit * power
}

/// Formats a number for a tick.
pub fn number(x: f64) -> String {
    let size = x.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if (999_999.5..1e9).contains(&size) {
        return format!("{} M", trimmed(x / 1e6, 3));
    }
    if !(0.000_999..1e9).contains(&size) {
        let power = (size.log10() + 1e-9).floor() as i32;
        return format!("{}e{power}", trimmed(x / 10f64.powi(power), 2));
    }
    if size >= 1000.0 {
        let whole = x.round().abs() as u64;
        let sign = if x < 0.0 { "-" } else { "" };
        return format!("{sign}{},{:03}", whole / 1000, whole % 1000);
    }
    let digits = (2.0 - size.log10().floor()).clamp(0.0, 6.0) as usize;
    trimmed(x, digits)
}

/// Formats with at most `decimals` decimals and without trailing zeros.
fn trimmed(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_people_do() {
        for (x, text) in [
            (0.0, "0"),
            (0.01, "0.01"),
            (0.125, "0.125"),
            (1.0, "1"),
            (2.5, "2.5"),
            (144.0, "144"),
            (1000.0, "1,000"),
            (20_000.0, "20,000"),
            (999_999.0, "999,999"),
            (1e6, "1 M"),
            (2.5e6, "2.5 M"),
            (1e-5, "1e-5"),
            (3e12, "3e12"),
        ] {
            assert_eq!(number(x), text);
        }
    }

    #[test]
    fn places_run_from_zero_to_one() {
        let axis = Axis::log("x", [1.0]).from_to(0.1, 1000.0);
        assert_eq!(
            (
                axis.position(0.1),
                axis.position(10.0),
                axis.position(1000.0)
            ),
            (0.0, 0.5, 1.0)
        );
        let axis = axis.with_zero("0 of N");
        let end = axis.zero_end().expect("a place for zero");
        assert!(axis.position(0.0) > 0.0 && axis.position(0.0) < end && end < axis.position(1.0));
        let linear = Axis::linear("y", [3.0]).from_to(0.0, 4.0);
        assert_eq!(linear.position(1.0), 0.25);
    }

    #[test]
    fn ticks_are_round_and_within() {
        let texts = |axis: &Axis| -> Vec<String> {
            let ticks = axis.ticks().into_iter();
            assert!(
                axis.ticks()
                    .iter()
                    .all(|(at, _)| (-1e-9..=1.0 + 1e-9).contains(&axis.position(*at)))
            );
            ticks
                .map(|(_, text)| text)
                .filter(|text| !text.is_empty())
                .collect()
        };
        let axis = Axis::log("x", []);
        assert_eq!(
            texts(&axis.clone().from_to(1.0, 1000.0)),
            ["1", "10", "100", "1,000"]
        );
        assert_eq!(
            texts(&axis.clone().from_to(1.0, 12.0)),
            ["1", "2", "5", "10"]
        );
        let axis = Axis::linear("x", []);
        assert_eq!(
            texts(&axis.from_to(0.0, 10.0)),
            ["0", "2", "4", "6", "8", "10"]
        );
    }
}
