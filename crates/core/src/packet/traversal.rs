//! Packet traversal: from the entry points of a large packet down to the triangles that a packet's rays may hit
//! (Reshetov, Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", 2005).
//!
//! The triangles of the leaves reached are projected eight at a time. Small ones are tested and merged at once; the
//! rest are queued, and set up eight at a time.

mod at_places;
mod descent;
mod entry_points;
mod gather;

use super::beside_rays::{CullBesideRays, CullingBalance};
use super::counts::CastCounts;
use super::decisions::Decisions;
use super::depth_reference::{DepthReference, ReferencePlane};
use super::frustum::{CellFrusta, Frustum, Viewpoint, Window};
use super::interval_zbuffer::{IntervalZBuffer, SmallOutcome};
use super::observer::Observer;
use super::occlusion::Occlusion;
use super::params::ROW;
use super::places::TANGENT_ERROR;
use super::plane_keys::SideOfPlane;
use super::ray_bounds::{CornerProjector, ProjectedTriangles};
use super::ray_box::RayBox;
use super::ray_rect::RayRect;
use super::setup::{PacketSpace, origin_error};
use crate::bvh::Accel;
use crate::bvh::tree::{Box32, BoxPair, Subtree};
use crate::camera::{Camera, ImagePlane, Lattice, Projection};
use crate::hit::{Cull, Precision};
use crate::num::simd::{LANES, Lanes};
use crate::ray::relative_origin;
use crate::triangle::clip::{Clip, Kept};
use descent::{DepthLimits, Descent, SmallBoxes};
use entry_points::EntryPair;
use glam::DVec3;
use std::ops::Range;

/// The number of rays in the bounds of the queued triangles at which they are set up although fewer than eight are
/// queued, since they may occlude what comes next. With a larger number packets visit boxes behind the queued
/// triangles; with a smaller one set-up runs with empty lanes.
const MANY_RAYS: i32 = 32;

/// The number of nodes with a possibly occluded child after which the cells' frusta are built, which costs as much as
/// testing about so many nodes. With fewer, packets that are nearly done build them in vain; with more, packets visit
/// boxes that are occluded cell by cell.
const DOUBTFUL: usize = 8;

/// The number of nodes to prefetch for a subtree. Nodes are stored depth first, so a subtree's first nodes are
/// contiguous; waiting for memory took half of a traversal of 4 million triangles. With fewer it waits again; with
/// more, data in use is evicted.
const NODES_AHEAD: usize = 4;

/// Up to eight primitive indices, with room for writes past them.
#[derive(Default)]
struct Batch {
    primitives: [u32; 2 * LANES],
    len: usize,
}

impl Batch {
    /// Appends a primitive index if there is room.
    #[inline(always)]
    fn push(&mut self, primitive: u32) {
        self.primitives[self.len & (LANES - 1)] = primitive;
        self.len += 1;
    }

    /// Appends as many of a run of primitive indices as there is room for, and removes them from the run.
    #[inline(always)]
    fn take(&mut self, run: &mut Range<u32>) {
        let room = &mut self.primitives[self.len & (LANES - 1)..];
        let last = run.end - 1;
        for (primitive, next) in room.iter_mut().take(LANES).zip(run.start..) {
            *primitive = next.min(last);
        }
        let count = run.len().min(LANES - self.len);
        self.len += count;
        run.start += count as u32;
    }

    /// All eight.
    #[inline(always)]
    fn primitives(&self) -> &[u32; LANES] {
        self.primitives.first_chunk().unwrap_or(&[0; LANES])
    }
}

/// The outcome of testing a projected triangle.
enum Outcome {
    /// No ray hits it, or all rays that do have nearer hits.
    Occluded,
    /// It was merged as a small triangle.
    Merged,
    /// It was queued for set-up; its bounds contain so many rays.
    Queued(i32),
    /// It and others must be set up, and the queue is too full for all of them.
    NoRoom,
}

/// The traversal of a lattice's packets, through one tree or through instances ([`Accel::open`]).
pub(super) struct Traversal<'a, const INSTANCES: bool> {
    pub(super) accel: &'a Accel,
    clip: &'a Clip,
    lattice: &'a Lattice,
    /// Whether the rays are those of a cube's face, which differ from the lattice's by up to [`TANGENT_ERROR`].
    pub(super) has_ray_error: bool,
    /// How packets see the scene.
    projection: Projection,
    eye: DVec3,
    eye_error: f64,
    /// Bound on how far parallel rays start from their places on the image plane.
    start_error: f64,
    /// The large packet's entry points in pairs, near to far.
    pairs: Vec<EntryPair>,
    /// The entry points one by one: subtree, box, and the nearest depth along the view axis.
    pub(super) entry_points: Vec<(Subtree, Box32, f32)>,
    next: Vec<(Subtree, Box32, f32)>,
    /// Primitive indices of the leaves reached.
    batch: Batch,
    /// Those of the batch, as bits, that clipping planes cut.
    cut: u32,
    /// Triangles queued for set-up, with the bounds of their rays.
    queued: Batch,
    boxes: [RayBox; LANES],
    /// Exact decisions, made once for all packets.
    decisions: Decisions<'a>,
    /// The reference of the large packet's depth keys.
    reference: DepthReference,
    beside: CullingBalance,
    pub(super) counts: CastCounts,
}

impl<'a, const INSTANCES: bool> Traversal<'a, INSTANCES> {
    pub(super) fn new(
        accel: &'a Accel,
        clip: &'a Clip,
        lattice: &'a Lattice,
        precision: Precision,
    ) -> Self {
        let (eye, eye_error) = relative_origin(lattice.camera.pose().eye, accel.origin);
        Self {
            accel,
            clip,
            lattice,
            has_ray_error: false,
            projection: lattice.camera.projection(),
            eye,
            eye_error,
            start_error: start_error(&lattice.camera, eye),
            pairs: Vec::new(),
            entry_points: Vec::new(),
            next: Vec::new(),
            batch: Batch::default(),
            cut: 0,
            queued: Batch::default(),
            boxes: [RayBox::default(); LANES],
            decisions: Decisions::new(accel, clip, lattice, precision),
            reference: DepthReference::NONE,
            beside: CullingBalance::default(),
            counts: CastCounts::default(),
        }
    }

    /// Sees the scene in perspective from another point than the lattice's eye, which packets' rays pass (`cast/far`).
    pub(super) fn see_from(&mut self, eye: DVec3) {
        self.projection = Projection::Perspective;
        self.eye = eye;
        self.eye_error = 0.0;
    }

    /// The window of the image plane that a rectangle's rays go through.
    fn window(&self, packet: &RayRect) -> Window {
        let (x0, y0) = self.lattice.place(packet.column, packet.row);
        let (x1, y1) = self.lattice.place(
            packet.column + packet.columns - 1,
            packet.row + packet.rows - 1,
        );
        let (left, top) = self.lattice.camera.across_and_along(x0, y0);
        let (right, bottom) = self.lattice.camera.across_and_along(x1, y1);
        let window = Window {
            across: (left, right),
            along: (bottom, top),
        };
        if self.has_ray_error {
            return window.grown(TANGENT_ERROR * self.lattice.camera.distance());
        }
        window
    }

    fn viewpoint(&self) -> Viewpoint<'a> {
        Viewpoint {
            camera: &self.lattice.camera,
            eye: self.eye,
            eye_error: self.eye_error + self.start_error,
            bounds: &self.accel.tree.bounds,
        }
    }

    pub(super) fn frustum(&self, packet: &RayRect) -> Frustum {
        Frustum::new(self.viewpoint(), &self.window(packet))
    }

    /// The frusta of a packet's cells, as if the packet were full.
    #[inline(never)]
    fn cell_frusta(&self, packet: &RayRect) -> CellFrusta {
        let diagonal = std::array::from_fn(|cell| {
            let from = (cell * ROW) as u32;
            self.window(&RayRect {
                column: packet.column + from,
                row: packet.row + from,
                columns: ROW as u32,
                rows: ROW as u32,
            })
        });
        CellFrusta::new(self.viewpoint(), &diagonal)
    }

    /// Casts a packet's rays. Returns `false`, and leaves `zbuffer` unchanged, where no triangle is near them.
    #[inline(always)]
    pub(super) fn cast(
        &mut self,
        lanes: impl Lanes,
        packet: &RayRect,
        cull: Cull,
        zbuffer: &mut IntervalZBuffer,
        observer: &mut impl Observer,
    ) -> bool {
        let of_large = self.reference;
        let begun = 'packet: loop {
            let space = self.space(packet, cull);
            let nearest = self.pairs.first().map_or(0.0, |pair| pair.near);
            let projector = CornerProjector::new(&space, nearest);
            let mut descent = Descent::new(self.frustum(packet), SmallBoxes::new(self.lattice));
            let mut projected = ProjectedTriangles::NONE;
            let mut begun = false;
            loop {
                let mut covered = 0;
                while self.queued.len < LANES {
                    if projected.seen != 0 {
                        let lane = projected.seen.trailing_zeros() as usize & (LANES - 1);
                        match self.test_projected(lanes, &projected, lane, zbuffer, observer) {
                            Outcome::Occluded => {}
                            Outcome::Merged => descent.merged_small = true,
                            Outcome::Queued(rays) => covered += rays,
                            Outcome::NoRoom => break,
                        }
                        projected.seen &= projected.seen - 1;
                        continue;
                    }
                    if covered >= MANY_RAYS {
                        break;
                    }
                    self.fill_batch(lanes, &mut descent, packet, zbuffer, observer);
                    if self.batch.len == 0 {
                        break;
                    }
                    if !self.clip.is_empty() && !self.clip_batch() {
                        continue;
                    }
                    if !begun {
                        begun = true;
                        self.decisions.set_rays(&space, packet);
                        zbuffer.clear(lanes, packet.columns, packet.rows, self.start_keys());
                    }
                    let corners = self
                        .accel
                        .eight_corners::<INSTANCES>(lanes, self.batch.primitives());
                    projector.project(lanes, &corners, self.batch.len, &mut projected);
                    if projected.unbounded != 0 && self.beside.allows_tests() {
                        let beside = CullBesideRays {
                            space: &space,
                            projector: projector.clone(),
                            corners,
                            projected: &mut projected,
                            balance: &mut self.beside,
                            by_edges: zbuffer.sets_up_again(),
                        };
                        beside.cull(self.accel.simd);
                    }
                    if !self.reference.is_zero() {
                        projected.relate_to(self.reference);
                    }
                }
                if self.queued.len == 0 {
                    break 'packet begun;
                }
                let corners = self
                    .accel
                    .eight_corners::<INSTANCES>(lanes, self.queued.primitives());
                let primitives = &self.queued.primitives[..self.queued.len];
                let decisions = &mut self.decisions;
                zbuffer.rasterize(lanes, &space, &corners, &self.boxes, primitives, decisions);
                self.counts.triangles += primitives.len() as u64;
                observer.set_up(primitives);
                self.queued.len = 0;
                if zbuffer.wants_single_rays() && self.decisions.are_exact() {
                    if zbuffer.has_overflowed() && self.reference.is_multiplied() {
                        self.reference = self.reference.not_multiplied();
                        continue 'packet;
                    }
                    zbuffer.leave_all_undecided();
                    break 'packet begun;
                }
                if zbuffer.has_overflowed() && self.shorten_unit(&self.lattice.camera) {
                    continue 'packet;
                }
                if let Some(primitive) = zbuffer.wanted_reference()
                    && self.refer_to(primitive, &space, space.last)
                {
                    continue 'packet;
                }
                descent.merged_small = false;
                descent.limits = self.limits(lanes, zbuffer);
            }
        };
        if self.reference.is_plane() {
            self.reference = of_large;
        }
        begun
    }

    /// Descends until eight triangles are reached, or until the queued triangles should be set up first.
    #[inline(always)]
    fn fill_batch(
        &mut self,
        lanes: impl Lanes,
        descent: &mut Descent,
        packet: &RayRect,
        occlusion: &mut impl Occlusion,
        observer: &mut impl Observer,
    ) {
        self.batch.len = 0;
        while self.batch.len < LANES {
            if !descent.leaf.is_empty() {
                self.batch.take(&mut descent.leaf);
                continue;
            }
            let mut opened = None;
            let (boxes, children) = if descent.depth > 0 {
                descent.depth -= 1;
                let (subtree, near) = descent.stack[descent.depth];
                if near > descent.limits.furthest {
                    continue;
                }
                let Some(index) = subtree.node() else {
                    descent.leaf = subtree.primitives();
                    observer.reached(descent.leaf.clone());
                    continue;
                };
                self.accel.open::<INSTANCES>(index, &mut opened)
            } else if descent.pair < self.pairs.len()
                && self.pairs[descent.pair].near <= descent.limits.furthest
            {
                // The triangles of the last pair are merged first: they may occlude the next pair.
                if self.batch.len > 0 || self.queued.len > 0 {
                    break;
                }
                if std::mem::take(&mut descent.merged_small) {
                    occlusion.update(lanes);
                    descent.limits = self.limits(lanes, occlusion);
                    continue;
                }
                descent.pair += 1;
                let pair = &self.pairs[descent.pair - 1];
                (&pair.boxes, pair.subtrees)
            } else {
                break;
            };
            self.counts.nodes += 1;
            let limits = descent.limits;
            let [(near_a, inside_a), (near_b, inside_b)] = descent.frustum.enter(lanes, boxes);
            let mut a_hit = inside_a & (near_a <= limits.furthest);
            let mut b_hit = inside_b & (near_b <= limits.furthest);
            if !self.clip.is_empty() {
                a_hit &= !self.removes(boxes, 0);
                b_hit &= !self.removes(boxes, 1);
            }
            // A box beyond hi-z of some cells is occluded if it touches only those.
            if a_hit & (near_a > limits.nearest_cell) | b_hit & (near_b > limits.nearest_cell) {
                descent.doubtful += 1;
                if descent.doubtful > DOUBTFUL {
                    let cells = match &descent.cells {
                        Some(cells) => cells,
                        None => descent.cells.insert(self.cell_frusta(packet)),
                    };
                    let in_a = cells.touched(lanes, boxes, 0);
                    let in_b = cells.touched(lanes, boxes, 1);
                    a_hit &= !occlusion.occludes_cells(lanes, in_a, self.depth_key(near_a));
                    b_hit &= !occlusion.occludes_cells(lanes, in_b, self.depth_key(near_b));
                }
            }
            let [a, b] = children;
            let a = descent.small.leaf_if_small(boxes, 0, near_a, a);
            let b = descent.small.leaf_if_small(boxes, 1, near_b, b);
            descent.push([(a, near_a, a_hit), (b, near_b, b_hit)]);
            self.prefetch(lanes, a, a_hit);
            self.prefetch(lanes, b, b_hit);
        }
    }

    /// Tests a projected triangle against hi-z and, if it is small, against its rays; queues it otherwise.
    #[inline(always)]
    fn test_projected(
        &mut self,
        lanes: impl Lanes,
        projected: &ProjectedTriangles,
        lane: usize,
        zbuffer: &mut IntervalZBuffer,
        observer: &mut impl Observer,
    ) -> Outcome {
        let primitive = self.batch.primitives[lane];
        let rays = projected.rays(lane);
        if zbuffer.occludes(&rays, projected.nearest[lane]) {
            return Outcome::Occluded;
        }
        if (projected.small & !self.cut) >> lane & 1 == 0 {
            if rays.is_narrow() && zbuffer.occludes_each(lanes, &rays, projected.nearest[lane]) {
                return Outcome::Occluded;
            }
            if self.reference.is_plane() {
                let is_occluded = match self.decisions.side_of_reference(primitive) {
                    SideOfPlane::Behind(nearest) => zbuffer.occludes(&rays, nearest),
                    SideOfPlane::Within => {
                        zbuffer.sure_hits_precede(rays.cells(), primitive, &self.decisions)
                    }
                    SideOfPlane::Neither => false,
                };
                if is_occluded {
                    return Outcome::Occluded;
                }
            }
            if self.decisions.is_known_never_hit(primitive) {
                return Outcome::Occluded;
            }
            self.queue(primitive, rays);
            return Outcome::Queued(rays.count());
        }
        let coverage = &projected.coverage;
        match zbuffer.test_small(coverage, lane, &rays, primitive) {
            SmallOutcome::Merged => {
                self.counts.triangles += 1;
                observer.set_up(&[primitive]);
                return Outcome::Merged;
            }
            SmallOutcome::Missed => return Outcome::Occluded,
            SmallOutcome::Undecided => {}
        }
        while self.queued.len + 1 < LANES {
            let Some((primitive, rays)) = zbuffer.evict_rival(coverage, lane, &rays) else {
                self.queue(primitive, rays);
                return Outcome::Queued(rays.count());
            };
            // It is counted again when it is set up.
            self.counts.triangles -= 1;
            self.queue(primitive, rays);
        }
        Outcome::NoRoom
    }

    /// Whether clipping planes surely remove all of a box.
    #[inline(always)]
    fn removes(&self, boxes: &BoxPair, which: usize) -> bool {
        !self.clip.is_empty()
            && self.clip.removes(
                boxes.min.map(|least| least[which]),
                boxes.max.map(|most| most[which]),
            )
    }

    /// Drops the triangles that clipping planes remove from the batch, and marks those that they cut. Returns whether
    /// any triangle is left.
    #[inline(never)]
    fn clip_batch(&mut self) -> bool {
        let all = self.batch.primitives;
        let count = std::mem::take(&mut self.batch.len);
        self.cut = 0;
        for &primitive in &all[..count] {
            match self.clip.of(self.accel.corners(primitive)) {
                Kept::Nothing => continue,
                Kept::Some => self.cut |= 1 << self.batch.len,
                Kept::All => {}
            }
            self.batch.push(primitive);
        }
        self.batch.len > 0
    }

    #[inline(always)]
    fn queue(&mut self, primitive: u32, rays: RayBox) {
        self.boxes[self.queued.len & (LANES - 1)] = rays;
        self.queued.push(primitive);
    }

    /// Prefetches what a subtree on the stack will be read from: its triangles, or its first nodes.
    #[inline(always)]
    fn prefetch(&self, lanes: impl Lanes, subtree: Subtree, is_hit: bool) {
        if !is_hit {
            return;
        }
        match subtree.node() {
            Some(node) => {
                for next in 0..NODES_AHEAD {
                    lanes.prefetch(&self.accel.tree.nodes, node as usize + next);
                }
            }
            // Eight triangles take five cache lines.
            None => {
                for line in 0..=subtree.count as usize * 5 / 8 {
                    lanes.prefetch(
                        self.accel.triangles(),
                        subtree.first as usize + line * 8 / 5,
                    );
                }
            }
        }
    }

    fn space(&self, packet: &RayRect, cull: Cull) -> PacketSpace {
        let space = PacketSpace::new(
            &self.lattice.camera,
            self.eye,
            self.eye_error,
            self.lattice.place(packet.column, packet.row),
            f64::from(self.lattice.stride),
            (packet.columns, packet.rows),
            cull,
        );
        let space = if self.has_ray_error {
            space.with_rays_beside(0.0)
        } else {
            space
        };
        space.relative_to(self.reference)
    }

    /// Bounds of the relative depth keys where rays start; infinite for perspective packets.
    fn start_keys(&self) -> [f32; 2] {
        match self.projection {
            Projection::Perspective | Projection::Panoramic(_) => [f32::INFINITY; 2],
            // Orthographic rays start at the image plane, where the negated depth is zero.
            Projection::Orthographic => self.reference.relative_zero(),
        }
    }

    /// Makes depth keys relative to a triangle's plane, for the packet of this space, whose last ray is in this column
    /// and row. False where they are already, or where that is of no use.
    #[inline(never)]
    fn refer_to(&mut self, primitive: u32, space: &PacketSpace, last: (f32, f32)) -> bool {
        if self.reference.is_plane() || !self.decisions.are_exact() {
            return false;
        }
        let plane_of = |primitive| {
            let key = space.depth_key_in_double(self.accel.corners(primitive))?;
            Some(ReferencePlane { primitive, key })
        };
        let Some(plane) = plane_of(primitive) else {
            return false;
        };
        // Distances from the last packet's plane are known.
        let last_plane = self.decisions.last_plane().and_then(plane_of);
        let plane = last_plane
            .filter(|last| last.is_close_to(&plane))
            .unwrap_or(plane);
        let reference = self.reference.with_plane(plane, last);
        self.reference = reference.unwrap_or(self.reference);
        reference.is_some()
    }

    /// Measures depths in the unit for triangles that pass the eye closely, as those do whose keys have overflowed;
    /// `view` is the packet's. False where it is used already, or would not help.
    #[inline(never)]
    fn shorten_unit(&mut self, view: &Camera) -> bool {
        // Where keys are multiplied few rays are left to the few triangles whose keys overflow.
        let is_useful = self.reference.is_in_scene_units()
            && !self.reference.is_multiplied()
            && self.projection != Projection::Orthographic;
        if is_useful {
            let boxes = self.entry_points.iter().map(|entry| entry.1);
            self.reference = DepthReference::close(boxes, view, self.eye);
        }
        is_useful
    }

    /// How far boxes may begin without being occluded.
    #[inline(always)]
    fn limits(&self, lanes: impl Lanes, occlusion: &impl Occlusion) -> DepthLimits {
        let (least, most) = occlusion.hi_z(lanes);
        DepthLimits {
            furthest: self.reference.furthest(self.projection, least),
            nearest_cell: self.reference.furthest(self.projection, most),
        }
    }

    /// An upper bound of the relative depth key of a box that begins at `near` along the view axis.
    #[inline(always)]
    fn depth_key(&self, near: f32) -> f32 {
        self.reference.key_of_box(self.projection, near)
    }
}

/// Bound on how far a camera's parallel rays start from their places on the image plane, zero for others; `eye` is the
/// camera's, relative to the tree's origin.
fn start_error(camera: &Camera, eye: DVec3) -> f64 {
    if camera.projection() != Projection::Orthographic {
        return 0.0;
    }
    let ImagePlane { columns, rows, .. } = camera.plane();
    let (left, top) = camera.across_and_along(0.0, 0.0);
    let (right, bottom) = camera.across_and_along(columns.into(), rows.into());
    let reach = left.abs().max(right.abs()) + top.abs().max(bottom.abs());
    let sizes = [camera.pose().eye, eye].map(|point| point.abs().max_element());
    // A picture is at most twice as wide as it reaches from the view axis.
    origin_error(sizes, 3.0 * reach)
}
