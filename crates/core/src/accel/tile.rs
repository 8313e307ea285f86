//! A tile of rays against the tree: one walk for many rays (Reshetov, Soupikov, Hurley, "Multi-Level Ray
//! Tracing Algorithm", 2005). Rays that a block cannot decide go the way of the single ray.

use super::simd::{Lanes, Work, dispatch};
use super::walk::{Part, Walk};
use super::{Accel, MISS, SlotHit, traverse};
use crate::camera::Lattice;
use crate::intersect::block::Block;
use crate::intersect::row::{self, Corners, RowHits, meet_row};
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
    /// of few rays that needed no set-up.
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
        let mut slots = Vec::new();
        self.find(lattice, cull, precision, &mut slots);
        match detail {
            Detail::Full => self.evaluate(lattice, cull, precision, &slots, hits),
            Detail::Triangle => {
                hits.clear();
                hits.extend(slots.iter().map(|&slot| SlotHit {
                    slot,
                    ..SlotHit::NONE
                }));
            }
        }
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

    /// Where the rays of a lattice meet the triangles that [`Accel::find`] found for them, in place
    /// of what `hits` held: what [`Accel::cast_slot`] answers, bit for bit.
    pub fn evaluate(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        slots: &[u32],
        hits: &mut Vec<SlotHit>,
    ) {
        hits.clear();
        hits.resize(slots.len(), SlotHit::NONE);
        dispatch(
            self.simd,
            Evaluate {
                accel: self,
                lattice,
                cull,
                precision,
                slots,
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
    slots: &'a [u32],
    hits: &'a mut [SlotHit],
}

impl Work for Evaluate<'_> {
    #[inline(always)]
    fn run(mut self, _: impl Lanes) {
        for row in 0..self.lattice.rows {
            for column in (0..self.lattice.columns).step_by(row::LANES) {
                self.evaluate_row(column, row);
            }
        }
    }
}

impl Evaluate<'_> {
    /// At most eight rays of a row.
    #[inline(always)]
    fn evaluate_row(&mut self, column: u32, row: u32) {
        let first = (row * self.lattice.columns + column) as usize;
        let count = row::LANES.min((self.lattice.columns - column) as usize);
        let slots = &self.slots[first..first + count];
        let one = slots.iter().all(|&slot| slot == slots[0]);
        if one && slots[0] == MISS {
            return;
        }
        let mut corners: Corners = [[0.0; row::LANES]; 9];
        if one {
            let [a, b, c] = self.accel.corners(slots[0]).map(|corner| corner.to_array());
            for (all, one) in corners.iter_mut().zip([a, b, c].into_iter().flatten()) {
                *all = [one; row::LANES];
            }
        } else {
            for (lane, &slot) in slots.iter().enumerate().filter(|(_, slot)| **slot != MISS) {
                for (corner, at) in self.accel.corners(slot).iter().zip([0, 3, 6]) {
                    corners[at][lane] = corner.x;
                    corners[at + 1][lane] = corner.y;
                    corners[at + 2][lane] = corner.z;
                }
            }
        }
        let place = self.lattice.place(column, row);
        let stride = f64::from(self.lattice.stride);
        let row_hits = meet_row(
            &self.lattice.camera,
            self.accel.origin,
            place,
            stride,
            &corners,
        );
        let RowHits { t, u, v, sure } = &row_hits;
        for (lane, &slot) in slots.iter().enumerate().filter(|(_, slot)| **slot != MISS) {
            if sure[lane] {
                // Number by number: a hit put together elsewhere first would be read before it is
                // all written.
                let hit = &mut self.hits[first + lane];
                hit.slot = slot;
                hit.t = t[lane];
                hit.u = u[lane];
                hit.v = v[lane];
            } else {
                self.hits[first + lane] = self.evaluate_one(slot, column + lane as u32, row);
            }
        }
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
