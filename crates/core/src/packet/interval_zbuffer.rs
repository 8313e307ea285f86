//! The interval z-buffer of a packet: for each of its 32 × 32 rays the nearest triangle so far, and an
//! interval that holds its depth, in single precision. A ray whose intervals overlap is marked undecided and
//! left to the single-ray path.
//!
//! A triangle with narrow bounds is rasterised row by row. A large one is tested against cells of 8 × 8 rays
//! first: the extremes of its functions over a cell decide whether the cell is missed, covered, or occluded
//! (Abrash, "Rasterization on Larrabee", 2009; Greene, Kass, Miller, "Hierarchical Z-Buffer Visibility",
//! 1993).

mod at_places;
mod cut_triangles;
mod depth_merge;
mod provisional;
#[cfg(test)]
mod tests;

use super::componentwise_setup::ComponentwiseSetup;
use super::decisions::Decisions;
use super::params::{CELLS, ROW, SIDE};
use super::ray_box::RayBox;
use super::rivals::Rivals;
use super::setup::{CornerLanes, PacketSpace, TriangleSetup};
use crate::bvh::tree::TRIANGLE_LIMIT;
use crate::hit::MISS;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8, dispatch};
use depth_merge::{DepthMerge, UndecidedRays};
pub(crate) use provisional::SmallOutcome;

/// Rays in a packet.
const RAYS: usize = SIDE * SIDE;

/// From a cell's first ray to its centre.
const HALF: f32 = (ROW as f32 - 1.0) * 0.5;
/// Centres of two rows of cells.
const CELL_X: [f32; ROW] = [3.5, 11.5, 19.5, 27.5, 3.5, 11.5, 19.5, 27.5];
const CELL_Y: [f32; ROW] = [3.5, 3.5, 3.5, 3.5, 11.5, 11.5, 11.5, 11.5];
/// Bit masks over two rows of cells: the first one to four columns, and the first row.
const CELL_COLUMNS: [u32; CELLS] = [0x11, 0x33, 0x77, 0xff];
const CELL_FIRST_ROW: u32 = 0x0f;

/// Columns of a row of rays.
const COLUMNS: [f32; ROW] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// All lanes of a row, as bits.
const ALL: u32 = (1 << ROW) - 1;

/// Marks the primitive index of a small triangle that was merged without set-up. No index has this bit.
const PROVISIONAL: u32 = !TRIANGLE_LIMIT;

/// Stored in place of a primitive index where the nearest of several triangles is undecided. A triangle that is
/// surely nearer than all of them replaces it.
///
/// Invariant: the closest hit so far of such a ray, if it has one, is one of its [`Rivals`].
const UNDECIDED: u32 = MISS - 1;

/// The nearest triangle of each ray so far; rows of rays one after another.
///
/// In this order, and aligned: eight rays that are read at once lie in one cache line. Where half of them lay in two,
/// visibility took 4 to 7 % longer.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct IntervalZBuffer {
    /// Lower bound of the depth key: inverse depth, or negated depth for orthographic packets, so that it
    /// grows towards the eye, relative to the packet's reference. −∞ where nothing is surely hit.
    low: [f32; RAYS],
    /// Upper bound of the depth key.
    high: [f32; RAYS],
    primitives: [u32; RAYS],
    /// Hi-z: the least `low` of each cell. What is surely further is occluded there.
    hi_z: [f32; CELLS * CELLS],
    /// Cells whose hi-z may be out of date, as bits.
    dirty: u32,
    /// What undecided rays are undecided between.
    rivals: Rivals,
    /// Where orthographic rays begin: nothing is nearer. Infinite for perspective.
    begin: f32,
}

/// Edge functions and depth key of a triangle: value at the first ray, step per column, step per row.
#[derive(Clone, Copy)]
struct EdgeFunctions {
    primitive: u32,
    edges: [[f32; 3]; 3],
    edge_error: f32,
    depth_key: [f32; 3],
    depth_key_error: f32,
}

impl EdgeFunctions {
    /// Those of lane `l` of a set-up.
    #[inline(always)]
    fn of(set_up: &TriangleSetup, l: usize, primitive: u32) -> Self {
        let linear = |f: &[[f32; LANES]; 3]| [f[0][l], f[1][l], f[2][l]];
        Self {
            primitive,
            edges: [
                linear(&set_up.edges[0]),
                linear(&set_up.edges[1]),
                linear(&set_up.edges[2]),
            ],
            edge_error: set_up.edge_error[l],
            depth_key: linear(&set_up.depth_key),
            depth_key_error: set_up.depth_key_error[l],
        }
    }
}

impl IntervalZBuffer {
    pub(crate) fn new() -> Self {
        Self {
            low: [0.0; RAYS],
            high: [0.0; RAYS],
            primitives: [MISS; RAYS],
            hi_z: [f32::NEG_INFINITY; CELLS * CELLS],
            dirty: 0,
            rivals: Rivals::default(),
            begin: f32::INFINITY,
        }
    }

    /// Clears it for a packet of `columns × rows` rays, at most [`SIDE`] each. `begin` is the depth key where
    /// orthographic rays begin, infinite for perspective.
    #[inline(always)]
    pub(crate) fn clear(&mut self, lanes: impl Lanes, columns: u32, rows: u32, begin: f32) {
        self.low = [f32::NEG_INFINITY; RAYS];
        self.high = [f32::NEG_INFINITY; RAYS];
        self.primitives = [MISS; RAYS];
        self.hi_z = [f32::NEG_INFINITY; CELLS * CELLS];
        self.dirty = 0;
        self.rivals.clear();
        self.begin = begin;
        let (columns, rows) = (columns as usize, rows as usize);
        if columns < SIDE || rows < SIDE {
            // Rays outside the packet accept nothing: they are infinitely near.
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

    /// Brings rivals into the order that [`IntervalZBuffer::rivals`] needs.
    pub(crate) fn sort_rivals(&mut self) {
        self.rivals.sort();
    }

    /// The rivals of an undecided ray, once they are sorted: see [`Rivals::of`].
    pub(crate) fn rivals(&self, row: u32, column: u32) -> Option<&[(u32, u32)]> {
        self.rivals.of(row as usize * SIDE + column as usize)
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

    /// The least and the greatest hi-z of the cells. What is surely further than the least is occluded for
    /// every ray; what is surely further than the greatest, for some cell.
    #[inline(always)]
    pub(crate) fn hi_z(&self, lanes: impl Lanes) -> (f32, f32) {
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

    /// Whether all rays of these cells (as bits) have a hit surely nearer than `nearest`.
    #[inline(always)]
    pub(crate) fn occludes_cells(&self, lanes: impl Lanes, cells: u32, nearest: f32) -> bool {
        let nearest = lanes.splat(nearest);
        let mut hidden = 0;
        for (rows, hi_z) in self.hi_z.as_chunks().0.iter().enumerate() {
            hidden |= nearest.lt(lanes.load(hi_z)).bits() << (rows * LANES);
        }
        cells & !hidden == 0
    }

    /// Whether all rays of a box have a hit surely nearer than `nearest`, judged by hi-z.
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

    /// Whether each ray of a box of at most eight columns has a hit surely nearer than `nearest`.
    #[inline(always)]
    pub(crate) fn occludes_each(&self, lanes: impl Lanes, rays: &RayBox, nearest: f32) -> bool {
        let columns = (2u32 << (rays.right - rays.left)) - 1;
        let nearest = lanes.splat(nearest);
        // A loop, not `all`: its closure may be compiled without the instruction set of its caller, and
        // then each comparison is a call.
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

    /// Sets rough triangles up again by component. Those (as bits) that exact arithmetic decides no ray hits, of the
    /// ill-conditioned ones and of those that orthographic rays may begin at.
    #[inline(never)]
    fn refine(
        &self,
        space: &PacketSpace,
        set_up: &mut TriangleSetup,
        corners: &CornerLanes,
        primitives: &[u32],
        decisions: &mut Decisions<'_>,
    ) -> u32 {
        let mut which = 0;
        if decisions.are_exact() {
            for l in 0..primitives.len().min(LANES) {
                which |= u32::from(set_up.is_rough[l] && set_up.boxes[l].right >= 0) << l;
            }
        }
        if which != 0 {
            let work = ComponentwiseSetup {
                space,
                corners,
                which,
                out: set_up,
            };
            dispatch(decisions.simd(), work);
        }
        let mut never_hit = 0;
        for (l, &primitive) in primitives.iter().enumerate().take(LANES) {
            let begins = decisions.are_exact()
                && self.begin != f32::INFINITY
                && set_up.may_touch(l, self.begin);
            let is_doubtful = set_up.boxes[l].right >= 0 && (set_up.ill_conditioned[l] || begins);
            never_hit |= u32::from(is_doubtful && decisions.is_never_hit(primitive)) << l;
        }
        never_hit
    }

    /// Sets up eight triangles and rasterises those with a primitive index, each within its bounds. Those that are
    /// ill-conditioned, or that rays may begin at, are left out where exact arithmetic decides that no ray hits them.
    #[inline(always)]
    pub(crate) fn rasterize(
        &mut self,
        lanes: impl Lanes,
        space: &PacketSpace,
        corners: &CornerLanes,
        boxes: &[RayBox; LANES],
        primitives: &[u32],
        decisions: &mut Decisions<'_>,
    ) {
        let mut set_up = space.set_up(corners, boxes);
        let any_rough = set_up.is_rough.iter().fold(false, |any, &is| any | is);
        let never_hit = if any_rough || self.begin != f32::INFINITY {
            self.refine(space, &mut set_up, corners, primitives, decisions)
        } else {
            0
        };
        for (l, &primitive) in primitives.iter().enumerate().take(LANES) {
            if never_hit >> l & 1 == 0
                && (decisions.clip().is_empty()
                    || !self.rasterize_cut(lanes, &set_up, l, primitive, decisions))
            {
                self.rasterize_one(lanes, &set_up, l, primitive, decisions);
            }
        }
        self.update_hi_z(lanes);
    }

    #[inline(always)]
    fn rasterize_one(
        &mut self,
        lanes: impl Lanes,
        set_up: &TriangleSetup,
        l: usize,
        primitive: u32,
        decisions: &mut Decisions<'_>,
    ) {
        let functions = EdgeFunctions::of(set_up, l, primitive);
        let RayBox {
            left,
            right,
            top,
            bottom,
        } = set_up.boxes[l];
        let (column, row) = (set_up.column[l] as usize, set_up.row[l] as usize);
        if right < left {
            return;
        }
        if set_up.ill_conditioned[l] {
            self.mark_undecided(
                &functions,
                (column, row),
                (left as usize, right as usize),
                (top as usize, bottom as usize),
            );
        } else if set_up.boxes[l].is_narrow() {
            let rows = (bottom - top + 1) as usize;
            self.rasterize_rows(lanes, &functions, row * SIDE + column, rows, decisions);
            let (first, last) = (column / ROW, column.div_ceil(ROW));
            let columns = (1u32 << first) | (1 << last);
            for cell_row in row / ROW..=bottom as usize / ROW {
                self.dirty |= columns << (CELLS * cell_row);
            }
        } else {
            self.rasterize_cells(
                lanes,
                &functions,
                (column, row),
                (right as usize, bottom as usize),
                decisions,
            );
        }
    }

    /// Rasterises a large triangle cell by cell.
    #[inline(always)]
    fn rasterize_cells(
        &mut self,
        lanes: impl Lanes,
        functions: &EdgeFunctions,
        (column, row): (usize, usize),
        (right, bottom): (usize, usize),
        decisions: &mut Decisions<'_>,
    ) {
        let EdgeFunctions {
            edges,
            edge_error,
            depth_key,
            depth_key_error,
            ..
        } = *functions;
        let columns = right / ROW - column / ROW + 1;
        let rows = bottom / ROW - row / ROW + 1;
        let (error, minus_error) = (lanes.splat(edge_error), lanes.splat(-edge_error));
        // All cells from the first, two rows of them at a time.
        for cell_row in (0..rows).step_by(ROW / CELLS) {
            let (x, y) = (
                lanes.load(&CELL_X),
                lanes.load(&CELL_Y) + (cell_row * ROW) as f32,
            );
            let value = |f: [f32; 3]| {
                let below = lanes.splat(f[0]) + lanes.splat(f[2]) * y;
                below + lanes.splat(f[1]) * x
            };
            let swing = |f: [f32; 3]| lanes.splat((f[1].abs() + f[2].abs()) * HALF);
            let [greatest, least] = {
                let of = |f: [f32; 3]| {
                    let (value, swing) = (value(f), swing(f));
                    [value + swing, value - swing]
                };
                let ([a, p], [b, q], [c, r]) = (of(edges[0]), of(edges[1]), of(edges[2]));
                [a.min(b).min(c), p.min(q).min(r)]
            };
            let outside = greatest.lt(minus_error).bits();
            let inside = error.lt(least).bits();
            let mut nearest = [0.0; ROW];
            let near = value(depth_key) + swing(depth_key);
            (near + depth_key_error).store(&mut nearest);

            let mut queued = !outside & CELL_COLUMNS[columns - 1];
            if cell_row + 1 == rows {
                queued &= CELL_FIRST_ROW;
            }
            while queued != 0 {
                let cell = queued.trailing_zeros() as usize % ROW;
                queued &= queued - 1;
                let (cell_column, cell_row) = (cell % CELLS, cell_row + cell / CELLS);
                let place =
                    ((row / ROW + cell_row) * CELLS + column / ROW + cell_column) % (CELLS * CELLS);
                if nearest[cell] < self.hi_z[place] {
                    continue;
                }
                let (x, y) = ((cell_column * ROW) as f32, (cell_row * ROW) as f32);
                let moved = |f: [f32; 3]| [(f[0] + f[2] * y) + f[1] * x, f[1], f[2]];
                let here = EdgeFunctions {
                    edges: [moved(edges[0]), moved(edges[1]), moved(edges[2])],
                    depth_key: moved(depth_key),
                    ..*functions
                };
                let first = (row + cell_row * ROW) * SIDE + column + cell_column * ROW;
                if inside & (1 << cell) != 0 {
                    self.cover(lanes, &here, first, decisions);
                } else {
                    self.rasterize_rows(lanes, &here, first, ROW, decisions);
                }
                self.dirty |= 1 << place;
            }
        }
    }

    /// Rasterises rows of eight rays.
    #[inline(always)]
    fn rasterize_rows(
        &mut self,
        lanes: impl Lanes,
        functions: &EdgeFunctions,
        first: usize,
        rows: usize,
        decisions: &mut Decisions<'_>,
    ) {
        let EdgeFunctions {
            edges: [e, f, g],
            edge_error,
            depth_key,
            ..
        } = *functions;
        let x = lanes.load(&COLUMNS);
        let row = |f: [f32; 3]| lanes.splat(f[0]) + lanes.splat(f[1]) * x;
        let (mut a, mut b, mut c, mut near) = (row(e), row(f), row(g), row(depth_key));
        let step = |f: [f32; 3]| lanes.splat(f[2]);
        let (step_a, step_b, step_c, step_near) = (step(e), step(f), step(g), step(depth_key));
        let (error, minus_error) = (lanes.splat(edge_error), lanes.splat(-edge_error));
        let merge = DepthMerge::new(lanes, functions, self.begin);
        for row in 0..rows {
            let first = first + row * SIDE;
            let Some((low, high, primitives)) = self.rays(first) else {
                return;
            };
            let least = a.min(b).min(c);
            let outside = least.lt(minus_error);
            let inside = error.lt(least);
            let undecided = merge.row(lanes, near, Some((inside, outside)), low, high, primitives);
            if undecided.rays != 0 {
                self.leave_undecided(merge.primitive, undecided, first, decisions);
            }
            a = a + step_a;
            b = b + step_b;
            c = c + step_c;
            near = near + step_near;
        }
    }

    /// Merges a triangle into a cell whose rays all lie surely inside its edges.
    #[inline(always)]
    fn cover(
        &mut self,
        lanes: impl Lanes,
        functions: &EdgeFunctions,
        first: usize,
        decisions: &mut Decisions<'_>,
    ) {
        let n = functions.depth_key;
        let x = lanes.load(&COLUMNS);
        let mut near = lanes.splat(n[0]) + lanes.splat(n[1]) * x;
        let step = lanes.splat(n[2]);
        let merge = DepthMerge::new(lanes, functions, self.begin);
        for row in 0..ROW {
            let first = first + row * SIDE;
            let Some((low, high, primitives)) = self.rays(first) else {
                return;
            };
            let undecided = merge.row(lanes, near, None, low, high, primitives);
            if undecided.rays != 0 {
                self.leave_undecided(merge.primitive, undecided, first, decisions);
            }
            near = near + step;
        }
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

    /// Marks undecided rays of eight from `first` on as undecided between their triangle so far and another, except those that
    /// are surely inside of it and have one of its plane: there the lower primitive id wins.
    #[inline(never)]
    fn leave_undecided(
        &mut self,
        primitive: u32,
        undecided: UndecidedRays,
        first: usize,
        decisions: &mut Decisions<'_>,
    ) {
        let Some((_, _, primitives)) = self.rays(first) else {
            return;
        };
        let (before, mut rest) = (*primitives, undecided.rays);
        // Neighbouring rays mostly have the same triangle.
        while rest != 0 {
            let stored = before[rest.trailing_zeros() as usize % ROW];
            let mut same = 0;
            for (lane, &other) in before.iter().enumerate() {
                same |= u32::from(other == stored) << lane;
            }
            same &= rest;
            rest &= !same;
            let rival = stored_primitive(stored);
            if let Some(rival) = rival
                && same & undecided.inside != 0
                && let Some(nearer) = decisions.first_in_one_plane(rival, primitive)
            {
                // Both hits have one depth, which either's bounds hold.
                if nearer == primitive {
                    for_each_bit(u64::from(same & undecided.inside), |lane| {
                        self.primitives[first + lane] = primitive;
                    });
                }
                same &= !undecided.inside;
            }
            for_each_bit(u64::from(same), |lane| {
                self.rivals.push_both(first + lane, rival, primitive);
                self.primitives[first + lane] = UNDECIDED;
            });
        }
    }

    /// Marks every ray undecided that an ill-conditioned triangle may hit: those in its bounds where the
    /// signs of its edge functions do not surely differ.
    #[inline(never)]
    fn mark_undecided(
        &mut self,
        functions: &EdgeFunctions,
        (column, row): (usize, usize),
        (left, right): (usize, usize),
        (top, bottom): (usize, usize),
    ) {
        let error = functions.edge_error;
        for j in top..=bottom {
            for i in left..=right {
                let (x, y) = (i as f32 - column as f32, j as f32 - row as f32);
                let values = functions.edges.map(|f| (f[0] + f[2] * y) + f[1] * x);
                let below = values.iter().any(|&value| value < -error);
                let above = values.iter().any(|&value| value > error);
                if !(below & above) {
                    let ray = j * SIDE + i;
                    self.high[ray] = f32::INFINITY;
                    let stored = std::mem::replace(&mut self.primitives[ray], UNDECIDED);
                    self.rivals
                        .push_both(ray, stored_primitive(stored), functions.primitive);
                }
            }
        }
    }

    /// Brings hi-z of the dirty cells up to date.
    #[inline(always)]
    pub(crate) fn update_hi_z(&mut self, lanes: impl Lanes) {
        let mut dirty = self.dirty & ((1 << (CELLS * CELLS)) - 1);
        self.dirty = 0;
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

/// The primitive index of a stored entry that is neither undecided nor a miss.
#[inline(always)]
fn stored_primitive(stored: u32) -> Option<u32> {
    (stored != MISS && stored != UNDECIDED).then_some(stored & !PROVISIONAL)
}

#[inline(always)]
fn for_each_bit(mut bits: u64, mut of: impl FnMut(usize)) {
    while bits != 0 {
        of(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
