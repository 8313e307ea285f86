/// A binary tree over a mesh's triangles without its boxes, which follow from the corners.
///
/// Only [`bvh`](crate::bvh) makes and checks it, and builds trees from it; it is stored here to stay with its mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct TreeTopology {
    /// The triangles' numbers in leaf order.
    pub(crate) order: Vec<u32>,
    /// The inner nodes, depth first: the numbers of triangles and of inner nodes below the first child. The second
    /// child has the rest of its parent's. A subtree without inner nodes is a leaf.
    pub(crate) nodes: Vec<[u32; 2]>,
    /// The levels of the tree, leaves included; 0 of an empty one.
    pub(crate) levels: usize,
}
