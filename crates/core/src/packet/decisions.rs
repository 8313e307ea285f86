//! Decisions about triangles that hold for all rays of a lattice, or of a packet, each made once.

use super::plane_along_rays::PlaneAlongRays;
use super::plane_order::{PlacesWithin, PlaneOrders};
use super::setup::PacketSpace;
use crate::bvh::Accel;
use crate::camera::{Camera, Projection};
use crate::hit::Precision;
use crate::num::simd::{LANES, Simd};
use crate::triangle::clip::{AtCorners, AtEye, Clip};
use crate::triangle::coplanar::Coplanar;
use crate::triangle::edge_on::EdgeOn;

/// Decisions about a tree's triangles, cached.
#[derive(Debug)]
pub(crate) struct Decisions<'a> {
    accel: &'a Accel,
    clip: &'a Clip,
    /// The clipping planes' functions at the eye, where all rays start there.
    planes_at_eye: Vec<AtEye>,
    /// The same along the packet's rays.
    planes_along_rays: Vec<PlaneAlongRays>,
    edge_on: EdgeOn,
    coplanar: Coplanar,
    plane_orders: PlaneOrders,
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
        let has_eye = camera.projection() != Projection::Orthographic;
        Self {
            accel,
            clip,
            planes_at_eye: match has_eye {
                true => clip.at_eye(camera.placement().eye).collect(),
                false => Vec::new(),
            },
            planes_along_rays: Vec::new(),
            edge_on: EdgeOn::new(camera, accel.origin),
            coplanar: Coplanar::new(),
            plane_orders: PlaneOrders::new(),
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

    /// A clipping plane's function along the packet's rays, where they start at the eye.
    pub(super) fn plane_along_rays(&self, plane: usize) -> Option<&PlaneAlongRays> {
        self.planes_along_rays.get(plane)
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

    /// Begins a packet: triangles are ordered, and cut, along its rays.
    pub(super) fn set_rays(&mut self, space: &PacketSpace) {
        self.plane_orders.set_rays(space);
        self.planes_along_rays.clear();
        let planes = self.planes_at_eye.iter();
        self.planes_along_rays
            .extend(planes.map(|plane| space.along_rays(plane)));
    }

    /// Of eight rays, as bits, those for which the first of two triangles is surely nearer where they hit both, and
    /// those for which the second is.
    #[inline(never)]
    pub(super) fn order_of_eight(
        &mut self,
        pair: [u32; 2],
        places: (&[f32; LANES], &[f32; LANES]),
    ) -> [u32; 2] {
        if self.precision == Precision::Fast {
            return [0; 2];
        }
        let corners = |primitive: u32| self.accel.corners(primitive);
        self.plane_orders.of_eight(pair, places, corners)
    }

    /// Whether the first of two triangles is the closer hit for all rays of a box of places that hit both.
    #[inline(never)]
    pub(super) fn is_first_within(&mut self, pair: [u32; 2], places: &PlacesWithin) -> bool {
        if self.precision == Precision::Fast {
            return false;
        }
        let corners = |primitive: u32| self.accel.corners(primitive);
        self.plane_orders.is_first_within(pair, places, corners)
            || self.first_in_one_plane(pair[0], pair[1]) == Some(pair[0])
    }
}
