//! Traversal of all triangles that a packet's rays may hit, however many lie behind one another.

use super::descent::{Descent, SmallBoxes};
use super::{Occlusion, Traversal};
use crate::hit::Cull;
use crate::num::simd::{LANES, Lanes};
use crate::packet::hit_buffer::{HitBuffer, Surface};
use crate::packet::ray_bounds::{CornerProjector, ProjectedTriangles};
use crate::packet::ray_rect::RayRect;

impl<const INSTANCES: bool> Traversal<'_, INSTANCES> {
    /// Adds all possible hits of a packet's rays to `buffer`, but for those that are surely behind sure hits with opaque
    /// triangles; `wanted` are the rays, as columns and rows, whose hits are asked for. Returns `false` where there are too
    /// many.
    #[inline(always)]
    pub(in crate::packet) fn gather(
        &mut self,
        lanes: impl Lanes,
        packet: &RayRect,
        cull: Cull,
        surface: &impl Fn(u32) -> Surface,
        wanted: impl Iterator<Item = (u32, u32)>,
        buffer: &mut HitBuffer,
    ) -> bool {
        let space = self.space(packet, cull);
        let nearest = self.pairs.first().map_or(0.0, |pair| pair.near);
        let projector = CornerProjector::new(&space, nearest);
        let mut descent = Descent::new(self.frustum(packet), SmallBoxes::new(self.lattice));
        let mut projected = ProjectedTriangles::NONE;
        let mut surfaces = [Surface::OPAQUE; LANES];
        buffer.clear(self.start_keys(), wanted);
        loop {
            while self.queued.len < LANES {
                if projected.seen != 0 {
                    let lane = projected.seen.trailing_zeros() as usize & (LANES - 1);
                    projected.seen &= projected.seen - 1;
                    let primitive = self.batch.primitives[lane];
                    let mut surface = surface(primitive);
                    surface.is_partial |= self.cut >> lane & 1 != 0;
                    surfaces[self.queued.len & (LANES - 1)] = surface;
                    self.queue(primitive, projected.rays(lane));
                    continue;
                }
                self.fill_batch(lanes, &mut descent, packet, buffer, &mut ());
                if self.batch.len == 0 {
                    break;
                }
                if !self.clip.is_empty() && !self.clip_batch() {
                    continue;
                }
                let corners =
                    (self.accel).eight_corners::<INSTANCES>(lanes, self.batch.primitives());
                projector.project(lanes, &corners, self.batch.len, &mut projected);
            }
            let count = std::mem::take(&mut self.queued.len);
            if count == 0 {
                return true;
            }
            let corners = (self.accel).eight_corners::<INSTANCES>(lanes, self.queued.primitives());
            let set_up = space.set_up(&corners, &self.boxes);
            let primitives = &self.queued.primitives[..count];
            buffer.rasterize(
                (lanes, self.accel.simd),
                &set_up,
                primitives,
                &surfaces[..count],
            );
            if buffer.is_full() {
                return false;
            }
            buffer.update(lanes);
            descent.limits = self.limits(lanes, buffer);
        }
    }
}
