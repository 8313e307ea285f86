//! A tree of bounding balls over triangles, so that a ray need not be tested against each of them.

use crate::Triangle;
use crate::filter::{Filter, HALF_ULP, TINY};
use glam::DVec3;
use std::ops::Range;

/// The most triangles in a leaf.
const LEAF_SIZE: usize = 8;

/// A ball around the exact corners of neighbouring triangles.
#[derive(Clone, Debug)]
struct Ball {
    center: DVec3,
    radius: f64,
    /// The triangles in it, if it is a leaf.
    triangles: Range<u32>,
    /// The index of the first ball after its descendants.
    next: u32,
}

/// All balls in depth-first order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree(Vec<Ball>);

impl Tree {
    /// Sorts the triangles, all finite, into leaf order.
    pub(crate) fn new(triangles: &mut [Triangle]) -> Self {
        let mut tree = Self::default();
        tree.split(triangles, 0);
        tree
    }

    fn split(&mut self, triangles: &mut [Triangle], first: u32) {
        if triangles.is_empty() {
            return;
        }
        let centroid = |triangle: &Triangle| triangle.rounded().iter().sum::<DVec3>() / 3.0;
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for triangle in triangles.iter() {
            low = low.min(centroid(triangle));
            high = high.max(centroid(triangle));
        }
        let center = (low + high) * 0.5;
        let number = self.0.len();
        let is_split = triangles.len() > LEAF_SIZE;
        self.0.push(Ball {
            center,
            radius: radius(triangles, center),
            triangles: first..if is_split {
                first
            } else {
                first + triangles.len() as u32
            },
            next: 0,
        });
        if is_split {
            let axis = (high - low).max_position();
            let middle = triangles.len() / 2;
            triangles.select_nth_unstable_by(middle, |a, b| {
                centroid(a)[axis].total_cmp(&centroid(b)[axis])
            });
            let (left, right) = triangles.split_at_mut(middle);
            self.split(left, first);
            self.split(right, first + middle as u32);
        }
        self.0[number].next = self.0.len() as u32;
    }

    /// Calls `visit` with the triangles of every ball that the ray may touch.
    pub(crate) fn visit(&self, filter: &Filter, mut visit: impl FnMut(Range<usize>)) {
        let mut at = 0;
        while let Some(ball) = self.0.get(at) {
            if filter.misses_ball(ball.center, ball.radius) {
                at = ball.next as usize;
                continue;
            }
            if !ball.triangles.is_empty() {
                visit(ball.triangles.start as usize..ball.triangles.end as usize);
            }
            at += 1;
        }
    }
}

/// An upper bound of the distance from `center` to the triangles' exact corners.
///
/// Each coordinate of a rounded corner is within half an ulp of the exact one, its distance from the centre is
/// rounded once more, and the length four times: fewer than 16 half-ulps of coordinates and distances together.
fn radius(triangles: &[Triangle], center: DVec3) -> f64 {
    let mut radius: f64 = 0.0;
    for corner in triangles.iter().flat_map(Triangle::rounded) {
        let away = (corner - center).abs();
        let size = corner.abs().element_sum() + center.abs().element_sum();
        let slack = 16.0 * HALF_ULP * (away.element_sum() + size);
        radius = radius.max(away.length() + slack);
    }
    radius + TINY
}
