//! Building without clustering, over meshes whose tree topology is known.

use super::flatten::{PlacedObject, World, in_range};
use super::instances::{Instances, Opened};
use super::layout::{LayoutOffset, inner, join};
use super::placement::{BoxPlacement, Placement};
use super::top_level::{Root, TOP_DEPTH, top_level};
use super::tree::{Box32, Node, Subtree, Tree};
use super::{Accel, Triangle};
use crate::num::simd::Simd;
use crate::scene::{Mesh, TreeTopology};
use glam::Vec3;
use rayon::prelude::*;
use std::borrow::Cow;

/// Fills the arrays until the triangles are written.
const EMPTY: Triangle = Triangle {
    corners: [Vec3::ZERO; 3],
    number: 0,
};

/// Builds a tree over a world in which the topology of some visible mesh's tree is known. The trees of those meshes,
/// and one tree over all other meshes, are joined below a top-level tree. `build` builds the tree over a world.
///
/// `None` where no topology is known, the result is too deep, or a corner is placed out of range: a tree would then
/// have to leave triangles out.
pub(super) fn build(
    world: &World<'_>,
    depth_limit: usize,
    build: impl Fn(World<'_>, usize) -> Accel,
) -> Option<Accel> {
    let is_seen = |object: &&PlacedObject<'_>| object.visible && !object.kept.is_empty();
    let seen = || world.objects.iter().filter(is_seen);
    if !seen().any(|object| object.tree.is_some()) {
        return None;
    }
    let numbered = world.objects.iter().zip(&world.first_numbers);
    let known = numbered.filter(|(object, _)| is_seen(object));
    let known = known.filter_map(|(object, &first)| Part::known(object, first));
    let mut parts: Vec<Part<'_>> = known.collect();
    let mut out_of_range = 0;
    if parts.len() < seen().count() {
        let others = build(world.without_known_trees(), depth_limit - TOP_DEPTH);
        out_of_range = others.out_of_range;
        parts.extend(Part::built(&others));
    }
    let levels = parts.iter().map(|part| part.topology.levels).max()?;
    let limit = match parts.len() {
        1 => depth_limit,
        _ => depth_limit - TOP_DEPTH,
    };
    if levels > limit {
        return None;
    }
    let joined = Joined::new(world, parts)?;
    let (tree, triangles) = joined.tree()?;
    Some(Accel {
        origin: world.origin,
        triangles,
        tree,
        instances: Instances::default(),
        simd: Simd::best(),
        first_numbers: world.first_numbers.clone(),
        out_of_range,
        known: None,
    })
}

/// A tree whose corners and boxes are not made yet.
struct Part<'p> {
    topology: Cow<'p, TreeTopology>,
    /// The offset of its triangles' numbers.
    first_number: u32,
    /// Its mesh and placement; `None` where it has several objects.
    mesh: Option<(&'p Mesh, Option<Placement>)>,
    /// Its approximate bounds, which only decide the shape of the top-level tree.
    around: Box32,
}

impl<'p> Part<'p> {
    /// The part of an object; `None` where its mesh's topology is unknown.
    fn known(object: &PlacedObject<'p>, first_number: u32) -> Option<Self> {
        let mesh = object.mesh;
        let (bounds, offset) = (mesh.bounds(), mesh.offset());
        let own = Box32 {
            min: (bounds.min - offset).as_vec3(),
            max: (bounds.max - offset).as_vec3(),
        };
        let placed = |placement| BoxPlacement::new(placement, &own).one(own);
        Some(Self {
            topology: Cow::Borrowed(object.tree?),
            first_number,
            mesh: Some((mesh, object.placement)),
            around: object.placement.as_ref().map_or(own, placed),
        })
    }

    /// The part made of a tree over several objects; `None` if that is empty.
    fn built(accel: &Accel) -> Option<Self> {
        (!accel.is_empty()).then(|| Self {
            topology: Cow::Owned(TreeTopology::of_tree(&accel.tree, &accel.triangles)),
            first_number: 0,
            mesh: None,
            around: accel.tree.bounds,
        })
    }
}

/// Parts below a top-level tree.
struct Joined<'p> {
    world: &'p World<'p>,
    parts: Vec<Part<'p>>,
    /// The top-level nodes; a leaf's first primitive index is its part's index.
    top: Vec<Opened>,
    root: Subtree,
    /// The numbers of inner nodes and triangles below each top-level node.
    sizes: Vec<LayoutOffset>,
}

impl<'p> Joined<'p> {
    /// `None` without parts.
    fn new(world: &'p World<'p>, parts: Vec<Part<'p>>) -> Option<Self> {
        let numbered = parts.iter().zip(0..);
        let mut roots: Vec<Root> = numbered
            .map(|(part, number)| (Subtree::leaf(number, 1), part.around))
            .collect();
        let (top, root) = top_level(&mut roots);
        let mut joined = Self {
            world,
            parts,
            sizes: vec![LayoutOffset::default(); top.len()],
            top,
            root: root?.0,
        };
        // Children have greater indices than their parents.
        for index in (0..joined.top.len()).rev() {
            let [a, b] = joined.top[index].children.map(|child| joined.size(child));
            joined.sizes[index] = a.after(1 + b.node, b.primitive);
        }
        Some(joined)
    }

    fn size(&self, subtree: Subtree) -> LayoutOffset {
        match subtree.node() {
            Some(index) => self.sizes[index as usize],
            None => {
                let TreeTopology { order, nodes, .. } =
                    &*self.parts[subtree.first as usize].topology;
                LayoutOffset::default().after(nodes.len(), order.len())
            }
        }
    }

    /// The tree, and the triangles in leaf order; `None` where one is out of range.
    fn tree(&self) -> Option<(Tree, Vec<Triangle>)> {
        let size = self.size(self.root);
        // In parallel, because the first write to new memory is slow.
        let all = |count: usize| (0..count).into_par_iter();
        let mut nodes: Vec<Node> = all(size.node).map(|_| Node::default()).collect();
        let mut triangles: Vec<Triangle> = all(size.primitive).map(|_| EMPTY).collect();
        let root = self.below(
            self.root,
            LayoutOffset::default(),
            &mut nodes,
            &mut triangles,
        )?;
        Some((Tree::new(nodes, root), triangles))
    }

    /// Lays out a subtree of the top-level tree.
    fn below(
        &self,
        subtree: Subtree,
        start: LayoutOffset,
        nodes: &mut [Node],
        triangles: &mut [Triangle],
    ) -> Option<(Subtree, Box32)> {
        let Some(index) = subtree.node() else {
            let part = &self.parts[subtree.first as usize];
            let TreeTopology {
                order,
                nodes: topology,
                ..
            } = &*part.topology;
            let (first, world) = (part.first_number, self.world);
            let number = |own: u32| first + own;
            return match part.mesh {
                Some((mesh, None)) => {
                    let corners = |own| mesh.corners(own).unwrap_or([Vec3::NAN; 3]);
                    let triangle = |own| (corners(own), number(own));
                    fill((order, topology), &triangle, start, nodes, triangles)
                }
                Some((mesh, Some(placement))) => {
                    let corners = |own| mesh.corners(own).unwrap_or([Vec3::NAN; 3]);
                    let placed = |own| corners(own).map(|corner| placement.corner(corner));
                    let triangle = |own| (placed(own), number(own));
                    fill((order, topology), &triangle, start, nodes, triangles)
                }
                None => {
                    let triangle = |own| (world.triangle(own).corners, own);
                    fill((order, topology), &triangle, start, nodes, triangles)
                }
            };
        };
        let [a, b] = self.top[index as usize].children;
        let size = self.size(a);
        let count = triangles.len();
        let (node, below) = nodes.split_first_mut()?;
        let (a_nodes, b_nodes) = below.split_at_mut(size.node);
        let (a_triangles, b_triangles) = triangles.split_at_mut(size.primitive);
        let a_start = start.after(1, 0);
        let b_start = a_start.after(size.node, size.primitive);
        let (a, b) = join(
            count,
            || self.below(a, a_start, a_nodes, a_triangles),
            || self.below(b, b_start, b_nodes, b_triangles),
        );
        Some(inner(node, start, count, (a?, b?)))
    }
}

/// Lays out a checked topology (order and nodes): its triangles, and its nodes with their boxes. `None` where a
/// triangle is out of range.
fn fill(
    (order, topology): (&[u32], &[[u32; 2]]),
    triangle: &(impl Fn(u32) -> ([Vec3; 3], u32) + Sync),
    start: LayoutOffset,
    nodes: &mut [Node],
    triangles: &mut [Triangle],
) -> Option<(Subtree, Box32)> {
    let count = order.len();
    let Some((&[of_a, below_a], topology)) = topology.split_first() else {
        let mut around = Box32::EMPTY;
        for (to, &own) in triangles.iter_mut().zip(order) {
            let (corners, number) = triangle(own);
            if !in_range(&corners) {
                return None;
            }
            *to = Triangle { corners, number };
            around = around.union(Box32::around(&corners));
        }
        return Some((Subtree::leaf(start.primitive as u32, count as u32), around));
    };
    let (of_a, below_a) = (of_a as usize, below_a as usize);
    let (a_order, b_order) = order.split_at(of_a);
    let (a_topology, b_topology) = topology.split_at(below_a);
    let (node, below) = nodes.split_first_mut()?;
    let (a_nodes, b_nodes) = below.split_at_mut(below_a);
    let (a_triangles, b_triangles) = triangles.split_at_mut(of_a);
    let a_start = start.after(1, 0);
    let b_start = a_start.after(below_a, of_a);
    let a = (a_order, a_topology);
    let b = (b_order, b_topology);
    let (a, b) = join(
        count,
        || fill(a, triangle, a_start, a_nodes, a_triangles),
        || fill(b, triangle, b_start, b_nodes, b_triangles),
    );
    Some(inner(node, start, count, (a?, b?)))
}
