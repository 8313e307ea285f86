use super::PixelFilter;

/// The seeds of scrambling the two dimensions: of 700 random pairs, the one whose sets of 2 to 64 samples estimate
/// the areas of half planes in a pixel best.
const SCRAMBLES: [u32; 2] = [0xb9fc_02ec, 0xe02c_211e];

/// Offsets are multiples of this fraction of a pixel, 2⁻²⁴, so that adding them to pixel numbers rounds nothing.
const GRID: f64 = 16_777_216.0;

/// The most, in pixels, that samples are shifted to make their mean the pixel's centre. With few samples, one of
/// which has a negative weight, the exact shift may be much larger and would leave the filter.
const MOST_SHIFT: f64 = 0.5;

/// The positions of the samples of a pixel, the same for all pixels, so that every sample is a lattice of rays and is
/// cast in packets.
///
/// The first sample is the pixel's centre. Points of the unit square are the first two dimensions of the Sobol
/// sequence (Sobol 1967), Owen-scrambled (Owen, "Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences", 1995) by
/// hashing (Burley, "Practical Hash-based Owen Scrambling", 2020); the one closest to the square's centre is moved
/// there and comes first. The filter maps points to offsets, and all but the first are shifted alike so that their
/// mean is the pixel's centre: edges in the picture then stay where they are with one sample. With two samples that
/// is impossible: the second sample of a box is a quarter of a pixel from the first in both directions.
///
/// With n samples the error at edges falls about as n^−¾. Scrambling each pixel differently would have the same
/// error, coarser noise at few samples (its FLIP with four is a fifth higher), and no lattices.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplePattern {
    samples: Vec<Sample>,
    has_negative: bool,
}

/// One sample of every pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The offset in pixels from the pixel's top left corner; with a filter wider than a pixel it may lie in another
    /// pixel.
    pub offset: (f64, f64),
    /// 1, or −1 where the filter is negative.
    pub weight: f32,
}

impl SamplePattern {
    /// A pattern of `count` samples a pixel; zero counts as one.
    pub fn new(count: u32, filter: PixelFilter) -> Self {
        let on_grid = |distance: f64| (distance * GRID).round_ties_even() / GRID;
        let mut places: Vec<[f64; 2]> = shares(count.max(1))
            .into_iter()
            .map(|point| point.map(|share| on_grid(filter.place(share))))
            .collect();
        let weight = |place: &[f64; 2]| {
            let [across, down] = place.map(|distance| filter.is_negative(distance));
            if across == down { 1.0 } else { -1.0 }
        };
        let weights: Vec<f32> = places.iter().map(weight).collect();
        let others: f64 = weights
            .iter()
            .skip(1)
            .map(|&weight| f64::from(weight))
            .sum();
        if count > 2 && others >= 1.0 {
            let radius = filter.radius();
            for axis in 0..2 {
                // Multiples of the grid: sums of them are exact.
                let terms = places.iter().zip(&weights);
                let sum: f64 = terms
                    .map(|(place, &weight)| place[axis] * f64::from(weight))
                    .sum();
                let shift = (-sum / others).clamp(-MOST_SHIFT, MOST_SHIFT);
                for place in &mut places[1..] {
                    place[axis] =
                        on_grid((place[axis] + shift).clamp(-radius, radius - 1.0 / GRID));
                }
            }
        }
        let sample = |([x, y], weight): ([f64; 2], f32)| Sample {
            offset: (0.5 + x, 0.5 + y),
            weight,
        };
        Self {
            has_negative: weights.iter().any(|&weight| weight < 0.0),
            samples: places.into_iter().zip(weights).map(sample).collect(),
        }
    }

    /// The samples, the centre first.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// Whether any weight is negative: sums may then leave the range from 0 to 1.
    pub fn has_negative(&self) -> bool {
        self.has_negative
    }

    /// The factor that turns the sum of the first `count` weighted samples into their mean.
    pub fn share(&self, count: usize) -> f32 {
        let sum: f32 = self.samples.iter().take(count).map(|it| it.weight).sum();
        // The weights of a whole pattern sum to at least two fifths of its count; those of its first few may sum to
        // zero.
        1.0 / sum.max(1.0)
    }
}

/// Points of the unit square, the centre first.
fn shares(count: u32) -> Vec<[f64; 2]> {
    const MIDDLE: f64 = 0.5;
    if count == 2 {
        return vec![[MIDDLE; 2], [0.75, 0.25]];
    }
    let mut points: Vec<[f64; 2]> = (0..count).map(point).collect();
    let squared = |[x, y]: [f64; 2]| (x - MIDDLE) * (x - MIDDLE) + (y - MIDDLE) * (y - MIDDLE);
    let nearest =
        (0..points.len()).min_by(|&a, &b| squared(points[a]).total_cmp(&squared(points[b])));
    points.swap(0, nearest.unwrap_or(0));
    points[0] = [MIDDLE; 2];
    points
}

/// A point of the scrambled sequence.
fn point(index: u32) -> [f64; 2] {
    let mut second = 0;
    let mut direction = 1 << 31;
    let mut rest = index;
    while rest != 0 {
        if rest & 1 != 0 {
            second ^= direction;
        }
        direction ^= direction >> 1;
        rest >>= 1;
    }
    let share = |bits: u32, seed: u32| f64::from(scramble(bits, seed)) / 4_294_967_296.0;
    [
        share(index.reverse_bits(), SCRAMBLES[0]),
        share(second, SCRAMBLES[1]),
    ]
}

/// A permutation of binary fractions in which each bit depends on the bits above it only: Laine and Karras,
/// "Stratified Sampling for Stochastic Transparency", 2011, on reversed bits, with the constants that Vegdahl found
/// ("Building a Better LK Hash", 2021).
fn scramble(bits: u32, seed: u32) -> u32 {
    let mut hash = bits.reverse_bits();
    hash ^= hash.wrapping_mul(0x3d20_adea);
    hash = hash.wrapping_add(seed);
    hash = hash.wrapping_mul((seed >> 16) | 1);
    hash ^= hash.wrapping_mul(0x0552_6c56);
    hash ^= hash.wrapping_mul(0x53a2_2864);
    hash.reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_elementary_interval_of_the_sequence_has_its_point() {
        for bits in 0..=8 {
            let count = 1_u32 << bits;
            for columns_bits in 0..=bits {
                let (columns, rows) = (1 << columns_bits, 1 << (bits - columns_bits));
                let mut cells = vec![0; count as usize];
                for [x, y] in (0..count).map(point) {
                    let (column, row) = (
                        (x * f64::from(columns)) as u32,
                        (y * f64::from(rows)) as u32,
                    );
                    cells[(row * columns + column) as usize] += 1;
                }
                assert!(
                    cells.iter().all(|&points| points == 1),
                    "{columns}x{rows}: {cells:?}"
                );
            }
        }
    }

    #[test]
    fn samples_start_at_the_centre_and_have_it_for_their_mean() {
        for (name, filter) in PixelFilter::ALL {
            for count in (1..=130).chain([1000, 4096]) {
                let pattern = SamplePattern::new(count, filter);
                let samples = pattern.samples();
                assert_eq!(samples.len(), count as usize);
                assert_eq!(samples[0].offset, (0.5, 0.5));
                let radius = filter.radius();
                let (mut mean, mut weight) = ((0.0, 0.0), 0.0);
                for Sample {
                    offset: (x, y),
                    weight: w,
                } in samples
                {
                    assert!(
                        (x - 0.5).abs() <= radius && (y - 0.5).abs() <= radius,
                        "{name} {count}"
                    );
                    mean = (
                        mean.0 + (x - 0.5) * f64::from(*w),
                        mean.1 + (y - 0.5) * f64::from(*w),
                    );
                    weight += w;
                }
                assert!(weight >= 0.4 * count as f32, "{name} {count}: {weight}");
                assert_eq!(pattern.share(count as usize), 1.0 / weight);
                let off = mean.0.abs().max(mean.1.abs()) / f64::from(weight);
                // Points that were clamped to the filter move the mean a little.
                let most = match filter {
                    _ if count == 2 => 0.25,
                    PixelFilter::Mitchell if count < 16 => 0.25,
                    PixelFilter::Mitchell => 0.02,
                    _ => 0.003,
                };
                assert!(off < most, "{name} {count}: {off}");
            }
        }
    }
}
