//! Traversal for packets of a panorama, whose rays lie at irregular places.

use super::descent::{Descent, SmallBoxes};
use super::{Batch, LANES, MANY_RAYS, Occlusion, Traversal};
use crate::camera::Camera;
use crate::hit::Cull;
use crate::num::simd::Lanes;
use crate::packet::depth_reference::DepthReference;
use crate::packet::frustum::{CellFrusta, Frustum, Viewpoint, Window};
use crate::packet::interval_zbuffer::IntervalZBuffer;
use crate::packet::params::{ROW, SIDE};
use crate::packet::place_box::PlaceBox;
use crate::packet::places::Places;
use crate::packet::plane_keys::SideOfPlane;
use crate::packet::ray_bounds::CornerProjector;
use crate::packet::ray_rect::RayRect;
use crate::packet::setup::PacketSpace;
use crate::packet::triangles_at_places::TrianglesAtPlaces;
use glam::DVec3;

impl<const INSTANCES: bool> Traversal<'_, INSTANCES> {
    /// The viewpoint of a camera with the same eye and other axes.
    pub(super) fn seen_from<'v>(&'v self, view: &'v Camera) -> Viewpoint<'v> {
        Viewpoint {
            camera: view,
            eye: self.eye,
            eye_error: self.eye_error,
            bounds: &self.accel.tree.bounds,
        }
    }

    /// Whether rays through a window of a view may hit anything below the entry points.
    #[inline(always)]
    pub(in crate::packet) fn may_hit(
        &self,
        lanes: impl Lanes,
        view: &Camera,
        window: &Window,
    ) -> bool {
        let frustum = Frustum::new(self.seen_from(view), window);
        for pair in &self.pairs {
            let [(_, first), (_, second)] = frustum.enter(lanes, &pair.boxes);
            if first | second {
                return true;
            }
        }
        false
    }

    /// As [`Self::may_hit`], for rays within a cone around an axis in world space, of this tangent.
    #[inline(always)]
    pub(in crate::packet) fn may_hit_around(
        &self,
        lanes: impl Lanes,
        (axis, tangent): (DVec3, f64),
    ) -> bool {
        let window = Window {
            across: (-tangent, tangent),
            along: (-tangent, tangent),
        };
        self.may_hit(lanes, &Camera::along(axis), &window)
    }

    /// Casts a panorama's packet from the entry points of its large packet. Returns `false`, and leaves `zbuffer`
    /// unchanged, where no triangle is near its rays.
    #[inline(always)]
    pub(in crate::packet) fn cast_at_places(
        &mut self,
        lanes: impl Lanes,
        places: &Places,
        cull: Cull,
        zbuffer: &mut IntervalZBuffer,
    ) -> bool {
        if self.decisions.are_exact() {
            let boxes = self.entry_points.iter().map(|entry| entry.1);
            self.reference = DepthReference::of(boxes, &places.view, self.eye);
        }
        'packet: loop {
            let from = self.seen_from(&places.view);
            let frustum = Frustum::new(from, &places.window());
            let cells = CellFrusta::new(from, &places.cell_windows());
            let space = places.space(self.eye, self.eye_error, cull);
            let space = space.relative_to(self.reference);
            let mut descent = Descent::new(frustum, SmallBoxes::new(self.lattice));
            descent.cells = Some(cells);
            // Used for the cells' frusta only, which are built already.
            let part = RayRect {
                column: 0,
                row: 0,
                columns: places.columns,
                rows: places.rows_of_rays,
            };
            let nearest = self.pairs.first().map_or(0.0, |pair| pair.near);
            let projector = CornerProjector::new(&space, nearest);
            let mut projected = TrianglesAtPlaces::NONE;
            let mut boxes = [PlaceBox::EMPTY; LANES];
            let mut begun = false;
            loop {
                let mut covered = 0;
                while self.queued.len < LANES {
                    if projected.bounds.seen != 0 {
                        let lane = projected.bounds.seen.trailing_zeros() as usize & (LANES - 1);
                        projected.bounds.seen &= projected.bounds.seen - 1;
                        let at = (places, &projected, lane);
                        covered +=
                            self.queue_or_merge(lanes, at, &mut boxes, &mut descent, zbuffer);
                        continue;
                    }
                    if covered >= MANY_RAYS {
                        break;
                    }
                    self.fill_batch(lanes, &mut descent, &part, zbuffer, &mut ());
                    if self.batch.len == 0 {
                        break;
                    }
                    if !self.clip.is_empty() && !self.clip_batch() {
                        continue;
                    }
                    if !begun {
                        begun = true;
                        self.decisions.set_rays(&space, &part);
                        zbuffer.clear_places(lanes, places);
                    }
                    self.project_batch(lanes, (&projector, &space), places, &mut projected);
                }
                if self.queued.len == 0 {
                    return begun;
                }
                let corners = self
                    .accel
                    .eight_corners::<INSTANCES>(lanes, self.queued.primitives());
                let primitives = &self.queued.primitives[..self.queued.len];
                let decisions = &mut self.decisions;
                zbuffer.rasterize_at_places(
                    lanes,
                    (&space, places),
                    &corners,
                    &boxes,
                    primitives,
                    decisions,
                );
                self.counts.triangles += primitives.len() as u64;
                self.queued.len = 0;
                if zbuffer.wants_single_rays()
                    && zbuffer.has_overflowed()
                    && self.reference.is_multiplied()
                {
                    self.reference = self.reference.not_multiplied();
                    continue 'packet;
                }
                if zbuffer.has_overflowed() && self.shorten_unit(&places.view) {
                    continue 'packet;
                }
                if let Some(primitive) = zbuffer.wanted_reference()
                    && self.refer_to(primitive, &space, (SIDE as f32, SIDE as f32))
                {
                    continue 'packet;
                }
                descent.merged_small = false;
                descent.limits = self.limits(lanes, zbuffer);
            }
        }
    }

    /// Bounds the batch's triangles among the rays, and prepares the small ones.
    #[inline(always)]
    fn project_batch(
        &self,
        lanes: impl Lanes,
        (projector, space): (&CornerProjector, &PacketSpace),
        places: &Places,
        projected: &mut TrianglesAtPlaces,
    ) {
        let corners = self
            .accel
            .eight_corners::<INSTANCES>(lanes, Batch::primitives(&self.batch));
        let count = self.batch.len;
        if !projected.project(lanes, projector, &corners, count, &places.around) {
            space.bound_places(&corners, count, &mut projected.bounds);
        }
        // Depth keys of small triangles are too coarse to be relative, and what clipping planes cut has further edges.
        projected.small &= match self.reference.is_zero() {
            true => !self.cut,
            false => 0,
        };
    }

    /// Merges one of the batch's triangles if it is small, and queues it for set-up otherwise; neither where it is
    /// occluded. Returns how many rays it may cover.
    #[inline(always)]
    fn queue_or_merge(
        &mut self,
        lanes: impl Lanes,
        (places, projected, lane): (&Places, &TrianglesAtPlaces, usize),
        boxes: &mut [PlaceBox; LANES],
        descent: &mut Descent,
        zbuffer: &mut IntervalZBuffer,
    ) -> i32 {
        let primitive = self.batch.primitives[lane];
        let near = (self.reference).relative_above(projected.bounds.nearest[lane]);
        let around = projected.bounds.of(lane);
        let cells = places.cells_touched(lanes, &around);
        if zbuffer.occludes_cells(lanes, cells, near) {
            return 0;
        }
        if self.reference.is_plane() {
            let is_occluded = match self.decisions.side_of_reference(primitive) {
                SideOfPlane::Behind(nearest) => zbuffer.occludes_cells(lanes, cells, nearest),
                SideOfPlane::Within => zbuffer.sure_hits_precede(cells, primitive, &self.decisions),
                SideOfPlane::Neither => false,
            };
            if is_occluded {
                return 0;
            }
        }
        if projected.small >> lane & 1 != 0 {
            let small = (projected.small(lane), primitive);
            let decisions = &mut self.decisions;
            if zbuffer.rasterize_small_at(lanes, places, small, (cells, &around), decisions) {
                descent.merged_small = true;
                self.counts.triangles += 1;
            }
        } else if places.has_ray_within(lanes, cells, &around) {
            boxes[self.queued.len & (LANES - 1)] = around;
            self.queued.push(primitive);
            return (cells.count_ones() as usize * ROW) as i32;
        }
        0
    }
}
