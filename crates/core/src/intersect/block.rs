//! A block of 32 × 32 rays of one camera: the nearest triangle of each so far, in single precision with
//! bounds. What the bounds leave open is marked, and left to the single-ray path.
//!
//! A small triangle is met by the rows of rays that its box covers. A large one is held against
//! sub-blocks of 8 × 8 first: those that it surely misses, covers whole, or lies behind are told from
//! its functions' greatest and least values there (Abrash, "Rasterization on Larrabee", 2009; Greene,
//! Kass, Miller, "Hierarchical Z-Buffer Visibility", 1993).

use super::footprint::RayBox;
use super::setup::{BlockSpace, CornerLanes, LANES, ROW, SIDE, SetUp};
use super::sides::FewRays;
use crate::accel::MISS;
use crate::accel::simd::Lanes;
use crate::accel::tree::TRIANGLE_LIMIT;

/// Rays in a block.
const RAYS: usize = SIDE * SIDE;
/// Sub-blocks along a side.
pub(crate) const SUBS: usize = SIDE / ROW;

/// From a sub-block's first ray to its middle.
const HALF: f32 = (ROW as f32 - 1.0) * 0.5;
/// The middles of two rows of sub-blocks.
const SUB_X: [f32; ROW] = [3.5, 11.5, 19.5, 27.5, 3.5, 11.5, 19.5, 27.5];
const SUB_Y: [f32; ROW] = [3.5, 3.5, 3.5, 3.5, 11.5, 11.5, 11.5, 11.5];
/// Of two rows of sub-blocks the first one to four columns, as bits; and the first row.
const SUB_COLUMNS: [u32; SUBS] = [0x11, 0x33, 0x77, 0xff];
const SUB_FIRST_ROW: u32 = 0x0f;

/// A row's columns.
const COLUMNS: [f32; ROW] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// The lanes of a row, as bits.
const ALL: u32 = (1 << ROW) - 1;

/// What marks the slot of a triangle that was met as one of few rays, and not set up. No slot has it.
const COARSE: u32 = !TRIANGLE_LIMIT;

/// What marks a ray for which it cannot be told which of several triangles is nearest, in place of a
/// slot: a triangle surely nearer than all of them takes its place.
const OPEN: u32 = MISS - 1;

/// The nearest triangle of each ray so far, rows of rays one after another.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// How near the hit is at least: inverse depth, or for orthographic blocks depth negated, so
    /// that it grows towards the eye. −∞ where nothing is surely met yet.
    low: [f32; RAYS],
    /// How near it is at most.
    high: [f32; RAYS],
    slots: [u32; RAYS],
    /// What every ray of a sub-block is at least as near as.
    horizons: [f32; SUBS * SUBS],
    /// Sub-blocks whose horizon may have moved, as bits.
    touched: u32,
    /// Where orthographic rays begin: nothing is nearer. Infinite for perspective.
    begin: f32,
}

/// What became of a triangle of few rays.
pub(crate) enum MetFew {
    /// Some rays meet it first, so far.
    Met,
    /// No ray does.
    Nobody,
    /// It was not met: it cannot be told without setting it up.
    Undecided,
}

/// A triangle's functions for some rays: values at the first, and steps.
#[derive(Clone, Copy)]
struct Functions {
    slot: u32,
    edges: [[f32; 3]; 3],
    edge_error: f32,
    nearness: [f32; 3],
    nearness_error: f32,
}

impl Block {
    pub(crate) fn new() -> Self {
        Self {
            low: [0.0; RAYS],
            high: [0.0; RAYS],
            slots: [MISS; RAYS],
            horizons: [f32::NEG_INFINITY; SUBS * SUBS],
            touched: 0,
            begin: f32::INFINITY,
        }
    }

    /// Forgets everything; from now on it has `columns × rows` rays, at most [`SIDE`] each.
    #[inline(always)]
    pub(crate) fn clear(&mut self, lanes: impl Lanes, columns: u32, rows: u32, perspective: bool) {
        self.low = [f32::NEG_INFINITY; RAYS];
        self.high = [f32::NEG_INFINITY; RAYS];
        self.slots = [MISS; RAYS];
        self.horizons = [f32::NEG_INFINITY; SUBS * SUBS];
        self.touched = 0;
        // Orthographic rays begin at the image plane, where the negated depth is zero.
        self.begin = if perspective { f32::INFINITY } else { 0.0 };
        let (columns, rows) = (columns as usize, rows as usize);
        if columns < SIDE || rows < SIDE {
            // Rays beyond the block's own take no part.
            for ray in (0..RAYS).filter(|ray| ray / SIDE >= rows || ray % SIDE >= columns) {
                self.low[ray] = f32::INFINITY;
                self.high[ray] = f32::INFINITY;
            }
            self.touched = u32::MAX >> (32 - SUBS * SUBS);
            self.look_around(lanes);
        }
    }

    /// What a row of rays has met: [`Block::slot`] makes slots of it, where [`Block::is_open`] does not
    /// say that it could not be told.
    #[inline(always)]
    pub(crate) fn row(&self, row: u32) -> &[u32] {
        let first = row as usize * SIDE;
        &self.slots[first..first + SIDE]
    }

    /// A ray's slot from what a row holds.
    #[inline(always)]
    pub(crate) fn slot(held: u32) -> u32 {
        if held == MISS { MISS } else { held & !COARSE }
    }

    /// Whether a ray could not be decided, from what a row holds.
    #[inline(always)]
    pub(crate) fn is_open(held: u32) -> bool {
        held == OPEN
    }

    /// What every ray's hit is at least as near as, and the greatest of what sub-blocks' are: anything
    /// surely further is of no use to them.
    #[inline(always)]
    pub(crate) fn horizons(&self, lanes: impl Lanes) -> (f32, f32) {
        let (infinity, zero) = (lanes.splat(f32::INFINITY), lanes.splat(0.0));
        let (mut least, mut most_negated) = (infinity, infinity);
        for horizons in self.horizons.as_chunks().0 {
            let horizons = lanes.load(horizons);
            least = lanes.min(horizons, least);
            // Sub-blocks without rays have an infinite one.
            let negated = lanes.sub(zero, horizons);
            let negated = lanes.pick(lanes.less(horizons, infinity), negated, infinity);
            most_negated = lanes.min(negated, most_negated);
        }
        (lanes.least(least), -lanes.least(most_negated))
    }

    /// Whether all rays of some sub-blocks, as bits, have met something surely nearer than `nearest`.
    #[inline(always)]
    pub(crate) fn hides_in(&self, lanes: impl Lanes, subs: u32, nearest: f32) -> bool {
        let nearest = lanes.splat(nearest);
        let mut hidden = 0;
        for (rows, horizons) in self.horizons.as_chunks().0.iter().enumerate() {
            hidden |= lanes.bits(lanes.less(nearest, lanes.load(horizons))) << (rows * LANES);
        }
        subs & !hidden == 0
    }

    /// Whether all rays of a box have met something surely nearer than `nearest`, as far as that is
    /// quickly told.
    #[inline(always)]
    pub(crate) fn hides(&self, rays: &RayBox, nearest: f32) -> bool {
        let (left, right) = (rays.left as usize / ROW, rays.right as usize / ROW);
        let (top, bottom) = (rays.top as usize / ROW, rays.bottom as usize / ROW);
        let horizon =
            |row: usize, column: usize| self.horizons[(row * SUBS + column) % (SUBS * SUBS)];
        let at_corners = lesser(
            lesser(horizon(top, left), horizon(top, right)),
            lesser(horizon(bottom, left), horizon(bottom, right)),
        );
        nearest < at_corners
            && (top..=bottom).all(|row| (left..=right).all(|column| nearest < horizon(row, column)))
    }

    /// Whether each ray of a box of at most eight columns has met something surely nearer than `nearest`.
    #[inline(always)]
    pub(crate) fn hides_each(&self, lanes: impl Lanes, rays: &RayBox, nearest: f32) -> bool {
        let columns = (2u32 << (rays.right - rays.left)) - 1;
        let nearest = lanes.splat(nearest);
        (rays.top..=rays.bottom).all(|y| {
            let first = y as usize * SIDE + rays.left as usize;
            let low = self.low.get(first..).and_then(|low| low.first_chunk());
            low.is_some_and(|low| columns & !lanes.bits(lanes.less(nearest, lanes.load(low))) == 0)
        })
    }

    /// Meets a triangle with the few rays of its box. Where it cannot be told of each ray whether the
    /// triangle is what it meets first so far, the triangle is not met.
    ///
    /// Ray by ray: rows of rays written side by side would wait for what the last triangle's, beginning
    /// at another column, have just written.
    #[inline(always)]
    pub(crate) fn meet_few(
        &mut self,
        few: &FewRays,
        lane: usize,
        rays: &RayBox,
        slot: u32,
    ) -> MetFew {
        let mut inside = few.inside(lane);
        if inside != few.perhaps(lane) {
            return MetFew::Undecided;
        }
        let (mut any, mut rivals) = (false, false);
        while inside != 0 {
            let ([x, y], [near_low, near_high]) = few.ray(lane, inside.trailing_zeros());
            inside &= inside - 1;
            let ray = (first_ray(rays) + y * SIDE + x) % RAYS;
            let (low, high, held) = (
                &mut self.low[ray],
                &mut self.high[ray],
                &mut self.slots[ray],
            );
            let wins = near_low > *high;
            any |= wins;
            rivals |= !wins & (near_high >= *low);
            if wins {
                (*low, *high, *held) = (near_low, near_high, slot | COARSE);
            }
        }
        if rivals {
            // What was further is lost where this triangle won: it will win again.
            self.forget(rays, slot);
            return MetFew::Undecided;
        }
        if !any {
            return MetFew::Nobody;
        }
        self.touch(rays);
        MetFew::Met
    }

    /// Of triangles that were met as ones of few rays themselves, forgets one that leaves it open which
    /// is nearer, it or a triangle of these few rays. Returns its slot and a box around its rays, for it
    /// to be set up and met again.
    #[inline(never)]
    pub(crate) fn forget_rival(
        &mut self,
        few: &FewRays,
        lane: usize,
        rays: &RayBox,
    ) -> Option<(u32, RayBox)> {
        let last = SIDE as i32 - 1;
        let mut perhaps = few.perhaps(lane);
        while perhaps != 0 {
            let ([x, y], [near_low, near_high]) = few.ray(lane, perhaps.trailing_zeros());
            perhaps &= perhaps - 1;
            let ray = (first_ray(rays) + y * SIDE + x) % RAYS;
            let held = self.slots[ray];
            let coarse = held != MISS && held != OPEN && held & COARSE != 0;
            if coarse && near_low <= self.high[ray] && near_high >= self.low[ray] {
                let reach = ROW as i32 - 1;
                let (x, y) = ((ray % SIDE) as i32, (ray / SIDE) as i32);
                let around = RayBox {
                    left: (x - reach).max(0),
                    right: (x + reach).min(last),
                    top: (y - reach).max(0),
                    bottom: (y + reach).min(last),
                };
                let slot = held & !COARSE;
                return self.forget(&around, slot).map(|rays| (slot, rays));
            }
        }
        None
    }

    /// Forgets a triangle that some rays of a box have met as ones of few rays: the box around those.
    ///
    /// The horizons stay: the triangle will be met again, and was surely as near as they say.
    #[inline(never)]
    fn forget(&mut self, rays: &RayBox, slot: u32) -> Option<RayBox> {
        let mut around: Option<RayBox> = None;
        for y in rays.top..=rays.bottom {
            for x in rays.left..=rays.right {
                let ray = (y as usize * SIDE + x as usize) % RAYS;
                if self.slots[ray] == slot | COARSE {
                    (self.low[ray], self.high[ray]) = (f32::NEG_INFINITY, f32::NEG_INFINITY);
                    self.slots[ray] = MISS;
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

    /// Marks the sub-blocks of a box, at most two each way.
    #[inline(always)]
    fn touch(&mut self, rays: &RayBox) {
        let columns = 1u32 << (rays.left as usize / ROW) | 1 << (rays.right as usize / ROW);
        self.touched |= columns << (SUBS * (rays.top as usize / ROW));
        self.touched |= columns << (SUBS * (rays.bottom as usize / ROW));
    }

    /// Meets the first of eight triangles, those with slots, each with the rays of its box. `is_edge_on`
    /// tells of a slot whether no ray meets it: it is asked where the set-up cannot tell the triangle's side.
    #[inline(always)]
    pub(crate) fn meet(
        &mut self,
        lanes: impl Lanes,
        space: &BlockSpace,
        corners: &CornerLanes,
        boxes: &[RayBox; LANES],
        slots: &[u32],
        mut is_edge_on: impl FnMut(u32) -> bool,
    ) {
        let set_up = space.set_up(corners, boxes);
        for (l, &slot) in slots.iter().enumerate().take(LANES) {
            if set_up.awkward[l] && is_edge_on(slot) {
                continue;
            }
            self.meet_one(lanes, &set_up, l, slot);
        }
        self.look_around(lanes);
    }

    #[inline(always)]
    fn meet_one(&mut self, lanes: impl Lanes, set_up: &SetUp, l: usize, slot: u32) {
        let linear = |f: &[[f32; LANES]; 3]| [f[0][l], f[1][l], f[2][l]];
        let functions = Functions {
            slot,
            edges: [
                linear(&set_up.edges[0]),
                linear(&set_up.edges[1]),
                linear(&set_up.edges[2]),
            ],
            edge_error: set_up.edge_error[l],
            nearness: linear(&set_up.nearness),
            nearness_error: set_up.nearness_error[l],
        };
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
        if set_up.awkward[l] {
            self.leave_open(
                &functions,
                (column, row),
                (left as usize, right as usize),
                (top as usize, bottom as usize),
            );
        } else if set_up.boxes[l].is_narrow() {
            let rows = (bottom - top + 1) as usize;
            self.meet_rows(lanes, &functions, row * SIDE + column, rows);
            let (first, last) = (column / ROW, column.div_ceil(ROW));
            let columns = (1u32 << first) | (1 << last);
            for sub_row in row / ROW..=bottom as usize / ROW {
                self.touched |= columns << (SUBS * sub_row);
            }
        } else {
            self.meet_subs(
                lanes,
                &functions,
                (column, row),
                (right as usize, bottom as usize),
            );
        }
    }

    /// Meets a large triangle sub-block by sub-block.
    #[inline(always)]
    fn meet_subs(
        &mut self,
        lanes: impl Lanes,
        functions: &Functions,
        (column, row): (usize, usize),
        (right, bottom): (usize, usize),
    ) {
        let Functions {
            edges,
            edge_error,
            nearness,
            nearness_error,
            ..
        } = *functions;
        let columns = right / ROW - column / ROW + 1;
        let rows = bottom / ROW - row / ROW + 1;
        let (error, minus_error) = (lanes.splat(edge_error), lanes.splat(-edge_error));
        // All sub-blocks from the first, two rows of them at a time.
        for sub_row in (0..rows).step_by(ROW / SUBS) {
            let (x, y) = (
                lanes.load(&SUB_X),
                lanes.add(lanes.load(&SUB_Y), lanes.splat((sub_row * ROW) as f32)),
            );
            let value = |f: [f32; 3]| {
                let below = lanes.add(lanes.splat(f[0]), lanes.mul(lanes.splat(f[2]), y));
                lanes.add(below, lanes.mul(lanes.splat(f[1]), x))
            };
            let swing = |f: [f32; 3]| lanes.splat((f[1].abs() + f[2].abs()) * HALF);
            let [greatest, least] = {
                let of = |f: [f32; 3]| {
                    let (value, swing) = (value(f), swing(f));
                    [lanes.add(value, swing), lanes.sub(value, swing)]
                };
                let ([a, p], [b, q], [c, r]) = (of(edges[0]), of(edges[1]), of(edges[2]));
                [lanes.min(lanes.min(a, b), c), lanes.min(lanes.min(p, q), r)]
            };
            let outside = lanes.bits(lanes.less(greatest, minus_error));
            let inside = lanes.bits(lanes.less(error, least));
            let mut nearest = [0.0; ROW];
            let near = lanes.add(value(nearness), swing(nearness));
            lanes.store(lanes.add(near, lanes.splat(nearness_error)), &mut nearest);

            let mut wanted = !outside & SUB_COLUMNS[columns - 1];
            if sub_row + 1 == rows {
                wanted &= SUB_FIRST_ROW;
            }
            while wanted != 0 {
                let sub = wanted.trailing_zeros() as usize % ROW;
                wanted &= wanted - 1;
                let (sub_column, sub_row) = (sub % SUBS, sub_row + sub / SUBS);
                let place =
                    ((row / ROW + sub_row) * SUBS + column / ROW + sub_column) % (SUBS * SUBS);
                if nearest[sub] < self.horizons[place] {
                    continue;
                }
                let (x, y) = ((sub_column * ROW) as f32, (sub_row * ROW) as f32);
                let moved = |f: [f32; 3]| [(f[0] + f[2] * y) + f[1] * x, f[1], f[2]];
                let here = Functions {
                    edges: [moved(edges[0]), moved(edges[1]), moved(edges[2])],
                    nearness: moved(nearness),
                    ..*functions
                };
                let first = (row + sub_row * ROW) * SIDE + column + sub_column * ROW;
                if inside & (1 << sub) != 0 {
                    self.cover(lanes, &here, first);
                } else {
                    self.meet_rows(lanes, &here, first, ROW);
                }
                self.touched |= 1 << place;
            }
        }
    }

    /// Meets rows of rays with a triangle.
    #[inline(always)]
    fn meet_rows(&mut self, lanes: impl Lanes, functions: &Functions, first: usize, rows: usize) {
        let Functions {
            edges: [e, f, g],
            edge_error,
            nearness,
            ..
        } = *functions;
        let x = lanes.load(&COLUMNS);
        let row = |f: [f32; 3]| lanes.add(lanes.splat(f[0]), lanes.mul(lanes.splat(f[1]), x));
        let (mut a, mut b, mut c, mut near) = (row(e), row(f), row(g), row(nearness));
        let step = |f: [f32; 3]| lanes.splat(f[2]);
        let (step_a, step_b, step_c, step_near) = (step(e), step(f), step(g), step(nearness));
        let (error, minus_error) = (lanes.splat(edge_error), lanes.splat(-edge_error));
        let merge = Merge::new(lanes, functions, self.begin);
        for row in 0..rows {
            let Some((low, high, slots)) = self.rays(first + row * SIDE) else {
                return;
            };
            let least = lanes.min(lanes.min(a, b), c);
            let outside = lanes.less(least, minus_error);
            let inside = lanes.less(error, least);
            merge.row(lanes, near, Some((inside, outside)), low, high, slots);
            a = lanes.add(a, step_a);
            b = lanes.add(b, step_b);
            c = lanes.add(c, step_c);
            near = lanes.add(near, step_near);
        }
    }

    /// Meets a sub-block of rays that are all surely inside of a triangle's edges.
    #[inline(always)]
    fn cover(&mut self, lanes: impl Lanes, functions: &Functions, first: usize) {
        let n = functions.nearness;
        let x = lanes.load(&COLUMNS);
        let mut near = lanes.add(lanes.splat(n[0]), lanes.mul(lanes.splat(n[1]), x));
        let step = lanes.splat(n[2]);
        let merge = Merge::new(lanes, functions, self.begin);
        for row in 0..ROW {
            let Some((low, high, slots)) = self.rays(first + row * SIDE) else {
                return;
            };
            merge.row(lanes, near, None, low, high, slots);
            near = lanes.add(near, step);
        }
    }

    /// Eight rays side by side.
    #[inline(always)]
    fn rays(
        &mut self,
        first: usize,
    ) -> Option<(&mut [f32; ROW], &mut [f32; ROW], &mut [u32; ROW])> {
        Some((
            self.low.get_mut(first..)?.first_chunk_mut()?,
            self.high.get_mut(first..)?.first_chunk_mut()?,
            self.slots.get_mut(first..)?.first_chunk_mut()?,
        ))
    }

    /// Leaves every ray open that an awkward triangle may touch: those in its box where its edge
    /// functions do not surely have both signs.
    #[inline(never)]
    fn leave_open(
        &mut self,
        functions: &Functions,
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
                    self.high[j * SIDE + i] = f32::INFINITY;
                    self.slots[j * SIDE + i] = OPEN;
                }
            }
        }
    }

    /// Brings the touched sub-blocks' horizons up to date.
    #[inline(always)]
    pub(crate) fn look_around(&mut self, lanes: impl Lanes) {
        let mut touched = self.touched & ((1 << (SUBS * SUBS)) - 1);
        self.touched = 0;
        while touched != 0 {
            let sub = touched.trailing_zeros() as usize % (SUBS * SUBS);
            touched &= touched - 1;
            let first = sub / SUBS * ROW * SIDE + sub % SUBS * ROW;
            let mut least = lanes.splat(f32::INFINITY);
            for row in 0..ROW {
                if let Some((low, _, _)) = self.rays(first + row * SIDE) {
                    least = lanes.min(lanes.load(low), least);
                }
            }
            self.horizons[sub] = lanes.least(least);
        }
    }
}

/// What merging a triangle into rows of rays needs, the same for all.
struct Merge<L: Lanes> {
    slot: u32,
    error: L::Singles,
    begin: L::Singles,
    never: L::Singles,
}

impl<L: Lanes> Merge<L> {
    #[inline(always)]
    fn new(lanes: L, functions: &Functions, begin: f32) -> Self {
        Self {
            slot: functions.slot,
            error: lanes.splat(functions.nearness_error),
            begin: lanes.splat(begin),
            never: lanes.splat(f32::NEG_INFINITY),
        }
    }

    /// Merges a triangle that is as near as `near` into what a row of rays has met so far. `sides`
    /// says which rays are surely inside of it and which surely outside; without, all are inside.
    ///
    /// No value here is other than a number: triangles whose functions are not are awkward.
    #[inline(always)]
    fn row(
        &self,
        lanes: L,
        near: L::Singles,
        sides: Option<(L::Mask, L::Mask)>,
        low: &mut [f32; ROW],
        high: &mut [f32; ROW],
        slots: &mut [u32; ROW],
    ) {
        let (old_low, old_high) = (lanes.load(low), lanes.load(high));
        let near_low = lanes.sub(near, self.error);
        let near_high = lanes.add(near, self.error);
        let began = lanes.less(near_high, self.begin);
        let unbegun = lanes.less(self.begin, near_low);
        let (met, missed) = match sides {
            Some((inside, outside)) => (lanes.and(inside, began), lanes.or(outside, unbegun)),
            None => (began, unbegun),
        };
        // What is nearest is as near as all that is surely met, and as what may be met at most. A
        // triangle surely further than that moves neither.
        let if_met = lanes.pick(met, near_low, self.never);
        let unless_missed = lanes.pick(missed, self.never, near_high);
        lanes.store(lanes.max(old_low, if_met), low);
        lanes.store(lanes.max(old_high, unless_missed), high);
        let wins = lanes.and(met, lanes.less(old_high, near_low));
        let loses = lanes.or(missed, lanes.less(near_high, old_low));
        lanes.put(wins, self.slot, slots);
        // Rays of which neither is sure are open, as long as nothing nearer wins them.
        let open = !lanes.bits(lanes.or(wins, loses)) & ALL;
        if open != 0 {
            for_each_bit(u64::from(open), |lane| slots[lane % ROW] = OPEN);
        }
    }
}

/// Where a box's first ray stands among the block's.
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
