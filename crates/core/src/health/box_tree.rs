//! A bounding volume hierarchy over triangles, to find pairs whose boxes overlap.

use glam::Vec3;
use rayon::prelude::*;

/// A box, by its lowest and its highest corner.
pub(super) type Box3 = [Vec3; 2];

/// The most triangles in a leaf. Larger leaves test more pairs of boxes; smaller ones visit more nodes, which costs
/// more than testing eight boxes.
const LEAF: usize = 8;

/// A balanced binary tree in heap order: the children of node i are 2i and 2i + 1.
pub(super) struct BoxTree {
    boxes: Vec<Box3>,
    /// Indices of boxes; those of a leaf are contiguous.
    order: Vec<u32>,
    nodes: Vec<Box3>,
    levels: u32,
}

impl BoxTree {
    /// Splits at the median along the longest side, until leaves are small.
    pub(super) fn new(boxes: Vec<Box3>) -> Self {
        let levels = boxes.len().div_ceil(LEAF).next_power_of_two().ilog2();
        let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
        let mut nodes = vec![[Vec3::INFINITY, Vec3::NEG_INFINITY]; 2 << levels];
        // Level by level, the nodes of a level in parallel.
        let mut parts = vec![&mut order[..]];
        for level in 0..=levels {
            let around = &mut nodes[1 << level..2 << level];
            let split = parts
                .into_par_iter()
                .zip(around)
                .flat_map_iter(|(part, node)| {
                    *node = union(part.iter().map(|index| &boxes[*index as usize]));
                    halves(&boxes, part, node)
                });
            parts = split.collect();
        }
        Self {
            boxes,
            order,
            nodes,
            levels,
        }
    }

    /// Calls `found` with each box that overlaps or touches the box `index` and has a greater index.
    pub(super) fn later_overlaps(&self, index: u32, mut found: impl FnMut(u32)) {
        let [min, max] = self.boxes[index as usize];
        let overlaps = |[low, high]: &Box3| low.cmple(max).all() && high.cmpge(min).all();
        let mut stack = vec![(1_usize, 0..self.order.len())];
        while let Some((node, range)) = stack.pop() {
            if !overlaps(&self.nodes[node]) {
                continue;
            }
            if node >> self.levels != 0 {
                let leaf = self.order[range].iter().copied();
                leaf.filter(|other| *other > index && overlaps(&self.boxes[*other as usize]))
                    .for_each(&mut found);
                continue;
            }
            let middle = range.start + range.len() / 2;
            stack.push((2 * node + 1, middle..range.end));
            stack.push((2 * node, range.start..middle));
        }
    }
}

fn union<'b>(boxes: impl Iterator<Item = &'b Box3>) -> Box3 {
    boxes.fold(
        [Vec3::INFINITY, Vec3::NEG_INFINITY],
        |[min, max], [a, b]| [min.min(*a), max.max(*b)],
    )
}

/// Partitions the boxes of a node at the median of their centres along the longest side of the node's box.
fn halves<'o>(boxes: &[Box3], part: &'o mut [u32], [min, max]: &Box3) -> [&'o mut [u32]; 2] {
    let middle = part.len() / 2;
    if middle > 0 {
        // Halved first: the difference of two coordinates may overflow.
        let size = (max * 0.5 - min * 0.5).to_array();
        let longest = (1..3).fold(0, |longest, axis| match size[axis] > size[longest] {
            true => axis,
            false => longest,
        });
        let centre = |index: &u32| {
            let [low, high] = boxes[*index as usize];
            low[longest] * 0.5 + high[longest] * 0.5
        };
        part.select_nth_unstable_by(middle, |a, b| {
            centre(a).total_cmp(&centre(b)).then(a.cmp(b))
        });
    }
    part.split_at_mut(middle).into()
}
