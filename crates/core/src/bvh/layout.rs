//! Writes the final tree: nodes in depth-first order, triangles in leaf order.

use super::tree::{Box32, DEPTH_LIMIT, Node, Subtree, Tree};
use super::treelet::{Treelets, middle, span};
use obvhs::bvh2::Bvh2;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// The most triangles in a leaf. With fewer there are more nodes to store and traverse; with more, rays test more
/// triangles that they miss.
pub(super) const LEAF_LIMIT: usize = 4;

/// The least number of triangles for which [`join`] uses two threads. With fewer, a task costs more than it saves;
/// with a larger limit, threads idle near the leaves.
const PARALLEL: usize = 1 << 12;

/// The depth down to which both children are measured in parallel: 2⁸ tasks. With fewer, threads idle; with more,
/// starting a task takes longer than it saves.
const PARALLEL_DEPTH: usize = 8;

/// A tree built by median splits alone. Its depth is logarithmic whatever the boxes.
pub(super) fn halved(boxes: &[Box32], mut order: Vec<u32>) -> (Tree, Vec<u32>) {
    let mut nodes = vec![Node::default(); halving_nodes(order.len())];
    let root = halve(boxes, LayoutOffset::default(), &mut nodes, &mut order);
    (Tree::new(nodes, root), order)
}

/// The number of inner nodes of a subtree built by median splits.
fn halving_nodes(triangles: usize) -> usize {
    if triangles <= LEAF_LIMIT {
        return 0;
    }
    let half = triangles / 2;
    1 + halving_nodes(half) + halving_nodes(triangles - half)
}

/// An offset into the lists of nodes and of primitives: where a subtree begins, or how much of each it takes.
#[derive(Clone, Copy, Default)]
pub(super) struct LayoutOffset {
    pub(super) node: usize,
    pub(super) primitive: usize,
}

impl LayoutOffset {
    /// The same, advanced by a number of nodes and of primitive indices.
    pub(super) fn after(self, nodes: usize, primitives: usize) -> Self {
        Self {
            node: self.node + nodes,
            primitive: self.primitive + primitives,
        }
    }
}

/// Builds a subtree by splitting at the median along the longest axis of the centroids' bounds. Fills `nodes`,
/// which must have the length that [`halving_nodes`] gives, and sorts `indices` into leaf order.
fn halve(
    boxes: &[Box32],
    start: LayoutOffset,
    nodes: &mut [Node],
    indices: &mut [u32],
) -> (Subtree, Box32) {
    let count = indices.len();
    let Some((node, below)) = nodes.split_first_mut().filter(|_| count > LEAF_LIMIT) else {
        let around = |all: Box32, &index: &u32| all.union(boxes[index as usize]);
        let leaf = Subtree::leaf(start.primitive as u32, count as u32);
        return (leaf, indices.iter().fold(Box32::EMPTY, around));
    };
    let span = span(boxes, indices);
    let axis = (span.max - span.min).max_position();
    let along = |&index: &u32| middle(&boxes[index as usize])[axis];
    let half = count / 2;
    indices.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
    let (a, b) = indices.split_at_mut(half);
    let (a_nodes, b_nodes) = below.split_at_mut(halving_nodes(half));
    let a_start = start.after(1, 0);
    let b_start = a_start.after(a_nodes.len(), half);
    let children = join(
        count,
        || halve(boxes, a_start, a_nodes, a),
        || halve(boxes, b_start, b_nodes, b),
    );
    inner(node, start, count, children)
}

/// Writes an inner node above two children.
pub(super) fn inner(
    node: &mut Node,
    start: LayoutOffset,
    count: usize,
    ((a, around_a), (b, around_b)): ((Subtree, Box32), (Subtree, Box32)),
) -> (Subtree, Box32) {
    *node = Node::of([around_a, around_b], [a, b]);
    let subtree = Subtree::inner(start.node as u32, start.primitive as u32, count as u32);
    (subtree, around_a.union(around_b))
}

/// Runs both closures, in parallel for at least [`PARALLEL`] triangles.
pub(super) fn join<A: Send, B: Send>(
    triangles: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if triangles < PARALLEL {
        (a(), b())
    } else {
        rayon::join(a, b)
    }
}

/// The number of nodes and triangles of a subtree.
#[derive(Clone, Copy, Default)]
struct SubtreeSize {
    nodes: usize,
    primitives: usize,
}

/// obvhs's tree over treelets, with the sizes of its subtrees: ready to be written.
pub(super) struct Layout<'a> {
    boxes: &'a [Box32],
    treelets: &'a Treelets,
    clusters: &'a Bvh2,
    /// The size of each cluster, by its index in `clusters`.
    sizes: Vec<SubtreeSize>,
}

impl<'a> Layout<'a> {
    /// Measures the tree. `None` if it has more than `depth_limit` levels, or does not contain every treelet
    /// exactly once.
    pub(super) fn measure(
        boxes: &'a [Box32],
        treelets: &'a Treelets,
        clusters: &'a Bvh2,
        depth_limit: usize,
    ) -> Option<Self> {
        let measure = Measure {
            treelets,
            clusters,
            sizes: (0..clusters.nodes.len()).map(|_| Cell::default()).collect(),
            seen: (0..treelets.len()).map(|_| AtomicBool::default()).collect(),
        };
        let (all, levels) = measure.below(0, 1)?;
        // Since no treelet occurs twice, the right number of boxes means that all of them are there.
        let whole = all.primitives == boxes.len() && levels <= depth_limit;
        whole.then(|| Self {
            boxes,
            treelets,
            clusters,
            sizes: measure.sizes.iter().map(Cell::get).collect(),
        })
    }

    /// The tree, and the indices of its boxes in leaf order.
    pub(super) fn tree(&self) -> (Tree, Vec<u32>) {
        let SubtreeSize { nodes, primitives } = self.sizes[0];
        let mut nodes = vec![Node::default(); nodes];
        let mut order = vec![0; primitives];
        let root = self.lay_out(0, LayoutOffset::default(), &mut nodes, &mut order);
        (Tree::new(nodes, root), order)
    }

    /// Writes the subtree of a cluster: its nodes, and its indices in leaf order.
    fn lay_out(
        &self,
        index: usize,
        start: LayoutOffset,
        nodes: &mut [Node],
        order: &mut [u32],
    ) -> (Subtree, Box32) {
        let cluster = &self.clusters.nodes[index];
        if cluster.is_leaf() || order.len() <= LEAF_LIMIT {
            self.gather(index, order);
            return halve(self.boxes, start, nodes, order);
        }
        let first = cluster.first_index as usize;
        let a = self.sizes[first];
        let count = order.len();
        let (node, below) = nodes.split_at_mut(1);
        let (a_nodes, b_nodes) = below.split_at_mut(a.nodes);
        let (a_order, b_order) = order.split_at_mut(a.primitives);
        let a_start = start.after(1, 0);
        let b_start = a_start.after(a.nodes, a.primitives);
        let children = join(
            count,
            || self.lay_out(first, a_start, a_nodes, a_order),
            || self.lay_out(first + 1, b_start, b_nodes, b_order),
        );
        inner(&mut node[0], start, count, children)
    }

    /// Collects the indices of a cluster's boxes.
    fn gather(&self, index: usize, order: &mut [u32]) {
        let cluster = &self.clusters.nodes[index];
        let first = cluster.first_index as usize;
        if cluster.is_leaf() {
            let treelet = self.clusters.primitive_indices[first] as usize;
            order.copy_from_slice(self.treelets.members(treelet));
        } else {
            let (a, b) = order.split_at_mut(self.sizes[first].primitives);
            self.gather(first, a);
            self.gather(first + 1, b);
        }
    }
}

/// A [`SubtreeSize`] that threads can set through a shared reference.
#[derive(Default)]
struct Cell {
    nodes: AtomicU32,
    primitives: AtomicU32,
}

impl Cell {
    fn set(&self, size: SubtreeSize) {
        self.nodes.store(size.nodes as u32, Ordering::Relaxed);
        self.primitives
            .store(size.primitives as u32, Ordering::Relaxed);
    }

    fn get(&self) -> SubtreeSize {
        SubtreeSize {
            nodes: self.nodes.load(Ordering::Relaxed) as usize,
            primitives: self.primitives.load(Ordering::Relaxed) as usize,
        }
    }
}

/// State of the measuring pass.
struct Measure<'a> {
    treelets: &'a Treelets,
    clusters: &'a Bvh2,
    sizes: Vec<Cell>,
    seen: Vec<AtomicBool>,
}

impl Measure<'_> {
    /// Measures a cluster at a depth (the root has 1): its size and its number of levels. `None` if it is too deep,
    /// or contains a treelet that was seen before.
    fn below(&self, index: usize, depth: usize) -> Option<(SubtreeSize, usize)> {
        // A cluster of at most LEAF_LIMIT triangles becomes one leaf, which removes fewer than LEAF_LIMIT levels.
        if depth > DEPTH_LIMIT + LEAF_LIMIT {
            return None;
        }
        let cluster = self.clusters.nodes.get(index)?;
        let first = cluster.first_index as usize;
        let (size, levels) = if cluster.is_leaf() {
            let treelet = *self.clusters.primitive_indices.get(first)? as usize;
            let again = self.seen.get(treelet)?.swap(true, Ordering::Relaxed);
            if again || cluster.prim_count != 1 {
                return None;
            }
            let primitives = self.treelets.members(treelet).len();
            let nodes = halving_nodes(primitives);
            let halvings = primitives.div_ceil(LEAF_LIMIT).next_power_of_two().ilog2();
            (SubtreeSize { nodes, primitives }, 1 + halvings as usize)
        } else {
            let a = || self.below(first, depth + 1);
            let b = || self.below(first + 1, depth + 1);
            let (a, b) = if depth <= PARALLEL_DEPTH {
                rayon::join(a, b)
            } else {
                (a(), b())
            };
            let ((a, a_levels), (b, b_levels)) = (a?, b?);
            let primitives = a.primitives + b.primitives;
            if primitives <= LEAF_LIMIT {
                (
                    SubtreeSize {
                        nodes: 0,
                        primitives,
                    },
                    1,
                )
            } else {
                let nodes = 1 + a.nodes + b.nodes;
                (
                    SubtreeSize { nodes, primitives },
                    1 + a_levels.max(b_levels),
                )
            }
        };
        self.sizes[index].set(size);
        Some((size, levels))
    }
}
