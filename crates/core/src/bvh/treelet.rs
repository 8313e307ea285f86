//! Treelets: boxes in small groups of neighbours along a Morton curve.
//!
//! Morton codes, split at their highest differing bits, follow Lauterbach et al., "Fast BVH Construction on GPUs",
//! 2009; such groups below a tree built with more care follow Pantaleoni and Luebke, "HLBVH: Hierarchical LBVH
//! Construction for Real-Time Ray Tracing of Dynamic Geometry", 2010.

use super::tree::Box32;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// The fewest boxes for which two threads are used: with fewer, starting a task takes longer than it saves; with more,
/// threads idle.
const PARALLEL: usize = 1 << 13;

/// An order of boxes in which neighbours are close, split into treelets.
pub(super) struct Treelets {
    /// Indices of boxes, treelet by treelet.
    order: Vec<u32>,
    /// Where in the order each treelet ends.
    ends: Vec<u32>,
}

impl Treelets {
    /// Treelets of at most `limit` boxes, at least 1.
    pub(super) fn of(boxes: &[Box32], limit: usize) -> Self {
        let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
        let counts = cut(boxes, &mut order, limit.max(1));
        let mut end = 0;
        let ends = counts.iter().map(|count| {
            end += count;
            end
        });
        Self {
            ends: ends.collect(),
            order,
        }
    }

    /// How many treelets there are.
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The indices of a treelet's boxes.
    pub(super) fn members(&self, treelet: usize) -> &[u32] {
        &self.order[self.range(treelet)]
    }

    /// The indices of all boxes, in order.
    pub(super) fn order(&self) -> &[u32] {
        &self.order
    }

    fn range(&self, treelet: usize) -> Range<usize> {
        let before = treelet.checked_sub(1);
        before.map_or(0, |before| self.ends[before] as usize)..self.ends[treelet] as usize
    }
}

/// The centre of a box. Halved first, so that the sum does not overflow.
pub(super) fn middle(b: &Box32) -> Vec3 {
    b.min * 0.5 + b.max * 0.5
}

/// The box around the centres of some boxes.
pub(super) fn span(boxes: &[Box32], indices: &[u32]) -> Box32 {
    let point = |&index: &u32| {
        let middle = middle(&boxes[index as usize]);
        Box32 {
            min: middle,
            max: middle,
        }
    };
    indices
        .par_iter()
        .with_min_len(PARALLEL)
        .map(point)
        .reduce(|| Box32::EMPTY, Box32::union)
}

/// Sorts the boxes of these indices along the curve; returns the number of boxes in each treelet.
fn cut(boxes: &[Box32], indices: &mut [u32], limit: usize) -> Vec<u32> {
    let span = span(boxes, indices);
    let size = (span.max.as_dvec3() - span.min.as_dvec3()).max_element();
    if size <= 0.0 {
        // All centres are equal, or there are none.
        let parts = indices.chunks(limit);
        return parts.map(|part| part.len() as u32).collect();
    }
    // A key is a cell of a cubic grid, then the box's index: keys are distinct, and sort to the same order everywhere.
    let index_bits = usize::BITS - boxes.len().leading_zeros();
    let axis_bits = (u64::BITS - index_bits) / 3;
    let cells = f64::from(1u32 << axis_bits);
    let (origin, per_unit) = (span.min.as_dvec3(), cells / size);
    let key = |&index: &u32| {
        let middle = middle(&boxes[index as usize]).as_dvec3();
        let cell = ((middle - origin) * per_unit).min(glam::DVec3::splat(cells - 1.0));
        let cell = cell.as_u64vec3();
        let code = spread(cell.x) << 2 | spread(cell.y) << 1 | spread(cell.z);
        code << index_bits | u64::from(index)
    };
    let keys = indices.par_iter().with_min_len(PARALLEL);
    let mut keys: Vec<u64> = keys.map(key).collect();
    keys.par_sort_unstable();
    let index = |key: u64| (key & ((1 << index_bits) - 1)) as u32;
    let sorted = indices.par_iter_mut().zip(&keys).with_min_len(PARALLEL);
    sorted.for_each(|(to, &key)| *to = index(key));
    let all = KeyRange {
        keys: &keys,
        indices,
    };
    Cutter {
        boxes,
        index_bits,
        limit,
    }
    .cut(all)
}

/// Moves bit i to bit 3i, for the lowest 21 bits.
fn spread(bits: u64) -> u64 {
    let bits = (bits | bits << 32) & 0x001f_0000_0000_ffff;
    let bits = (bits | bits << 16) & 0x001f_0000_ff00_00ff;
    let bits = (bits | bits << 8) & 0x100f_00f0_0f00_f00f;
    let bits = (bits | bits << 4) & 0x10c3_0c30_c30c_30c3;
    (bits | bits << 2) & 0x1249_2492_4924_9249
}

/// Sorted keys, and the indices of their boxes.
struct KeyRange<'p> {
    keys: &'p [u64],
    indices: &'p mut [u32],
}

/// The parameters of splitting, besides the keys.
#[derive(Clone, Copy)]
struct Cutter<'b> {
    boxes: &'b [Box32],
    index_bits: u32,
    limit: usize,
}

impl Cutter<'_> {
    /// Splits at the highest bit in which keys differ, until parts are small enough; returns the number of boxes in
    /// each.
    fn cut(self, part: KeyRange<'_>) -> Vec<u32> {
        if part.keys.len() < PARALLEL {
            let mut counts = Vec::new();
            self.cut_here(part, &mut counts);
            return counts;
        }
        match self.halves(part) {
            Ok([a, b]) => {
                let (mut a, b) = rayon::join(|| self.cut(a), || self.cut(b));
                a.extend(b);
                a
            }
            Err(cell) => cut(self.boxes, cell.indices, self.limit),
        }
    }

    /// As `cut`, on this thread alone.
    fn cut_here(self, part: KeyRange<'_>, counts: &mut Vec<u32>) {
        if part.keys.len() <= self.limit {
            counts.push(part.keys.len() as u32);
            return;
        }
        match self.halves(part) {
            Ok(halves) => halves
                .into_iter()
                .for_each(|half| self.cut_here(half, counts)),
            Err(cell) => counts.extend(cut(self.boxes, cell.indices, self.limit)),
        }
    }

    /// A part's two halves, or the part itself if it lies in one cell of the grid: it then gets a grid of its own.
    fn halves<'p>(self, part: KeyRange<'p>) -> Result<[KeyRange<'p>; 2], KeyRange<'p>> {
        let (Some(first), Some(last)) = (part.keys.first(), part.keys.last()) else {
            return Err(part);
        };
        let bit = (first ^ last).checked_ilog2().unwrap_or(0);
        if bit < self.index_bits {
            return Err(part);
        }
        let upper = last >> bit << bit;
        let (a, b) = part
            .keys
            .split_at(part.keys.partition_point(|&key| key < upper));
        let (a_indices, b_indices) = part.indices.split_at_mut(a.len());
        Ok([(a, a_indices), (b, b_indices)].map(|(keys, indices)| KeyRange { keys, indices }))
    }
}
