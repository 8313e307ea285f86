//! A tree of boxes over triangles, to find those whose boxes overlap.

use glam::Vec3;
use rayon::prelude::*;

/// A box, by its lowest and its highest corner.
pub(super) type Box3 = [Vec3; 2];

/// The most triangles of a leaf: a box is tested faster than a tree is descended.
const LEAF: usize = 8;

/// A balanced tree in the order of a heap: the children of node i are 2 i and 2 i + 1.
pub(super) struct BoxTree {
    boxes: Vec<Box3>,
    /// Indices of boxes, those of a leaf beside one another.
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
        // Level by level: the parts of one are split at the same time.
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

    /// Tells of each box that overlaps the one of this index, or touches it, and comes after it.
    pub(super) fn later_overlaps(&self, index: u32, mut tell: impl FnMut(u32)) {
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
                    .for_each(&mut tell);
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

/// A part with the lower half first, by the middles of its boxes along the longest side of the box around them.
fn halves<'o>(boxes: &[Box3], part: &'o mut [u32], [min, max]: &Box3) -> [&'o mut [u32]; 2] {
    let middle = part.len() / 2;
    if middle > 0 {
        // In halves: the difference of two coordinates may be too large a number.
        let size = (max * 0.5 - min * 0.5).to_array();
        let longest = (1..3).fold(0, |longest, axis| match size[axis] > size[longest] {
            true => axis,
            false => longest,
        });
        let place = |index: &u32| {
            let [low, high] = boxes[*index as usize];
            low[longest] * 0.5 + high[longest] * 0.5
        };
        part.select_nth_unstable_by(middle, |a, b| place(a).total_cmp(&place(b)).then(a.cmp(b)));
    }
    part.split_at_mut(middle).into()
}
