use super::{Clipped, traversal};
use crate::hit::{Cull, Precision, PrimitiveHit};
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
}

impl OrderedHits {
    /// Finds the hits of a ray that are kept, in exact order; equal distances go by object, then triangle. Ends with
    /// the first hit for which `is_opaque` holds, or with the [`MOST_HITS`]-th.
    pub(crate) fn find(
        &mut self,
        kept: &Clipped<'_>,
        ray: &Ray,
        (cull, precision): (Cull, Precision),
        is_opaque: impl Fn(u32) -> bool,
    ) {
        self.hits.clear();
        let accel = kept.accel;
        let Some(ray) = PreparedRay::new(ray, accel.origin, cull, precision) else {
            return;
        };
        let hits = &mut self.hits;
        let corners = |primitive| accel.corners(primitive);
        let id = |primitive| accel.id(primitive);
        // Whether the last hit hides everything behind it.
        let mut is_closed = false;
        traversal::visit(accel, &ray, |primitives| {
            for primitive in primitives {
                let mut hit = BoundedHit::NONE;
                accel.intersect(&ray, primitive, &mut hit);
                if hit.is_miss() || !kept.keeps(&ray, &hit) {
                    continue;
                }
                let before =
                    |other: &BoundedHit| ray.order(other, &hit, corners, id) == Ordering::Less;
                let place = hits.partition_point(before);
                if place == hits.len() && is_closed {
                    continue;
                }
                hits.insert(place, hit);
                if is_opaque(primitive) {
                    hits.truncate(place + 1);
                    is_closed = true;
                } else if hits.len() > MOST_HITS {
                    hits.truncate(MOST_HITS);
                }
                is_closed |= hits.len() == MOST_HITS;
            }
            match hits.last() {
                Some(last) if is_closed => *last,
                _ => BoundedHit::NONE,
            }
        });
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = PrimitiveHit> + '_ {
        self.hits.iter().map(|hit| hit.to_primitive_hit())
    }
}
