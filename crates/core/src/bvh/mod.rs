//! The scene made ready for casting: world-space triangles in the order of a tree's leaves.

mod build;
mod flatten;
mod layout;
pub(crate) mod tree;
mod treelet;

use crate::num::simd::Simd;
use crate::scene::{Scene, SceneError};
use glam::{DVec3, Vec3};
use tree::Tree;

/// A triangle in the order of the leaves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// Corners relative to the accel's origin.
    pub(crate) corners: [Vec3; 3],
    /// Its number among all triangles of the scene, objects in order: ties go to the lowest.
    pub(crate) number: u32,
}

/// World-space triangles and the tree over them.
///
/// Corners are stored in single precision relative to [`Accel::origin`]. Where the scene is one
/// object at rest, or all its meshes share an offset and rest, they are the meshes' own positions,
/// unchanged; anything else is moved in double precision and rounded once. The corners as stored
/// here are what "exact" is about.
#[derive(Clone, Debug)]
pub struct Accel {
    pub(crate) origin: DVec3,
    pub(crate) triangles: Vec<Triangle>,
    pub(crate) tree: Tree,
    /// The instruction set for tiles.
    pub(crate) simd: Simd,
    /// The first number of each object, and the number after the last.
    first_numbers: Vec<u32>,
    /// Triangles that were finite in their mesh but left single precision's range in the world.
    out_of_range: u32,
}

impl Accel {
    /// Places every object's kept triangles in the world and builds the tree.
    ///
    /// # Errors
    /// A scene whose transforms or parents are not valid, or too large to number.
    pub fn build(scene: &Scene) -> Result<Self, SceneError> {
        build::build(scene)
    }

    /// What to add to a corner from [`Accel::corners`] to get world coordinates.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The corners of the triangle in a slot, relative to [`Accel::origin`]. `slot` < [`Accel::len`].
    pub fn corners(&self, slot: u32) -> [Vec3; 3] {
        self.triangles[slot as usize].corners
    }

    /// The object and triangle number of a slot. `slot` < [`Accel::len`].
    pub fn identify(&self, slot: u32) -> (u32, u32) {
        let number = self.triangles[slot as usize].number;
        let object = match &self.first_numbers[..] {
            // One object: nothing to look up.
            [_, _] => 0,
            first => first.partition_point(|&first| first <= number) - 1,
        };
        (object as u32, number - self.first_numbers[object])
    }

    /// The instruction set that tiles are cast with; it changes no answer.
    pub fn simd(&self) -> Simd {
        self.simd
    }

    /// Casts tiles with another instruction set, or with the best this machine has below it.
    pub fn with_simd(mut self, simd: Simd) -> Self {
        self.simd = simd.min(Simd::best());
        self
    }

    /// How many triangles can be met.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether nothing can be met.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// How many triangles a transform has moved out of single precision's range: never met.
    pub fn out_of_range(&self) -> u32 {
        self.out_of_range
    }

    /// Bytes kept: the tree and the triangles.
    pub fn retained_bytes(&self) -> usize {
        self.triangles.capacity() * size_of::<Triangle>()
            + self.tree.retained_bytes()
            + self.first_numbers.capacity() * size_of::<u32>()
    }
}
