//! The interval z-buffer of a packet: for each of its 32 × 32 rays the nearest triangle so far, and an
//! interval that holds its depth, in single precision. A ray whose intervals overlap is marked undecided and
//! left to the single-ray path.
//!
//! A triangle with narrow bounds is rasterised row by row. A large one is tested against cells of 8 × 8 rays
//! first: the extremes of its functions over a cell tell whether the cell is missed, covered, or occluded
//! (Abrash, "Rasterization on Larrabee", 2009; Greene, Kass, Miller, "Hierarchical Z-Buffer Visibility",
//! 1993).

mod at_places;
mod cut_triangles;

use super::componentwise_setup::ComponentwiseSetup;
use super::decisions::Decisions;
use super::params::{CELLS, ROW, SIDE};
use super::ray_box::RayBox;
use super::rivals::Rivals;
use super::setup::{CornerLanes, PacketSpace, TriangleSetup};
use super::small_triangles::SmallCoverage;
use crate::bvh::tree::TRIANGLE_LIMIT;
use crate::hit::MISS;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8, dispatch};

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

/// Stands for a primitive index where the nearest of several triangles is undecided. A triangle surely
/// nearer than all of them replaces it.
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

/// What came of testing a small triangle.
pub(crate) enum SmallOutcome {
    /// Some ray hits it first, so far.
    Merged,
    /// No ray hits the triangle, or all that do have nearer hits.
    Missed,
    /// Not merged: it cannot be decided without set-up.
    Undecided,
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

    /// A row of primitive indices as stored; decode with [`IntervalZBuffer::slot`] unless
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
    pub(crate) fn primitive(held: u32) -> u32 {
        if held == MISS {
            MISS
        } else {
            held & !PROVISIONAL
        }
    }

    /// Whether a stored entry is undecided.
    #[inline(always)]
    pub(crate) fn is_undecided(held: u32) -> bool {
        held == UNDECIDED
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

    /// Whether all rays of a box have a hit surely nearer than `nearest`, as far as hi-z tells.
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

    /// Tests a small triangle against the rays of its bounds and merges it, unless some ray leaves
    /// undecided whether it is the nearest.
    ///
    /// One ray at a time: vector stores of overlapping rows would stall on store forwarding, since each
    /// triangle's rows begin at another column.
    #[inline(always)]
    pub(crate) fn test_small(
        &mut self,
        coverage: &SmallCoverage,
        lane: usize,
        rays: &RayBox,
        primitive: u32,
    ) -> SmallOutcome {
        let mut inside = coverage.inside(lane);
        if inside != coverage.perhaps(lane) {
            return SmallOutcome::Undecided;
        }
        let (mut any, mut rivals) = (false, false);
        while inside != 0 {
            let ([x, y], [near_low, near_high]) = coverage.ray(lane, inside.trailing_zeros());
            inside &= inside - 1;
            let ray = (first_ray(rays) + y * SIDE + x) % RAYS;
            let (low, high, held) = (
                &mut self.low[ray],
                &mut self.high[ray],
                &mut self.primitives[ray],
            );
            let wins = near_low > *high;
            any |= wins;
            rivals |= !wins & (near_high >= *low);
            if wins {
                (*low, *high, *held) = (near_low, near_high, primitive | PROVISIONAL);
            }
        }
        if rivals {
            // The hits that it replaced are lost, but it is tested again and replaces them again.
            self.evict(rays, primitive);
            return SmallOutcome::Undecided;
        }
        if !any {
            return SmallOutcome::Missed;
        }
        self.mark_dirty(rays);
        SmallOutcome::Merged
    }

    /// Removes a provisional triangle that leaves the order with a small triangle undecided. Returns its
    /// primitive index and bounds of its rays, for it to be set up and merged again.
    #[inline(never)]
    pub(crate) fn evict_rival(
        &mut self,
        coverage: &SmallCoverage,
        lane: usize,
        rays: &RayBox,
    ) -> Option<(u32, RayBox)> {
        let last = SIDE as i32 - 1;
        let mut perhaps = coverage.perhaps(lane);
        while perhaps != 0 {
            let ([x, y], [near_low, near_high]) = coverage.ray(lane, perhaps.trailing_zeros());
            perhaps &= perhaps - 1;
            let ray = (first_ray(rays) + y * SIDE + x) % RAYS;
            let held = self.primitives[ray];
            let coarse = held != MISS && held != UNDECIDED && held & PROVISIONAL != 0;
            if coarse && near_low <= self.high[ray] && near_high >= self.low[ray] {
                let reach = ROW as i32 - 1;
                let (x, y) = ((ray % SIDE) as i32, (ray / SIDE) as i32);
                let around = RayBox {
                    left: (x - reach).max(0),
                    right: (x + reach).min(last),
                    top: (y - reach).max(0),
                    bottom: (y + reach).min(last),
                };
                let primitive = held & !PROVISIONAL;
                return self.evict(&around, primitive).map(|rays| (primitive, rays));
            }
        }
        None
    }

    /// Removes a provisional triangle from the rays of a box; returns the bounds of the rays that it had.
    ///
    /// Hi-z stays as it is: the triangle will be merged again, and was surely as near as hi-z says.
    #[inline(never)]
    fn evict(&mut self, rays: &RayBox, primitive: u32) -> Option<RayBox> {
        let mut around: Option<RayBox> = None;
        for y in rays.top..=rays.bottom {
            for x in rays.left..=rays.right {
                let ray = (y as usize * SIDE + x as usize) % RAYS;
                if self.primitives[ray] == primitive | PROVISIONAL {
                    (self.low[ray], self.high[ray]) = (f32::NEG_INFINITY, f32::NEG_INFINITY);
                    self.primitives[ray] = MISS;
                    let all = around.get_or_insert(RayBox {
                        left: x,
                        right: x,
                        top: y,
                        bottom: y,
                    });
                    all.left = all.left.min(x);
                    all.right = all.right.max(x);
                    all.bottom = y;
                }
            }
        }
        around
    }

    /// Marks the cells of a box dirty, at most two each way.
    #[inline(always)]
    fn mark_dirty(&mut self, rays: &RayBox) {
        let columns = 1u32 << (rays.left as usize / ROW) | 1 << (rays.right as usize / ROW);
        self.dirty |= columns << (CELLS * (rays.top as usize / ROW));
        self.dirty |= columns << (CELLS * (rays.bottom as usize / ROW));
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
            let open = merge.row(lanes, near, Some((inside, outside)), low, high, primitives);
            if open.rays != 0 {
                self.leave_undecided(merge.primitive, open, first, decisions);
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
            let open = merge.row(lanes, near, None, low, high, primitives);
            if open.rays != 0 {
                self.leave_undecided(merge.primitive, open, first, decisions);
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

    /// Marks open rays of eight from `first` on undecided between their triangle so far and another, except those that
    /// are surely inside of it and have one of its plane: there the lower primitive id wins.
    #[inline(never)]
    fn leave_undecided(
        &mut self,
        primitive: u32,
        open: Open,
        first: usize,
        decisions: &mut Decisions<'_>,
    ) {
        let Some((_, _, primitives)) = self.rays(first) else {
            return;
        };
        let (before, mut rest) = (*primitives, open.rays);
        // Neighbouring rays mostly have the same triangle.
        while rest != 0 {
            let stored = before[rest.trailing_zeros() as usize % ROW];
            let mut same = 0;
            for (lane, &other) in before.iter().enumerate() {
                same |= u32::from(other == stored) << lane;
            }
            same &= rest;
            rest &= !same;
            let rival = held_primitive(stored);
            if let Some(rival) = rival
                && same & open.inside != 0
                && let Some(nearer) = decisions.first_in_one_plane(rival, primitive)
            {
                // Both hits have one depth, which either's bounds hold.
                if nearer == primitive {
                    for_each_bit(u64::from(same & open.inside), |lane| {
                        self.primitives[first + lane] = primitive;
                    });
                }
                same &= !open.inside;
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
                    let held = std::mem::replace(&mut self.primitives[ray], UNDECIDED);
                    self.rivals
                        .push_both(ray, held_primitive(held), functions.primitive);
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

/// Rays of eight, as bits, that merging a triangle leaves open: neither hit first nor left as they were.
#[derive(Clone, Copy)]
struct Open {
    rays: u32,
    /// Those of all eight that are surely inside the triangle.
    inside: u32,
}

/// What merging a triangle into rows needs, the same for every row.
struct DepthMerge<L: Lanes> {
    primitive: u32,
    error: L::F32,
    begin: L::F32,
    never: L::F32,
}

impl<L: Lanes> DepthMerge<L> {
    #[inline(always)]
    fn new(lanes: L, functions: &EdgeFunctions, begin: f32) -> Self {
        Self {
            primitive: functions.primitive,
            error: lanes.splat(functions.depth_key_error),
            begin: lanes.splat(begin),
            never: lanes.splat(f32::NEG_INFINITY),
        }
    }

    /// Merges a triangle of depth key `near` into a row of rays. `sides` has the rays surely inside and
    /// surely outside of it; without it, all are inside.
    ///
    /// No value here is NaN: a triangle whose functions are not finite is ill-conditioned.
    #[inline(always)]
    fn row(
        &self,
        lanes: L,
        near: L::F32,
        sides: Option<(L::Mask, L::Mask)>,
        low: &mut [f32; ROW],
        high: &mut [f32; ROW],
        primitives: &mut [u32; ROW],
    ) -> Open {
        let (old_low, old_high) = (lanes.load(low), lanes.load(high));
        let near_low = near - self.error;
        let near_high = near + self.error;
        let began = near_high.lt(self.begin);
        let unbegun = self.begin.lt(near_low);
        let (met, missed) = match sides {
            Some((inside, outside)) => (inside & began, outside | unbegun),
            None => (began, unbegun),
        };
        // The nearest hit is at least as near as every sure hit, and at most as near as every possible one.
        // A triangle surely further moves neither bound.
        let if_met = met.select(near_low, self.never);
        let unless_missed = missed.select(self.never, near_high);
        old_low.max(if_met).store(low);
        old_high.max(unless_missed).store(high);
        let wins = met & old_high.lt(near_low);
        let loses = missed | near_high.lt(old_low);
        wins.store(self.primitive, primitives);
        // Rays where neither holds stay undecided until something nearer wins them.
        Open {
            rays: !(wins | loses).bits() & ALL,
            inside: met.bits(),
        }
    }
}

/// The primitive index of a ray that is neither undecided nor a miss so far.
#[inline(always)]
fn held_primitive(held: u32) -> Option<u32> {
    (held != MISS && held != UNDECIDED).then_some(held & !PROVISIONAL)
}

/// Index of a box's first ray in the packet.
#[inline(always)]
fn first_ray(rays: &RayBox) -> usize {
    rays.top as usize * SIDE + rays.left as usize
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::simd::Plain;

    /// Intervals that share a number leave the order open, and so does a depth where rays may begin.
    #[test]
    fn intervals_that_touch_are_undecided() {
        let functions = EdgeFunctions {
            primitive: 7,
            edges: [[0.0; 3]; 3],
            edge_error: 0.0,
            depth_key: [0.0; 3],
            depth_key_error: 0.25,
        };
        let merge = DepthMerge::new(Plain, &functions, 8.0);
        let near = [2.25, 2.5, 0.75, 0.5, 1.5, 7.75, 8.25, 8.5];
        let (mut low, mut high) = ([1.0; ROW], [2.0; ROW]);
        let mut primitives = [3; ROW];
        let open = merge.row(
            Plain,
            Plain.load(&near),
            None,
            &mut low,
            &mut high,
            &mut primitives,
        );
        // Touches from before, is before, touches from behind, is behind, lies within; touches the beginning from
        // both sides, and is behind it.
        assert_eq!(open.rays, 0b0111_0101);
        assert_eq!(open.inside, 0b0001_1111);
        assert_eq!(primitives, [3, 7, 3, 3, 3, 3, 3, 3]);
        assert_eq!(low, [2.0, 2.25, 1.0, 1.0, 1.25, 1.0, 1.0, 1.0]);
        assert_eq!(high, [2.5, 2.75, 2.0, 2.0, 2.0, 8.0, 8.5, 2.0]);
    }
}
