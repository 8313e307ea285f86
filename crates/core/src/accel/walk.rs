//! The way of a block of rays down the tree, to the triangles that they may meet.
//!
//! A large block walks first, until it has a short list of sub-trees that its frustum touches; the blocks
//! in it start from that list, from near to far. Triangles that they come to are placed among their rays
//! eight at a time (`footprint`); those of few rays are met there and then, and what that leaves is set up
//! eight at a time as well.

use super::Accel;
use super::frustum::{Frustum, SubFrusta, Viewpoint, Window};
use super::levels::Notice;
use super::simd::Lanes;
use super::tile::CastCounts;
use super::tree::{Box32, BoxPair, DEPTH_LIMIT, Subtree};
use crate::camera::{Lattice, Projection};
use crate::intersect::Cull;
use crate::intersect::block::{Block, MetFew};
use crate::intersect::edge_on::EdgeOn;
use crate::intersect::footprint::{Footprints, Placer, RayBox};
use crate::intersect::setup::{self, BlockSpace, CornerLanes, ROW};
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Sub-trees at which the large block's walk ends: below, each block sorts out its own.
const LIST_LENGTH: usize = 24;

/// How much further than the horizon a box must begin to be left out: rounding of the horizon's
/// inverse and of the box's distance are each a few 2⁻²⁴.
const BEYOND: f32 = 1.0 + 1e-5;

/// The most triangles of a small sub-tree, whose triangles are taken in a row: its nodes would take
/// longer than what they spare.
const RUN: u32 = 32;

/// How large a small sub-tree's box is at most, its three sides together, as a number of columns.
const SMALL: f64 = 16.0;

/// Sub-trees that wait at most: a pair of the list, one more for each level below it, and what is written
/// above the top.
const STACK: usize = DEPTH_LIMIT + 3;

/// Rays of boxes at which triangles are set up, though there be fewer than are set up at once: they may
/// hide what else is on the way.
const MANY_RAYS: i32 = 32;

/// Nodes with a child that might be hidden from the sub-blocks that it touches, before it is told of any
/// which it touches: to make the sub-blocks' frusta takes as long as for so many to tell.
const DOUBTFUL: usize = 8;

/// Nodes that are asked for when a sub-tree is come to: what is below a node follows it, and waiting for
/// memory took half of a walk through 4 million triangles.
const NODES_AHEAD: usize = 4;

/// A rectangle of a lattice's rays.
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub(super) column: u32,
    pub(super) row: u32,
    pub(super) columns: u32,
    pub(super) rows: u32,
}

impl Part {
    /// Its parts of at most `side × side` rays.
    #[inline(always)]
    pub(super) fn split(self, side: u32) -> impl Iterator<Item = Self> {
        let (right, bottom) = (self.column + self.columns, self.row + self.rows);
        (self.row..bottom)
            .step_by(side as usize)
            .flat_map(move |row| {
                (self.column..right)
                    .step_by(side as usize)
                    .map(move |column| Self {
                        column,
                        row,
                        columns: side.min(right - column),
                        rows: side.min(bottom - row),
                    })
            })
    }
}

/// Up to eight slots, and room for what is written beyond them.
#[derive(Default)]
struct Batch {
    slots: [u32; 2 * setup::LANES],
    len: usize,
}

impl Batch {
    /// Adds a slot where there is room.
    #[inline(always)]
    fn push(&mut self, slot: u32) {
        self.slots[self.len & (setup::LANES - 1)] = slot;
        self.len += 1;
    }

    /// Takes as many slots of a run as there is room for.
    #[inline(always)]
    fn take(&mut self, run: &mut Range<u32>) {
        let room = &mut self.slots[self.len & (setup::LANES - 1)..];
        let last = run.end - 1;
        for (slot, next) in room.iter_mut().take(setup::LANES).zip(run.start..) {
            *slot = next.min(last);
        }
        let count = run.len().min(setup::LANES - self.len);
        self.len += count;
        run.start += count as u32;
    }

    /// The eight.
    #[inline(always)]
    fn slots(&self) -> &[u32; setup::LANES] {
        self.slots.first_chunk().unwrap_or(&[0; setup::LANES])
    }
}

/// What became of a triangle that was placed among a block's rays.
enum Fate {
    /// No ray meets it, or what they have met is nearer.
    Hidden,
    /// Some of its few rays have met it.
    Met,
    /// It is to be set up for so many rays.
    Wanted(i32),
    /// It is to be set up, with others that were met, and there is no room for so many.
    NoRoom,
}

/// Two sub-trees of a large block's list.
struct Pair {
    boxes: BoxPair,
    subtrees: [Subtree; 2],
    /// Where the nearer one begins along the view axis.
    near: f32,
}

/// The walk of a lattice's blocks through the tree.
pub(super) struct Walk<'a> {
    accel: &'a Accel,
    lattice: &'a Lattice,
    eye: DVec3,
    eye_error: f64,
    /// The large block's sub-trees in pairs, from near to far.
    pairs: Vec<Pair>,
    /// The same one by one: what each is, its box, and where it begins.
    pub(super) list: Vec<(Subtree, Box32, f32)>,
    next: Vec<(Subtree, Box32, f32)>,
    /// Slots of the leaves that were come to.
    batch: Batch,
    /// Those of them whose triangles are to be set up, with their boxes of rays.
    wanted: Batch,
    boxes: [RayBox; setup::LANES],
    edge_on: EdgeOn,
    pub(super) counts: CastCounts,
}

impl<'a> Walk<'a> {
    pub(super) fn new(accel: &'a Accel, lattice: &'a Lattice) -> Self {
        let eye_in_world = lattice.camera.placement().eye;
        let eye = eye_in_world - accel.origin;
        let off = accel.origin != DVec3::ZERO;
        let eye_error = if off {
            eye.abs().max_element() * f64::EPSILON * 0.5
        } else {
            0.0
        };
        Self {
            accel,
            lattice,
            eye,
            eye_error,
            pairs: Vec::new(),
            list: Vec::new(),
            next: Vec::new(),
            batch: Batch::default(),
            wanted: Batch::default(),
            boxes: [RayBox::default(); setup::LANES],
            edge_on: EdgeOn::new(&lattice.camera, accel.origin),
            counts: CastCounts::default(),
        }
    }

    /// The window of the image plane that a part's rays go through.
    fn window(&self, part: &Part) -> Window {
        let (x0, y0) = self.lattice.place(part.column, part.row);
        let (x1, y1) = self
            .lattice
            .place(part.column + part.columns - 1, part.row + part.rows - 1);
        let (left, top) = self.lattice.camera.across_and_along(x0, y0);
        let (right, bottom) = self.lattice.camera.across_and_along(x1, y1);
        Window {
            across: (left, right),
            along: (bottom, top),
        }
    }

    fn viewpoint(&self) -> Viewpoint<'a> {
        Viewpoint {
            camera: &self.lattice.camera,
            eye: self.eye,
            eye_error: self.eye_error,
            bounds: &self.accel.tree.bounds,
        }
    }

    fn frustum(&self, part: &Part) -> Frustum {
        Frustum::new(self.viewpoint(), &self.window(part))
    }

    /// The frusta of a block's sub-blocks, each as if the block had all its rays.
    #[inline(never)]
    fn sub_frusta(&self, part: &Part) -> SubFrusta {
        let diagonal = std::array::from_fn(|sub| {
            let from = (sub * ROW) as u32;
            self.window(&Part {
                column: part.column + from,
                row: part.row + from,
                columns: ROW as u32,
                rows: ROW as u32,
            })
        });
        SubFrusta::new(self.viewpoint(), &diagonal)
    }

    /// Makes the list of sub-trees that a large block's frustum touches.
    #[inline(always)]
    pub(super) fn list(&mut self, lanes: impl Lanes, large: &Part) {
        let tree = &self.accel.tree;
        self.list.clear();
        self.pairs.clear();
        let Some(root) = tree.root else { return };
        let frustum = self.frustum(large);
        self.list.push((root, tree.bounds, f32::NEG_INFINITY));
        let mut deepened = true;
        while deepened && self.list.len() < LIST_LENGTH {
            deepened = false;
            self.next.clear();
            for &(subtree, bounds, near) in &self.list {
                let Some(index) = subtree.node() else {
                    self.next.push((subtree, bounds, near));
                    continue;
                };
                deepened = true;
                self.counts.nodes += 1;
                let node = &tree.nodes[index as usize];
                let children = node.children(index);
                let entered = frustum.enter(lanes, &node.boxes);
                for (child, (near, inside)) in entered.into_iter().enumerate() {
                    if inside {
                        self.next
                            .push((children[child], node.boxes.get(child), near));
                    }
                }
            }
            std::mem::swap(&mut self.list, &mut self.next);
        }
        self.list.sort_unstable_by(|a, b| a.2.total_cmp(&b.2));
        for pair in self.list.chunks(2) {
            let (first, second) = (&pair[0], pair.get(1));
            // An empty box is outside every frustum: its lowest corner is above its highest.
            let nothing = (
                Subtree::default(),
                Box32 {
                    min: Vec3::MAX,
                    max: Vec3::MIN,
                },
                f32::INFINITY,
            );
            let second = second.unwrap_or(&nothing);
            self.pairs.push(Pair {
                boxes: BoxPair::of([first.1, second.1]),
                subtrees: [first.0, second.0],
                near: first.2,
            });
        }
    }

    /// Casts a block's rays. `false`, and the block as it was, where no triangle is near them.
    #[inline(always)]
    pub(super) fn cast(
        &mut self,
        lanes: impl Lanes,
        part: &Part,
        cull: Cull,
        block: &mut Block,
        notice: &mut impl Notice,
    ) -> bool {
        let frustum = self.frustum(part);
        let space = self.space(part, cull);
        let nearest = self.pairs.first().map_or(0.0, |pair| pair.near);
        let placer = Placer::new(&space, nearest);
        let small = self.small();
        let (mut limit, mut least_limit) = (f32::INFINITY, f32::INFINITY);
        let (mut doubtful, mut sub_frusta) = (0, None);
        let mut stack = [(Subtree::default(), 0.0f32); STACK];
        let (mut pair, mut depth) = (0, 0);
        let mut leaf = 0..0;
        let mut placed = Footprints::NONE;
        let (mut begun, mut met_few) = (false, false);
        loop {
            let mut covered = 0;
            while self.wanted.len < setup::LANES {
                if placed.seen != 0 {
                    let lane = placed.seen.trailing_zeros() as usize & (setup::LANES - 1);
                    match self.sort_out(lanes, &placed, lane, block, notice) {
                        Fate::Hidden => {}
                        Fate::Met => met_few = true,
                        Fate::Wanted(rays) => covered += rays,
                        Fate::NoRoom => break,
                    }
                    placed.seen &= placed.seen - 1;
                    continue;
                }
                if covered >= MANY_RAYS {
                    break;
                }
                self.batch.len = 0;
                while self.batch.len < setup::LANES {
                    if !leaf.is_empty() {
                        self.batch.take(&mut leaf);
                        continue;
                    }
                    let (boxes, [a, b]) = if depth > 0 {
                        depth -= 1;
                        let (subtree, near) = stack[depth];
                        if near > limit {
                            continue;
                        }
                        let Some(index) = subtree.node() else {
                            leaf = subtree.slots();
                            notice.reached(leaf.clone());
                            continue;
                        };
                        let node = &self.accel.tree.nodes[index as usize];
                        (&node.boxes, node.children(index))
                    } else if pair < self.pairs.len() && self.pairs[pair].near <= limit {
                        // What the last pair holds is met first: it may hide the next one.
                        if self.batch.len > 0 || self.wanted.len > 0 {
                            break;
                        }
                        if std::mem::take(&mut met_few) {
                            block.look_around(lanes);
                            (limit, least_limit) = self.limits(lanes, block);
                            continue;
                        }
                        pair += 1;
                        let Pair {
                            boxes, subtrees, ..
                        } = &self.pairs[pair - 1];
                        (boxes, *subtrees)
                    } else {
                        break;
                    };
                    self.counts.nodes += 1;
                    let [(near_a, inside_a), (near_b, inside_b)] = frustum.enter(lanes, boxes);
                    let (mut a_meets, mut b_meets) =
                        (inside_a & (near_a <= limit), inside_b & (near_b <= limit));
                    // What begins behind all that some sub-blocks have met may touch no others.
                    if a_meets & (near_a > least_limit) | b_meets & (near_b > least_limit) {
                        doubtful += 1;
                        if doubtful > DOUBTFUL {
                            let subs = match &sub_frusta {
                                Some(subs) => subs,
                                None => sub_frusta.insert(self.sub_frusta(part)),
                            };
                            let (in_a, in_b) =
                                (subs.touched(lanes, boxes, 0), subs.touched(lanes, boxes, 1));
                            a_meets &= !block.hides_in(lanes, in_a, self.nearness(near_a));
                            b_meets &= !block.hides_in(lanes, in_b, self.nearness(near_b));
                        }
                    }
                    // The nearer one on top, without a branch: what does not meet is written above.
                    let b_nearer = near_b < near_a;
                    let a_above = if b_nearer { !a_meets } else { b_meets };
                    let b_above = if b_nearer { a_meets } else { !b_meets };
                    let a = small.whole(boxes, 0, near_a, a);
                    let b = small.whole(boxes, 1, near_b, b);
                    stack[depth + usize::from(a_above)] = (a, near_a);
                    stack[depth + usize::from(b_above)] = (b, near_b);
                    depth += usize::from(a_meets) + usize::from(b_meets);
                    self.prefetch(lanes, a, a_meets);
                    self.prefetch(lanes, b, b_meets);
                }
                if self.batch.len == 0 {
                    break;
                }
                if !begun {
                    begun = true;
                    let perspective = self.lattice.camera.projection() == Projection::Perspective;
                    block.clear(lanes, part.columns, part.rows, perspective);
                }
                let corners = self.corners(lanes, self.batch.slots());
                placer.place(lanes, &corners, self.batch.len, &mut placed);
            }
            if self.wanted.len == 0 {
                return begun;
            }
            let corners = self.corners(lanes, self.wanted.slots());
            let slots = &self.wanted.slots[..self.wanted.len];
            let is_edge_on = |slot| self.edge_on.is(slot, self.accel.corners(slot));
            block.meet(lanes, &space, &corners, &self.boxes, slots, is_edge_on);
            self.counts.triangles += slots.len() as u64;
            notice.set_up(slots);
            self.wanted.len = 0;
            met_few = false;
            (limit, least_limit) = self.limits(lanes, block);
        }
    }

    /// Meets a triangle that was placed, as far as that can be done without setting it up.
    #[inline(always)]
    fn sort_out(
        &mut self,
        lanes: impl Lanes,
        placed: &Footprints,
        lane: usize,
        block: &mut Block,
        notice: &mut impl Notice,
    ) -> Fate {
        let slot = self.batch.slots[lane];
        let rays = placed.rays(lane);
        if block.hides(&rays, placed.nearest[lane]) {
            return Fate::Hidden;
        }
        if placed.few >> lane & 1 == 0 {
            if rays.is_narrow() && block.hides_each(lanes, &rays, placed.nearest[lane]) {
                return Fate::Hidden;
            }
            self.want(slot, rays);
            return Fate::Wanted(rays.count());
        }
        let few = &placed.few_rays;
        match block.meet_few(few, lane, &rays, slot) {
            MetFew::Met => {
                self.counts.triangles += 1;
                notice.set_up(&[slot]);
                return Fate::Met;
            }
            MetFew::Nobody => return Fate::Hidden,
            MetFew::Undecided => {}
        }
        while self.wanted.len + 1 < setup::LANES {
            let Some((slot, rays)) = block.forget_rival(few, lane, &rays) else {
                self.want(slot, rays);
                return Fate::Wanted(rays.count());
            };
            // It is counted again once it is set up.
            self.counts.triangles -= 1;
            self.want(slot, rays);
        }
        Fate::NoRoom
    }

    #[inline(always)]
    fn want(&mut self, slot: u32, rays: RayBox) {
        self.boxes[self.wanted.len & (setup::LANES - 1)] = rays;
        self.wanted.push(slot);
    }

    /// The corners of eight triangles.
    #[inline(always)]
    fn corners(&self, lanes: impl Lanes, slots: &[u32; setup::LANES]) -> CornerLanes {
        let [a, b, c, d, e, f, g, h] = *slots;
        let rows = [
            self.row(lanes, a),
            self.row(lanes, b),
            self.row(lanes, c),
            self.row(lanes, d),
            self.row(lanes, e),
            self.row(lanes, f),
            self.row(lanes, g),
            self.row(lanes, h),
        ];
        let [ax, ay, az, bx, by, bz, cx, cy] = lanes.transpose(rows);
        let cz = lanes.load(&[
            self.last(a),
            self.last(b),
            self.last(c),
            self.last(d),
            self.last(e),
            self.last(f),
            self.last(g),
            self.last(h),
        ]);
        let mut out: CornerLanes = [[0.0; setup::LANES]; 9];
        for (out, corners) in out.iter_mut().zip([ax, ay, az, bx, by, bz, cx, cy, cz]) {
            lanes.store(corners, out);
        }
        out
    }

    /// A triangle's first eight coordinates.
    #[inline(always)]
    fn row<L: Lanes>(&self, lanes: L, slot: u32) -> L::Singles {
        let [a, b, c] = self.accel.triangles[slot as usize].corners;
        lanes.load(&[a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y])
    }

    /// Its ninth.
    #[inline(always)]
    fn last(&self, slot: u32) -> f32 {
        self.accel.triangles[slot as usize].corners[2].z
    }

    /// Asks for what a sub-tree on the stack will be read from: its triangles, or nodes that stand
    /// together with its own.
    #[inline(always)]
    fn prefetch(&self, lanes: impl Lanes, subtree: Subtree, meets: bool) {
        if !meets {
            return;
        }
        match subtree.node() {
            Some(node) => {
                for next in 0..NODES_AHEAD {
                    lanes.prefetch(&self.accel.tree.nodes, node as usize + next);
                }
            }
            // Eight triangles are five lines.
            None => {
                for line in 0..=subtree.count as usize * 5 / 8 {
                    lanes.prefetch(&self.accel.triangles, subtree.first as usize + line * 8 / 5);
                }
            }
        }
    }

    fn small(&self) -> Small {
        let camera = &self.lattice.camera;
        let side = (SMALL * camera.plane().step * f64::from(self.lattice.stride)) as f32;
        match camera.projection() {
            Projection::Perspective => Small {
                slope: side / camera.distance() as f32,
                constant: 0.0,
            },
            Projection::Orthographic => Small {
                slope: 0.0,
                constant: side,
            },
        }
    }

    fn space(&self, part: &Part, cull: Cull) -> BlockSpace {
        BlockSpace::new(
            &self.lattice.camera,
            self.eye,
            self.eye_error,
            self.lattice.place(part.column, part.row),
            f64::from(self.lattice.stride),
            (part.columns, part.rows),
            cull,
        )
    }

    /// How far along the view axis a box may begin and still hold something that a ray of the block meets
    /// first, and something that one of some sub-block does.
    #[inline(always)]
    fn limits(&self, lanes: impl Lanes, block: &Block) -> (f32, f32) {
        let (least, most) = block.horizons(lanes);
        (self.limit(least), self.limit(most))
    }

    /// How near a box at most is that begins here along the view axis.
    #[inline(always)]
    fn nearness(&self, near: f32) -> f32 {
        match self.lattice.camera.projection() {
            Projection::Perspective if near > 0.0 => BEYOND / near,
            Projection::Perspective => f32::INFINITY,
            Projection::Orthographic => near.abs() * (BEYOND - 1.0) - near,
        }
    }

    /// How far along the view axis a box may begin and still hold something nearer than `horizon`.
    #[inline(always)]
    fn limit(&self, horizon: f32) -> f32 {
        match self.lattice.camera.projection() {
            // The nearness is the inverse of the depth.
            Projection::Perspective if horizon > 0.0 => BEYOND / horizon,
            Projection::Perspective => f32::INFINITY,
            Projection::Orthographic => -horizon + horizon.abs() * (BEYOND - 1.0),
        }
    }
}

/// Which boxes are small among the rays: those whose sides add up to less than this, by where they begin
/// along the view axis.
struct Small {
    slope: f32,
    constant: f32,
}

impl Small {
    /// The sub-tree, as a leaf if it is small.
    #[inline(always)]
    fn whole(&self, boxes: &BoxPair, which: usize, near: f32, subtree: Subtree) -> Subtree {
        let extent = |axis: usize| boxes.max[axis][which] - boxes.min[axis][which];
        let small = extent(0) + extent(1) + extent(2) < near * self.slope + self.constant;
        if small & (subtree.count <= RUN) {
            subtree.whole()
        } else {
            subtree
        }
    }
}
