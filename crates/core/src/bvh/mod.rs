//! The acceleration structure: a scene's triangles in one space, in the leaf order of a tree over them.

mod build;
mod corner_hash;
mod duplicates;
mod eight_corners;
mod flatten;
mod instances;
mod joined;
mod layout;
mod placement;
mod rounds;
mod support;
mod top_level;
mod topology;
pub(crate) mod tree;
mod treelet;
mod two_level;

use crate::num::simd::Simd;
use crate::scene::{Bounds, Scene, SceneError};
use glam::{DVec3, Vec3};
use instances::{Instances, Opened};
use std::sync::Arc;
use tree::{BoxPair, Subtree, Tree};
use two_level::Known;

/// A triangle, as stored in leaf order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// Corners relative to [`Accel::origin`].
    pub(crate) corners: [Vec3; 3],
    /// Primitive id: the triangle's number among all triangles of the scene, objects in order. At equal distances the
    /// lowest wins.
    pub(crate) number: u32,
}

/// World-space triangles and the tree over them: one tree over all, or a top-level tree over the objects and a tree
/// for each mesh.
///
/// Corners are in single precision relative to [`Accel::origin`]. Where the scene is one object without transform, or
/// all its meshes share an offset and have no transform, they are the meshes' own positions, unchanged; anything else
/// is transformed in double precision and rounded once. "Exact" refers to these corners. Both variants have the same
/// corners and give every ray the same answer, bit for bit; only primitive indices differ.
#[derive(Clone, Debug)]
pub struct Accel {
    pub(crate) origin: DVec3,
    /// In leaf order; empty where there are instances.
    triangles: Vec<Triangle>,
    /// The nodes; empty where there are instances.
    pub(crate) tree: Tree,
    /// The nodes and triangles of instances.
    pub(crate) instances: Instances,
    /// The instruction set for packets.
    pub(crate) simd: Simd,
    /// The first primitive id of each object, and the one after the last.
    first_numbers: Vec<u32>,
    /// Triangles finite in their mesh that a transform moved out of single precision's range.
    out_of_range: u32,
    /// Trees that [`Accel::updated`] may reuse.
    known: Option<Arc<Known>>,
}

impl Accel {
    /// Transforms every object's kept triangles to world space and builds one tree over all of them.
    ///
    /// # Errors
    /// A scene whose transforms or parents are invalid, or with more triangles than ids.
    pub fn build(scene: &Scene) -> Result<Self, SceneError> {
        build::build(scene)
    }

    /// Builds a tree for each mesh, however many objects have it, and a top-level tree over the objects (Embree's
    /// instances). Rays take longer, the more so where objects overlap; memory is that of the meshes, and
    /// [`Accel::updated`] rebuilds none of their trees.
    ///
    /// # Errors
    /// As [`Accel::build`].
    pub fn build_instances(scene: &Scene) -> Result<Self, SceneError> {
        match two_level::build(scene, None, false)? {
            Some(accel) => Ok(accel),
            None => Self::build(scene),
        }
    }

    /// How many triangles [`Accel::build_instances`] stores for a scene, in trees of at most 200 bytes a triangle:
    /// the triangles of every object where these are few enough to be placed once, else those of every mesh.
    pub fn stored_triangles(scene: &Scene) -> usize {
        two_level::stored_triangles(scene)
    }

    /// The structure after the scene's objects have changed, as [`Accel::build_instances`] would build it; only the
    /// trees of new meshes are built. The origin stays: moving an object changes no other's corners.
    ///
    /// # Errors
    /// As [`Accel::build`].
    pub fn updated(&self, scene: &Scene) -> Result<Self, SceneError> {
        match two_level::build(scene, Some(self), false)? {
            Some(accel) => Ok(accel),
            None => Self::build(scene),
        }
    }

    /// As [`Accel::updated`], where that takes at most some milliseconds on this thread alone: every mesh has a tree,
    /// there are at most some thousand objects, and few of them have a new placement. `None` elsewhere.
    pub fn updated_at_once(&self, scene: &Scene) -> Option<Self> {
        self.known.as_ref()?;
        two_level::build(scene, Some(self), true).ok()?
    }

    /// The box around everything that rays can hit, in world coordinates; empty where there is nothing.
    pub fn bounds(&self) -> Bounds {
        if self.is_empty() {
            return Bounds::EMPTY;
        }
        let around = self.tree.bounds;
        Bounds {
            min: self.origin + around.min.as_dvec3(),
            max: self.origin + around.max.as_dvec3(),
        }
    }

    /// Whether there is a tree for each mesh.
    pub fn has_instances(&self) -> bool {
        !self.instances.is_empty()
    }

    /// The children of a node, with their boxes. Those of a mesh's tree are placed in `opened`.
    ///
    /// `INSTANCES` says whether there may be any, here and below. Packets are compiled for both values: with a branch
    /// that is never taken, one tree took 4 % longer (in memory that could have been registers).
    #[inline(always)]
    pub(crate) fn open<'a, const INSTANCES: bool>(
        &'a self,
        index: u32,
        opened: &'a mut Option<Opened>,
    ) -> (&'a BoxPair, [Subtree; 2]) {
        if !INSTANCES {
            let node = &self.tree.nodes[index as usize];
            return (&node.boxes, node.children(index));
        }
        match self.tree.nodes.get(index as usize) {
            Some(node) => (&node.boxes, node.children(index)),
            None => {
                let opened = opened.insert(self.instances.open(index));
                (&opened.boxes, opened.children)
            }
        }
    }

    /// As [`Accel::open`] where it is not known whether there are instances: for single rays.
    #[inline(always)]
    pub(crate) fn open_any<'a>(
        &'a self,
        index: u32,
        opened: &'a mut Option<Opened>,
    ) -> (&'a BoxPair, [Subtree; 2]) {
        match self.tree.nodes.get(index as usize) {
            Some(node) => (&node.boxes, node.children(index)),
            None => {
                let opened = opened.insert(self.open_placed(index));
                (&opened.boxes, opened.children)
            }
        }
    }

    #[cold]
    #[inline(never)]
    fn open_placed(&self, index: u32) -> Opened {
        self.instances.open(index)
    }

    #[cold]
    #[inline(never)]
    fn placed_corners(&self, primitive: u32) -> [Vec3; 3] {
        self.instances.corners(primitive)
    }

    /// The stored triangles, for prefetching.
    #[inline(always)]
    pub(crate) fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// A triangle's primitive id.
    #[inline(always)]
    pub(crate) fn id(&self, primitive: u32) -> u32 {
        match self.triangles.get(primitive as usize) {
            Some(triangle) => triangle.number,
            None => self.instances.id(primitive),
        }
    }

    /// The primitive indices below a subtree.
    pub(crate) fn primitives_below(&self, subtree: Subtree) -> Vec<u32> {
        match self.instances.top_children(subtree) {
            Some(children) => {
                let below = children.map(|child| self.primitives_below(child));
                below.concat()
            }
            None => subtree.primitives().collect(),
        }
    }

    /// All primitive indices: those below [`Accel::len`], except with instances.
    pub fn primitives(&self) -> impl Iterator<Item = u32> {
        (0..self.triangles.len() as u32).chain(self.instances.primitives())
    }

    /// What to add to a corner from [`Accel::corners`] to get world coordinates.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The corners of a triangle by primitive index, one of [`Accel::primitives`], relative to [`Accel::origin`].
    #[inline(always)]
    pub fn corners(&self, primitive: u32) -> [Vec3; 3] {
        match self.triangles.get(primitive as usize) {
            Some(triangle) => triangle.corners,
            None => self.placed_corners(primitive),
        }
    }

    /// [`Accel::corners`] by reference: where they are stored, or in `placed`. A copy is stored 16 bytes at a time, and a
    /// load that spans two of these stores waits until both have reached the cache.
    #[inline(always)]
    pub(crate) fn corners_in<'c>(
        &'c self,
        primitive: u32,
        placed: &'c mut [Vec3; 3],
    ) -> &'c [Vec3; 3] {
        match self.triangles.get(primitive as usize) {
            Some(triangle) => &triangle.corners,
            None => {
                *placed = self.placed_corners(primitive);
                placed
            }
        }
    }

    /// [`Accel::corners`].
    #[inline(always)]
    pub(crate) fn corners_of<const INSTANCES: bool>(&self, primitive: u32) -> [Vec3; 3] {
        if INSTANCES {
            self.corners(primitive)
        } else {
            self.triangles[primitive as usize].corners
        }
    }

    /// The object and the triangle number of a primitive index, one of [`Accel::primitives`].
    pub fn identify(&self, primitive: u32) -> (u32, u32) {
        let Some(triangle) = self.triangles.get(primitive as usize) else {
            return self.instances.identify(primitive);
        };
        let number = triangle.number;
        let object = match &self.first_numbers[..] {
            // One object: nothing to search.
            [_, _] => 0,
            first => first.partition_point(|&first| first <= number) - 1,
        };
        (object as u32, number - self.first_numbers[object])
    }

    /// The instruction set that packets are cast with; it changes no answer.
    pub fn simd(&self) -> Simd {
        self.simd
    }

    /// Casts packets with another instruction set, or with the best below it that this machine has.
    pub fn with_simd(mut self, simd: Simd) -> Self {
        self.simd = simd.min(Simd::best());
        self
    }

    /// How many triangles rays can hit. Of triangles that coincide in the same winding order only the one with the
    /// lowest id counts; with instances, only within a mesh.
    pub fn len(&self) -> usize {
        self.triangles.len() + self.instances.triangle_count()
    }

    /// Whether there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.tree.root.is_none()
    }

    /// Triangles that a transform moved out of single precision's range; they are never hit.
    pub fn out_of_range(&self) -> u32 {
        self.out_of_range
    }

    /// Bytes retained by trees and triangles, including trees that [`Accel::updated`] may reuse; a tree that several
    /// objects share counts once.
    pub fn retained_bytes(&self) -> usize {
        let known = self.known.as_deref();
        let trees = known.into_iter().flat_map(Known::all_trees);
        let mut trees: Vec<_> = trees.chain(self.instances.all_trees()).collect();
        trees.sort_unstable_by_key(|tree| Arc::as_ptr(tree));
        trees.dedup_by_key(|tree| Arc::as_ptr(tree));
        let meshes: usize = trees.iter().map(|tree| tree.retained_bytes()).sum();
        self.triangles.capacity() * size_of::<Triangle>()
            + self.tree.retained_bytes()
            + meshes
            + self.instances.retained_bytes()
            + known.map_or(0, Known::retained_bytes)
            + self.first_numbers.capacity() * size_of::<u32>()
    }
}
