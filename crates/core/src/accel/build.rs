//! Placing triangles in the world, and building the tree with obvhs.

use super::tree::{Box32, DEPTH_LIMIT, Node, Subtree, TRIANGLE_LIMIT, Tree};
use super::{Accel, Simd, Triangle};
use crate::scene::{COORDINATE_LIMIT, Scene, SceneError};
use glam::{DAffine3, DVec3, Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

/// The most triangles in a leaf, except where boxes coincide.
const LEAF_LIMIT: u32 = 4;

/// Boxes from which on the tree is left as it was clustered. Reinsertion takes a fifth of the build
/// there, for a few hundredths of a frame.
const REINSERTION_LIMIT: usize = 500_000;

pub(super) fn build(scene: &Scene) -> Result<Accel, SceneError> {
    let transforms = scene.world_from_objects()?;
    let first_numbers = number(scene)?;
    let origin = common_origin(scene, &transforms);
    let (triangles, out_of_range) = place(scene, &transforms, &first_numbers, origin);
    let boxes: Vec<Box32> = triangles
        .par_iter()
        .map(|t| Box32::around(&t.corners))
        .collect();
    let (tree, order) = build_tree(&boxes);
    let triangles = order
        .into_par_iter()
        .map(|index| triangles[index as usize])
        .collect();
    Ok(Accel {
        origin,
        triangles,
        tree,
        simd: Simd::best(),
        first_numbers,
        out_of_range,
    })
}

/// The first number of each object, and the number after the last.
fn number(scene: &Scene) -> Result<Vec<u32>, SceneError> {
    let limit = TRIANGLE_LIMIT;
    let mut next: u64 = 0;
    let mut first_numbers = vec![0];
    for object in &scene.objects {
        next += object.mesh.triangles().len() as u64;
        first_numbers.push(next.min(limit.into()) as u32);
    }
    if next > limit.into() {
        return Err(SceneError::TooManyTriangles {
            triangles: next,
            limit,
        });
    }
    Ok(first_numbers)
}

/// What all corners are stored relative to: the first object's place if it lies far from zero.
///
/// A mesh at rest keeps its positions as they are when this is its own offset; for others it is as
/// good as any other point nearby.
fn common_origin(scene: &Scene, transforms: &[DAffine3]) -> DVec3 {
    let mut offsets = scene
        .objects
        .iter()
        .zip(transforms)
        .filter(|(object, _)| !object.mesh.kept().is_empty())
        .map(|(object, world_from_object)| {
            let offset = object.mesh.offset();
            if offset == DVec3::ZERO && world_from_object.translation.abs().max_element() < 1e6 {
                DVec3::ZERO
            } else {
                let place = world_from_object.transform_point3(offset);
                // Whole numbers of a coarse grain, so that differences from it stay exact.
                if *world_from_object == DAffine3::IDENTITY {
                    offset
                } else {
                    place.round()
                }
            }
        });
    let first = offsets.next().unwrap_or(DVec3::ZERO);
    // Objects far apart share no good origin but zero itself.
    let shared =
        offsets.all(|offset| (offset - first).abs().max_element() <= first.abs().max_element());
    if shared { first } else { DVec3::ZERO }
}

/// All kept triangles in the world, and how many were moved out of range.
fn place(
    scene: &Scene,
    transforms: &[DAffine3],
    first_numbers: &[u32],
    origin: DVec3,
) -> (Vec<Triangle>, u32) {
    let mut triangles = Vec::with_capacity(scene.objects.iter().map(|o| o.mesh.kept().len()).sum());
    let mut out_of_range = 0;
    for ((object, world_from_object), &first) in
        scene.objects.iter().zip(transforms).zip(first_numbers)
    {
        let mesh = &object.mesh;
        let as_stored = *world_from_object == DAffine3::IDENTITY && mesh.offset() == origin;
        for &triangle in mesh.kept() {
            let Some(corners) = mesh.corners(triangle) else {
                continue;
            };
            let corners = if as_stored {
                corners
            } else {
                corners.map(|corner| {
                    let in_object = mesh.offset() + corner.as_dvec3();
                    (world_from_object.transform_point3(in_object) - origin).as_vec3()
                })
            };
            let reach = corners
                .iter()
                .fold(Vec3::ZERO, |reach, c| reach.max(c.abs()))
                .max_element();
            let finite = corners.iter().all(|c| c.is_finite());
            // Twice the limit: a mesh at the limit may have been moved off its offset.
            if finite && f64::from(reach) <= 2.0 * COORDINATE_LIMIT {
                triangles.push(Triangle {
                    corners,
                    number: first + triangle,
                });
            } else {
                out_of_range += 1;
            }
        }
    }
    (triangles, out_of_range)
}

/// The tree over the boxes, and their indices in the order of its leaves.
fn build_tree(boxes: &[Box32]) -> (Tree, Vec<u32>) {
    let from_obvhs = if boxes.len() < 2 || has_many_equals(boxes) {
        None
    } else {
        lay_out_obvhs(&build_obvhs(boxes), boxes)
    };
    from_obvhs.unwrap_or_else(|| lay_out_halves(boxes))
}

/// Builds with obvhs: PLOC (Meister and Bittner, "Parallel Locally-Ordered Clustering for Bounding
/// Volume Hierarchy Construction", 2018), then reinsertion (the same, "Parallel Reinsertion for
/// Bounding Volume Hierarchy Optimization", 2018).
///
/// The builder computes areas in single precision: the boxes it sees are brought into the unit cube
/// first. It decides the tree's shape alone, so their rounding changes no answer.
fn build_obvhs(boxes: &[Box32]) -> Bvh2 {
    let all = boxes.iter().copied().fold(Box32::EMPTY, Box32::union);
    let size = (all.max.as_dvec3() - all.min.as_dvec3()).max_element();
    let factor = if size > 0.0 { 1.0 / size } else { 1.0 };
    let offset = all.min.as_dvec3();
    let unit = |v: Vec3| Vec3A::from(((v.as_dvec3() - offset) * factor).as_vec3());
    let aabbs: Vec<Aabb> = boxes
        .par_iter()
        .map(|b| Aabb::new(unit(b.min), unit(b.max)))
        .collect();
    let indices = (0..boxes.len() as u32).collect();
    let mut bvh = PlocBuilder::with_capacity(aabbs.len()).build(
        PlocSearchDistance::Low,
        &aabbs,
        indices,
        SortPrecision::U64,
        2,
    );
    if boxes.len() < REINSERTION_LIMIT {
        let mut reinsertion = ReinsertionOptimizer::default();
        reinsertion.run(&mut bvh, 0.02, None);
    }
    collapse(&mut bvh, LEAF_LIMIT, 3.0);
    bvh
}

/// Whether so many boxes coincide that clustering by area would have nothing to go by: it then
/// takes time quadratic in their number. Told from a sample.
fn has_many_equals(boxes: &[Box32]) -> bool {
    let stride = boxes.len().div_ceil(4096);
    let mut sample: Vec<[u32; 6]> = boxes
        .iter()
        .step_by(stride)
        .map(|b| {
            let ([a, b, c], [d, e, f]) = (b.min.to_array(), b.max.to_array());
            [a, b, c, d, e, f].map(f32::to_bits)
        })
        .collect();
    let count = sample.len();
    sample.sort_unstable();
    sample.dedup();
    count > 8 && count - sample.len() > count / 4
}

/// Lays out obvhs's tree depth first. `None` if it is too deep for the traversals, or does not hold
/// every box once.
fn lay_out_obvhs(bvh: &Bvh2, boxes: &[Box32]) -> Option<(Tree, Vec<u32>)> {
    let mut layout = Layout::new(boxes.len());
    let mut seen = vec![false; boxes.len()];
    let mut open = vec![(0, None, 0)];
    while let Some((index, place, depth)) = open.pop() {
        let node: &Bvh2Node = bvh.nodes.get(index as usize)?;
        if depth >= DEPTH_LIMIT {
            return None;
        }
        if node.is_leaf() {
            let first = node.first_index as usize;
            let members = bvh
                .primitive_indices
                .get(first..first + node.prim_count as usize)?;
            for &member in members {
                if std::mem::replace(seen.get_mut(member as usize)?, true) {
                    return None;
                }
            }
            layout.leaf(place, members);
        } else {
            let inner = layout.inner(place);
            open.push((node.first_index + 1, Some((inner, 1)), depth + 1));
            open.push((node.first_index, Some((inner, 0)), depth + 1));
        }
    }
    (layout.order.len() == boxes.len()).then(|| layout.finish(boxes))
}

/// A tree by halving the boxes along the longest axis of their middles: never deep, whatever the
/// boxes are like.
fn lay_out_halves(boxes: &[Box32]) -> (Tree, Vec<u32>) {
    let mut layout = Layout::new(boxes.len());
    let mut indices: Vec<u32> = (0..boxes.len() as u32).collect();
    // Halved, so that no sum leaves the range.
    let middle = |&index: &u32| boxes[index as usize].min * 0.5 + boxes[index as usize].max * 0.5;
    let mut open = if boxes.is_empty() {
        vec![]
    } else {
        vec![(0..boxes.len(), None)]
    };
    while let Some((range, place)) = open.pop() {
        let part = &mut indices[range.clone()];
        if part.len() <= LEAF_LIMIT as usize {
            layout.leaf(place, part);
            continue;
        }
        let span = part.iter().map(middle).fold(Box32::EMPTY, |span, point| {
            span.union(Box32 {
                min: point,
                max: point,
            })
        });
        let axis = (span.max - span.min).max_position();
        let half = part.len() / 2;
        part.select_nth_unstable_by(half, |a, b| {
            middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(b))
        });
        let inner = layout.inner(place);
        let cut = range.start + half;
        open.push((cut..range.end, Some((inner, 1))));
        open.push((range.start..cut, Some((inner, 0))));
    }
    layout.finish(boxes)
}

/// Where a sub-tree hangs: the node's index, and which of its children; `None` for the root.
type Place = Option<(u32, usize)>;

/// A tree as it is laid out, depth first.
struct Layout {
    /// Each node's children; inner ones have no slots yet.
    children: Vec<[Subtree; 2]>,
    root: Option<Subtree>,
    order: Vec<u32>,
}

impl Layout {
    fn new(boxes: usize) -> Self {
        Self {
            children: Vec::new(),
            root: None,
            order: Vec::with_capacity(boxes),
        }
    }

    fn attach(&mut self, place: Place, subtree: Subtree) {
        match place {
            None => self.root = Some(subtree),
            Some((node, child)) => self.children[node as usize][child] = subtree,
        }
    }

    fn leaf(&mut self, place: Place, members: &[u32]) {
        let first = self.order.len() as u32;
        self.attach(place, Subtree::leaf(first, members.len() as u32));
        self.order.extend_from_slice(members);
    }

    fn inner(&mut self, place: Place) -> u32 {
        let node = self.children.len() as u32;
        self.attach(place, Subtree::inner(node, 0, 0));
        self.children.push([Subtree::default(); 2]);
        node
    }

    /// Makes the boxes from the leaves upwards: the triangles' own, whatever the builder saw.
    fn finish(self, boxes: &[Box32]) -> (Tree, Vec<u32>) {
        let mut nodes = vec![Node::default(); self.children.len()];
        // Each node's slots, and the box around them.
        let mut below = vec![(Subtree::default(), Box32::EMPTY); nodes.len()];
        let known = |subtree: Subtree, below: &[(Subtree, Box32)]| match subtree.node() {
            Some(node) => below[node as usize],
            None => {
                let members = &self.order[subtree.first as usize..][..subtree.count as usize];
                let around = |all: Box32, &index: &u32| all.union(boxes[index as usize]);
                (subtree, members.iter().fold(Box32::EMPTY, around))
            }
        };
        for (index, children) in self.children.iter().enumerate().rev() {
            let [(a, around_a), (b, around_b)] = children.map(|child| known(child, &below));
            nodes[index] = Node::of([around_a, around_b], [a, b]);
            let all = Subtree::inner(index as u32, a.first, a.count + b.count);
            below[index] = (all, around_a.union(around_b));
        }
        let root = self.root.map(|root| known(root, &below));
        let tree = Tree {
            nodes,
            root: root.map(|(root, _)| root),
            bounds: root.map_or(Box32::EMPTY, |(_, bounds)| bounds),
        };
        (tree, self.order)
    }
}
