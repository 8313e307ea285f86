//! Exact decisions about triangles that hold for all rays of a lattice, each made once.

use crate::bvh::Accel;
use crate::camera::Camera;
use crate::hit::Precision;
use crate::num::simd::Simd;
use crate::triangle::clip::{AtCorners, Clip};
use crate::triangle::coplanar::Coplanar;
use crate::triangle::edge_on::EdgeOn;

/// Decisions about a tree's triangles, cached.
#[derive(Debug)]
pub(crate) struct Decisions<'a> {
    accel: &'a Accel,
    clip: &'a Clip,
    edge_on: EdgeOn,
    coplanar: Coplanar,
    /// With fast casting, triangles of one plane are ordered by their rounded distances.
    precision: Precision,
}

impl<'a> Decisions<'a> {
    pub(super) fn new(
        accel: &'a Accel,
        clip: &'a Clip,
        camera: &Camera,
        precision: Precision,
    ) -> Self {
        Self {
            accel,
            clip,
            edge_on: EdgeOn::new(camera, accel.origin),
            coplanar: Coplanar::new(),
            precision,
        }
    }

    /// The instruction set to compute with.
    pub(super) fn simd(&self) -> Simd {
        self.accel.simd
    }

    /// The clipping planes.
    #[inline(always)]
    pub(super) fn clip(&self) -> &'a Clip {
        self.clip
    }

    /// The functions of the clipping planes that cut a triangle.
    pub(super) fn clipped(&self, primitive: u32) -> impl Iterator<Item = AtCorners> {
        self.clip.through(self.accel.corners(primitive))
    }

    /// Whether casting is exact. Fast casting interpolates t, u and v in double precision alone, which would give
    /// wrong values at triangles that only exact arithmetic decides.
    pub(super) fn are_exact(&self) -> bool {
        self.precision == Precision::Exact
    }

    /// Whether no ray hits a triangle because all rays start in its plane, are parallel to it, or start behind it.
    #[inline(never)]
    pub(super) fn is_never_hit(&mut self, primitive: u32) -> bool {
        self.edge_on.is(primitive, self.accel.corners(primitive))
    }

    /// For two triangles of one plane, the one that every ray hitting both hits first: that with the lower primitive
    /// id. `None` if they do not lie in one plane.
    #[inline(never)]
    pub(super) fn first_in_one_plane(&mut self, a: u32, b: u32) -> Option<u32> {
        let is_one_plane = self.precision == Precision::Exact
            && self
                .coplanar
                .are(a, b, |primitive| self.accel.corners(primitive));
        let id = |primitive: u32| self.accel.id(primitive);
        is_one_plane.then(|| if id(a) < id(b) { a } else { b })
    }
}
