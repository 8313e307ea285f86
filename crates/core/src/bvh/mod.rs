//! The acceleration structure: a scene's triangles in one space, in the order of the leaves of a tree over them.

mod build;
mod copies;
mod corner_hash;
mod flatten;
mod layout;
mod support;
pub(crate) mod tree;
mod treelet;

use crate::num::simd::Simd;
use crate::scene::{Scene, SceneError};
use glam::{DVec3, Vec3};
use tree::Tree;

/// A triangle in leaf order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// Corners relative to [`Accel::origin`].
    pub(crate) corners: [Vec3; 3],
    /// Primitive id: its number among all triangles of the scene, objects in order. Ties go to the lowest.
    pub(crate) number: u32,
}

/// World-space triangles and the tree over them.
///
/// Corners are stored in single precision relative to [`Accel::origin`]. Where the scene is one object at rest,
/// or all its meshes share an offset and rest, they are the meshes' own positions, unchanged; anything else is
/// transformed in double precision and rounded once. "Exact" refers to the corners as stored here.
#[derive(Clone, Debug)]
pub struct Accel {
    pub(crate) origin: DVec3,
    pub(crate) triangles: Vec<Triangle>,
    pub(crate) tree: Tree,
    /// The instruction set for packets.
    pub(crate) simd: Simd,
    /// The first primitive id of each object, and the one after the last.
    first_numbers: Vec<u32>,
    /// Triangles finite in their mesh that a transform moved out of single precision's range.
    out_of_range: u32,
}

impl Accel {
    /// Places every object's kept triangles in the world and builds the tree.
    ///
    /// # Errors
    /// A scene whose transforms or parents are not valid, or with more triangles than ids.
    pub fn build(scene: &Scene) -> Result<Self, SceneError> {
        build::build(scene)
    }

    /// What to add to a corner from [`Accel::corners`] to get world coordinates.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The corners of a triangle by primitive index, relative to [`Accel::origin`]. `primitive` < [`Accel::len`].
    pub fn corners(&self, primitive: u32) -> [Vec3; 3] {
        self.triangles[primitive as usize].corners
    }

    /// The object and the triangle number of a primitive index. `primitive` < [`Accel::len`].
    pub fn identify(&self, primitive: u32) -> (u32, u32) {
        let number = self.triangles[primitive as usize].number;
        let object = match &self.first_numbers[..] {
            // One object: nothing to look up.
            [_, _] => 0,
            first => first.partition_point(|&first| first <= number) - 1,
        };
        (object as u32, number - self.first_numbers[object])
    }

    /// The instruction set that packets are cast with; it changes no answer.
    pub fn simd(&self) -> Simd {
        self.simd
    }

    /// Casts packets with another instruction set, or with the best this machine has below it.
    pub fn with_simd(mut self, simd: Simd) -> Self {
        self.simd = simd.min(Simd::best());
        self
    }

    /// How many triangles rays can hit. Of those that coincide and turn the same way only the one with
    /// the lowest id counts.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there is nothing to hit.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Triangles that a transform moved out of single precision's range: never hit.
    pub fn out_of_range(&self) -> u32 {
        self.out_of_range
    }

    /// Bytes kept by the tree and the triangles.
    pub fn retained_bytes(&self) -> usize {
        self.triangles.capacity() * size_of::<Triangle>()
            + self.tree.retained_bytes()
            + self.first_numbers.capacity() * size_of::<u32>()
    }
}
