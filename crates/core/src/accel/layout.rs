//! A tree's layout: its nodes depth first, and the triangles in the order of its leaves.

use super::tree::{Box32, DEPTH_LIMIT, Node, Subtree, Tree};
use super::treelet::{Treelets, middle, span};
use obvhs::bvh2::Bvh2;

/// The most triangles in a leaf.
const LEAF_LIMIT: usize = 4;

/// Triangles that are worth a second thread.
const PARALLEL: usize = 1 << 12;

/// A tree by halving alone: never deep, whatever the boxes are like.
pub(super) fn halved(boxes: &[Box32], mut order: Vec<u32>) -> (Tree, Vec<u32>) {
    let mut nodes = vec![Node::default(); halving_nodes(order.len())];
    let root = halve(boxes, Place::default(), &mut nodes, &mut order);
    (Tree::new(nodes, root), order)
}

/// How many nodes a sub-tree by halving has.
fn halving_nodes(triangles: usize) -> usize {
    if triangles <= LEAF_LIMIT {
        return 0;
    }
    let half = triangles / 2;
    1 + halving_nodes(half) + halving_nodes(triangles - half)
}

/// Where a sub-tree's nodes and slots begin.
#[derive(Clone, Copy, Default)]
struct Place {
    node: usize,
    slot: usize,
}

impl Place {
    /// The same after some more nodes and slots.
    fn after(self, nodes: usize, slots: usize) -> Self {
        Self {
            node: self.node + nodes,
            slot: self.slot + slots,
        }
    }
}

/// A sub-tree by halving boxes along the longest axis of their middles: its nodes, as many as
/// [`halving_nodes`] says, and its indices in the order of its leaves.
fn halve(
    boxes: &[Box32],
    place: Place,
    nodes: &mut [Node],
    indices: &mut [u32],
) -> (Subtree, Box32) {
    let count = indices.len();
    let Some((node, below)) = nodes.split_first_mut().filter(|_| count > LEAF_LIMIT) else {
        let around = |all: Box32, &index: &u32| all.union(boxes[index as usize]);
        let leaf = Subtree::leaf(place.slot as u32, count as u32);
        return (leaf, indices.iter().fold(Box32::EMPTY, around));
    };
    let span = span(boxes, indices);
    let axis = (span.max - span.min).max_position();
    let along = |&index: &u32| middle(&boxes[index as usize])[axis];
    let half = count / 2;
    indices.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
    let (a, b) = indices.split_at_mut(half);
    let (a_nodes, b_nodes) = below.split_at_mut(halving_nodes(half));
    let a_place = place.after(1, 0);
    let b_place = a_place.after(a_nodes.len(), half);
    let children = join(
        count,
        || halve(boxes, a_place, a_nodes, a),
        || halve(boxes, b_place, b_nodes, b),
    );
    inner(node, place, count, children)
}

/// Fills in a node above its children.
fn inner(
    node: &mut Node,
    place: Place,
    count: usize,
    ((a, around_a), (b, around_b)): ((Subtree, Box32), (Subtree, Box32)),
) -> (Subtree, Box32) {
    *node = Node::of([around_a, around_b], [a, b]);
    let subtree = Subtree::inner(place.node as u32, place.slot as u32, count as u32);
    (subtree, around_a.union(around_b))
}

/// Does both, on two threads if `triangles` are worth it.
fn join<A: Send, B: Send>(
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

/// What a sub-tree takes.
#[derive(Clone, Copy, Default)]
struct Size {
    nodes: usize,
    slots: usize,
}

/// obvhs's tree over treelets, about to be laid out.
pub(super) struct Layout<'a> {
    boxes: &'a [Box32],
    treelets: &'a Treelets,
    clusters: &'a Bvh2,
    /// What each cluster takes.
    sizes: Vec<Size>,
}

impl<'a> Layout<'a> {
    /// Measures the tree. `None` if it is too deep for the traversals, or does not hold every treelet
    /// once.
    pub(super) fn measure(
        boxes: &'a [Box32],
        treelets: &'a Treelets,
        clusters: &'a Bvh2,
    ) -> Option<Self> {
        let mut sizes = vec![Size::default(); clusters.nodes.len()];
        let mut from_above = Vec::with_capacity(clusters.nodes.len());
        let mut seen = vec![false; treelets.len()];
        let mut open = vec![(0, 0)];
        while let Some((index, depth)) = open.pop() {
            let cluster = clusters.nodes.get(index as usize)?;
            let mut levels = 1;
            if cluster.is_leaf() {
                let treelet = *clusters
                    .primitive_indices
                    .get(cluster.first_index as usize)?;
                let again = std::mem::replace(seen.get_mut(treelet as usize)?, true);
                if again || cluster.prim_count != 1 {
                    return None;
                }
                let slots = treelets.members(treelet as usize).len();
                levels += slots.div_ceil(LEAF_LIMIT).next_power_of_two().ilog2() as usize;
                let nodes = halving_nodes(slots);
                sizes[index as usize] = Size { nodes, slots };
            } else {
                open.push((cluster.first_index + 1, depth + 1));
                open.push((cluster.first_index, depth + 1));
                from_above.push(index);
            }
            if depth + levels > DEPTH_LIMIT {
                return None;
            }
        }
        for index in from_above.into_iter().rev() {
            let first = clusters.nodes[index as usize].first_index as usize;
            let [a, b] = [sizes[first], sizes[first + 1]];
            let slots = a.slots + b.slots;
            let nodes = if slots <= LEAF_LIMIT {
                0
            } else {
                1 + a.nodes + b.nodes
            };
            sizes[index as usize] = Size { nodes, slots };
        }
        seen.iter().all(|&seen| seen).then_some(Self {
            boxes,
            treelets,
            clusters,
            sizes,
        })
    }

    /// The tree, and the indices of its boxes in the order of its leaves.
    pub(super) fn tree(&self) -> (Tree, Vec<u32>) {
        let Size { nodes, slots } = self.sizes[0];
        let mut nodes = vec![Node::default(); nodes];
        let mut order = vec![0; slots];
        let root = self.lay_out(0, Place::default(), &mut nodes, &mut order);
        (Tree::new(nodes, root), order)
    }

    /// Lays out a cluster: its nodes, and its indices in the order of its leaves.
    fn lay_out(
        &self,
        index: usize,
        place: Place,
        nodes: &mut [Node],
        order: &mut [u32],
    ) -> (Subtree, Box32) {
        let cluster = &self.clusters.nodes[index];
        if cluster.is_leaf() || order.len() <= LEAF_LIMIT {
            self.gather(index, order);
            return halve(self.boxes, place, nodes, order);
        }
        let first = cluster.first_index as usize;
        let a = self.sizes[first];
        let count = order.len();
        let (node, below) = nodes.split_at_mut(1);
        let (a_nodes, b_nodes) = below.split_at_mut(a.nodes);
        let (a_order, b_order) = order.split_at_mut(a.slots);
        let a_place = place.after(1, 0);
        let b_place = a_place.after(a.nodes, a.slots);
        let children = join(
            count,
            || self.lay_out(first, a_place, a_nodes, a_order),
            || self.lay_out(first + 1, b_place, b_nodes, b_order),
        );
        inner(&mut node[0], place, count, children)
    }

    /// The indices of a cluster's boxes.
    fn gather(&self, index: usize, order: &mut [u32]) {
        let cluster = &self.clusters.nodes[index];
        let first = cluster.first_index as usize;
        if cluster.is_leaf() {
            let treelet = self.clusters.primitive_indices[first] as usize;
            order.copy_from_slice(self.treelets.members(treelet));
        } else {
            let (a, b) = order.split_at_mut(self.sizes[first].slots);
            self.gather(first, a);
            self.gather(first + 1, b);
        }
    }
}
