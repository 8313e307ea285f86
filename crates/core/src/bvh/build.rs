//! Building one tree over all triangles: treelets, and obvhs's clustering above them.

use super::Accel;
use super::duplicates::duplicates;
use super::flatten::{Reachable, World};
use super::instances::Instances;
use super::joined;
use super::layout::{Layout, halved};
use super::rounds;
use super::tree::{Box32, DEPTH_LIMIT, Tree};
use super::treelet::Treelets;
use crate::num::simd::Simd;
use crate::scene::{Mesh, Scene, SceneError, TreeTopology};
use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

/// The most triangles in a treelet. Clustering every triangle by itself (1) takes three times as long to build.
/// Frames of a million triangles take equally long from 1 to 16; with 16, single rays take a tenth longer.
const TREELET_LIMIT: usize = 8;

/// The number of triangles for each one that a treelet may have, up to [`TREELET_LIMIT`]: below twice this number every
/// triangle is clustered by itself, since building is fast anyway.
const FEW_TREELETS: usize = 1 << 14;

pub(super) fn build(scene: &Scene) -> Result<Accel, SceneError> {
    Ok(build_world(World::of(scene)?, DEPTH_LIMIT))
}

impl TreeTopology {
    /// The topology of a tree built over a mesh alone.
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let accel = build_world(World::of_mesh(mesh), DEPTH_LIMIT);
        Self::of_tree(&accel.tree, &accel.triangles)
    }
}

/// Builds a tree over all visible objects of a world, of at most `depth_limit` levels.
pub(super) fn build_world(world: World<'_>, depth_limit: usize) -> Accel {
    if let Some(accel) = joined::build(&world, depth_limit, build_world) {
        return accel;
    }
    let Reachable {
        mut numbers,
        mut boxes,
        hashes,
        out_of_range,
    } = world.reachable();
    let duplicates = duplicates(&world, &numbers, &hashes);
    drop(hashes);
    if !duplicates.is_empty() {
        remove(&mut numbers, &duplicates);
        remove(&mut boxes, &duplicates);
    }
    let (tree, order) = build_tree(&boxes, depth_limit);
    drop(boxes);
    // Corners are placed a second time: that takes less time and memory than keeping them unsorted.
    let triangles = order.par_iter();
    let triangles = triangles.map(|&index| world.triangle(numbers[index as usize]));
    Accel {
        origin: world.origin,
        triangles: triangles.collect(),
        tree,
        instances: Instances::default(),
        simd: Simd::best(),
        first_numbers: world.first_numbers,
        out_of_range,
        known: None,
    }
}

/// Removes the items at some indices, which ascend.
fn remove<T>(all: &mut Vec<T>, indices: &[u32]) {
    let mut indices = indices.iter().copied().peekable();
    let mut place = 0;
    all.retain(|_| {
        let is_removed = indices.next_if_eq(&place).is_some();
        place += 1;
        !is_removed
    });
}

/// A tree of at most `depth_limit` levels over the boxes, and the boxes' indices in leaf order.
fn build_tree(boxes: &[Box32], depth_limit: usize) -> (Tree, Vec<u32>) {
    let limit = (boxes.len() / FEW_TREELETS).min(TREELET_LIMIT);
    let treelets = Treelets::of(boxes, limit);
    let around = |treelet| {
        let members = treelets.members(treelet).iter();
        members.fold(Box32::EMPTY, |all, &index| all.union(boxes[index as usize]))
    };
    let around: Vec<Box32> = (0..treelets.len()).into_par_iter().map(around).collect();
    let clusters = if treelets.len() > 1 && !has_many_equals(&around) {
        cluster(&around)
    } else {
        None
    };
    let layout = clusters
        .as_ref()
        .and_then(|clusters| Layout::measure(boxes, &treelets, clusters, depth_limit));
    match layout {
        Some(layout) => layout.tree(),
        None => halved(boxes, treelets.order().to_vec()),
    }
}

/// Clusters with obvhs: PLOC (Meister and Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy
/// Construction", 2018), then reinsertion (the same, "Parallel Reinsertion for Bounding Volume Hierarchy
/// Optimization", 2018).
///
/// The builder computes areas in single precision, so boxes are scaled into the unit cube first. They decide only the
/// tree's shape, so this rounding changes no answer.
///
/// `None` for boxes on which that would take long.
fn cluster(boxes: &[Box32]) -> Option<Bvh2> {
    let all = boxes.iter().copied().fold(Box32::EMPTY, Box32::union);
    let size = (all.max.as_dvec3() - all.min.as_dvec3()).max_element();
    let factor = if size > 0.0 { 1.0 / size } else { 1.0 };
    let offset = all.min.as_dvec3();
    let unit = |v: Vec3| Vec3A::from(((v.as_dvec3() - offset) * factor).as_vec3());
    let aabbs: Vec<Aabb> = boxes
        .par_iter()
        .map(|b| Aabb::new(unit(b.min), unit(b.max)))
        .collect();
    if rounds::are_many(&aabbs) {
        return None;
    }
    let indices = (0..boxes.len() as u32).collect();
    let mut bvh = PlocBuilder::with_capacity(aabbs.len()).build(
        PlocSearchDistance::Low,
        &aabbs,
        indices,
        SortPrecision::U64,
        rounds::SHORT_ROUNDS,
    );
    // The parameters, here and above, are those of obvhs's `fast_build`.
    ReinsertionOptimizer::default().run(&mut bvh, 0.02, None);
    Some(bvh)
}

/// Whether so many boxes coincide that areas do not order pairs: clustering then takes time quadratic in their
/// number. Decided by a sample.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::tree::Subtree;
    use crate::random::Random;

    fn cube(middle: Vec3, size: f32) -> Box32 {
        Box32 {
            min: middle - size,
            max: middle + size,
        }
    }

    /// Checks that a tree contains every box once, inside the boxes above it, in contiguous primitive indices, and
    /// that it is not too deep.
    fn check(name: &str, boxes: &[Box32]) {
        let (tree, order) = build_tree(boxes, DEPTH_LIMIT);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..boxes.len() as u32), "{name}");
        let Some(root) = tree.root else {
            assert!(boxes.is_empty(), "{name}");
            return;
        };
        assert_eq!(root.primitives(), 0..boxes.len() as u32, "{name}");
        let mut nodes = 0;
        let mut open: Vec<(Subtree, Box32, usize)> = vec![(root, tree.bounds, 1)];
        while let Some((subtree, around, depth)) = open.pop() {
            assert!(depth <= DEPTH_LIMIT, "{name}");
            for primitive in subtree.primitives() {
                let inside = &boxes[order[primitive as usize] as usize];
                assert!(around.min.cmple(inside.min).all(), "{name}");
                assert!(around.max.cmpge(inside.max).all(), "{name}");
            }
            let Some(index) = subtree.node() else {
                assert!(subtree.count <= 4, "{name}");
                continue;
            };
            nodes += 1;
            let node = &tree.nodes[index as usize];
            let children = node.children(index);
            let [a, b] = children.each_ref().map(Subtree::clone);
            assert_eq!(a.primitives().start, subtree.primitives().start, "{name}");
            assert_eq!(a.primitives().end, b.primitives().start, "{name}");
            assert_eq!(b.primitives().end, subtree.primitives().end, "{name}");
            for (which, child) in children.into_iter().enumerate() {
                open.push((child, node.boxes.get(which), depth + 1));
            }
        }
        assert_eq!(nodes, tree.nodes.len(), "{name}");
    }

    #[test]
    fn trees_are_the_same_on_any_number_of_threads() {
        let mut random = Random(2);
        let mut cube_somewhere = || cube(random.point().as_vec3(), 1e-2);
        for count in [5_000, 300_000] {
            let boxes: Vec<Box32> = (0..count).map(|_| cube_somewhere()).collect();
            let orders = [1, 2, 5].map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                pool.expect("a pool")
                    .install(|| build_tree(&boxes, DEPTH_LIMIT).1)
            });
            assert!(orders[0] == orders[1] && orders[1] == orders[2], "{count}");
        }
    }

    #[test]
    fn trees_hold_every_box_once() {
        let mut random = Random(1);
        for count in [0, 1, 2, 4, 5, 8, 9, 100, 20_000, 50_000, 200_000] {
            let boxes: Vec<Box32> = (0..count)
                .map(|_| cube(random.point().as_vec3(), 1e-3))
                .collect();
            check(&format!("{count} anywhere"), &boxes);
        }
        let count = 1 << 17;
        let of = |place: &dyn Fn(u32) -> Vec3| -> Vec<Box32> {
            (0..count).map(|i| cube(place(i), 1e-3)).collect()
        };
        check("one place", &of(&|_| Vec3::ONE));
        check("two indices", &of(&|i| Vec3::splat((i % 2) as f32)));
        check("evenly along a line", &of(&|i| Vec3::X * i as f32));
        check(
            "in a plane",
            &of(&|i| Vec3::new((i % 362) as f32, 0.0, (i / 362) as f32)),
        );
        check(
            "halfway again and again",
            &of(&|i| Vec3::splat(0.5f32.powi((i % 140) as i32))),
        );
        check(
            "from very small to vast",
            &of(&|i| Vec3::Y * 1.001f32.powi(i as i32 % 80_000 - 40_000)),
        );
        check(
            "a crowd far from one other",
            &of(&|i| Vec3::splat(if i == 0 { 1e18 } else { i as f32 })),
        );
        check(
            "each larger than the one before",
            &(0..count)
                .map(|i| Box32 {
                    min: Vec3::ZERO,
                    max: Vec3::new((i + 1) as f32, 1.0, 0.0),
                })
                .collect::<Vec<_>>(),
        );
        check(
            "at the ends of the range",
            &of(&|i| Vec3::splat(if i % 2 == 0 { 2e18 } else { -2e18 })),
        );
    }
}
