//! Rasterising triangles that are set up. Small bounds are rasterised in rows of eight rays; for large ones cells of
//! 8 × 8 rays come first, whose extremes decide whether a cell is missed, covered or occluded (Abrash, "Rasterization
//! on Larrabee", 2009).

use super::cut_triangles::Cut;
use super::depth_merge::{DepthMerge, StartingRays, UndecidedRays};
use super::edge_functions::{CELL_X, CELL_Y, EdgeFunctions, ForEachThatMayHit, HALF};
use super::{IntervalZBuffer, UNDECIDED, cell_of, for_each_bit, is_uniform};
use crate::hit::MISS;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8, Simd, dispatch};
use crate::packet::componentwise_setup::ComponentwiseSetup;
use crate::packet::decisions::Decisions;
use crate::packet::params::{CELLS, COLUMNS, ROW, SIDE};
use crate::packet::plane_order::{PlacesWithin, PlaneOrder};
use crate::packet::ray_box::RayBox;
use crate::packet::setup::{PacketSpace, TriangleSetup};
use crate::triangle::CornerLanes;

/// Bit masks over two rows of cells: the cells of the first one to four columns, and those of the first row.
const CELL_COLUMNS: [u32; CELLS] = [0x11, 0x33, 0x77, 0xff];
const CELL_FIRST_ROW: u32 = 0x0f;

/// The number of undecided orders in the rows of a cell beyond which a triangle is first compared with the cell's
/// stored triangles by their planes: as many as two triangles that cover the cell cause. With a smaller number, cells
/// where a few triangles touch are compared for nothing (casting `assets/dahlia.obj` took 7 % longer); with a larger
/// one, layers are merged ray by ray for longer.
pub(super) const CONTESTED: u8 = 2 * ROW as u8;

impl IntervalZBuffer {
    /// Sets rough triangles up again with componentwise bounds. Returns, as bits, the triangles that surely no ray hits, and
    /// those in front of which surely all rays start; only those are examined that are ill-conditioned, or on which
    /// orthographic rays may start.
    #[inline(never)]
    pub(super) fn refine(
        &mut self,
        space: &PacketSpace,
        set_up: &mut TriangleSetup,
        corners: &CornerLanes,
        primitives: &[u32],
        decisions: &mut Decisions<'_>,
    ) -> [u32; 2] {
        let mut which = 0;
        if decisions.are_exact() {
            for (l, &primitive) in primitives.iter().enumerate().take(LANES) {
                let may_be_never_hit = set_up.ill_conditioned[l] && set_up.boxes[l].right >= 0;
                if may_be_never_hit && decisions.is_never_hit_if_likely(primitive) {
                    set_up.boxes[l].right = -1;
                }
                which |= u32::from(set_up.is_rough[l] && set_up.boxes[l].right >= 0) << l;
            }
        }
        if which != 0 {
            let work = ComponentwiseSetup {
                space,
                corners,
                which,
                out: set_up,
                one_by_one: &mut self.one_by_one,
            };
            dispatch(decisions.simd(), work);
            self.overflowed |= set_up.overflows;
        }
        let [mut never_hit, mut in_front] = [0; 2];
        for (l, &primitive) in primitives.iter().enumerate().take(LANES) {
            if set_up.boxes[l].right < 0 {
                continue;
            }
            let mut may_start_on = decisions.are_exact()
                && self.start_keys[0] != f32::INFINITY
                && set_up.may_touch(l, self.start_keys);
            if may_start_on && let Some(are_in_front) = decisions.start_all_in_front(primitive) {
                may_start_on = false;
                in_front |= u32::from(are_in_front) << l;
                never_hit |= u32::from(!are_in_front) << l;
            }
            let is_doubtful = set_up.ill_conditioned[l] || may_start_on;
            never_hit |= u32::from(is_doubtful && decisions.is_never_hit(primitive)) << l;
        }
        [never_hit, in_front]
    }

    /// Empties the bounds of rough triangles that are occluded by as much as is known of their depths: they need not be
    /// set up again.
    #[inline(never)]
    fn cull_rough(&self, set_up: &mut TriangleSetup) {
        for l in 0..LANES {
            if !set_up.is_rough[l] || set_up.boxes[l].right < 0 {
                continue;
            }
            if self.occludes(&set_up.boxes[l], set_up.nearest_key(l)) {
                set_up.boxes[l].right = -1;
            }
        }
    }

    /// Sets up eight triangles and rasterises those with a primitive index, each within its bounds. Ill-conditioned
    /// triangles, and those on which orthographic rays may start, are skipped where exact arithmetic proves that no ray
    /// hits them.
    #[inline(always)]
    pub(in crate::packet) fn rasterize(
        &mut self,
        lanes: impl Lanes,
        space: &PacketSpace,
        corners: &CornerLanes,
        boxes: &[RayBox; LANES],
        primitives: &[u32],
        decisions: &mut Decisions<'_>,
    ) {
        let mut set_up = space.set_up(corners, boxes);
        if space.reference_plane.is_some() {
            decisions.refine_keys(space, (corners, primitives), &mut set_up);
            self.overflowed |= set_up.overflows;
        }
        let any_rough = set_up.is_rough.iter().fold(false, |any, &is| any | is);
        self.sets_up_again = any_rough;
        if any_rough {
            self.cull_rough(&mut set_up);
        }
        let start_keys = self.start_keys;
        let [never_hit, in_front] = if any_rough || start_keys[0] != f32::INFINITY {
            self.refine(space, &mut set_up, corners, primitives, decisions)
        } else {
            [0; 2]
        };
        for (l, &primitive) in primitives.iter().enumerate().take(LANES) {
            if in_front >> l & 1 != 0 {
                self.start_keys = [f32::INFINITY; 2];
            }
            if never_hit >> l & 1 == 0
                && (decisions.clip().is_empty()
                    || !self.rasterize_cut(&set_up, (l, primitive), decisions))
            {
                self.rasterize_one(lanes, &set_up, (l, primitive), &[], decisions);
            }
            self.start_keys = start_keys;
        }
        self.update_hi_z(lanes);
    }

    /// Rasterises one of eight triangles, or the part of it that planes keep.
    #[inline(always)]
    pub(super) fn rasterize_one(
        &mut self,
        lanes: impl Lanes,
        set_up: &TriangleSetup,
        (l, primitive): (usize, u32),
        cuts: &[Cut],
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
            let bounds = set_up.boxes[l];
            self.mark_undecided(decisions.simd(), &functions, (column, row), bounds);
        } else if set_up.boxes[l].is_narrow() {
            let rows = (bottom - top + 1) as usize;
            let begin = row * SIDE + column;
            if cuts.is_empty() {
                self.rasterize_rows(lanes, &functions, begin, rows, decisions);
            } else {
                self.rasterize_cut_rows(lanes, &functions, cuts, begin, rows, decisions);
            }
            let (first, last) = (column / ROW, column.div_ceil(ROW));
            let columns = (1u32 << first) | (1 << last);
            for cell_row in row / ROW..=bottom as usize / ROW {
                self.dirty |= columns << (CELLS * cell_row);
            }
        } else {
            self.rasterize_cells(
                lanes,
                (&functions, cuts),
                (column, row),
                (right as usize, bottom as usize),
                decisions,
            );
        }
    }

    /// Rasterises a large triangle, or the part of it that planes keep, cell by cell.
    #[inline(always)]
    pub(super) fn rasterize_cells(
        &mut self,
        lanes: impl Lanes,
        (functions, cuts): (&EdgeFunctions, &[Cut]),
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
        // Rows of cells, two at a time: eight cells.
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
                let covers = inside & (1 << cell) != 0 && cuts.is_empty();
                let mut is_before = false;
                if self.contested[place] > CONTESTED {
                    let within = PlacesWithin::of_cell(place);
                    if self.is_behind_sure_hits(functions.primitive, (place, &within), decisions) {
                        continue;
                    }
                    if covers && nearest[cell] < self.start_keys[0] {
                        let cell = (place, &within);
                        is_before = self.is_before_sure_hits(functions.primitive, cell, decisions);
                        if !is_before {
                            self.keep_cover(functions.primitive, cell, decisions);
                        }
                    }
                }
                let (x, y) = ((cell_column * ROW) as f32, (cell_row * ROW) as f32);
                let moved = |f: [f32; 3]| [(f[0] + f[2] * y) + f[1] * x, f[1], f[2]];
                let here = EdgeFunctions {
                    edges: [moved(edges[0]), moved(edges[1]), moved(edges[2])],
                    depth_key: moved(depth_key),
                    ..*functions
                };
                let first = (row + cell_row * ROW) * SIDE + column + cell_column * ROW;
                if is_before {
                    self.hi_z[place] = self.win(lanes, &here, first);
                    self.sure_hits.set(functions.primitive, place);
                    continue;
                }
                if covers {
                    self.cover(lanes, &here, first, decisions);
                } else if cuts.is_empty() {
                    self.rasterize_rows(lanes, &here, first, ROW, decisions);
                } else {
                    let cuts = (cuts, x, y);
                    self.rasterize_cut_rows_at(lanes, &here, cuts, (first, ROW), decisions);
                }
                self.dirty |= 1 << place;
            }
        }
    }

    /// Rasterises rows of eight rays.
    #[inline(always)]
    pub(super) fn rasterize_rows(
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
        let merge = DepthMerge::new(lanes, functions, self.start_keys);
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
                let starting = merge.starting(near, Some(inside));
                self.leave_undecided_on_lattice(
                    (merge.primitive, first),
                    undecided,
                    &starting,
                    decisions,
                );
            }
            a = a + step_a;
            b = b + step_b;
            c = c + step_c;
            near = near + step_near;
        }
    }

    /// Merges a triangle into a cell whose rays are all surely inside its edges.
    #[inline(always)]
    pub(super) fn cover(
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
        let merge = DepthMerge::new(lanes, functions, self.start_keys);
        for row in 0..ROW {
            let first = first + row * SIDE;
            let Some((low, high, primitives)) = self.rays(first) else {
                return;
            };
            let undecided = merge.row(lanes, near, None, low, high, primitives);
            if undecided.rays != 0 {
                let starting = merge.starting(near, None);
                self.leave_undecided_on_lattice(
                    (merge.primitive, first),
                    undecided,
                    &starting,
                    decisions,
                );
            }
            near = near + step;
        }
    }

    /// Merges a triangle into a cell, all of whose rays surely hit it first so far. Returns the cell's hi-z.
    #[inline(always)]
    pub(super) fn win(
        &mut self,
        lanes: impl Lanes,
        functions: &EdgeFunctions,
        first: usize,
    ) -> f32 {
        let n = functions.depth_key;
        let mut near = lanes.splat(n[0]) + lanes.splat(n[1]) * lanes.load(&COLUMNS);
        let (step, error) = (lanes.splat(n[2]), lanes.splat(functions.depth_key_error));
        let mut least = lanes.splat(f32::INFINITY);
        for row in 0..ROW {
            let (low, high, primitives) = self.rays_of_row(first + row * SIDE);
            // Entries without a ray stay infinitely near.
            let new_low = lanes.load(low).max(near - error);
            new_low.store(low);
            lanes.load(high).max(near + error).store(high);
            *primitives = [functions.primitive; ROW];
            least = new_low.min(least);
            near = near + step;
        }
        least.reduce_min()
    }

    /// [`IntervalZBuffer::leave_undecided`] for rays of a lattice.
    #[inline(never)]
    pub(super) fn leave_undecided_on_lattice(
        &mut self,
        (primitive, first): (u32, usize),
        undecided: UndecidedRays,
        starting: &StartingRays,
        decisions: &mut Decisions<'_>,
    ) {
        let undecided = if undecided.rays & starting.rays != 0 && decisions.are_exact() {
            self.decide_starts((primitive, first), undecided, starting, decisions)
        } else {
            undecided
        };
        let at = ((first % SIDE) as f64, (first / SIDE) as f64);
        let order_of_row = |order: &PlaneOrder| order.of_row(at);
        self.leave_undecided((primitive, first), undecided, order_of_row, decisions);
    }

    /// Decides which of the rays that may start behind the triangle do. The others surely hit it.
    #[inline(never)]
    fn decide_starts(
        &mut self,
        (primitive, first): (u32, usize),
        undecided: UndecidedRays,
        StartingRays { rays, low, high }: &StartingRays,
        decisions: &mut Decisions<'_>,
    ) -> UndecidedRays {
        let starting = undecided.rays & rays;
        let in_front = decisions.start_in_front(primitive, (first, starting), [low, high]);
        for_each_bit(u64::from(in_front), |lane| {
            let nearest = &mut self.low[first + lane];
            *nearest = nearest.max(low[lane]);
        });
        UndecidedRays {
            rays: undecided.rays & !starting | in_front,
            hits: undecided.hits | in_front,
        }
    }

    /// Decides, of eight rays from `first` on, those that merging left undecided, where a ray surely hits a triangle
    /// already: in one plane the lower primitive id wins, elsewhere the order of their planes decides if it can, which
    /// `of_eight` evaluates at the rays' places. A ray that may hit this triangle and not surely loses it keeps it as a
    /// rival.
    #[inline(never)]
    pub(super) fn leave_undecided(
        &mut self,
        (primitive, first): (u32, usize),
        undecided: UndecidedRays,
        of_eight: impl Fn(&PlaneOrder) -> [u32; 2],
        decisions: &mut Decisions<'_>,
    ) {
        let Some((_, _, &mut row)) = self.rays(first) else {
            return;
        };
        let (sure_hits, was_undecided) = self.sure_hits_of_row(first, &row);
        let are_same = is_uniform(&sure_hits, sure_hits[0]);
        let mut rest = undecided.rays;
        // Neighbouring rays mostly have the same triangle.
        while rest != 0 {
            let sure_hit = sure_hits[rest.trailing_zeros() as usize % ROW];
            let mut same = rest;
            if !are_same {
                let mut equal = 0;
                for (lane, &other) in sure_hits.iter().enumerate() {
                    equal |= u32::from(other == sure_hit) << lane;
                }
                same &= equal;
            }
            rest &= !same;
            let mut wins = 0;
            if sure_hit != MISS && same & (undecided.hits | was_undecided) != 0 {
                // The stored bounds contain the depths of both, and so of the nearer one.
                let order = decisions.order([sure_hit, primitive]);
                let [loses, nearer] = of_eight(order);
                let contested = &mut self.contested[cell_of(first) % (CELLS * CELLS)];
                *contested = contested.saturating_add(1);
                self.contests += 1;
                self.contested_by = sure_hit;
                same &= !loses;
                wins = nearer & same & undecided.hits;
            } else if sure_hit == MISS {
                wins = same & undecided.hits;
            }
            for_each_bit(u64::from(wins & !was_undecided), |lane| {
                self.primitives[first + lane] = primitive;
            });
            for_each_bit(u64::from(same & !wins), |lane| {
                self.leave_ray_undecided(first + lane, primitive);
            });
            for_each_bit(u64::from(wins & was_undecided), |lane| {
                self.rivals.push_sure_hit(first + lane, primitive);
            });
        }
    }

    /// The sure hits, or [`MISS`], of eight rays from `first` on with these entries, and those of them, as bits, that are
    /// undecided.
    fn sure_hits_of_row(&self, first: usize, row: &[u32; ROW]) -> ([u32; ROW], u32) {
        let (mut sure_hits, mut undecided) = ([MISS; ROW], 0);
        for (lane, &stored) in row.iter().enumerate() {
            sure_hits[lane] = Self::primitive(stored);
            undecided |= u32::from(stored == UNDECIDED) << lane;
        }
        for_each_bit(undecided.into(), |lane| {
            sure_hits[lane] = self.rivals.sure_hit(first + lane).unwrap_or(MISS);
        });
        (sure_hits, undecided)
    }

    /// Marks undecided every ray within bounds that an ill-conditioned triangle may hit. The triangle's functions begin at the
    /// ray in column and row `first`.
    #[inline(never)]
    pub(super) fn mark_undecided(
        &mut self,
        simd: Simd,
        functions: &EdgeFunctions,
        first: (usize, usize),
        bounds: RayBox,
    ) {
        let of_ray = |ray: usize| {
            self.marks += 1;
            self.high[ray] = f32::INFINITY;
            self.leave_ray_undecided(ray, functions.primitive);
            // Hi-z stays as it is, but the cell's sure hits are no longer its rays' closest hits.
            self.dirty |= 1 << cell_of(ray);
        };
        let marking = ForEachThatMayHit {
            functions,
            first,
            bounds,
            of_ray,
        };
        dispatch(simd, marking);
    }
}
