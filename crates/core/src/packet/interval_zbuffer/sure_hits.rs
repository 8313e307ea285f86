//! Triangles that the rays of a cell surely hit. Where layers lie closer together than single precision distinguishes, most
//! triangles are behind these for all rays of the cell, by the planes of the two, and need not be merged; and those that
//! are in front of all of them are merged without an order ray by ray. Of triangles of one plane the one with the lowest
//! primitive id is hit first: there the greatest id of a cell's sure hits stands for all of them.

use super::{CELLS, IntervalZBuffer, ROW, UNDECIDED, is_uniform};
use crate::hit::MISS;
use crate::packet::decisions::Decisions;
use crate::packet::plane_order::PlacesWithin;
use std::cmp::Ordering::{Greater, Less};

/// The most sure hits of a cell, which take one test each. Layers leave a few triangles in long runs. With a larger number
/// comparing takes longer than merging the eight rows; with a smaller one, cells where layers cross are merged ray by ray.
const MOST: usize = 16;

/// The sure hits of each cell. They stay true as triangles are merged, though nearer ones may be found.
#[derive(Clone, Debug, Default)]
pub(super) struct SureHits {
    /// Empty before the first is needed, since most pictures need none.
    cells: Vec<SureHitsOfCell>,
    /// The cells, as bits, whose `cover` is known.
    covered: u32,
    /// The cells whose list is known.
    listed: u32,
    /// The cells that may have changed since.
    outdated: u32,
}

#[derive(Clone, Copy, Debug)]
struct SureHitsOfCell {
    /// A triangle that all rays of the cell surely hit: one that is near, compared with others that they all hit.
    cover: u32,
    /// Triangles of which each ray of the cell surely hits at least one.
    list: [u32; MOST],
    /// Zero where a ray has no sure hit, or all of them are too many.
    count: usize,
    /// Whether each ray's closest hit so far is in the list.
    is_decided: bool,
    /// Where each ray has a sure hit in the reference plane, the greatest primitive id of these, else [`MISS`]: however
    /// many they are, a triangle of the plane that comes after it is behind them.
    last_in_plane: u32,
}

impl SureHitsOfCell {
    const NONE: Self = Self {
        cover: MISS,
        list: [MISS; MOST],
        count: 0,
        is_decided: false,
        last_in_plane: MISS,
    };

    /// Whether there is a list, and something holds for all in it. The one for which it did not hold comes first from then
    /// on.
    fn are_all(&mut self, mut holds: impl FnMut(u32) -> bool) -> bool {
        let list = &mut self.list[..self.count];
        let failed = (list.iter()).position(|&primitive| !holds(primitive));
        if let Some(failed) = failed {
            list.swap(0, failed);
        }
        self.count > 0 && failed.is_none()
    }
}

impl SureHits {
    pub(super) fn clear(&mut self) {
        self.covered = 0;
        self.listed = 0;
    }

    /// Some cells, as bits, have changed.
    #[inline(always)]
    pub(super) fn outdate(&mut self, cells: u32) {
        self.outdated |= cells;
    }

    /// Sets a cell's sure hits to one triangle, the closest hit of all its rays.
    pub(super) fn set(&mut self, primitive: u32, cell: usize) {
        let mut sure_hits = SureHitsOfCell {
            cover: primitive,
            count: 1,
            is_decided: true,
            ..SureHitsOfCell::NONE
        };
        sure_hits.list[0] = primitive;
        *self.cell(cell) = sure_hits;
        self.covered |= 1 << cell;
        self.listed |= 1 << cell;
    }

    fn cell(&mut self, cell: usize) -> &mut SureHitsOfCell {
        if self.cells.is_empty() {
            self.cells.resize(CELLS * CELLS, SureHitsOfCell::NONE);
        }
        &mut self.cells[cell]
    }
}

impl IntervalZBuffer {
    /// Keeps a triangle that all rays of a cell surely hit, if it is nearer at the cell's centre than the one that is kept.
    #[inline(never)]
    pub(super) fn keep_cover(
        &mut self,
        primitive: u32,
        (cell, places): (usize, &PlacesWithin),
        decisions: &mut Decisions<'_>,
    ) {
        let cell = cell % (CELLS * CELLS);
        let has_cover = self.sure_hits.covered >> cell & 1 != 0;
        let cover = &mut self.sure_hits.cell(cell).cover;
        let centre = PlacesWithin {
            half: [0.0; 2],
            ..*places
        };
        // This way round the order is known from `is_behind_sure_hits`.
        if !has_cover || decisions.order([*cover, primitive]).within(&centre) == Some(Greater) {
            *cover = primitive;
        }
        self.sure_hits.covered |= 1 << cell;
    }

    /// Whether all rays of some cells, as bits, surely hit triangles of the reference plane that come before this one,
    /// which lies in it.
    #[inline(never)]
    pub(in crate::packet) fn sure_hits_precede(
        &self,
        cells: u32,
        primitive: u32,
        decisions: &Decisions<'_>,
    ) -> bool {
        let SureHits {
            cells: of_cells,
            covered,
            listed,
            ..
        } = &self.sure_hits;
        let Some(id) = decisions.id_in_plane(primitive) else {
            return false;
        };
        let has = |cells: u32, cell: usize| cells >> cell & 1 != 0;
        let precede = |cell: usize| {
            let known = &of_cells[cell];
            has(*listed, cell) && known.last_in_plane < id
                || has(*covered, cell)
                    && decisions
                        .id_in_plane(known.cover)
                        .is_some_and(|cover| cover < id)
        };
        let all = 0..CELLS * CELLS;
        cells & !(covered | listed) == 0 && all.filter(|&cell| has(cells, cell)).all(precede)
    }

    /// Whether each ray of a cell has a sure hit that is surely nearer than this triangle, by the planes of the two. For
    /// cells in which depths have left orders undecided.
    #[inline(never)]
    pub(super) fn is_behind_sure_hits(
        &mut self,
        primitive: u32,
        (cell, places): (usize, &PlacesWithin),
        decisions: &mut Decisions<'_>,
    ) -> bool {
        let cell = cell % (CELLS * CELLS);
        let has = |cells: u32| cells >> cell & 1 != 0;
        let id = decisions.id_in_plane(primitive);
        if let Some(id) = id
            && has(self.sure_hits.listed)
        {
            let last = self.sure_hits.cell(cell).last_in_plane;
            if last < id {
                return true;
            }
            if last != MISS && !has(self.sure_hits.outdated | self.dirty) {
                return false;
            }
        }
        let is_nearer = |decisions: &mut Decisions<'_>, other| {
            decisions.order([other, primitive]).within(places) == Some(Less)
        };
        if has(self.sure_hits.covered) && is_nearer(decisions, self.sure_hits.cell(cell).cover) {
            return true;
        }
        if has(self.sure_hits.listed) {
            let known = self.sure_hits.cell(cell);
            let is_cover_alone = known.count == 1 && known.list[0] == known.cover;
            if !is_cover_alone && known.are_all(|other| is_nearer(decisions, other)) {
                return true;
            }
            if !has(self.sure_hits.outdated | self.dirty) {
                return false;
            }
        }
        // Nearer hits may have been found.
        self.sure_hits.listed |= 1 << cell;
        self.sure_hits.outdated &= !(1 << cell);
        let cover = self.sure_hits.cell(cell).cover;
        let listed = self.list_sure_hits(cell, decisions);
        if listed.count == 0 && listed.last_in_plane == MISS {
            // Looking for them again soon would find none.
            self.contested[cell] = 0;
        }
        *self.sure_hits.cell(cell) = SureHitsOfCell { cover, ..listed };
        match id {
            Some(id) if listed.last_in_plane != MISS => listed.last_in_plane < id,
            _ => (self.sure_hits.cell(cell)).are_all(|other| is_nearer(decisions, other)),
        }
    }

    /// Whether a triangle is surely nearer than the closest hits so far of all rays of a cell, by the planes of each two. For
    /// triangles that [`Self::is_behind_sure_hits`] has just been called for: it lists the hits.
    #[inline(never)]
    pub(super) fn is_before_sure_hits(
        &mut self,
        primitive: u32,
        (cell, places): (usize, &PlacesWithin),
        decisions: &mut Decisions<'_>,
    ) -> bool {
        let known = self.sure_hits.cell(cell % (CELLS * CELLS));
        let is_before = |other| decisions.order([other, primitive]).within(places) == Some(Greater);
        known.is_decided && known.are_all(is_before)
    }

    fn list_sure_hits(&self, cell: usize, decisions: &Decisions<'_>) -> SureHitsOfCell {
        let mut found = SureHitsOfCell {
            is_decided: true,
            ..SureHitsOfCell::NONE
        };
        let (mut last_in_plane, mut are_too_many) = (Some(0), false);
        let (rows, _) = self.primitives.as_chunks::<ROW>();
        let mut last = MISS;
        for row in 0..ROW {
            let row = (cell / CELLS * ROW + row) * CELLS + cell % CELLS;
            let entries = &rows[row];
            // Layers mostly fill rows with one triangle.
            if last < UNDECIDED && is_uniform(entries, last) {
                continue;
            }
            // Entries that are not those of their neighbours, and those that say too little.
            let mut rest = 0;
            for (lane, &entry) in entries.iter().enumerate() {
                rest |= u32::from(entry != last || entry >= UNDECIDED) << lane;
                last = entry;
            }
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize % ROW;
                rest &= rest - 1;
                let (ray, entry) = (row * ROW + lane, entries[lane]);
                // Entries without a ray are infinitely near.
                if entry == MISS && self.low[ray] == f32::INFINITY {
                    continue;
                }
                let Some(sure_hit) = self.sure_hit(ray, entry) else {
                    return SureHitsOfCell::NONE;
                };
                found.is_decided &= entry != UNDECIDED;
                if let Some(greatest) = last_in_plane {
                    last_in_plane = decisions.id_in_plane(sure_hit).map(|id| greatest.max(id));
                }
                // All of the list at once: what is not in use is no triangle.
                let is_listed = |any, &listed| any | (listed == sure_hit);
                if found.list.iter().fold(false, is_listed) {
                    continue;
                }
                are_too_many |= found.count == MOST;
                if !are_too_many {
                    found.list[found.count] = sure_hit;
                    found.count += 1;
                } else if last_in_plane.is_none() {
                    return SureHitsOfCell::NONE;
                }
            }
        }
        if are_too_many {
            found = SureHitsOfCell::NONE;
        }
        found.last_in_plane = last_in_plane.unwrap_or(MISS);
        found
    }
}
