//! Proofs in double precision that a ray misses.

use crate::{Ray, Triangle};
use glam::DVec3;

/// Half the distance from 1 to the next double: the relative error of one rounding.
pub(crate) const HALF_ULP: f64 = f64::EPSILON * 0.5;

/// More than the underflow errors of fewer than 1000 terms, whose factors are below 1e40 where it matters, or of the
/// root of a sum of squares (1e-161); and far less than any distance that a filter should decide.
pub(crate) const TINY: f64 = 1e-150;

/// Beyond this, products of three coordinates could leave the range of double precision, so the filter decides
/// nothing.
const RANGE: f64 = 1e100;

/// A ray, prepared for proofs that it misses.
pub(crate) struct Filter {
    origin: DVec3,
    /// The ray's direction, scaled by a power of two (which changes no hit) so that its largest coordinate is between
    /// 1 and 2.
    direction: DVec3,
}

impl Filter {
    /// The ray must be valid.
    pub(crate) fn new(ray: &Ray) -> Self {
        // In two steps, because 2^1074 is no double.
        let mut direction = ray.direction;
        while direction.abs().max_element() >= 2.0 {
            direction *= if direction.abs().max_element() >= 2f64.powi(100) {
                2f64.powi(-100)
            } else {
                0.5
            };
        }
        while direction.abs().max_element() < 1.0 {
            direction *= if direction.abs().max_element() < 2f64.powi(-100) {
                2f64.powi(100)
            } else {
                2.0
            };
        }
        Self {
            origin: ray.origin,
            direction,
        }
    }

    /// Whether the line along the ray certainly misses the ball.
    ///
    /// The line's distance from the centre is |m × d| / |d|, with m = centre − origin. m is rounded
    /// once. Each coordinate of the product is a difference of two products of at most |m|∞ |d|∞,
    /// |d|∞ ≤ 2: five roundings of less than 4 |m|∞ each, coordinates of m included. Lengths add
    /// four roundings of their own. 64 half-ulps of 4 |m|∞ are more than all of that, three
    /// coordinates together. (A ball behind the ray is not excluded.)
    pub(crate) fn misses_ball(&self, center: DVec3, radius: f64) -> bool {
        let to_center = center - self.origin;
        let size = to_center.abs().max_element();
        let distance = to_center.cross(self.direction).length();
        let reach = radius * self.direction.length();
        let slack = 64.0 * HALF_ULP * (4.0 * size + reach) + TINY;
        size < RANGE && distance > reach + slack
    }

    /// Whether two of the ray's three determinants have certainly opposite signs.
    ///
    /// Let M bound the rounded relative corners' coordinates and P the rounded world corners'. A relative coordinate
    /// is off by at most E = h (P + M), h half an ulp: the sum `base + corner` is rounded once, to a number of at
    /// most P, and the difference from the origin once, to at most M; 2E below allows for the rounding of E and of P
    /// and M themselves. A determinant is six products d·B·C of at most 2 M²; two off coordinates move each by at
    /// most 2 (2 M E + E²), and evaluating it rounds each product twice, and each of its sums (two in the cross
    /// product's difference and the dot product), at most 8 h of 2 M² for each product. In all 6 · 2 · (2 M E + E² +
    /// 8 h M²), doubled again as a margin.
    pub(crate) fn misses_triangle(&self, triangle: &Triangle) -> bool {
        let world = triangle.rounded();
        let [a, b, c] = world.map(|corner| corner - self.origin);
        let largest = |points: [DVec3; 3]| {
            let [a, b, c] = points.map(DVec3::abs);
            a.max(b).max(c).max_element()
        };
        let (p, m) = (largest(world), largest([a, b, c]));
        let e = 2.0 * HALF_ULP * (p + m);
        let bound = 24.0 * (2.0 * m * e + e * e + 8.0 * HALF_ULP * m * m) + TINY;
        let d = self.direction;
        let w = [d.dot(b.cross(c)), d.dot(c.cross(a)), d.dot(a.cross(b))];
        m < RANGE && w.iter().any(|&w| w > bound) && w.iter().any(|&w| w < -bound)
    }
}
