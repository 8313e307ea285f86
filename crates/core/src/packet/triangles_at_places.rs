//! Eight triangles in a packet whose rays lie at [`Places`](super::places::Places) of their own, in single precision: the
//! bounds of the places where rays may hit each, and for small ones edge functions and depth keys without a set-up. Most
//! triangles smaller than the ray spacing pass between places and are culled by their bounds.
//!
//! # Error bound
//! u, m, m' and E as in [`ray_bounds`](super::ray_bounds), which projects the corners; the rays' own error ρ is that of
//! [`places`](super::places).
//!
//! * **Bounds** grow by m'. Of its 2⁻¹⁵ = 512u a place takes 192u, the sums here take 64u, and the rounding of a ray's place
//!   to single precision 32u. Places further out than 2·SIDE stay outside: they are off by less than a 2000th of
//!   themselves, and by m'.
//! * **Edge functions.** That of corners a and b is (a_y − b_y)(x − a_x) + (b_x − a_x)(y − a_y), evaluated as a linear
//!   function of the place (x, y), at most 32. Slopes are at most s, the triangle's size, below [`SMALL_SIDE`], and the
//!   corners of a triangle that a ray may hit at most 32 + s. The slopes round by 2us(s + ⅛) in all, products and sum of
//!   the constant by 4·37us, those at a place by 32us, 42us, 32us and 10us: below 280us. Of m' 288u are left, which E
//!   multiplies by 4s + 1.
//! * **Area.** The doubled area is the first function at the third corner: a cross product of two differences, each off by
//!   2m' and at most s. It is off by 8sm' + 8m'² and 4us², less than 3E = 12sm' + 3m' with m' < ⅛, as
//!   [`ray_bounds`](super::ray_bounds) supposes; depth keys are interpolated as there.

use super::lane_math::{Three, least, most};
use super::params::{SIDE, SMALL_SIDE};
use super::place_box::PlaceBox;
use super::ray_bounds::CornerProjector;
use super::setup::place_bounds::PlaceBounds;
use super::small_triangles::{DEPTH_KEY_ERROR, MAX_AREA_ERROR};
use crate::hit::Cull;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use crate::triangle::CornerLanes;

/// The greatest m' at which single precision serves: above it triangles are bounded in double precision. It is the m' of
/// small triangles as [`ray_bounds`](super::ray_bounds) has it.
const MOST_PLACE_ERROR: f32 = 0.125;

/// Eight triangles projected into a packet.
pub(super) struct TrianglesAtPlaces {
    pub(super) bounds: PlaceBounds,
    /// Those of the seen triangles, as bits, that are small.
    pub(super) small: u32,
    edges: [[[f32; LANES]; 3]; 3],
    edge_error: [f32; LANES],
    depth_key: [[f32; LANES]; 3],
    depth_key_error: [f32; LANES],
}

/// One of them that is small.
#[derive(Clone, Copy)]
pub(super) struct SmallTriangle<'a> {
    all: &'a TrianglesAtPlaces,
    lane: usize,
}

impl SmallTriangle<'_> {
    /// Edge functions, positive inside: value at (0, 0) and slopes.
    #[inline(always)]
    pub(super) fn edges(&self) -> [[f32; 3]; 3] {
        let [e, f, g] = &self.all.edges;
        [self.of(e), self.of(f), self.of(g)]
    }

    /// Bound on their errors within the triangle's bounds.
    #[inline(always)]
    pub(super) fn edge_error(&self) -> f32 {
        self.all.edge_error[self.lane]
    }

    /// The depth key: its value at the first corner, and its slopes by the third and the first edge function.
    #[inline(always)]
    pub(super) fn depth_key(&self) -> [f32; 3] {
        self.of(&self.all.depth_key)
    }

    /// Bound on its error inside the triangle.
    #[inline(always)]
    pub(super) fn depth_key_error(&self) -> f32 {
        self.all.depth_key_error[self.lane]
    }

    #[inline(always)]
    fn of(&self, numbers: &[[f32; LANES]; 3]) -> [f32; 3] {
        let lane = self.lane;
        [numbers[0][lane], numbers[1][lane], numbers[2][lane]]
    }
}

impl TrianglesAtPlaces {
    /// No triangles.
    pub(super) const NONE: Self = Self {
        bounds: PlaceBounds::NONE,
        small: 0,
        edges: [[[0.0; LANES]; 3]; 3],
        edge_error: [0.0; LANES],
        depth_key: [[0.0; LANES]; 3],
        depth_key_error: [0.0; LANES],
    };

    /// One that is small.
    #[inline(always)]
    pub(super) fn small(&self, lane: usize) -> SmallTriangle<'_> {
        let lane = lane % LANES;
        SmallTriangle { all: self, lane }
    }

    /// Projects the first `count` triangles into a packet whose places are within `around`. Returns whether single precision
    /// serves all that are seen; else `self` holds no triangles.
    #[inline(always)]
    pub(super) fn project<L: Lanes>(
        &mut self,
        lanes: L,
        projector: &CornerProjector,
        corners: &CornerLanes,
        count: usize,
        around: &PlaceBox,
    ) -> bool {
        let projected = projector.projected(lanes, corners);
        let error = projected.place_error();
        let (xs, ys) = (projected.xs, projected.ys);
        let (left, right) = (least(xs), most(xs));
        let (top, bottom) = (least(ys), most(ys));
        let size = (right - left).max(bottom - top);
        let (left, right) = (left - error, right + error);
        let (top, bottom) = (top - error, bottom + error);
        let beside = right.lt(lanes.splat(around.left)) | lanes.splat(around.right).lt(left);
        let above = bottom.lt(lanes.splat(around.top)) | lanes.splat(around.bottom).lt(top);
        let serves = projected.safe & error.lt(lanes.splat(MOST_PLACE_ERROR));
        let missed = projected.behind | (serves & (beside | above));
        let seen = !missed.bits() & ((1 << count) - 1);
        self.small = 0;
        if seen & !serves.bits() != 0 {
            self.bounds.seen = 0;
            return false;
        }
        let bounds = [left, right, top, bottom, projected.nearest];
        self.bounds.store(bounds, seen);
        let is_small = projected.in_front & size.lt(lanes.splat(SMALL_SIDE));
        self.small = is_small.bits() & seen;
        if self.small != 0 {
            let error = error * (size * 4.0 + 1.0);
            let keys = (projected.keys, projected.key_error);
            self.find_functions(lanes, (xs, ys), keys, error, projector.cull);
        }
        true
    }

    /// Computes the functions of small triangles; those of which it is not sure which side faces the eye are no longer
    /// small, and those that are culled no longer seen.
    #[inline(always)]
    fn find_functions<L: Lanes>(
        &mut self,
        lanes: L,
        ((ax, bx, cx), (ay, by, cy)): (Three<L::F32>, Three<L::F32>),
        ((a_key, b_key, c_key), corner_error): (Three<L::F32>, L::F32),
        error: L::F32,
        cull: Cull,
    ) {
        let area = (ay - by) * (cx - ax) + (bx - ax) * (cy - ay);
        // Columns run right and rows down, so a triangle that faces the eye has a negative area.
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        let front = area.lt(zero);
        let sign = front.select(lanes.splat(-1.0), one);
        // Of an area of minus zero too this is plus infinity: nothing is sure of it.
        let inverse = one / area.abs();
        let area_error = error * inverse;
        self.small &= area_error.lt(lanes.splat(MAX_AREA_ERROR)).bits();
        if cull == Cull::Back {
            let culled = self.small & !front.bits();
            self.small &= !culled;
            self.bounds.seen &= !culled;
        }
        let corners = [(ax, ay), (bx, by), (cx, cy)];
        for (edge, out) in self.edges.iter_mut().enumerate() {
            let ((px, py), (qx, qy)) = (corners[edge], corners[(edge + 1) % 3]);
            let (by_x, by_y) = ((py - qy) * sign, (qx - px) * sign);
            (zero - (by_x * px + by_y * py)).store(&mut out[0]);
            by_x.store(&mut out[1]);
            by_y.store(&mut out[2]);
        }
        error.store(&mut self.edge_error);
        let (to_b, to_c) = (b_key - a_key, c_key - a_key);
        let by_slope = area_error * (to_b.abs() + to_c.abs()) * DEPTH_KEY_ERROR;
        a_key.store(&mut self.depth_key[0]);
        (to_b * inverse).store(&mut self.depth_key[1]);
        (to_c * inverse).store(&mut self.depth_key[2]);
        (corner_error + by_slope).store(&mut self.depth_key_error);
    }
}

/// No place is further from a packet's corner.
const _: () = assert!(SIDE <= 32 && SMALL_SIDE < 5.0);
