use super::{Clipped, traversal};
use crate::hit::{Cull, Precision};
use crate::ray::Ray;
use crate::triangle::{BoundedHit, PreparedRay};
use std::cmp::Ordering;

/// The most hits that are kept of a ray. It bounds time and memory of a ray through any number of triangles; what
/// lies behind 256 layers of which each covers a fortieth contributes less than a part in 600. With fewer, faint
/// layers would be missing; with more, hostile scenes would take longer.
pub(crate) const MOST_HITS: usize = 256;

/// The hits of a ray, nearest first.
#[derive(Debug, Default)]
pub(crate) struct OrderedHits {
    hits: Vec<BoundedHit>,
    /// Whether nothing behind the last hit counts.
    is_closed: bool,
}

impl OrderedHits {
    /// Finds the hits of a ray that are kept, in exact order; equal distances go by object, then triangle. Ends with
    /// the first hit for which `is_opaque` holds, or with the [`MOST_HITS`]-th.
    pub(crate) fn find(
        &mut self,
        kept: &Clipped<'_>,
        ray: &Ray,
        options: (Cull, Precision),
        is_opaque: impl Fn(u32) -> bool,
    ) {
        let Some(ray) = self.begin(kept, ray, options) else {
            return;
        };
        traversal::visit(kept.accel, &kept.clip, &ray, |primitives| {
            self.add(kept, &ray, primitives, &is_opaque);
            match self.hits.last() {
                Some(last) if self.is_closed => *last,
                _ => BoundedHit::NONE,
            }
        });
    }

    /// As [`OrderedHits::find`], among some triangles.
    pub(crate) fn find_among(
        &mut self,
        primitives: impl Iterator<Item = u32>,
        kept: &Clipped<'_>,
        ray: &Ray,
        options: (Cull, Precision),
        is_opaque: impl Fn(u32) -> bool,
    ) {
        if let Some(ray) = self.begin(kept, ray, options) {
            self.add(kept, &ray, primitives, &is_opaque);
        }
    }

    fn begin(
        &mut self,
        kept: &Clipped<'_>,
        ray: &Ray,
        (cull, precision): (Cull, Precision),
    ) -> Option<PreparedRay> {
        self.hits.clear();
        self.is_closed = false;
        kept.accel.prepare(ray, cull, precision)
    }

    /// Inserts the hits with some triangles.
    #[inline(always)]
    fn add(
        &mut self,
        kept: &Clipped<'_>,
        ray: &PreparedRay,
        primitives: impl Iterator<Item = u32>,
        is_opaque: &impl Fn(u32) -> bool,
    ) {
        let Self { hits, is_closed } = self;
        let accel = kept.accel;
        let corners = |primitive| accel.corners(primitive);
        let id = |primitive| accel.id(primitive);
        for primitive in primitives {
            let mut hit = BoundedHit::NONE;
            accel.intersect(ray, primitive, &mut hit);
            if hit.is_miss() || !kept.keeps(ray, &hit) {
                continue;
            }
            let before = |other: &BoundedHit| ray.order(other, &hit, corners, id) == Ordering::Less;
            let place = hits.partition_point(before);
            if place == hits.len() && *is_closed {
                continue;
            }
            hits.insert(place, hit);
            if is_opaque(primitive) {
                hits.truncate(place + 1);
                *is_closed = true;
            } else if hits.len() > MOST_HITS {
                hits.truncate(MOST_HITS);
            }
            *is_closed |= hits.len() == MOST_HITS;
        }
    }

    /// The triangles that are hit.
    pub(crate) fn primitives(&self) -> impl Iterator<Item = u32> + '_ {
        self.hits.iter().map(|hit| hit.primitive)
    }
}
