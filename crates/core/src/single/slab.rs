//! Slab tests of a ray against boxes that never miss a box that the ray touches.
//!
//! After Ize, "Robust BVH Ray Traversal", JCGT 2013: the far end of the interval is moved outwards by a bound on the
//! rounding error of both ends.

use crate::bvh::tree::{Box32, BoxPair};
use crate::num::double_double::DoubleDouble;
use crate::num::roundoff::EPSILON;
use crate::triangle::PreparedRay;

/// The component of a direction, relative to the longest, below which it counts as parallel to a box's faces. With a
/// greater value slabs are widened by more, and rays enter boxes that they miss; with a lesser one reciprocals
/// overflow.
const PARALLEL: f64 = 1.0 / (1 << 24) as f64;

/// The relative amount by which the far end of a box's interval is moved outwards.
///
/// With u = 2⁻²⁴ each end carries three roundings (difference, reciprocal, product) and the reciprocal's second
/// rounding: 3u to first order. Near and far together, and the product with this factor: 7u, doubled since that costs
/// nothing.
const SLACK: f32 = 14.0 / (1 << 24) as f32;

/// A ray prepared for tests against boxes. Distances are in units of the advance along the major axis, measured from
/// the ray's start.
pub(super) struct SlabRay {
    /// A lower bound of the start's coordinates.
    low: [f32; 3],
    /// An upper bound of the start's coordinates.
    high: [f32; 3],
    /// Advance along the major axis per advance along each axis.
    inverse: [f32; 3],
    /// The start of the ray's range, rounded down.
    begin: f32,
    /// The ray's parameter at the start.
    skipped: DoubleDouble,
    /// Advance along the major axis per unit of the ray's parameter.
    advance: f64,
}

impl SlabRay {
    /// For points of a ray from the parameter `begin` on; `bounds` is the box around everything.
    pub(super) fn new(ray: &PreparedRay, begin: f64, bounds: &Box32) -> Self {
        let direction = ray.ray.direction / ray.advance.abs();
        let [min, max] = bounds.corners();
        let away = (min - ray.start).abs().max((max - ray.start).abs());
        let reach = away.max_element();
        let (start, direction) = (ray.start.to_array(), direction.to_array());
        let mut low = [0.0; 3];
        let mut high = [0.0; 3];
        let mut inverse = [0.0; 3];
        for axis in 0..3 {
            let slope = direction[axis];
            // Within the scene a nearly parallel ray moves by less than reach · PARALLEL across the slab. The slab is
            // widened by sixteen times that, and a large factor replaces the infinite reciprocal so that 0 · ∞ does
            // not occur.
            let (pad, factor) = if slope.abs() < PARALLEL {
                (reach * PARALLEL * 16.0, (1u64 << 60) as f64)
            } else {
                (0.0, 1.0 / slope)
            };
            // Twice the start's own error, because adding it rounds by as much again.
            let pad = pad + 2.0 * ray.start_error;
            low[axis] = round_down(start[axis] - pad);
            high[axis] = round_up(start[axis] + pad);
            inverse[axis] = factor as f32;
        }
        let mut slab = Self {
            low,
            high,
            inverse,
            begin: 0.0,
            skipped: ray.skipped.unwrap_or(DoubleDouble::from(0.0)),
            advance: ray.advance.abs(),
        };
        let begin = round_down(slab.distance(begin, 0.0));
        // The slack of far ends would cover this as well.
        slab.begin = begin - begin.abs() * SLACK;
        slab
    }

    /// The distance from the start of the point at `t`, or no less than that at `t` + `t_error`, within 4ε of itself, which
    /// the slack of far ends covers.
    ///
    /// Both differences are off by ε of themselves: where they cancel, the first is exact (Sterbenz). The sum moves by 2ε of
    /// the difference and by its own rounding: relative to the sum by 3ε, and by 4ε of `t_error`, of which 8ε are added.
    fn distance(&self, t: f64, t_error: f64) -> f64 {
        let way = (t - self.skipped.high) - self.skipped.low;
        (way + t_error * (1.0 + 8.0 * EPSILON)) * self.advance
    }

    /// An upper bound of the distance along the ray of a hit at `t` ± `t_error`.
    pub(super) fn limit(&self, t: f64, t_error: f64) -> f32 {
        let limit = round_up(self.distance(t, t_error));
        limit + limit.abs() * SLACK
    }

    /// For each child, where the ray enters its box, and whether it touches the box before `limit`.
    #[inline(always)]
    pub(super) fn enter(&self, boxes: &BoxPair, limit: f32) -> [(f32, bool); 2] {
        let mut near = [self.begin; 2];
        let mut far = [f32::INFINITY; 2];
        for axis in 0..3 {
            for child in 0..2 {
                // The lower face is tested against the upper bound of the origin, and the upper face against the
                // lower bound, so that errors widen the interval whichever way the ray runs.
                let a = (boxes.min[axis][child] - self.high[axis]) * self.inverse[axis];
                let b = (boxes.max[axis][child] - self.low[axis]) * self.inverse[axis];
                near[child] = max(near[child], min(a, b));
                far[child] = min(far[child], max(a, b));
            }
        }
        std::array::from_fn(|child| {
            let far = far[child] + far[child].abs() * SLACK;
            (near[child], near[child] <= min(far, limit))
        })
    }
}

// `f32::min` would also handle NaN, which cannot occur here, with two more instructions.
#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The greatest f32 not above `x`.
fn round_down(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) > x {
        nearest.next_down()
    } else {
        nearest
    }
}

/// The least f32 not below `x`.
fn round_up(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) < x {
        nearest.next_up()
    } else {
        nearest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hit::{Cull, Precision};
    use crate::random::Random;
    use crate::ray::Ray;
    use glam::{DVec3, Vec3};

    /// From far away, where subtracting the skipped distance cancels nearly all of a distance, and adding t's error what is
    /// left. The truth is double-double arithmetic; without what is added to the error this fails.
    #[test]
    fn ranges_begin_no_later_and_end_no_sooner_than_exact_ones() {
        let mut random = Random(65);
        let bounds = Box32 {
            min: Vec3::NEG_ONE,
            max: Vec3::ONE,
        };
        for _ in 0..20_000 {
            let ray = Ray::new(random.point() * 1e12, random.point());
            let ray = PreparedRay::new(&ray, DVec3::ZERO, Cull::None, Precision::Exact);
            let mut ray = ray.expect("a valid ray").close_to(bounds.corners());
            let skipped = ray.skipped.expect("a far origin");
            let t = skipped.high + random.signed() / ray.advance.abs();
            ray.ray.t_min = t;
            let slab = SlabRay::new(&ray, ray.ray.t_min, &bounds);
            let along = (DoubleDouble::from(t) - skipped) * slab.advance.into();
            let (begin, end) = (slab.begin, slab.limit(t, 0.0));
            assert!(f64::from(begin) <= along.high && f64::from(end) >= along.high);
            let before = skipped.high - random.unit() / ray.advance.abs();
            let way = DoubleDouble::from(before) - skipped;
            let t_error = way.high.abs() * (1.0 + random.signed() * 8.0 * EPSILON);
            let end = (way + t_error.into()) * slab.advance.into();
            assert!(f64::from(slab.limit(before, t_error)) >= end.high);
        }
    }

    #[test]
    fn rounds_outwards() {
        for x in [
            0.0,
            0.1,
            -0.1,
            1e30,
            -1e30,
            1e300,
            -1e300,
            1e-60,
            -1e-60,
            1.0 + 1e-12,
        ] {
            assert!(
                f64::from(round_down(x)) <= x && f64::from(round_up(x)) >= x,
                "{x}"
            );
        }
        assert_eq!((round_down(0.5), round_up(0.5)), (0.5, 0.5));
    }
}
