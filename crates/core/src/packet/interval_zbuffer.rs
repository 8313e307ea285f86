//! The interval z-buffer of a packet: for each of its 32 × 32 rays the nearest triangle so far, and an interval that
//! contains its depth, in single precision. A ray whose intervals overlap is marked undecided and left to the
//! single-ray path.
//!
//! A triangle with narrow bounds is rasterised row by row. A large one is first tested against cells of 8 × 8 rays:
//! the extremes of its functions over a cell decide whether the cell is missed, covered, or occluded (Abrash,
//! "Rasterization on Larrabee", 2009; Greene, Kass, Miller, "Hierarchical Z-Buffer Visibility", 1993).

mod at_places;
mod cut_triangles;
mod depth_merge;
pub(super) mod edge_functions;
mod provisional;
mod rasterize;
mod sure_hits;
#[cfg(test)]
mod tests;

use super::occlusion::Occlusion;
use super::params::{CELLS, RAYS, ROW, SIDE};
use super::ray_box::RayBox;
use super::rivals::Rivals;
use crate::bvh::tree::TRIANGLE_LIMIT;
use crate::hit::MISS;
use crate::num::choice::lesser;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
pub(crate) use provisional::SmallOutcome;
use sure_hits::SureHits;

/// All lanes of a row, as bits.
const ALL: u32 = (1 << ROW) - 1;

/// The number of rows whose order depths leave undecided, beyond which a packet is cast again with another reference: a
/// few times those of a packet, 128. With fewer, packets where a few triangles touch are cast twice; with more, those
/// with layers are cast again later.
const MANY_CONTESTS: u32 = 400;

/// The number of rays that ill-conditioned triangles may hit, each counted for each triangle, beyond which a packet's
/// rays are cast one by one: eight a ray, which take a tenth of the time that casting the ray does. With fewer, packets
/// are given up whose rays have few rivals; with more, spheres smaller than the roundings of their rays take longer.
const MANY_MARKS: usize = 8 * RAYS;

/// Marks the primitive index of a small triangle that was merged without set-up. No index has this bit.
const PROVISIONAL: u32 = !TRIANGLE_LIMIT;

/// Stored in place of a primitive index where the nearest of several triangles is undecided. A triangle that is
/// surely nearer than all of them replaces it.
///
/// Invariant: the closest hit so far of such a ray, if any, is one of its [`Rivals`].
const UNDECIDED: u32 = MISS - 1;

/// For each ray, in row order, the nearest triangle so far.
///
/// The order of fields and the alignment make eight rays that are read together lie in one cache line. With half of
/// them in two lines casting took 4 to 7 % longer.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct IntervalZBuffer {
    /// Lower bound of the depth key: inverse depth, or negated depth for orthographic packets, so that it
    /// grows towards the eye, relative to the packet's reference. −∞ where nothing is surely hit.
    low: [f32; RAYS],
    /// Upper bound of the depth key.
    high: [f32; RAYS],
    primitives: [u32; RAYS],
    /// Hi-z: the least `low` of each cell. What is surely further is occluded in the cell.
    hi_z: [f32; CELLS * CELLS],
    /// Cells whose hi-z may be out of date, as bits.
    dirty: u32,
    /// For each cell, how many times depths left the order of two triangles undecided in a row of it.
    contested: [u8; CELLS * CELLS],
    /// How many times in all.
    contests: u32,
    /// The triangle that the last of them was with.
    contested_by: u32,
    /// For each undecided ray, the triangles that it is undecided between.
    rivals: Rivals,
    /// For each cell, triangles that its rays surely hit.
    sure_hits: SureHits,
    /// How often a ray was marked undecided because an ill-conditioned triangle may be hit by it.
    marks: usize,
    /// Whether depth keys overflowed that a shorter unit of depth would hold.
    overflowed: bool,
    /// Whether rough triangles are set up again one by one.
    one_by_one: bool,
    /// Whether some of those that were rasterised last were set up again.
    sets_up_again: bool,
    /// Bounds of the depth keys where orthographic rays start: no hit is nearer. Infinite for perspective packets.
    start_keys: [f32; 2],
}

impl IntervalZBuffer {
    pub(crate) fn new() -> Self {
        Self {
            low: [0.0; RAYS],
            high: [0.0; RAYS],
            primitives: [MISS; RAYS],
            hi_z: [f32::NEG_INFINITY; CELLS * CELLS],
            dirty: 0,
            contested: [0; CELLS * CELLS],
            contests: 0,
            contested_by: MISS,
            rivals: Rivals::default(),
            sure_hits: SureHits::default(),
            marks: 0,
            overflowed: false,
            one_by_one: false,
            sets_up_again: false,
            start_keys: [f32::INFINITY; 2],
        }
    }

    /// Clears it for a packet of `columns × rows` rays, at most [`SIDE`] each. `start_keys` bound the depth keys where
    /// orthographic rays start, infinite for perspective packets.
    #[inline(always)]
    pub(crate) fn clear(
        &mut self,
        lanes: impl Lanes,
        columns: u32,
        rows: u32,
        start_keys: [f32; 2],
    ) {
        self.low = [f32::NEG_INFINITY; RAYS];
        self.high = [f32::NEG_INFINITY; RAYS];
        self.primitives = [MISS; RAYS];
        self.hi_z = [f32::NEG_INFINITY; CELLS * CELLS];
        self.dirty = 0;
        self.contested = [0; CELLS * CELLS];
        self.contests = 0;
        self.rivals.clear();
        self.sure_hits.clear();
        self.marks = 0;
        self.overflowed = false;
        self.start_keys = start_keys;
        let (columns, rows) = (columns as usize, rows as usize);
        if columns < SIDE || rows < SIDE {
            // Entries outside the packet are infinitely near, so that no triangle wins them.
            for ray in (0..RAYS).filter(|ray| ray / SIDE >= rows || ray % SIDE >= columns) {
                self.low[ray] = f32::INFINITY;
                self.high[ray] = f32::INFINITY;
            }
            self.dirty = u32::MAX >> (32 - CELLS * CELLS);
            self.update_hi_z(lanes);
        }
    }

    /// A row of primitive indices as stored; decode with [`IntervalZBuffer::primitive`] unless
    /// [`IntervalZBuffer::is_undecided`].
    #[inline(always)]
    pub(crate) fn row(&self, row: u32) -> &[u32] {
        let first = row as usize * SIDE;
        &self.primitives[first..first + SIDE]
    }

    /// Whether depth keys overflowed, since it was cleared, that a shorter unit of depth would hold.
    #[inline(always)]
    pub(crate) fn has_overflowed(&self) -> bool {
        self.overflowed
    }

    /// Whether ill-conditioned triangles leave so many rays undecided that casting all rays one by one takes less time.
    #[inline(always)]
    pub(crate) fn wants_single_rays(&self) -> bool {
        self.marks > MANY_MARKS
    }

    /// Whether some of the triangles that were rasterised last were set up again, so that culling one is worth much.
    #[inline(always)]
    pub(crate) fn sets_up_again(&self) -> bool {
        self.sets_up_again
    }

    /// Leaves all rays undecided, without rivals.
    #[inline(never)]
    pub(crate) fn leave_all_undecided(&mut self) {
        self.primitives = [UNDECIDED; RAYS];
        self.rivals.forget();
    }

    /// A triangle whose plane is a better reference of depth keys, where many orders are left undecided.
    #[inline(always)]
    pub(crate) fn wanted_reference(&self) -> Option<u32> {
        (self.contests > MANY_CONTESTS).then_some(self.contested_by)
    }

    /// The rivals of an undecided ray: see [`Rivals::of`].
    pub(crate) fn rivals(&self, row: u32, column: u32) -> Option<impl Iterator<Item = u32>> {
        self.rivals.of(row as usize * SIDE + column as usize)
    }

    /// Leaves a ray undecided between a triangle and what it had before.
    fn leave_ray_undecided(&mut self, ray: usize, primitive: u32) {
        let stored = std::mem::replace(&mut self.primitives[ray], UNDECIDED);
        if stored != UNDECIDED {
            self.rivals.begin(ray, stored_primitive(stored));
        }
        self.rivals.push(ray, primitive);
    }

    /// A triangle that a ray surely hits, given its stored entry: its closest hit so far, or a sure hit of an undecided
    /// ray. `None` where none is known.
    fn sure_hit(&self, ray: usize, stored: u32) -> Option<u32> {
        if stored == UNDECIDED {
            self.rivals.sure_hit(ray)
        } else {
            stored_primitive(stored)
        }
    }

    /// The primitive index of a stored entry, or [`MISS`].
    #[inline(always)]
    pub(crate) fn primitive(stored: u32) -> u32 {
        if stored == MISS {
            MISS
        } else {
            stored & !PROVISIONAL
        }
    }

    /// Whether a stored entry is undecided.
    #[inline(always)]
    pub(crate) fn is_undecided(stored: u32) -> bool {
        stored == UNDECIDED
    }

    /// Whether all rays of a box surely have a hit nearer than `nearest`, by hi-z.
    #[inline(always)]
    pub(crate) fn occludes(&self, rays: &RayBox, nearest: f32) -> bool {
        let (left, right) = (rays.left as usize / ROW, rays.right as usize / ROW);
        let (top, bottom) = (rays.top as usize / ROW, rays.bottom as usize / ROW);
        let hi_z = |row: usize, column: usize| self.hi_z[(row * CELLS + column) % (CELLS * CELLS)];
        let at_corners = lesser(
            lesser(hi_z(top, left), hi_z(top, right)),
            lesser(hi_z(bottom, left), hi_z(bottom, right)),
        );
        nearest < at_corners
            && (top..=bottom).all(|row| (left..=right).all(|column| nearest < hi_z(row, column)))
    }

    /// Whether each ray of a box of at most eight columns surely has a hit nearer than `nearest`, ray by ray.
    #[inline(always)]
    pub(crate) fn occludes_each(&self, lanes: impl Lanes, rays: &RayBox, nearest: f32) -> bool {
        let columns = (2u32 << (rays.right - rays.left)) - 1;
        let nearest = lanes.splat(nearest);
        // A loop, not `all`: its closure may be compiled without the instruction set of its caller, and then each
        // comparison is a call.
        for y in rays.top..=rays.bottom {
            let first = y as usize * SIDE + rays.left as usize;
            let Some(low) = self.low.get(first..).and_then(|low| low.first_chunk()) else {
                return false;
            };
            if columns & !nearest.lt(lanes.load(low)).bits() != 0 {
                return false;
            }
        }
        true
    }

    /// Depth bounds and primitive indices of eight rays.
    #[inline(always)]
    fn rays(
        &mut self,
        first: usize,
    ) -> Option<(&mut [f32; ROW], &mut [f32; ROW], &mut [u32; ROW])> {
        Some((
            self.low.get_mut(first..)?.first_chunk_mut()?,
            self.high.get_mut(first..)?.first_chunk_mut()?,
            self.primitives.get_mut(first..)?.first_chunk_mut()?,
        ))
    }

    /// As [`Self::rays`], for a row of a cell, the first ray of which is `first`.
    #[inline(always)]
    fn rays_of_row(&mut self, first: usize) -> (&mut [f32; ROW], &mut [f32; ROW], &mut [u32; ROW]) {
        let row = first / ROW % (RAYS / ROW);
        (
            &mut self.low.as_chunks_mut().0[row],
            &mut self.high.as_chunks_mut().0[row],
            &mut self.primitives.as_chunks_mut().0[row],
        )
    }

    /// Recomputes hi-z of the dirty cells.
    #[inline(always)]
    pub(crate) fn update_hi_z(&mut self, lanes: impl Lanes) {
        let mut dirty = self.dirty & ((1 << (CELLS * CELLS)) - 1);
        self.dirty = 0;
        self.sure_hits.outdate(dirty);
        while dirty != 0 {
            let cell = dirty.trailing_zeros() as usize % (CELLS * CELLS);
            dirty &= dirty - 1;
            let first = cell / CELLS * ROW * SIDE + cell % CELLS * ROW;
            let mut least = lanes.splat(f32::INFINITY);
            for row in 0..ROW {
                if let Some((low, _, _)) = self.rays(first + row * SIDE) {
                    least = lanes.load(low).min(least);
                }
            }
            self.hi_z[cell] = least.reduce_min();
        }
    }
}

impl Occlusion for IntervalZBuffer {
    #[inline(always)]
    fn update(&mut self, lanes: impl Lanes) {
        self.update_hi_z(lanes);
    }

    #[inline(always)]
    fn hi_z(&self, lanes: impl Lanes) -> (f32, f32) {
        let (infinity, zero) = (lanes.splat(f32::INFINITY), lanes.splat(0.0));
        let (mut least, mut most_negated) = (infinity, infinity);
        for hi_z in self.hi_z.as_chunks().0 {
            let hi_z = lanes.load(hi_z);
            least = hi_z.min(least);
            // Cells without rays have an infinite one.
            let negated = zero - hi_z;
            let negated = hi_z.lt(infinity).select(negated, infinity);
            most_negated = negated.min(most_negated);
        }
        (least.reduce_min(), -most_negated.reduce_min())
    }

    #[inline(always)]
    fn occludes_cells(&self, lanes: impl Lanes, cells: u32, nearest: f32) -> bool {
        let nearest = lanes.splat(nearest);
        let mut hidden = 0;
        for (rows, hi_z) in self.hi_z.as_chunks().0.iter().enumerate() {
            hidden |= nearest.lt(lanes.load(hi_z)).bits() << (rows * LANES);
        }
        cells & !hidden == 0
    }
}

/// The cell of a ray.
fn cell_of(ray: usize) -> usize {
    ray / (SIDE * ROW) * CELLS + ray % SIDE / ROW
}

/// The primitive index of a stored entry that is neither undecided nor a miss.
#[inline(always)]
fn stored_primitive(stored: u32) -> Option<u32> {
    (stored != MISS && stored != UNDECIDED).then_some(stored & !PROVISIONAL)
}

/// Whether all entries of a row are this one. Comparing with an array of copies would store the copies first.
#[inline(always)]
fn is_uniform(row: &[u32], entry: u32) -> bool {
    row.iter()
        .fold(0, |differs, other| differs | (other ^ entry))
        == 0
}

#[inline(always)]
pub(super) fn for_each_bit(mut bits: u64, mut of: impl FnMut(usize)) {
    while bits != 0 {
        of(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}
