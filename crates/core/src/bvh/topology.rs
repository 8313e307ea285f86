//! Tree topologies: trees without their boxes, as they are kept with a mesh so that the next tree over it needs no
//! clustering.
//!
//! A topology says which triangles lie together, and nothing else. Boxes are recomputed from the placed corners, so
//! that none can be wrong.

use super::Triangle;
use super::duplicates::duplicates;
use super::flatten::World;
use super::layout::LEAF_LIMIT;
use super::tree::{DEPTH_LIMIT, Tree};
use crate::scene::{Mesh, TreeTopology};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Triangles in one parallel task. With fewer, starting a task takes longer than it saves; with more, threads idle.
const CHUNK: usize = 1 << 14;

impl TreeTopology {
    /// The topology of a tree over triangles in leaf order.
    pub(super) fn of_tree(tree: &Tree, triangles: &[Triangle]) -> Self {
        let mut nodes = vec![[0; 2]; tree.nodes.len()];
        let mut levels = 0;
        let mut open = Vec::from_iter(tree.root.map(|root| (root, tree.nodes.len() as u32, 1)));
        while let Some((subtree, count, level)) = open.pop() {
            levels = levels.max(level);
            let Some(index) = subtree.node() else {
                continue;
            };
            let [a, b] = tree.nodes[index as usize].children(index);
            let below = match (a.node(), b.node()) {
                (None, _) => 0,
                (Some(_), None) => count - 1,
                (Some(_), Some(second)) => second - index - 1,
            };
            nodes[index as usize] = [a.count, below];
            open.push((a, below, level + 1));
            open.push((b, count - 1 - below, level + 1));
        }
        Self {
            order: triangles.iter().map(|triangle| triangle.number).collect(),
            nodes,
            levels,
        }
    }

    /// Checks a topology from outside against a mesh: each triangle that rays can hit is in exactly one leaf, leaves
    /// are small, and the tree is not too deep.
    ///
    /// # Errors
    /// What does not hold, in words.
    pub(crate) fn checked(
        mesh: &Mesh,
        order: Vec<u32>,
        nodes: Vec<[u32; 2]>,
    ) -> Result<Self, &'static str> {
        let levels = match order.len() {
            0 if nodes.is_empty() => Some(0),
            count => levels(&nodes, count, 1),
        };
        let Some(levels) = levels else {
            return Err("a node has children that do not fit it, or the tree is too deep");
        };
        check_order(mesh, &order)?;
        Ok(Self {
            order,
            nodes,
            levels,
        })
    }
}

/// The level of the deepest leaf of a subtree whose root is on `level`. `None` where the nodes do not form a tree.
///
/// Each node takes its children's nodes and triangles out of its own: whatever the numbers are, no node is in two
/// subtrees, and none is its own descendant.
fn levels(nodes: &[[u32; 2]], triangles: usize, level: usize) -> Option<usize> {
    let Some((&[count, below], nodes)) = nodes.split_first() else {
        return (1..=LEAF_LIMIT).contains(&triangles).then_some(level);
    };
    let count = count as usize;
    if level >= DEPTH_LIMIT || count == 0 || count >= triangles {
        return None;
    }
    let (a, b) = nodes.split_at_checked(below as usize)?;
    let a = || levels(a, count, level + 1);
    let b = || levels(b, triangles - count, level + 1);
    let (a, b) = if triangles > CHUNK {
        rayon::join(a, b)
    } else {
        (a(), b())
    };
    Some(a?.max(b?))
}

/// Checks that an order contains each of a mesh's kept triangles once, except for duplicates, which no tree has.
fn check_order(mesh: &Mesh, order: &[u32]) -> Result<(), &'static str> {
    let count = mesh.triangles().len();
    let seen: Vec<AtomicU64> = (0..count.div_ceil(64)).map(|_| AtomicU64::new(0)).collect();
    let bit = |number: u32| (&seen[number as usize / 64], 1u64 << (number % 64));
    let is_new = |&number: &u32| {
        (number as usize) < count && {
            let (word, bit) = bit(number);
            word.fetch_or(bit, Ordering::Relaxed) & bit == 0
        }
    };
    if !order.par_iter().with_min_len(CHUNK).all(is_new) {
        return Err("a triangle is in two leaves, or not there");
    }
    let is_absent = |&number: &u32| {
        let (word, bit) = bit(number);
        word.load(Ordering::Relaxed) & bit == 0
    };
    let kept = mesh.kept().par_iter().copied().with_min_len(CHUNK);
    let absent: Vec<u32> = kept.filter(is_absent).collect();
    if absent.len() + order.len() != mesh.kept().len() {
        return Err("a triangle that was dropped is in a leaf");
    }
    if absent.is_empty() {
        return Ok(());
    }
    let world = World::of_mesh(mesh);
    let reachable = world.reachable();
    let places = duplicates(&world, &reachable.numbers, &reachable.hashes);
    let duplicates = places.into_iter().map(|at| reachable.numbers[at as usize]);
    match duplicates.eq(absent) {
        true => Ok(()),
        false => Err("a triangle is in no leaf"),
    }
}
