//! The scene made ready for casting: world-space triangles in the order of a tree's leaves.

use crate::camera::Ray;
use crate::intersect::{Cull, Hit};
use crate::scene::{Scene, SceneError};
use glam::{DVec3, Vec3};

/// Marks a ray that meets nothing, in place of a triangle's slot.
pub const MISS: u32 = u32::MAX;

/// A nearest hit as the casting loops store it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlotHit {
    /// The triangle's place in leaf order, or [`MISS`].
    pub slot: u32,
    /// The ray's parameter; infinity at a miss.
    pub t: f32,
    /// Weight of the second corner.
    pub u: f32,
    /// Weight of the third corner.
    pub v: f32,
}

impl SlotHit {
    /// A ray that meets nothing.
    pub const NONE: Self = Self {
        slot: MISS,
        t: f32::INFINITY,
        u: 0.0,
        v: 0.0,
    };
}

/// World-space triangles and the tree over them.
#[derive(Debug)]
pub struct Accel {}

impl Accel {
    /// Places every object's kept triangles in the world and builds the tree.
    ///
    /// # Errors
    /// A scene whose transforms or parents are not valid, or too large to number.
    pub fn build(_scene: &Scene) -> Result<Self, SceneError> {
        unimplemented!()
    }

    /// The nearest hit of `ray` by exact arithmetic; ties go to the lowest object, then triangle.
    pub fn cast(&self, _ray: &Ray, _cull: Cull) -> Option<Hit> {
        unimplemented!()
    }

    /// What [`Accel::cast`] answers, found by trying every triangle: for tests.
    pub fn cast_brute_force(&self, _ray: &Ray, _cull: Cull) -> Option<Hit> {
        unimplemented!()
    }

    /// What to add to a corner from [`Accel::corners`] to get world coordinates.
    pub fn origin(&self) -> DVec3 {
        unimplemented!()
    }

    /// The corners of the triangle in a slot, relative to [`Accel::origin`]. `slot` < [`Accel::len`].
    pub fn corners(&self, _slot: u32) -> [Vec3; 3] {
        unimplemented!()
    }

    /// The object and triangle number of a slot. `slot` < [`Accel::len`].
    pub fn identify(&self, _slot: u32) -> (u32, u32) {
        unimplemented!()
    }

    /// How many triangles can be met.
    pub fn len(&self) -> usize {
        unimplemented!()
    }

    /// Whether nothing can be met.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes kept: the tree and the triangles.
    pub fn retained_bytes(&self) -> usize {
        unimplemented!()
    }
}
