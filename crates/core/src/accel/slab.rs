//! A ray against boxes, never missing one that it touches.
//!
//! After Ize, "Robust BVH Ray Traversal", JCGT 2013: the far end is moved outwards by what rounding
//! may have moved the two ends together.

use super::tree::{Box32, BoxPair};
use crate::intersect::PreparedRay;
use glam::DVec3;

/// Below this share of the longest component a direction is taken to be along the box's faces.
const PARALLEL: f64 = 1.0 / (1 << 24) as f64;

/// How much the far end of a box is moved outwards, as a share of itself.
///
/// With ε = 2⁻²⁴ each end carries three roundings (difference, reciprocal, product): 3ε, and a
/// hair for the reciprocal's second rounding. Near and far together, and the product with this
/// share: 7ε, doubled for good measure since it costs nothing.
const SLACK: f32 = 14.0 / (1 << 24) as f32;

/// How many times as far away as the scene is long a ray's origin is at least, for distances to be measured
/// from a place of the ray that is next to the scene.
const FAR: f64 = 4.0;

/// Half a unit in the last place of 1 in double precision.
const EPSILON: f64 = f64::EPSILON / 2.0;

/// A ray made ready for boxes. Distances along it are measured in advances of its major axis, from its
/// start: its origin or, where that is far away, a place next to the scene, so that single precision is
/// that of the scene's size and not of the distance.
pub(super) struct SlabRay {
    /// No more than the start, by axis.
    low: [f32; 3],
    /// No less than the start, by axis.
    high: [f32; 3],
    /// Advance of the major axis by advance of the axis.
    inverse: [f32; 3],
    /// Where the ray's range begins, rounded down.
    begin: f32,
    /// From the origin to the start.
    skipped: f64,
    /// The major axis's advance by the ray's parameter.
    advance: f64,
}

impl SlabRay {
    /// `bounds` is the box around everything.
    pub(super) fn new(ray: &PreparedRay, bounds: &Box32) -> Self {
        let direction = ray.ray.direction / ray.advance.abs();
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let reach_from = |point: DVec3| {
            let away = (min - point).abs().max((max - point).abs());
            away.max_element()
        };
        let skipped = if reach_from(ray.origin) > FAR * (max - min).max_element() {
            // To the middle of the scene, or as near as the ray comes to it. Any place would do.
            let way = ((min + max) * 0.5 - ray.origin).dot(direction) / direction.length_squared();
            if way.is_finite() { way } else { 0.0 }
        } else {
            0.0
        };
        let start = ray.origin + direction * skipped;
        // The direction is rounded to ε of itself, its components are at most 1, and so is the product:
        // 2ε · |skipped|. The sum takes ε · (|origin| + |skipped|), and adding this to it as much again.
        let start_error = if skipped == 0.0 {
            0.0
        } else {
            4.0 * EPSILON * (skipped.abs() + ray.origin.abs().max_element())
        };
        let reach = reach_from(start);
        let (start, direction) = (start.to_array(), direction.to_array());
        let mut low = [0.0; 3];
        let mut high = [0.0; 3];
        let mut inverse = [0.0; 3];
        for axis in 0..3 {
            let slope = direction[axis];
            // Along its way through the scene a nearly parallel ray moves by less than
            // reach · PARALLEL across the slab. Widening the slab sixteen times that, and looking
            // at it through a great factor, lets it through wherever it might touch: no infinity,
            // and no zero times one.
            let (pad, factor) = if slope.abs() < PARALLEL {
                (reach * PARALLEL * 16.0, (1u64 << 60) as f64)
            } else {
                (0.0, 1.0 / slope)
            };
            // Twice the origin's own error: adding it is rounded by as much as that again.
            let pad = pad + 2.0 * ray.origin_error + start_error;
            low[axis] = round_down(start[axis] - pad);
            high[axis] = round_up(start[axis] + pad);
            inverse[axis] = factor as f32;
        }
        let begin = ray.ray.t_min * ray.advance.abs();
        // A product and a difference are rounded.
        let rounding = 4.0 * EPSILON * (begin.abs() + skipped.abs());
        let begin = round_down(begin - skipped - rounding);
        Self {
            low,
            high,
            inverse,
            begin: begin - begin.abs() * SLACK,
            skipped,
            advance: ray.advance.abs(),
        }
    }

    /// How far along the ray a hit at `t`, give or take `t_error`, can be: never less.
    pub(super) fn limit(&self, t: f64, t_error: f64) -> f32 {
        let limit = (t + t_error) * self.advance;
        let rounding = 4.0 * EPSILON * self.skipped.abs();
        let limit = round_up(limit - self.skipped + rounding);
        limit + limit.abs() * SLACK
    }

    /// Where the ray enters each child's box, and whether it touches it before `limit`.
    #[inline(always)]
    pub(super) fn enter(&self, boxes: &BoxPair, limit: f32) -> [(f32, bool); 2] {
        let mut near = [self.begin; 2];
        let mut far = [f32::INFINITY; 2];
        for axis in 0..3 {
            for child in 0..2 {
                // Against the higher origin the lower face is never too far, and against the lower
                // origin the higher face is never too near, whichever way the ray runs.
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

// `f32::min` also sorts out NaN, which cannot come up here, at the cost of two more instructions.
#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The greatest single not above `x`.
fn round_down(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) > x {
        nearest.next_down()
    } else {
        nearest
    }
}

/// The least single not below `x`.
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
