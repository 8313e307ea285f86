//! The top-level tree: over the objects of a scene; its leaves are the roots of the objects' own trees, or subtrees
//! of them.
//!
//! Split by the surface area heuristic over bins (Wald, "On fast Construction of SAH-based Bounding Volume
//! Hierarchies", 2007). Single-threaded: a window that waits for it must not wait for cores that cast rays.

use super::instances::Opened;
use super::tree::{Box32, BoxPair, Subtree};
use super::treelet::middle;
use glam::DVec3;

/// The deepest top-level tree: one level more than halving needs for two million instances, each with its page of
/// indices.
pub(super) const TOP_DEPTH: usize = 22;

/// Bins along an axis. Fewer give worse splits; with 32, frames of a thousand objects take as long.
const BINS: usize = 16;

/// The least triangle count of a top-level node (a smaller one reports this): too many for traversal to treat the
/// node as a leaf, which it must not, since its triangles are not contiguous.
const MANY: u32 = 1 << 10;

/// A subtree of an object's tree, and the box around it.
pub(super) type Root = (Subtree, Box32);

/// The nodes over some roots, the first at index 0, and the root of all; `None` without roots.
pub(super) fn top_level(roots: &mut [Root]) -> (Vec<Opened>, Option<Root>) {
    let mut nodes = Vec::with_capacity(roots.len());
    let root = build(roots, TOP_DEPTH, &mut nodes);
    (nodes, root)
}

/// Builds at most `levels` levels; halving must not need more.
fn build(roots: &mut [Root], levels: usize, nodes: &mut Vec<Opened>) -> Option<Root> {
    if roots.len() < 2 {
        return roots.first().copied();
    }
    let node = nodes.len();
    nodes.push(Opened::default());
    // Each half must fit below: halving it must not need more levels than are left.
    let below = levels.saturating_sub(1);
    let most = 1usize << below.saturating_sub(1).min(30);
    let count = split(roots).filter(|&count| count.max(roots.len() - count) <= most);
    let count = count.unwrap_or_else(|| halve(roots));
    let (a, b) = roots.split_at_mut(count);
    let (a, around_a) = build(a, below, nodes)?;
    let (b, around_b) = build(b, below, nodes)?;
    nodes[node] = Opened {
        boxes: BoxPair::of([around_a, around_b]),
        children: [a, b],
    };
    let count = a.count.saturating_add(b.count).max(MANY);
    let root = Subtree::inner(node as u32, 0, count);
    Some((root, around_a.union(around_b)))
}

/// The box around the centres of the roots' boxes.
fn span(roots: &[Root]) -> Box32 {
    roots.iter().fold(Box32::EMPTY, |all, (_, around)| {
        let middle = middle(around);
        all.union(Box32 {
            min: middle,
            max: middle,
        })
    })
}

/// Partitions roots by the side of the best plane on which their centres lie; returns how many lie on the first.
/// `None` where no plane separates them.
fn split(roots: &mut [Root]) -> Option<usize> {
    let span = span(roots);
    let (from, size) = (
        span.min.as_dvec3(),
        span.max.as_dvec3() - span.min.as_dvec3(),
    );
    let bin = |axis: usize, around: &Box32| {
        let along = f64::from(middle(around)[axis]) - from[axis];
        ((along / size[axis] * BINS as f64) as usize).min(BINS - 1)
    };
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| size[axis] > 0.0) {
        let mut bins = [(Box32::EMPTY, 0usize); BINS];
        for (_, around) in roots.iter() {
            let (all, count) = &mut bins[bin(axis, around)];
            *all = all.union(*around);
            *count += 1;
        }
        let mut after = [0.0; BINS];
        let (mut all, mut count) = (Box32::EMPTY, 0);
        for first in (1..BINS).rev() {
            all = all.union(bins[first].0);
            count += bins[first].1;
            after[first] = area(&all) * count as f64;
        }
        let (mut all, mut count) = (Box32::EMPTY, 0);
        for first in 1..BINS {
            all = all.union(bins[first - 1].0);
            count += bins[first - 1].1;
            let cost = area(&all) * count as f64 + after[first];
            let is_split = count > 0 && count < roots.len();
            if is_split && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, first));
            }
        }
    }
    let (_, axis, first) = best?;
    // A stable sort keeps the order on each side.
    roots.sort_by_key(|(_, around)| bin(axis, around) >= first);
    Some(roots.partition_point(|(_, around)| bin(axis, around) < first))
}

/// Partitions roots in the middle, along the longest axis of their centres; returns half their number.
fn halve(roots: &mut [Root]) -> usize {
    let span = span(roots);
    let axis = (span.max - span.min).max_position();
    let half = roots.len() / 2;
    roots.select_nth_unstable_by(half, |(first, a), (second, b)| {
        let along = middle(a)[axis].total_cmp(&middle(b)[axis]);
        along.then(first.first.cmp(&second.first))
    });
    half
}

/// Half the surface area of a box; zero for an empty one.
pub(super) fn area(around: &Box32) -> f64 {
    let size = around.max.as_dvec3() - around.min.as_dvec3();
    let DVec3 { x, y, z } = size.max(DVec3::ZERO);
    x * y + y * z + z * x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use glam::Vec3;

    #[test]
    fn each_root_is_there_once_inside_the_boxes_above_it_and_not_deep() {
        let mut random = Random(7);
        let mut anywhere = || random.point().as_vec3();
        let somewhere: Vec<Vec3> = (0..1000).map(|_| anywhere()).collect();
        let crowds = (0..1000).map(|i| Vec3::X * 0.5f32.powi(i % 140));
        let row = (0..300).map(|i| Vec3::X * i as f32);
        let places = [
            Vec::new(),
            vec![Vec3::ONE],
            vec![Vec3::ONE, Vec3::ZERO],
            vec![Vec3::ONE; 70],
            somewhere,
            crowds.collect(),
            row.collect(),
        ];
        for places in places {
            let around = |(i, &place): (usize, &Vec3)| {
                let around = Box32 {
                    min: place - 0.01,
                    max: place + 0.01,
                };
                (Subtree::leaf(i as u32, 1), around)
            };
            let roots: Vec<Root> = places.iter().enumerate().map(around).collect();
            let (nodes, root) = top_level(&mut roots.clone());
            assert_eq!(nodes.len(), roots.len().saturating_sub(1));
            let mut seen = vec![false; roots.len()];
            let mut open = Vec::from_iter(root.map(|(root, around)| (root, around, 1)));
            while let Some((subtree, around, depth)) = open.pop() {
                let Some(node) = subtree.node() else {
                    let inside = &roots[subtree.first as usize].1;
                    assert!(around.min.cmple(inside.min).all());
                    assert!(around.max.cmpge(inside.max).all());
                    assert!(!std::mem::replace(&mut seen[subtree.first as usize], true));
                    continue;
                };
                assert!(depth <= TOP_DEPTH);
                let Opened { boxes, children } = nodes[node as usize];
                for (which, child) in children.into_iter().enumerate() {
                    open.push((child, boxes.get(which), depth + 1));
                }
            }
            assert!(seen.iter().all(|&seen| seen));
        }
    }
}
