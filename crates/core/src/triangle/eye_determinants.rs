//! What the determinants of rays from one eye share, rounded to double precision.

use super::componentwise::{Determinant, Determinants, Factor};
use super::exact::{OffsetTriangle, crosses_from};
use super::wide_determinants::WideDeterminants;
use super::wide_vectors::WideCross;
use crate::num::roundoff::EPSILON;
use glam::DVec3;

/// A cross product of two corners relative to an eye, computed in double-double arithmetic and rounded: the product
/// with a ray's direction is one of its weights.
///
/// With p the sum of a component's products' magnitudes, the component is off by 16ε²p (see [`WideDeterminants`]: twice
/// 3.1ε² for the factors, 5ε² for their product, and 3.1ε² for the difference of two) and by ε of itself from rounding.
/// The three products with a direction and their two sums are off by 3ε of the terms' magnitudes.
#[derive(Clone, Copy, Debug)]
struct EyeCross {
    value: DVec3,
    /// Of each component, the bound on its error and on the roundings of products with it.
    error: DVec3,
}

impl EyeCross {
    fn new(cross: &WideCross) -> Self {
        let (value, off) = cross.rounded();
        Self {
            value,
            error: off + value.abs() * (5.0 * EPSILON),
        }
    }

    /// The error of exact cross products, rounded to within a unit in the last place: 2ε of themselves, 3ε from
    /// products with a direction, and one ε for higher orders.
    const ROUNDED: f64 = 6.0 * EPSILON;

    /// Of an exact cross product, rounded.
    fn rounded(value: DVec3) -> Self {
        Self {
            value,
            error: value.abs() * Self::ROUNDED,
        }
    }

    fn weight(&self, direction: DVec3) -> Determinant {
        Determinant {
            value: direction.dot(self.value),
            error: direction.abs().dot(self.error),
        }
    }
}

/// What the determinants of rays from one eye share.
#[derive(Clone, Copy, Debug)]
pub(super) struct EyeDeterminants {
    crosses: [EyeCross; 3],
    numerator: Determinant,
}

impl EyeDeterminants {
    /// `numerator` is that of the eye.
    pub(super) fn new(wide: &WideDeterminants, numerator: Determinant) -> Self {
        let [e, f, g] = &wide.crosses;
        Self {
            crosses: [e, f, g].map(EyeCross::new),
            numerator,
        }
    }

    /// The same from exact cross products, rounded.
    pub(super) fn exact(eye: DVec3, triangle: &OffsetTriangle, numerator: Determinant) -> Self {
        let crosses = crosses_from(eye, triangle).map(EyeCross::rounded);
        Self { crosses, numerator }
    }

    /// Whether every component of the cross products is known as well as an exact one that is rounded.
    pub(super) fn are_accurate(&self) -> bool {
        let is_accurate = |cross: &EyeCross| {
            let most = cross.value.abs() * EyeCross::ROUNDED;
            cross.error.cmple(most).all()
        };
        self.crosses.iter().all(is_accurate)
    }

    /// The determinants of a ray with this direction. `None` where that is out of [range](Factor::in_range).
    pub(super) fn of(&self, direction: DVec3) -> Option<Determinants> {
        let in_range = Factor::exact(direction).in_range().all();
        in_range.then(|| Determinants {
            weights: self.crosses.map(|cross| cross.weight(direction)),
            numerator: self.numerator,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::exact::{cross, decompose, dot, ratio, subtract};
    use crate::num::integer::Integer;
    use crate::random::Random;
    use glam::Vec3;
    use num_bigint::BigInt;

    /// Whole numbers, whose determinants integers of any length hold. Eyes are next to the lines of edges but for
    /// rounding, and directions along their planes. With either share of the error in [`EyeCross`] at zero this fails,
    /// and with that of rounded ones.
    #[test]
    fn weights_from_an_eye_are_within_their_bounds_of_those_in_integers() {
        let whole = |x: f64| {
            let (mantissa, exponent) = decompose(x);
            BigInt::shifted(mantissa, exponent as u32)
        };
        let vector = |v: DVec3| v.to_array().map(whole);
        let mut random = Random(91);
        let mut sure = [0; 3];
        for round in 0..6000 {
            let coordinate =
                |random: &mut Random, unit: f32| (random.signed() * 8e6).round() as f32 * unit;
            let unit = if round % 4 == 3 { 2f32.powi(60) } else { 2e8 };
            let mut corners =
                [(); 3].map(|()| Vec3::from_array([(); 3].map(|()| coordinate(&mut random, unit))));
            if round % 4 == 3 {
                corners[2] = -corners[1];
            }
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let eye = match round % 4 {
                0 => a + (b - a) * (random.signed() * 3.0),
                1 => a + ((b - a) * random.unit() + (c - a) * random.unit()) * 0.5,
                2 => random.point() * 1e15,
                // Next to the line from B through zero to C, by a share of their lengths that only double-double has.
                _ => b * (random.signed() * 2f64.powi(-34)),
            };
            let eye = eye.round();
            let target = a + (b - a) * random.signed() + (c - a) * random.signed();
            let direction = (target - eye).round();
            let triangle = OffsetTriangle {
                corners,
                origin: DVec3::ZERO,
            };
            let numerator = Determinant {
                value: 1.0,
                error: 0.0,
            };
            let wide = WideDeterminants::new(eye, &triangle).expect("in range");
            let shared = EyeDeterminants::new(&wide, numerator);
            let exact = EyeDeterminants::exact(eye, &triangle, numerator);
            assert!(exact.are_accurate());
            let found = [
                wide.of(direction),
                shared.of(direction),
                exact.of(direction),
            ];
            let found = found.map(|found| found.expect("in range"));
            let [a, b, c] = [a, b, c].map(|corner| subtract(&vector(corner), &vector(eye)));
            let direction = vector(direction);
            for (at, (from, to)) in [(&b, &c), (&c, &a), (&a, &b)].into_iter().enumerate() {
                let truth = dot(&direction, &cross(from, to));
                for (found, sure) in found.iter().zip(&mut sure) {
                    let Determinant { value, error } = found.weights[at];
                    let off = ratio(&truth.minus(&whole(value)), &BigInt::shifted(1, 0), 0);
                    assert!(off.abs() <= error, "{off} {error}");
                    *sure += u32::from(value.abs() > error);
                }
            }
        }
        assert!(sure[1] > 10_000 && sure[2] > 9900, "{sure:?}");
        assert!(sure[0] > sure[1], "{sure:?}");
    }
}
