//! A binary tree of boxes, laid out for packet and single-ray traversal.

use glam::{DVec3, Vec3};
use std::ops::Range;

/// The deepest tree. Traversals keep their stacks in arrays of this length, so a greater limit takes more of the
/// first-level cache. Trees of millions of triangles that crowd at poles, clustered one by one, were 64 to 96 levels
/// deep; a deeper tree is built by halving instead.
pub(crate) const DEPTH_LIMIT: usize = 96;

/// In place of a node's index, marks a leaf; in a count of [`Node`], the bit that marks a leaf.
const LEAF: u32 = u32::MAX;
const LEAF_BIT: u32 = 1 << 31;

/// The most triangles in a tree: counts leave one bit free.
pub(crate) const TRIANGLE_LIMIT: u32 = LEAF_BIT - 1;

/// A subtree: the run of its triangles' primitive indices, and its node unless it is a leaf.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Subtree {
    node: u32,
    /// Its first primitive index.
    pub(crate) first: u32,
    /// How many triangles it has.
    pub(crate) count: u32,
}

impl Subtree {
    /// A leaf of these primitive indices.
    #[inline(always)]
    pub(crate) const fn leaf(first: u32, count: u32) -> Self {
        Self {
            node: LEAF,
            first,
            count,
        }
    }

    /// The subtree below a node, with these primitive indices.
    #[inline(always)]
    pub(crate) fn inner(node: u32, first: u32, count: u32) -> Self {
        Self { node, first, count }
    }

    /// The same subtree with node and primitive indices increased by `by`.
    #[inline(always)]
    pub(crate) fn shifted(self, by: u32) -> Self {
        let node = if self.node == LEAF {
            LEAF
        } else {
            self.node + by
        };
        Self {
            node,
            first: self.first + by,
            ..self
        }
    }

    /// The same triangles as a leaf.
    #[inline(always)]
    pub(crate) fn as_leaf(self) -> Self {
        Self { node: LEAF, ..self }
    }

    /// Its node's index; `None` for a leaf.
    #[inline(always)]
    pub(crate) fn node(self) -> Option<u32> {
        (self.node != LEAF).then_some(self.node)
    }

    /// The primitive indices of its triangles.
    #[inline(always)]
    pub(crate) fn primitives(self) -> Range<u32> {
        self.first..self.first + self.count
    }
}

/// Two boxes in structure-of-arrays order.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct BoxPair {
    /// Lowest coordinates by axis, then by box.
    pub(crate) min: [[f32; 2]; 3],
    /// Highest coordinates by axis, then by box.
    pub(crate) max: [[f32; 2]; 3],
}

impl BoxPair {
    pub(crate) fn of([a, b]: [Box32; 2]) -> Self {
        Self {
            min: [[a.min.x, b.min.x], [a.min.y, b.min.y], [a.min.z, b.min.z]],
            max: [[a.max.x, b.max.x], [a.max.y, b.max.y], [a.max.z, b.max.z]],
        }
    }

    /// One of the boxes.
    pub(crate) fn get(&self, which: usize) -> Box32 {
        let ([x, y, z], [to_x, to_y, to_z]) = (&self.min, &self.max);
        Box32 {
            min: Vec3::new(x[which], y[which], z[which]),
            max: Vec3::new(to_x[which], to_y[which], to_z[which]),
        }
    }
}

/// An inner node: its two children with their boxes, in one cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(crate) struct Node {
    pub(crate) boxes: BoxPair,
    /// The first primitive index of the first child; the second child's follow.
    first: u32,
    /// How many triangles the children have, with [`LEAF_BIT`] for leaves.
    counts: [u32; 2],
    /// The second child's node, or [`LEAF`]. The first child's node is the next one.
    second: u32,
}

impl Node {
    /// A node of these boxes and children. The first child's node must be the next one, and its primitive indices
    /// must end where the second child's begin.
    pub(crate) fn of(boxes: [Box32; 2], [a, b]: [Subtree; 2]) -> Self {
        let count = |child: Subtree| {
            let bit = if child.node == LEAF { LEAF_BIT } else { 0 };
            child.count | bit
        };
        Self {
            boxes: BoxPair::of(boxes),
            first: a.first,
            counts: [count(a), count(b)],
            second: b.node,
        }
    }

    /// The children; `index` is this node's own.
    #[inline(always)]
    pub(crate) fn children(&self, index: u32) -> [Subtree; 2] {
        let [a, b] = self.counts;
        let node = if a & LEAF_BIT == 0 { index + 1 } else { LEAF };
        let first = Subtree::inner(node, self.first, a & !LEAF_BIT);
        let second = Subtree::inner(self.second, first.first + first.count, b & !LEAF_BIT);
        [first, second]
    }
}

/// A box in single precision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Box32 {
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

impl Box32 {
    pub(crate) const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    pub(crate) fn around(corners: &[Vec3; 3]) -> Self {
        let [a, b, c] = *corners;
        Self {
            min: a.min(b).min(c),
            max: a.max(b).max(c),
        }
    }

    pub(crate) fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Its corners with the least and the greatest coordinates, in double precision.
    pub(crate) fn corners(&self) -> [DVec3; 2] {
        [self.min, self.max].map(Vec3::as_dvec3)
    }
}

/// A tree: nodes in depth-first order, so that a first child follows its parent.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) nodes: Vec<Node>,
    /// The whole tree; `None` if it is empty.
    pub(crate) root: Option<Subtree>,
    /// The box around everything.
    pub(crate) bounds: Box32,
}

impl Tree {
    /// A tree of these nodes, below this root and box.
    pub(crate) fn new(nodes: Vec<Node>, (root, bounds): (Subtree, Box32)) -> Self {
        Self {
            nodes,
            root: (root.count > 0).then_some(root),
            bounds,
        }
    }

    pub(crate) fn retained_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
    }
}
