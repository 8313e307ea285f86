//! A binary tree of boxes, laid out for the traversals here.

use glam::Vec3;

/// The deepest that a tree may be: traversals keep their stacks in arrays of this length.
pub(crate) const DEPTH_LIMIT: usize = 64;

/// A sub-tree: an inner node, or a leaf's run of triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Subtree {
    /// The node's index, or the leaf's first slot.
    pub(crate) first: u32,
    /// How many triangles the leaf has; zero for an inner node.
    pub(crate) count: u32,
}

/// An inner node: its two children with their boxes, one cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// Lowest coordinates by axis, then by child.
    pub(crate) min: [[f32; 2]; 3],
    /// Highest coordinates by axis, then by child.
    pub(crate) max: [[f32; 2]; 3],
    /// The children.
    pub(crate) children: [Subtree; 2],
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
}

impl Node {
    /// A node of these boxes and children.
    pub(crate) fn of(boxes: [Box32; 2], children: [Subtree; 2]) -> Self {
        let [a, b] = boxes;
        Self {
            min: [[a.min.x, b.min.x], [a.min.y, b.min.y], [a.min.z, b.min.z]],
            max: [[a.max.x, b.max.x], [a.max.y, b.max.y], [a.max.z, b.max.z]],
            children,
        }
    }

    /// A child's box.
    pub(crate) fn bounds(&self, child: usize) -> Box32 {
        let ([x, y, z], [to_x, to_y, to_z]) = (&self.min, &self.max);
        Box32 {
            min: Vec3::new(x[child], y[child], z[child]),
            max: Vec3::new(to_x[child], to_y[child], to_z[child]),
        }
    }
}

/// The tree: nodes in depth-first order, so that a child follows its parent.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) nodes: Vec<Node>,
    /// The whole tree; `None` if there is nothing in it.
    pub(crate) root: Option<Subtree>,
    /// The box around everything.
    pub(crate) bounds: Box32,
}

impl Tree {
    pub(crate) fn retained_bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>()
    }
}
