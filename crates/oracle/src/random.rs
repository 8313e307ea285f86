//! Pseudorandom numbers that are the same on every machine and in every run.

use glam::DVec3;

/// A stream of pseudorandom numbers: SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number
/// generators", 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x2545_f491_4f6c_dd1d))
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// An integer below `end`, which must be positive.
    pub fn below(&mut self, end: u32) -> u32 {
        (self.bits() % u64::from(end)) as u32
    }

    /// From `low` (inclusive) to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 * 2f64.powi(-53)
    }

    /// A power of ten between 10^`low` and 10^`high`, uniform in the exponent.
    pub fn decade(&mut self, low: f64, high: f64) -> f64 {
        libm::pow(10.0, self.between(low, high))
    }

    /// A point of the cube [−1, 1]³.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::new(
            self.between(-1.0, 1.0),
            self.between(-1.0, 1.0),
            self.between(-1.0, 1.0),
        )
    }

    /// A uniformly distributed unit vector.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let point = self.in_cube();
            if (0.01..=1.0).contains(&point.length_squared()) {
                return point.normalize();
            }
        }
    }

    /// `point` with each coordinate moved by up to `most` units in the last place of double or single precision,
    /// chosen at random.
    pub fn nudge(&mut self, point: DVec3, most: u32) -> DVec3 {
        let single = self.bits() & 1 == 0;
        let mut coordinate = |x: f64| {
            let steps = i64::from(self.below(2 * most + 1)) - i64::from(most);
            if single {
                let bits = (x as f32).to_bits().wrapping_add_signed(steps as i32);
                let moved = f64::from(f32::from_bits(bits));
                if moved.is_finite() { moved } else { x }
            } else {
                let moved = f64::from_bits(x.to_bits().wrapping_add_signed(steps));
                if moved.is_finite() { moved } else { x }
            }
        };
        DVec3::new(
            coordinate(point.x),
            coordinate(point.y),
            coordinate(point.z),
        )
    }
}
