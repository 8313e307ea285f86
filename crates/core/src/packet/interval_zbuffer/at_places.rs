//! Rasterising packets of panoramas, whose rays lie at irregular places.
//!
//! Functions are evaluated at each ray's place instead of stepping from ray to ray; the cells and rows that a
//! triangle touches are found by comparing bounds.
//!
//! # Error bound
//! u = 2⁻²⁴, M as at [`LINEAR_ERROR`](crate::packet::setup::LINEAR_ERROR), whose 48u of M cover all of this. At a ray a
//! function is off by u for its place, u for coefficients, u for products and 2u for sums. Over a cell its extremes are
//! the value at the centre, off by 4u, and the swing from there, off by 3u; their sum rounds by 2u, and bounds hold
//! places as rounded, by u. The centre and half of the extent are rounded by u·[`SIDE`] each: 12u.

use super::cut_triangles::Cut;
use super::depth_merge::DepthMerge;
use super::edge_functions::EdgeFunctions;
use super::rasterize::CONTESTED;
use super::{ALL, IntervalZBuffer, ROW, SIDE, for_each_bit};
use crate::num::simd::{F32x8, LANES, Lanes, Mask8, Work, dispatch};
use crate::packet::decisions::Decisions;
use crate::packet::place_box::PlaceBox;
use crate::packet::places::{ALL_CELLS, Places, first_of};
use crate::packet::plane_order::{PlacesWithin, PlaneOrder};
use crate::packet::ray_box::RayBox;
use crate::packet::setup::PacketSpace;
use crate::packet::triangles_at_places::SmallTriangle;
use crate::triangle::CornerLanes;

/// The box of all rays: functions are set up relative to the packet's first place.
const WHOLE: RayBox = RayBox {
    left: 0,
    right: SIDE as i32 - 1,
    top: 0,
    bottom: SIDE as i32 - 1,
};

/// The values of a function at eight places. Not a closure: calls inside one may be compiled without the instruction
/// set of its caller.
#[inline(always)]
fn value<L: Lanes>(lanes: L, f: [f32; 3], (x, y): (L::F32, L::F32)) -> L::F32 {
    let below = lanes.splat(f[0]) + lanes.splat(f[2]) * y;
    below + lanes.splat(f[1]) * x
}

/// The most by which a function differs from its value at the centre, within half extents.
#[inline(always)]
fn swing<F: F32x8>(f: [f32; 3], (half_x, half_y): (F, F)) -> F {
    half_x * f[1].abs() + half_y * f[2].abs()
}

impl IntervalZBuffer {
    /// Clears it for a panorama's packet. Entries without a ray are infinitely near, so that no triangle wins them.
    #[inline(always)]
    pub(in crate::packet) fn clear_places(&mut self, lanes: impl Lanes, places: &Places) {
        self.clear(lanes, SIDE as u32, SIDE as u32, [f32::INFINITY; 2]);
        let mut is_whole = true;
        for has_ray in places.has_ray {
            is_whole &= has_ray == u32::MAX;
        }
        if is_whole {
            return;
        }
        for (row, has_ray) in places.has_ray.into_iter().enumerate() {
            for_each_bit(u64::from(!has_ray), |column| {
                self.low[row * SIDE + column] = f32::INFINITY;
                self.high[row * SIDE + column] = f32::INFINITY;
            });
        }
        self.dirty = u32::MAX;
        self.update_hi_z(lanes);
    }

    /// [`IntervalZBuffer::rasterize`] at places.
    #[inline(always)]
    pub(in crate::packet) fn rasterize_at_places(
        &mut self,
        lanes: impl Lanes,
        (space, places): (&PacketSpace, &Places),
        corners: &CornerLanes,
        bounds: &[PlaceBox; LANES],
        primitives: &[u32],
        decisions: &mut Decisions<'_>,
    ) {
        let mut set_up = space.set_up(corners, &[WHOLE; LANES]);
        if space.reference_plane.is_some() {
            decisions.refine_keys(space, (corners, primitives), &mut set_up);
            self.overflowed |= set_up.overflows;
        }
        let any_rough = set_up.is_rough.iter().fold(false, |any, &is| any | is);
        let [never_hit, _] = if any_rough {
            self.refine(space, &mut set_up, corners, primitives, decisions)
        } else {
            [0; 2]
        };
        for (l, &primitive) in primitives.iter().enumerate().take(LANES) {
            if never_hit >> l & 1 != 0 || set_up.boxes[l].right < 0 {
                continue;
            }
            let functions = EdgeFunctions::of(&set_up, l, primitive);
            if set_up.ill_conditioned[l] {
                let marking = MarkPlacesUndecided {
                    zbuffer: self,
                    places,
                    functions: &functions,
                    bounds: &bounds[l],
                };
                dispatch(decisions.simd(), marking);
                continue;
            }
            let all;
            let cuts = if decisions.clip().is_empty() {
                &[][..]
            } else {
                all = Cut::all(primitive, &set_up, l, decisions);
                &all.0[..all.1]
            };
            self.rasterize_cells_at(lanes, places, (&functions, cuts), &bounds[l], decisions);
        }
        self.update_hi_z(lanes);
    }

    /// Merges a small triangle into the rays within its bounds, which lie in these cells (as bits). Returns whether any
    /// of them may hit it.
    #[inline(always)]
    pub(in crate::packet) fn rasterize_small_at(
        &mut self,
        lanes: impl Lanes,
        places: &Places,
        (triangle, primitive): (SmallTriangle<'_>, u32),
        (mut cells, bounds): (u32, &PlaceBox),
        decisions: &mut Decisions<'_>,
    ) -> bool {
        let [e, f, g] = triangle.edges();
        let [base, by_third, by_first] = triangle.depth_key();
        let edge_error = triangle.edge_error();
        let (error, minus_error) = (lanes.splat(edge_error), lanes.splat(-edge_error));
        let (left, right) = (lanes.splat(bounds.left), lanes.splat(bounds.right));
        let (top, bottom) = (lanes.splat(bounds.top), lanes.splat(bounds.bottom));
        let never = lanes.splat(f32::NEG_INFINITY);
        let merge = DepthMerge::of(
            lanes,
            primitive,
            triangle.depth_key_error(),
            self.start_keys,
        );
        let mut any = false;
        while cells != 0 {
            let cell = cells.trailing_zeros() as usize % ALL_CELLS;
            cells &= cells - 1;
            let mut rows = places.rows_touched(lanes, cell, bounds);
            while rows != 0 {
                let first = first_of(cell, rows.trailing_zeros() as usize);
                rows &= rows - 1;
                let (x, y) = places.eight(first);
                let at = (lanes.load(x), lanes.load(y));
                let beside = at.0.lt(left) | right.lt(at.0) | at.1.lt(top) | bottom.lt(at.1);
                if beside.bits() & ALL == ALL {
                    continue;
                }
                let (a, b, c) = (
                    value(lanes, e, at),
                    value(lanes, f, at),
                    value(lanes, g, at),
                );
                // The functions' errors are bounded within the bounds alone.
                let least = beside.select(never, a.min(b).min(c));
                let outside = least.lt(minus_error);
                if outside.bits() & ALL == ALL {
                    continue;
                }
                any = true;
                let inside = error.lt(least);
                let (low, high, primitives) = self.rays_of_row(first);
                let near = lanes.splat(base) + (c * by_third + a * by_first);
                let sides = Some((inside, outside));
                let undecided = merge.row(lanes, near, sides, low, high, primitives);
                if undecided.rays != 0 {
                    let of_eight = |order: &PlaneOrder| order.of_eight((x, y));
                    self.leave_undecided((primitive, first), undecided, of_eight, decisions);
                }
                self.dirty |= 1 << cell;
            }
        }
        any
    }

    /// Rasterises a triangle, or the part that clipping planes keep of it, cell by cell.
    #[inline(always)]
    fn rasterize_cells_at(
        &mut self,
        lanes: impl Lanes,
        places: &Places,
        (functions, cuts): (&EdgeFunctions, &[Cut]),
        bounds: &PlaceBox,
        decisions: &mut Decisions<'_>,
    ) {
        let EdgeFunctions {
            edges,
            edge_error,
            depth_key,
            depth_key_error,
            ..
        } = *functions;
        let (error, minus_error) = (lanes.splat(edge_error), lanes.splat(-edge_error));
        let touched = places.cells_touched(lanes, bounds);
        for half in 0..ALL_CELLS / LANES {
            let touched = touched >> (half * LANES) & ((1 << LANES) - 1);
            if touched == 0 {
                continue;
            }
            let cells = places.centres(half);
            let (x, y) = (lanes.load(&cells.x), lanes.load(&cells.y));
            let (half_x, half_y) = (lanes.load(&cells.half_x), lanes.load(&cells.half_y));
            let [e, f, g] = edges;
            let (a, b, c) = (
                value(lanes, e, (x, y)),
                value(lanes, f, (x, y)),
                value(lanes, g, (x, y)),
            );
            let (p, q, r) = (
                swing(e, (half_x, half_y)),
                swing(f, (half_x, half_y)),
                swing(g, (half_x, half_y)),
            );
            let greatest = (a + p).min(b + q).min(c + r);
            let least = (a - p).min(b - q).min(c - r);
            let outside = greatest.lt(minus_error).bits();
            let inside = error.lt(least).bits();
            let mut nearest = [0.0; ROW];
            let near = value(lanes, depth_key, (x, y)) + swing(depth_key, (half_x, half_y));
            (near + depth_key_error).store(&mut nearest);

            let mut queued = touched & !outside;
            while queued != 0 {
                let lane = queued.trailing_zeros() as usize % LANES;
                queued &= queued - 1;
                let cell = half * LANES + lane;
                if nearest[lane] < self.hi_z[cell] {
                    continue;
                }
                let covers = inside >> lane & 1 != 0 && cuts.is_empty();
                if self.contested[cell] > CONTESTED {
                    let within = PlacesWithin {
                        centre: [cells.x[lane], cells.y[lane]].map(f64::from),
                        half: [cells.half_x[lane], cells.half_y[lane]].map(f64::from),
                    };
                    if self.is_behind_sure_hits(functions.primitive, (cell, &within), decisions) {
                        continue;
                    }
                    if covers {
                        self.keep_cover(functions.primitive, (cell, &within), decisions);
                    }
                }
                if covers {
                    self.cover_at(lanes, places, functions, cell, decisions);
                } else {
                    let rows = (cell, places.rows_touched(lanes, cell, bounds));
                    self.rasterize_rows_at(lanes, places, (functions, cuts), rows, decisions);
                }
                self.dirty |= 1 << cell;
            }
        }
    }

    /// Rasterises some rows, as bits, of a cell.
    #[inline(always)]
    fn rasterize_rows_at(
        &mut self,
        lanes: impl Lanes,
        places: &Places,
        (functions, cuts): (&EdgeFunctions, &[Cut]),
        (cell, mut rows): (usize, u32),
        decisions: &mut Decisions<'_>,
    ) {
        let EdgeFunctions {
            edges: [e, f, g],
            edge_error,
            depth_key,
            ..
        } = *functions;
        let (error, minus_error) = (lanes.splat(edge_error), lanes.splat(-edge_error));
        let merge = DepthMerge::new(lanes, functions, self.start_keys);
        while rows != 0 {
            let first = first_of(cell, rows.trailing_zeros() as usize);
            rows &= rows - 1;
            let (x, y) = places.eight(first);
            let at = (lanes.load(x), lanes.load(y));
            let (a, b, c) = (
                value(lanes, e, at),
                value(lanes, f, at),
                value(lanes, g, at),
            );
            let least = a.min(b).min(c);
            let mut outside = least.lt(minus_error);
            if outside.bits() & ALL == ALL {
                continue;
            }
            let mut inside = error.lt(least);
            let near = value(lanes, depth_key, at);
            for cut in cuts {
                let along = value(lanes, cut.along(), at);
                let (removes, keeps) = cut.decide(lanes, [a, b, c], near, along);
                outside = outside | removes;
                inside = inside & keeps;
            }
            let (low, high, primitives) = self.rays_of_row(first);
            let undecided = merge.row(lanes, near, Some((inside, outside)), low, high, primitives);
            if undecided.rays != 0 {
                let of_eight = |order: &PlaneOrder| order.of_eight((x, y));
                self.leave_undecided((merge.primitive, first), undecided, of_eight, decisions);
            }
        }
    }

    /// Merges a triangle into a cell whose rays are all surely inside its edges.
    #[inline(always)]
    fn cover_at(
        &mut self,
        lanes: impl Lanes,
        places: &Places,
        functions: &EdgeFunctions,
        cell: usize,
        decisions: &mut Decisions<'_>,
    ) {
        let merge = DepthMerge::new(lanes, functions, self.start_keys);
        for row in 0..ROW {
            let first = first_of(cell, row);
            let (x, y) = places.eight(first);
            let (low, high, primitives) = self.rays_of_row(first);
            let near = value(lanes, functions.depth_key, (lanes.load(x), lanes.load(y)));
            let undecided = merge.row(lanes, near, None, low, high, primitives);
            if undecided.rays != 0 {
                let of_eight = |order: &PlaneOrder| order.of_eight((x, y));
                self.leave_undecided((merge.primitive, first), undecided, of_eight, decisions);
            }
        }
    }
}

/// Marks undecided every ray within bounds that an ill-conditioned triangle may hit.
struct MarkPlacesUndecided<'m> {
    zbuffer: &'m mut IntervalZBuffer,
    places: &'m Places,
    functions: &'m EdgeFunctions,
    bounds: &'m PlaceBox,
}

impl Work for MarkPlacesUndecided<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            zbuffer,
            places,
            functions,
            bounds,
        } = self;
        let mut cells = places.cells_touched(lanes, bounds);
        while cells != 0 {
            let cell = cells.trailing_zeros() as usize % ALL_CELLS;
            cells &= cells - 1;
            let mut rows = places.rows_touched(lanes, cell, bounds);
            while rows != 0 {
                let first = first_of(cell, rows.trailing_zeros() as usize);
                rows &= rows - 1;
                let (x, y) = places.eight(first);
                let mut rays = functions.may_be_hit(lanes, (lanes.load(x), lanes.load(y)), 0.0);
                rays &= places.has_ray[first / SIDE] >> (first % SIDE);
                for_each_bit(rays.into(), |lane| {
                    zbuffer.high[first + lane] = f32::INFINITY;
                    zbuffer.leave_ray_undecided(first + lane, functions.primitive);
                });
            }
        }
    }
}
