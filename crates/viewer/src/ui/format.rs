//! Numbers for people: groups of thousands, and units by size.

use std::time::Duration;

/// The separator of thousands: a no-break space, so that a number stays on one line.
const GAP: char = '\u{a0}';

/// Groups a number's digits by thousands: `-1234567.25` becomes `-1 234 567.25`.
pub fn group(number: &str) -> String {
    let digits = number.trim_start_matches('-');
    let whole = digits
        .find(|c: char| !c.is_ascii_digit())
        .unwrap_or(digits.len());
    if whole < 5 {
        return number.to_owned();
    }
    let mut grouped = number[..number.len() - digits.len()].to_owned();
    for (index, digit) in digits[..whole].chars().enumerate() {
        if index > 0 && (whole - index).is_multiple_of(3) {
            grouped.push(GAP);
        }
        grouped.push(digit);
    }
    grouped.push_str(&digits[whole..]);
    grouped
}

/// Reads a number as [`group`] writes it, or as people type it.
pub fn parse(text: &str) -> Option<f64> {
    let plain: String = text
        .chars()
        .filter(|c| !c.is_whitespace() && *c != GAP)
        .collect();
    plain.parse().ok().filter(|number: &f64| number.is_finite())
}

/// `1 600 000`.
pub fn count(number: u64) -> String {
    group(&number.to_string())
}

/// `41.3 Mrays/s`.
pub fn rate(rays: u64, time: Duration) -> String {
    let seconds = time.as_secs_f64();
    if seconds <= 0.0 {
        return "–".to_owned();
    }
    let rate = rays as f64 / seconds;
    match rate {
        1e9.. => format!("{} Grays/s", three(rate * 1e-9)),
        1e6.. => format!("{} Mrays/s", three(rate * 1e-6)),
        _ => format!("{} krays/s", three(rate * 1e-3)),
    }
}

/// `850 µs`, `38 ms`, `1.24 s`.
pub fn time(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    match seconds {
        1.0.. => format!("{} s", three(seconds)),
        1e-3.. => format!("{} ms", three(seconds * 1e3)),
        _ => format!("{} µs", three(seconds * 1e6)),
    }
}

/// `12.3 MB`.
pub fn bytes(bytes: usize) -> String {
    let bytes = bytes as f64;
    match bytes {
        1e9.. => format!("{} GB", three(bytes * 1e-9)),
        1e6.. => format!("{} MB", three(bytes * 1e-6)),
        1e3.. => format!("{} kB", three(bytes * 1e-3)),
        _ => format!("{bytes:.0} B"),
    }
}

/// Three significant digits: `1.24`, `38.1`, `412`.
pub fn three(number: f64) -> String {
    match number.abs() {
        99.95.. => group(&format!("{number:.0}")),
        9.995.. => format!("{number:.1}"),
        _ => format!("{number:.2}"),
    }
}

/// A length in scene units: five significant digits, with a power of ten where that is shorter.
pub fn length(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    let magnitude = number.abs().log10().floor();
    if !(-4.0..7.0).contains(&magnitude) {
        return format!("{number:.3e}");
    }
    let decimals = (4.0 - magnitude).clamp(0.0, 8.0) as usize;
    group(&format!("{number:.decimals$}"))
}

/// A coordinate, or 0 where it is below `negligible`, which also takes the sign of a zero.
pub fn coordinate(number: f64, negligible: f64) -> f64 {
    match number.abs() < negligible {
        true => 0.0,
        false => number,
    }
}

/// Coordinates of a point in a scene of this size: with the same decimals, so that they show a hundred-thousandth of the
/// size, and 0 where they show nothing else.
pub fn point(point: [f64; 3], size: f64) -> [String; 3] {
    let magnitude = size.log10().floor();
    if !(-4.0..7.0).contains(&magnitude) {
        return point.map(|number| length(coordinate(number, size * 1e-5)));
    }
    let decimals = (4.0 - magnitude).max(0.0) as usize;
    point.map(|number| {
        let text = fixed(number, decimals);
        match text.contains(|c: char| matches!(c, '1'..='9')) {
            true => group(&text),
            false => "0".to_owned(),
        }
    })
}

/// A number with so many decimals; no minus sign before a number that is displayed as zero.
pub fn fixed(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    let is_zero = !text.contains(|c: char| matches!(c, '1'..='9'));
    match text.strip_prefix('-') {
        Some(rest) if is_zero => rest.to_owned(),
        _ => text,
    }
}

/// A length in less room: four significant digits without trailing zeros.
pub fn short(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    let magnitude = number.abs().log10().floor();
    if !(-3.0..6.0).contains(&magnitude) {
        return format!("{number:.1e}");
    }
    let decimals = (3.0 - magnitude).max(0.0) as usize;
    let text = format!("{number:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(text: &str) -> String {
        text.replace(GAP, " ")
    }

    #[test]
    fn thousands_stand_apart() {
        assert_eq!(plain(&count(1_600_000)), "1 600 000");
        assert_eq!(plain(&count(9999)), "9999");
        assert_eq!(plain(&group("-12345.6789")), "-12 345.6789");
        assert_eq!(plain(&group("1234567")), "1 234 567");
        assert_eq!(group("inf"), "inf");
        assert_eq!(parse(&count(1_600_000)), Some(1_600_000.0));
        assert_eq!(parse("1 0.5"), Some(10.5));
        assert_eq!(parse("nan"), None);
    }

    #[test]
    fn units_follow_size() {
        assert_eq!(rate(1_600_000, Duration::from_millis(40)), "40.0 Mrays/s");
        assert_eq!(rate(1, Duration::ZERO), "–");
        assert_eq!(time(Duration::from_micros(850)), "850 µs");
        assert_eq!(time(Duration::from_micros(38_120)), "38.1 ms");
        assert_eq!(time(Duration::from_millis(1240)), "1.24 s");
        assert_eq!(bytes(12_345_678), "12.3 MB");
    }

    #[test]
    fn what_rounding_leaves_is_zero() {
        let shown = [7.5e-16, -7.5e-16, 2e-9, -0.0].map(|n| length(coordinate(n, 1e-9)));
        assert_eq!(shown, ["0", "0", "2.000e-9", "0"]);
        assert_eq!(
            point([7.5e-16, -0.016_841_4, 12.0], 0.25),
            ["0", "-0.01684", "12.00000"]
        );
        assert_eq!(
            point([-0.004, 0.5, 123_456.0], 5000.0).map(|c| plain(&c)),
            ["0", "0.5", "123 456.0"]
        );
        assert_eq!(point([1e-20, 2e-9, 0.0], 1e-8), ["0", "2.000e-9", "0"]);
        assert_eq!(
            [fixed(-0.01, 1), fixed(-0.06, 1), fixed(0.0, 0)],
            ["0.0", "-0.1", "0"]
        );
    }

    #[test]
    fn lengths_keep_their_digits() {
        assert_eq!(length(0.0021374), "0.0021374");
        assert_eq!(plain(&length(123_456.7)), "123 457");
        assert_eq!(length(1.0), "1.0000");
        assert_eq!(length(1.5e-9), "1.500e-9");
        let texts = [-0.016841, 0.35914, 2.0, -123_456.7, 1.5e-9, 0.0].map(short);
        assert_eq!(texts, ["-0.01684", "0.3591", "2", "-123457", "1.5e-9", "0"]);
    }
}
