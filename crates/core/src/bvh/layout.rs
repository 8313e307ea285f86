//! Writes the final tree: nodes in depth-first order, triangles in leaf order.

use super::tree::{Box32, DEPTH_LIMIT, Node, Subtree, Tree};
use super::treelet::{Treelets, middle, span};
use crate::num::simd::prefetch;
use obvhs::bvh2::Bvh2;
use rayon::prelude::*;
use std::mem::replace;

/// The most triangles in a leaf. With fewer there are more nodes to store and traverse; with more, rays test more
/// triangles that they miss.
pub(super) const LEAF_LIMIT: usize = 4;

/// The least number of triangles for which [`join`] uses two threads. With fewer, a task costs more than it saves;
/// with a larger limit, threads idle near the leaves.
const PARALLEL: usize = 1 << 12;

/// A list to be filled. Most of the time for a long one goes into new memory, which several threads get sooner.
fn defaults<T: Default + Send>(count: usize) -> Vec<T> {
    let all = (0..count).into_par_iter().with_min_len(PARALLEL);
    all.map(|_| T::default()).collect()
}

/// A tree built by median splits alone. Its depth is logarithmic whatever the boxes.
pub(super) fn halved(boxes: &[Box32], mut order: Vec<u32>) -> (Tree, Vec<u32>) {
    let mut nodes = defaults(halving_nodes(order.len()));
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

/// The size of a subtree.
#[derive(Clone, Copy, Default)]
struct SubtreeSize {
    /// How many inner nodes it has.
    nodes: u32,
    primitives: u32,
    /// Zero for subtrees that are not measured yet.
    levels: u32,
}

impl SubtreeSize {
    /// A treelet's, built by median splits.
    fn of_treelet(primitives: usize) -> Self {
        let leaves = primitives.div_ceil(LEAF_LIMIT);
        Self {
            nodes: halving_nodes(primitives) as u32,
            primitives: primitives as u32,
            levels: 1 + leaves.next_power_of_two().ilog2(),
        }
    }

    /// That of the subtree above two.
    fn above([a, b]: [Self; 2]) -> Self {
        let primitives = a.primitives + b.primitives;
        let is_leaf = primitives as usize <= LEAF_LIMIT;
        Self {
            nodes: if is_leaf { 0 } else { 1 + a.nodes + b.nodes },
            primitives,
            levels: if is_leaf {
                1
            } else {
                1 + a.levels.max(b.levels)
            },
        }
    }
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
        let mut measure = Measure {
            treelets,
            clusters,
            sizes: defaults(clusters.nodes.len()),
            has_parent: vec![false; clusters.nodes.len()],
            seen: vec![false; treelets.len()],
        };
        // Most clusters come after their parents: one pass backwards measures nearly all of them, in less time than two
        // threads take that follow the tree.
        for index in (0..clusters.nodes.len()).rev() {
            measure.one(index)?;
        }
        let all = measure.below(0, 1)?;
        // Since no cluster has two parents and no treelet two clusters, the right number of boxes means that all of them
        // are there.
        let whole = all.primitives as usize == boxes.len() && all.levels as usize <= depth_limit;
        whole.then_some(Self {
            boxes,
            treelets,
            clusters,
            sizes: measure.sizes,
        })
    }

    /// The tree, and the indices of its boxes in leaf order.
    pub(super) fn tree(&self) -> (Tree, Vec<u32>) {
        let all = self.sizes[0];
        let mut nodes = defaults(all.nodes as usize);
        let mut order = vec![0; all.primitives as usize];
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
        // The second child's own children have arrived when its turn comes.
        for child in [first, first + 1] {
            let below = self.clusters.nodes[child].first_index as usize;
            prefetch(&self.clusters.nodes, below);
            prefetch(&self.sizes, below);
        }
        let a = self.sizes[first];
        let (a_nodes, a_primitives) = (a.nodes as usize, a.primitives as usize);
        let count = order.len();
        let (node, below) = nodes.split_at_mut(1);
        let a_start = start.after(1, 0);
        let b_start = a_start.after(a_nodes, a_primitives);
        let (a_nodes, b_nodes) = below.split_at_mut(a_nodes);
        let (a_order, b_order) = order.split_at_mut(a_primitives);
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
            let (a, b) = order.split_at_mut(self.sizes[first].primitives as usize);
            self.gather(first, a);
            self.gather(first + 1, b);
        }
    }
}

/// State of the measuring pass.
struct Measure<'a> {
    treelets: &'a Treelets,
    clusters: &'a Bvh2,
    /// The size of each cluster that is measured.
    sizes: Vec<SubtreeSize>,
    /// Whether a cluster is the child of one that is measured.
    has_parent: Vec<bool>,
    /// Whether a treelet is in a cluster that is measured.
    seen: Vec<bool>,
}

impl Measure<'_> {
    /// Measures a cluster, unless its children are not measured. `None` if it contains a treelet or a child that
    /// another one has.
    fn one(&mut self, index: usize) -> Option<()> {
        let cluster = &self.clusters.nodes[index];
        let first = cluster.first_index as usize;
        if cluster.is_leaf() {
            let treelet = *self.clusters.primitive_indices.get(first)? as usize;
            let is_first = !replace(self.seen.get_mut(treelet)?, true);
            let is_whole = is_first && cluster.prim_count == 1;
            self.sizes[index] =
                is_whole.then(|| SubtreeSize::of_treelet(self.treelets.members(treelet).len()))?;
            return Some(());
        }
        let children = [*self.sizes.get(first)?, *self.sizes.get(first + 1)?];
        if children.iter().all(|child| child.levels > 0) {
            let [a, b] = [first, first + 1].map(|child| replace(&mut self.has_parent[child], true));
            self.sizes[index] = (!a && !b).then(|| SubtreeSize::above(children))?;
        }
        Some(())
    }

    /// The size of a cluster at a depth (the root has 1), measured now where it is not yet. `None` as for `one`, or if
    /// it is too deep.
    fn below(&mut self, index: usize, depth: usize) -> Option<SubtreeSize> {
        // A cluster of at most LEAF_LIMIT triangles becomes one leaf, which removes fewer than LEAF_LIMIT levels.
        if depth > DEPTH_LIMIT + LEAF_LIMIT {
            return None;
        }
        if self.sizes.get(index)?.levels == 0 {
            let first = self.clusters.nodes[index].first_index as usize;
            self.below(first, depth + 1)?;
            self.below(first + 1, depth + 1)?;
            self.one(index)?;
        }
        Some(self.sizes[index])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use obvhs::aabb::Aabb;
    use obvhs::bvh2::node::Bvh2Node;

    fn inner(first: u32) -> Bvh2Node {
        Bvh2Node::new(Aabb::default(), 0, first)
    }

    fn leaf(first: u32) -> Bvh2Node {
        Bvh2Node::new(Aabb::default(), 1, first)
    }

    /// The order of `count` boxes below these clusters, whose leaves are treelets in order; `None` where they are no
    /// tree over all.
    fn order(count: usize, nodes: Vec<Bvh2Node>, depth_limit: usize) -> Option<Vec<u32>> {
        // Equal boxes, which treelets split into eights.
        let boxes = vec![Box32::around(&[Vec3::ZERO, Vec3::X, Vec3::Y]); count];
        let treelets = Treelets::of(&boxes, 8);
        let clusters = Bvh2 {
            nodes,
            primitive_indices: (0..treelets.len() as u32).collect(),
            ..Bvh2::default()
        };
        let layout = Layout::measure(&boxes, &treelets, &clusters, depth_limit)?;
        let (tree, mut order) = layout.tree();
        assert_eq!(tree.nodes.len(), layout.sizes[0].nodes as usize);
        order.sort_unstable();
        Some(order)
    }

    #[test]
    fn clusters_before_their_parents_are_measured() {
        let all = Some((0..24).collect());
        // The last but one has its children before it, and so the first pass leaves it and the root.
        let nodes = vec![inner(3), leaf(0), leaf(1), inner(1), leaf(2)];
        assert_eq!(order(24, nodes.clone(), DEPTH_LIMIT), all);
        // A treelet of eight has two levels below its cluster's.
        assert_eq!(order(24, nodes.clone(), 4), all);
        assert_eq!(order(24, nodes, 3), None);
    }

    #[test]
    fn clusters_that_are_no_tree_over_all_are_refused() {
        let tree = vec![inner(1), inner(3), leaf(2), leaf(0), leaf(1)];
        assert!(order(24, tree.clone(), DEPTH_LIMIT).is_some());
        let with = |index: usize, node| {
            let mut nodes = tree.clone();
            nodes[index] = node;
            nodes
        };
        let treelet_twice = with(2, leaf(1));
        let children_shared = with(2, inner(3));
        let own_child = with(1, inner(1));
        let missing = with(1, inner(7));
        let without_some = with(0, inner(3));
        for nodes in [
            treelet_twice,
            children_shared,
            own_child,
            missing,
            without_some,
        ] {
            assert_eq!(order(24, nodes.clone(), DEPTH_LIMIT), None, "{nodes:?}");
        }
        // As many boxes as there are, but one treelet below two clusters, and another below none.
        let second_is_first = vec![inner(1), inner(3), inner(4), leaf(0), leaf(1), leaf(2)];
        assert_eq!(order(32, second_is_first, DEPTH_LIMIT), None);
    }

    #[test]
    fn chains_that_are_too_deep_are_refused() {
        // Each inner cluster's second child is the next one.
        let chain = |levels: u32| {
            let pairs = (0..levels).flat_map(|level| [leaf(level), inner(2 * level + 3)]);
            let last = [leaf(levels), leaf(levels + 1)];
            std::iter::once(inner(1)).chain(pairs).chain(last).collect()
        };
        let is_some = |levels: u32| {
            let count = 8 * (levels as usize + 2);
            order(count, chain(levels), DEPTH_LIMIT).is_some()
        };
        assert!(is_some(90) && !is_some(100) && !is_some(1000));
    }
}
