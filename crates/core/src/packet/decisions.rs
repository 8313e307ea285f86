//! Decisions about triangles that hold for all rays of a lattice, or of a packet, each made once.

use super::params::ROW;
use super::plane_along_rays::PlaneAlongRays;
use super::plane_keys::{PlaneKeys, SideOfPlane};
use super::plane_order::{PlaneOrder, PlaneOrders};
use super::ray_rect::RayRect;
use super::ray_starts::RayStarts;
use super::setup::{PacketSpace, TriangleSetup};
use crate::bvh::Accel;
use crate::camera::{Lattice, Projection};
use crate::hit::Precision;
use crate::num::simd::Simd;
use crate::triangle::CornerLanes;
use crate::triangle::clip::{AtCorners, AtEye, Clip};
use crate::triangle::coplanar::Coplanar;
use crate::triangle::edge_on::EdgeOn;
use glam::Vec3;

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
    /// The plane that the packet's depth keys are relative to. `None` before the first, since few packets' are.
    plane_keys: Option<Box<PlaneKeys>>,
    ray_starts: RayStarts,
    /// With fast casting, triangles of one plane are ordered by their rounded distances.
    precision: Precision,
}

impl<'a> Decisions<'a> {
    pub(super) fn new(
        accel: &'a Accel,
        clip: &'a Clip,
        lattice: &Lattice,
        precision: Precision,
    ) -> Self {
        let camera = &lattice.camera;
        let has_eye = camera.projection() != Projection::Orthographic;
        Self {
            accel,
            clip,
            planes_at_eye: match has_eye {
                true => clip.at_eye(camera.pose().eye).collect(),
                false => Vec::new(),
            },
            planes_along_rays: Vec::new(),
            edge_on: EdgeOn::new(camera, accel.origin),
            coplanar: Coplanar::new(accel.len()),
            plane_orders: PlaneOrders::new(),
            plane_keys: None,
            ray_starts: RayStarts::new(lattice),
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

    /// As [`Decisions::is_known_never_hit`], but where the triangle that was decided last is never hit this one is decided too:
    /// most are, and deciding it costs less than setting it up closely.
    #[inline(never)]
    pub(super) fn is_never_hit_if_likely(&mut self, primitive: u32) -> bool {
        if self.edge_on.was_last() {
            return self.is_never_hit(primitive);
        }
        self.edge_on.is_known(primitive)
    }

    /// Whether [`Decisions::is_never_hit`] is known to be true of a triangle.
    #[inline(always)]
    pub(super) fn is_known_never_hit(&self, primitive: u32) -> bool {
        self.edge_on.is_known(primitive)
    }

    /// Begins a packet: triangles are ordered, and cut, along its rays.
    pub(super) fn set_rays(&mut self, space: &PacketSpace, packet: &RayRect) {
        self.ray_starts.set_rays(packet, space);
        self.plane_orders.set_rays(space);
        self.planes_along_rays.clear();
        let planes = self.planes_at_eye.iter();
        self.planes_along_rays
            .extend(planes.map(|plane| space.along_rays(plane)));
        if let Some(plane) = space.reference_plane {
            let keys = self.plane_keys.get_or_insert_with(Box::default);
            keys.set(space, plane, self.accel.corners(plane));
        }
    }

    /// The triangle whose plane the depth keys of a packet were last relative to.
    pub(super) fn last_plane(&self) -> Option<u32> {
        self.plane_keys.as_ref().map(|keys| keys.primitive())
    }

    /// Where a triangle lies relative to the packet's reference plane.
    pub(super) fn side_of_reference(&mut self, primitive: u32) -> SideOfPlane {
        let Some(keys) = &mut self.plane_keys else {
            return SideOfPlane::Neither;
        };
        let side = keys.side_of(primitive, self.accel.corners(primitive));
        if side == SideOfPlane::Within {
            self.coplanar.join(keys.primitive(), primitive);
        }
        side
    }

    /// The primitive id of a triangle that is known to lie in the plane that depth keys are, or were last, relative to. Of
    /// two such triangles that a ray hits, the one with the lower id is hit first.
    pub(super) fn id_in_plane(&self, primitive: u32) -> Option<u32> {
        let keys = self.plane_keys.as_ref()?;
        let is_known = self.coplanar.are_known(keys.primitive(), primitive);
        is_known.then(|| self.accel.id(primitive))
    }

    /// Sets up those of eight triangles again whose depth keys are inaccurate, where keys are relative to a plane.
    pub(super) fn refine_keys(
        &mut self,
        space: &PacketSpace,
        triangles: (&CornerLanes, &[u32]),
        set_up: &mut TriangleSetup,
    ) {
        if let Some(keys) = &mut self.plane_keys {
            let in_plane = keys.refine((space, self.accel.simd), triangles, set_up);
            for (l, &primitive) in triangles.1.iter().enumerate() {
                if in_plane >> l & 1 != 0 {
                    self.coplanar.join(keys.primitive(), primitive);
                }
            }
        }
    }

    /// Whether all of the packet's rays, which are parallel, start in front of a triangle's plane, or all behind it, so that
    /// none hits the triangle; `None` where neither is sure.
    #[inline(never)]
    pub(super) fn start_all_in_front(&mut self, primitive: u32) -> Option<bool> {
        let corners = || self.accel.corners(primitive);
        self.ray_starts.all_in_front(primitive, corners)
    }

    /// Which of eight rays, as bits, start in front of a triangle that they cross: by their distances from its plane or
    /// the bounds of its depth keys where those decide it, else by [`RayStarts::in_front`].
    #[inline(never)]
    pub(super) fn start_in_front(
        &mut self,
        primitive: u32,
        (first, rays): (usize, u32),
        depth_keys: [&[f32; ROW]; 2],
    ) -> u32 {
        let corners = || self.accel.corners(primitive);
        let [in_front, behind] = self.ray_starts.by_distance(primitive, first, corners);
        let mut decided = rays & in_front;
        let mut rest = rays & !(in_front | behind);
        if rest != 0 {
            let [in_front, behind] = self.ray_starts.by_depth_keys(first, depth_keys);
            decided |= rest & in_front;
            rest &= !(in_front | behind);
        }
        if rest == 0 {
            return decided;
        }
        let rest = (first, rest);
        decided | (self.ray_starts).in_front(self.accel, &mut self.coplanar, primitive, rest)
    }

    /// The order of two triangles along the packet's rays. All rays that hit two triangles of one plane hit the one
    /// with the lower primitive id first.
    #[inline(never)]
    pub(super) fn order(&mut self, pair: [u32; 2]) -> &PlaneOrder {
        if self.precision == Precision::Fast {
            return &PlaneOrder::UNKNOWN;
        }
        if !self.plane_orders.knows(pair) {
            let (accel, coplanar) = (self.accel, &mut self.coplanar);
            let [first, second] = pair;
            let is_first = accel.id(first) < accel.id(second);
            if coplanar.are_known(first, second) {
                return PlaneOrder::in_one_plane(is_first);
            }
            let mut placed = [[Vec3::ZERO; 3]; 2];
            let [of_first, of_second] = &mut placed;
            let corners = [
                accel.corners_in(first, of_first),
                accel.corners_in(second, of_second),
            ];
            self.plane_orders.find(pair, corners, is_first);
            if self.plane_orders.order(pair).in_one_plane {
                coplanar.join(first, second);
            }
        }
        self.plane_orders.order(pair)
    }
}
