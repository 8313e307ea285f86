//! Depth-first traversal of one ray.

use super::slab::SlabRay;
use crate::bvh::Accel;
use crate::bvh::tree::{DEPTH_LIMIT, Subtree};
use crate::triangle::clip::Clip;
use crate::triangle::{BoundedHit, PreparedRay};

/// The closest hit whose point `clip` keeps.
pub(crate) fn nearest(accel: &Accel, clip: &Clip, ray: &PreparedRay) -> BoundedHit {
    let mut nearest = BoundedHit::NONE;
    visit(accel, clip, ray, |primitives| {
        for primitive in primitives {
            accel.intersect_kept(clip, ray, primitive, &mut nearest);
        }
        nearest
    });
    nearest
}

/// Calls `leaf` with the primitives of each leaf that the ray may hit where `clip` keeps its points, front to back;
/// skips boxes beyond the hit that it returns.
#[inline(always)]
pub(super) fn visit(
    accel: &Accel,
    clip: &Clip,
    ray: &PreparedRay,
    mut leaf: impl FnMut(std::ops::Range<u32>) -> BoundedHit,
) {
    let tree = &accel.tree;
    let Some(mut subtree) = tree.root else {
        return;
    };
    let [begin, end] = clip.range_along(&ray.ray);
    let slab = SlabRay::new(ray, begin, &tree.bounds);
    let mut limit = slab.limit(end, 0.0);
    let mut stack = [(Subtree::default(), 0.0f32); DEPTH_LIMIT];
    let mut depth = 0;
    loop {
        if let Some(index) = subtree.node() {
            let mut opened = None;
            let (boxes, [a, b]) = accel.open_any(index, &mut opened);
            let [(near_a, hits_a), (near_b, hits_b)] = slab.enter(boxes, limit);
            match (hits_a, hits_b) {
                (true, true) => {
                    let (first, second) = if near_b < near_a {
                        ((b, near_b), (a, near_a))
                    } else {
                        ((a, near_a), (b, near_b))
                    };
                    stack[depth] = second;
                    depth += 1;
                    subtree = first.0;
                    continue;
                }
                (true, false) => {
                    subtree = a;
                    continue;
                }
                (false, true) => {
                    subtree = b;
                    continue;
                }
                (false, false) => {}
            }
        } else {
            let nearest = leaf(subtree.primitives());
            if !nearest.is_miss() {
                limit = slab.limit(nearest.t, nearest.t_error);
            }
        }
        // A box that begins beyond the limit contains nothing nearer; one that begins at it may contain a tie.
        loop {
            if depth == 0 {
                return;
            }
            depth -= 1;
            let (next, near) = stack[depth];
            if near <= limit {
                subtree = next;
                break;
            }
        }
    }
}
