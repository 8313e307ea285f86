//! The sample positions of a pixel, computed independently from the renderer's documentation.

use raycast_core::camera::PixelFilter;
use raycast_core::math;

/// A sample's offset from its pixel's top left corner, and its weight.
pub(crate) type PlacedSample = ((f64, f64), f64);

/// The samples of a pixel, the centre first: the first two dimensions of Sobol's sequence by their generator
/// matrices, scrambled, mapped by the inverse of the filter's integral, and shifted so that their mean is the centre.
pub(crate) fn sample_places(count: u32, filter: PixelFilter) -> Vec<PlacedSample> {
    let on_grid = |at: f64| (at * 16_777_216.0).round_ties_even() / 16_777_216.0;
    let place = |share: f64| on_grid(inverse(filter, share));
    let sample = |(x, y): (f64, f64)| {
        let (x, y) = (place(x), place(y));
        ((x, y), (height(filter, x) * height(filter, y)).signum())
    };
    let mut samples: Vec<PlacedSample> = points(count).into_iter().map(sample).collect();
    let others: f64 = samples[1..].iter().map(|sample| sample.1).sum();
    if count > 2 && others >= 1.0 {
        let mean = |of: fn(&PlacedSample) -> f64| {
            let sum: f64 = samples.iter().map(|it| of(it) * it.1).sum();
            -sum / others
        };
        let (across, down) = (mean(|it| it.0.0), mean(|it| it.0.1));
        let last = filter.radius() - 1.0 / 16_777_216.0;
        let moved =
            |at: f64, by: f64| on_grid((at + by.clamp(-0.5, 0.5)).clamp(-filter.radius(), last));
        for ((x, y), _) in &mut samples[1..] {
            (*x, *y) = (moved(*x, across), moved(*y, down));
        }
    }
    let from_corner = |((x, y), weight)| ((x + 0.5, y + 0.5), weight);
    samples.into_iter().map(from_corner).collect()
}

fn points(count: u32) -> Vec<(f64, f64)> {
    match count {
        0 | 1 => return vec![(0.5, 0.5)],
        2 => return vec![(0.5, 0.5), (0.75, 0.25)],
        _ => {}
    }
    let mut points: Vec<(f64, f64)> = (0..count)
        .map(|index| (first(index), second(index)))
        .collect();
    let mut nearest = 0;
    for (at, point) in points.iter().enumerate() {
        let squared = |(x, y): (f64, f64)| (x - 0.5).powi(2) + (y - 0.5).powi(2);
        if squared(*point) < squared(points[nearest]) {
            nearest = at;
        }
    }
    points[nearest] = points[0];
    points[0] = (0.5, 0.5);
    points
}

/// The radical inverse in base 2, scrambled: the generator matrix is the identity.
fn first(index: u32) -> f64 {
    scrambled(u64::from(index), 0xb9fc_02ec)
}

/// The second dimension's generator matrix is Pascal's triangle modulo 2: digit j of the index contributes to digit i
/// if the binomial coefficient of j over i is odd, which is so where i's bits are a subset of j's (Lucas).
fn second(index: u32) -> f64 {
    let mut digits = 0;
    for i in 0..32_u32 {
        let odd = (0..32_u32).filter(|j| index >> j & 1 == 1 && i & !j == 0);
        digits |= (odd.count() as u64 & 1) << i;
    }
    scrambled(digits, 0xe02c_211e)
}

/// The fraction with these digits, the lowest bit first after the point, after the scrambling hash.
fn scrambled(mut bits: u64, seed: u64) -> f64 {
    const WORD: u64 = 1 << 32;
    bits ^= bits * 0x3d20_adea % WORD;
    bits = (bits + seed) % WORD;
    bits = bits * ((seed / 65_536) | 1) % WORD;
    bits ^= bits * 0x0552_6c56 % WORD;
    bits ^= bits * 0x53a2_2864 % WORD;
    (0..32)
        .map(|i| (bits >> i & 1) as f64 * 0.5_f64.powi(i + 1))
        .sum()
}

/// The filter's function of a distance from the centre.
fn height(filter: PixelFilter, x: f64) -> f64 {
    let x = x.abs();
    match filter {
        PixelFilter::Box => 1.0,
        PixelFilter::Tent => 1.0 - x,
        PixelFilter::Gaussian => math::exp(-2.0 * x * x) - math::exp(-4.5),
        PixelFilter::Mitchell if x < 1.0 => (7.0 * x.powi(3) - 12.0 * x * x + 16.0 / 3.0) / 6.0,
        PixelFilter::Mitchell => -7.0 / 18.0 * (x - 2.0).powi(2) * (x - 8.0 / 7.0),
    }
}

/// The position up to which a fraction of the absolute weight lies: by bisection of its integral over smooth pieces.
fn inverse(filter: PixelFilter, share: f64) -> f64 {
    let knots: &[f64] = match filter {
        PixelFilter::Box => &[0.0, 0.5],
        PixelFilter::Tent => &[0.0, 1.0],
        PixelFilter::Gaussian => &[0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5],
        PixelFilter::Mitchell => &[0.0, 1.0, 8.0 / 7.0, 2.0],
    };
    let before = |x: f64| -> f64 {
        let pieces = knots.windows(2).filter(|piece| piece[0] < x);
        pieces
            .map(|piece| integral(filter, piece[0], piece[1].min(x)))
            .sum()
    };
    let all = before(f64::INFINITY);
    let wanted = (share - 0.5).abs() * 2.0 * all;
    let (mut low, mut high) = (0.0, knots[knots.len() - 1]);
    for _ in 0..60 {
        let middle = low + (high - low) / 2.0;
        if before(middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    if share < 0.5 { -high } else { high }
}

/// Gauss–Legendre quadrature with five points: exact to the ninth degree.
fn integral(filter: PixelFilter, from: f64, to: f64) -> f64 {
    let (near, far) = (
        (5.0 - 2.0 * (10.0_f64 / 7.0).sqrt()).sqrt() / 3.0,
        (5.0 + 2.0 * (10.0_f64 / 7.0).sqrt()).sqrt() / 3.0,
    );
    let inner = (322.0 + 13.0 * 70.0_f64.sqrt()) / 900.0;
    let outer = (322.0 - 13.0 * 70.0_f64.sqrt()) / 900.0;
    let half = (to - from) / 2.0;
    let points = [
        (0.0, 128.0 / 225.0),
        (near, inner),
        (-near, inner),
        (far, outer),
        (-far, outer),
    ];
    let sum: f64 = (points.iter())
        .map(|(at, weight)| weight * height(filter, from + half * (1.0 + at)).abs())
        .sum();
    sum * half
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::camera::SamplePattern;

    #[test]
    fn the_renderers_samples_are_where_they_are_said_to_be() {
        for (name, filter) in PixelFilter::ALL {
            for count in (1..=33).chain([64, 100, 1024]) {
                let pattern = SamplePattern::new(count, filter);
                let actual = pattern.samples().iter();
                let actual: Vec<PlacedSample> = actual
                    .map(|sample| (sample.offset, f64::from(sample.weight)))
                    .collect();
                assert_eq!(sample_places(count, filter), actual, "{name} {count}");
            }
        }
    }
}
