/// Which triangles of a mesh lie together: a binary tree over their numbers without its boxes, which follow from the
/// corners.
///
/// [`bvh`](crate::bvh) alone makes and checks it, and makes its tree from it again; here it is kept with its mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct TreeTopology {
    /// The triangles' numbers in the order of the leaves.
    pub(crate) order: Vec<u32>,
    /// The inner nodes, depth first: how many triangles and how many inner nodes the first child has. The second child
    /// has the rest of its parent's. A subtree without inner nodes is a leaf.
    pub(crate) nodes: Vec<[u32; 2]>,
    /// The levels of the tree, leaves included; 0 of an empty one.
    pub(crate) levels: usize,
}
