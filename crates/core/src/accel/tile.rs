//! A tile of rays against the tree: one walk for many rays (Reshetov, Soupikov, Hurley, "Multi-Level Ray
//! Tracing Algorithm", 2005). Rays that a block cannot decide go the way of the single ray.

use super::simd::{Lanes, Work, dispatch};
use super::walk::{Part, Walk};
use super::{Accel, Hits, MISS, SlotHit, traverse};
use crate::camera::Lattice;
use crate::intersect::block::Block;
use crate::intersect::row::{self, Corners, Places, RowHits, meet_row};
use crate::intersect::setup::SIDE;
use crate::intersect::{Cull, Detail, Precision, PreparedRay};

/// Rays along the side of a block that walks down the tree first.
pub(super) const LARGE_SIDE: u32 = 64;

/// What casting a lattice took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CastCounts {
    /// Rays that met something.
    pub hits: u64,
    /// Nodes of the tree whose children's boxes were tested.
    pub nodes: u64,
    /// Triangles that a block's rays were held against, counted for each block: those set up, and those
    /// of few rays that needed no set-up and that some ray met first, of what it had met by then.
    pub triangles: u64,
    /// Rays that single precision with its bounds left open, and doubles decided.
    pub double_rays: u64,
    /// Rays that doubles with their bounds left open too, decided by exact arithmetic.
    pub exact_rays: u64,
}

impl std::ops::AddAssign for CastCounts {
    fn add_assign(&mut self, other: Self) {
        self.hits += other.hits;
        self.nodes += other.nodes;
        self.triangles += other.triangles;
        self.double_rays += other.double_rays;
        self.exact_rays += other.exact_rays;
    }
}

impl Accel {
    /// Casts every ray of a lattice: its hits row by row, in place of what `hits` held.
    ///
    /// Each is what [`Accel::cast_slot`] answers for that ray, as far as `detail` asks for it. With
    /// [`Precision::Fast`] a block may be right where a single ray in doubles is not.
    pub fn cast_lattice(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        detail: Detail,
        hits: &mut Vec<SlotHit>,
    ) {
        let mut found = Hits::default();
        self.find(lattice, cull, precision, &mut found.slots);
        if detail == Detail::Full {
            self.evaluate(lattice, cull, precision, &mut found);
        }
        hits.clear();
        hits.extend(found.iter());
    }

    /// Finds the triangle that each ray of a lattice meets first: its slot or [`MISS`], row by row,
    /// in place of what `slots` held.
    pub fn find(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        slots: &mut Vec<u32>,
    ) -> CastCounts {
        slots.clear();
        slots.resize(lattice.len(), MISS);
        let mut counts = CastCounts::default();
        if self.tree.root.is_some() {
            dispatch(
                self.simd,
                Find {
                    accel: self,
                    lattice,
                    cull,
                    precision,
                    slots,
                    counts: &mut counts,
                },
            );
        }
        counts
    }

    /// Where the rays of a lattice meet the triangles that [`Accel::find`] found for them, the slots of
    /// `hits`: what [`Accel::cast_slot`] answers, bit for bit.
    pub fn evaluate(&self, lattice: &Lattice, cull: Cull, precision: Precision, hits: &mut Hits) {
        hits.slots.resize(lattice.len(), MISS);
        hits.make_places();
        dispatch(
            self.simd,
            Evaluate {
                accel: self,
                lattice,
                cull,
                precision,
                hits,
            },
        );
    }
}

pub(super) struct Find<'a> {
    pub(super) accel: &'a Accel,
    pub(super) lattice: &'a Lattice,
    pub(super) cull: Cull,
    pub(super) precision: Precision,
    pub(super) slots: &'a mut [u32],
    pub(super) counts: &'a mut CastCounts,
}

impl Work for Find<'_> {
    #[inline(always)]
    fn run(mut self, lanes: impl Lanes) {
        let whole = Part {
            column: 0,
            row: 0,
            columns: self.lattice.columns,
            rows: self.lattice.rows,
        };
        let mut walk = Walk::new(self.accel, self.lattice);
        let mut block = Block::new();
        for large in whole.split(LARGE_SIDE) {
            walk.list(lanes, &large);
            if walk.list.is_empty() {
                continue;
            }
            for part in large.split(SIDE as u32) {
                if walk.cast(lanes, &part, self.cull, &mut block, &mut ()) {
                    self.keep(&part, &block);
                }
            }
        }
        *self.counts = CastCounts {
            nodes: walk.counts.nodes,
            triangles: walk.counts.triangles,
            ..*self.counts
        };
    }
}

impl Find<'_> {
    /// Keeps what a block found, and casts the rays that it left open.
    #[inline(always)]
    pub(super) fn keep(&mut self, part: &Part, block: &Block) {
        let columns = part.columns as usize;
        for row in 0..part.rows {
            let first = ((part.row + row) * self.lattice.columns + part.column) as usize;
            let held = &block.row(row)[..columns];
            let (mut met, mut any_open) = (0, false);
            let kept = &mut self.slots[first..first + columns];
            for (kept, &held) in kept.iter_mut().zip(held) {
                *kept = Block::slot(held);
                met += u32::from(held != MISS);
                any_open |= Block::is_open(held);
            }
            self.counts.hits += u64::from(met);
            if any_open {
                for (column, _) in held
                    .iter()
                    .enumerate()
                    .filter(|held| Block::is_open(*held.1))
                {
                    let slot = self.cast_one(part.column + column as u32, part.row + row);
                    self.slots[first + column] = slot;
                    // It was counted as one that met something.
                    self.counts.hits -= u64::from(slot == MISS);
                }
            }
        }
    }

    /// What [`Accel::cast_slot`] answers.
    #[inline(never)]
    fn cast_one(&mut self, column: u32, row: u32) -> u32 {
        let ray = self.lattice.ray(column, row);
        let ray = PreparedRay::new(&ray, self.accel.origin, self.cull, self.precision);
        let Some(ray) = ray else { return MISS };
        let slot = traverse::nearest(self.accel, &ray).slot;
        if ray.was_exact() {
            self.counts.exact_rays += 1;
        } else {
            self.counts.double_rays += 1;
        }
        slot
    }
}

struct Evaluate<'a> {
    accel: &'a Accel,
    lattice: &'a Lattice,
    cull: Cull,
    precision: Precision,
    hits: &'a mut Hits,
}

impl Work for Evaluate<'_> {
    #[inline(always)]
    fn run(mut self, lanes: impl Lanes) {
        for row in 0..self.lattice.rows {
            for column in (0..self.lattice.columns).step_by(row::LANES) {
                self.evaluate_row(lanes, column, row);
            }
        }
    }
}

impl Evaluate<'_> {
    /// At most eight rays of a row.
    #[inline(always)]
    fn evaluate_row(&mut self, lanes: impl Lanes, column: u32, row: u32) {
        let first = (row * self.lattice.columns + column) as usize;
        let count = row::LANES.min((self.lattice.columns - column) as usize);
        let mut slots = [MISS; row::LANES];
        slots[..count].copy_from_slice(&self.hits.slots[first..first + count]);
        if slots == [MISS; row::LANES] {
            return;
        }
        let corners = self.corners(lanes, &slots);
        let places = Places::new(self.lattice, column, row);
        let found = meet_row(&self.lattice.camera, self.accel.origin, places, &corners);
        let mut open = false;
        let RowHits {
            mut t,
            mut u,
            mut v,
            sure,
        } = found;
        for lane in 0..row::LANES {
            let met = slots[lane] != MISS;
            open |= met & !sure[lane];
            t[lane] = if met { t[lane] } else { SlotHit::NONE.t };
            u[lane] = if met { u[lane] } else { SlotHit::NONE.u };
            v[lane] = if met { v[lane] } else { SlotHit::NONE.v };
        }
        let Hits {
            t: all_t,
            u: all_u,
            v: all_v,
            ..
        } = &mut *self.hits;
        for (all, row) in [(all_t, t), (all_u, u), (all_v, v)] {
            all[first..first + count].copy_from_slice(&row[..count]);
        }
        if open {
            for lane in (0..count).filter(|&lane| slots[lane] != MISS && !sure[lane]) {
                let hit = self.evaluate_one(slots[lane], column + lane as u32, row);
                self.hits.set(first + lane, hit);
            }
        }
    }

    /// The corners of eight rays' triangles. Each triangle takes all lanes from its first one on, until
    /// the next one's.
    #[inline(always)]
    fn corners<L: Lanes>(&self, lanes: L, slots: &[u32; row::LANES]) -> Corners {
        let mut all = [lanes.splat(0.0); 9];
        let mut lane = 0;
        while lane < row::LANES {
            let slot = slots[lane];
            let from = lanes.from(lane);
            while lane < row::LANES && slots[lane] == slot {
                lane += 1;
            }
            if slot != MISS {
                let [a, b, c] = self.accel.corners(slot);
                let one = [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z];
                for (all, one) in all.iter_mut().zip(one) {
                    *all = lanes.pick(from, lanes.splat(one), *all);
                }
            }
        }
        let mut corners = [[0.0; row::LANES]; 9];
        for (corner, all) in corners.iter_mut().zip(all) {
            lanes.store(all, corner);
        }
        corners
    }

    #[inline(never)]
    fn evaluate_one(&self, slot: u32, column: u32, row: u32) -> SlotHit {
        let ray = self.lattice.ray(column, row);
        let ray = PreparedRay::new(&ray, self.accel.origin, self.cull, self.precision);
        ray.map_or(SlotHit::NONE, |ray| {
            ray.evaluate(slot, self.accel.corners(slot)).to_slot_hit()
        })
    }
}
