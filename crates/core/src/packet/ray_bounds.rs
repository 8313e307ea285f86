//! Which of a block's rays may meet a triangle, eight triangles at once, in single precision: most of
//! those smaller than the rays' spacing pass between them, and need not be set up.
//!
//! A corner's place in the block is X/Z, with X, Y, Z what T (see [`setup`](super::setup)) makes of it,
//! or X itself for orthographic blocks; a triangle's box is that of its corners' places.
//!
//! # Error bounds
//! u = 2⁻²⁴. T's rows are S_x, S_y, S_z long as sums of magnitudes, S the greatest of the first two. Corners
//! are taken relative to a point q on the block's first ray, about as deep as what is looked at; r is the
//! greatest magnitude of a triangle's corners there, and t = T(q − o), o the eye or the ray's beginning,
//! is (0, 0, depth of q) but for rounding.
//!
//! * **Corners.** q is the sum of two singles, and exact: what it is off the ray by, t tells. The difference
//!   from the first is exact where the second counts (Sterbenz), else rounded by less than 2u of the result;
//!   that from the second is rounded by u. The eye's own error is η; T, rounded in doubles, moves t by less
//!   than 128ε|q − o|·B/D (see [`setup`](super::setup)) of S. r is taken to be no less than the sum of
//!   both over u, so that corners are off by 4ur.
//! * **X, Y, Z.** T's rows are rounded by u of themselves (their own errors in doubles are less as long
//!   as B/D < 10⁶), products by u, three sums by u each: with the corners' errors X is off by 9ur·S and the
//!   second order, and t's rounding, which is second order too. We take e_x = 10ur·S. Z's sums and t
//!   add 4u|t_z|: e_z = 10ur·S_z + 5u|t_z|.
//! * **Boxes.** Where Z ≥ 2048·e_z, a place p with |p| ≤ 2·[`SIDE`] is off by
//!   (e_x + |p|e_z)/Z · 2048/2047 and 3u|p| for the quotient; rays are off by ρ of a column, which
//!   [`BlockSpace`] gives. Boxes are made larger by 2⁻⁹ + m with m = 2ρ + 1.25(e_x + 64e_z)/Z; 3u|p| and the
//!   rounding of the sums need 2⁻¹⁵ of the 2⁻⁹. Of places further out it is enough that they stay outside:
//!   off by less than a 2000th and the same e_x/Z, they do. Z is the least of the three corners'.
//! * **Few rays.** Where a box is less than w = [`FEW_SIDE`] wide and high, and made larger by less than
//!   1/8, it holds no more than 5 rays each way. Places are off by m' = m + 2⁻¹⁵, and no coordinate of a
//!   corner relative to a ray of the box is more than its size s + 1/8. Edges are linear in the ray's place:
//!   what is evaluated is, but for rounding, the cross product of two moved corners relative to the ray,
//!   off by 4(s + 1/8)m' + 2m'² ≤ (4s + 1)m'. Rounded are the corners relative to the first ray, two products
//!   and a difference, the steps, and a sum for each column and row: of values below
//!   2(w + 1)² + 2·2w·(w + 1) < 130, twelve times at most, each by u: less than 2⁻¹³. The sum of a ray's
//!   three, the doubled area, is more than three times as great as what it is off by, so that its sign is
//!   sure: edges are turned to be above zero inside. Where a ray's three are surely above zero it is inside,
//!   where one is surely below it is outside.
//! * **How near.** A depth is off by e_z, its inverse by e_z/Z · 2048/2047 of itself and 2u. Where a triangle
//!   is met it is no nearer than its nearest corner. Its nearness along a ray is that of its corners by their
//!   weights, edges' values over their sum, the doubled area. With E what an edge may be off by, the sum is off by
//!   3E, and a weight of at most 1 by 4E over the sum as evaluated: by as much of how much nearer the
//!   second corner and the third are than the first; we take 6E. Rounding takes less than 26u of the nearest corner (orthographic: of the
//!   greatest depth), which the slack of 2⁻¹⁹ covers beside the corners' own.
//!
//! Where Z is less than that, or a number leaves the range, every ray of the block may meet the
//! triangle. Range: S and r·S < 10³⁰ and Z ≥ 10⁻³⁰ keep products and inverses finite; r is taken to be
//! 10⁻³⁰ at least as well, which keeps what underflow leaves out, 10⁻⁴⁴, far below the bounds.

use super::lane_math::{ROUNDER, least, most, round};
use super::params::{FEW_SIDE, SIDE};
use super::ray_box::RayBox;
use super::setup::{BlockSpace, CornerLanes};
use super::slivers::{Boxes, Placed};
use super::small_triangles::{Edges, FewRays};
use crate::hit::Cull;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use glam::DVec3;

/// u.
const UNIT: f64 = 1.0 / (1u64 << 24) as f64;

/// By how much boxes are larger than the places' errors alone would have it.
const MARGIN: f64 = 1.0 / 512.0;

/// How much greater than its error a corner's depth has to be.
const CLEAR: f32 = 2048.0;

/// By how much a box of few rays is made larger at most: together with [`FEW_SIDE`] it holds no more
/// than 5 rays each way.
const FEW_MARGIN: f32 = 0.125;

/// What places are off by though nothing else were.
const PLACE_ERROR: f64 = 1.0 / 32768.0;

/// What cross products are off by though places were exact.
const CROSS_ROUNDING: f32 = 1.0 / 8192.0;

/// What a nearness may be off by as a share of the greatest, but for the errors of corners and edges.
const NEARNESS_SLACK: f32 = 1.0 / (1 << 19) as f32;

/// The greatest that places and depths may be, and the inverse of the least.
const RANGE: f64 = 1e30;

/// Places triangles among a block's rays.
#[derive(Clone, Debug)]
pub(crate) struct Placer {
    perspective: bool,
    cull: Cull,
    /// What corners are taken relative to, in two parts.
    origin: [[f32; 2]; 3],
    /// T's rows.
    map: [[f32; 3]; 3],
    /// The least r.
    least_reach: f32,
    /// The greatest r.
    most_reach: f32,
    /// T of that.
    shift: [f32; 3],
    /// e_z: always, and as a share of r.
    depth_error: [f32; 2],
    /// By how much boxes are made larger: always, and as shares of 1/Z and of r/Z; for orthographic blocks
    /// of 1 and r.
    margin: [f32; 3],
    /// The last column and row.
    last: [f32; 2],
}

/// The rays that may meet each of eight triangles: boxes of whole numbers, both ends included, with
/// [`ROUNDER`] added.
pub(crate) struct Footprints {
    left: [f32; LANES],
    right: [f32; LANES],
    top: [f32; LANES],
    bottom: [f32; LANES],
    /// At least how near the nearest corner is, as [`SetUp::nearness`](super::setup::SetUp) counts;
    /// infinite where it cannot be told.
    pub(crate) nearest: [f32; LANES],
    /// Those that a ray may meet, as bits.
    pub(crate) seen: u32,
    /// Those of them with few rays, whose edges tell which meet them, as bits.
    pub(crate) few: u32,
    /// Which of those meet them.
    pub(crate) few_rays: FewRays,
}

impl Placer {
    /// Places well what is about as deep as `depth`, and everything else soundly.
    pub(crate) fn new(space: &BlockSpace, depth: f32) -> Self {
        let length = |row: DVec3| row.abs().element_sum();
        let [x, y, z] = space.map.map(length);
        let wide = if x > y { x } else { y };
        let depth = if (0.0..f32::MAX).contains(&depth) {
            depth
        } else {
            0.0
        };
        let origin = (space.origin + space.way * f64::from(depth)).to_array();
        let origin = origin.map(|o| {
            let high = o as f32;
            [high, (o - f64::from(high)) as f32]
        });
        let [ox, oy, oz] = origin.map(|[high, low]| f64::from(high) + f64::from(low));
        let from_origin = DVec3::new(ox, oy, oz) - space.origin;
        let shift = space.map.map(|row| row.dot(from_origin));
        let (moved, far) = (
            from_origin.abs().max_element(),
            space.origin.abs().max_element() + from_origin.abs().max_element(),
        );
        // Written so that what is not a number is not sound.
        let sound = (far < RANGE)
            & (x + y + z < RANGE)
            & ((x + y + z) * moved < RANGE)
            & (space.obliqueness < 1e6);
        let most_reach = if sound { RANGE / (wide + z) } else { 0.0 };
        let place_share = if space.perspective {
            2.0 * SIDE as f64
        } else {
            0.0
        };
        let depth_error = 5.0 * UNIT * shift[2].abs();
        Self {
            perspective: space.perspective,
            cull: space.cull,
            origin,
            map: space.map.map(|row| row.as_vec3().to_array()),
            shift: shift.map(|s| s as f32),
            least_reach: (space.origin_error / UNIT
                + 128.0 * f64::EPSILON * space.obliqueness / UNIT * moved
                + UNIT * far
                + 1.0 / RANGE) as f32,
            most_reach: most_reach as f32,
            depth_error: [depth_error as f32, (10.0 * UNIT * z) as f32],
            margin: [
                (MARGIN + 2.0 * space.ray_error) as f32,
                (1.25 * place_share * depth_error) as f32,
                (1.25 * 10.0 * UNIT * (wide + place_share * z)) as f32,
            ],
            last: space.last.into(),
        }
    }

    /// Which rays may meet each of the first `count` triangles.
    #[inline(always)]
    pub(crate) fn place<L: Lanes>(
        &self,
        lanes: L,
        corners: &CornerLanes,
        count: usize,
        out: &mut Footprints,
    ) {
        let zero = lanes.splat(0.0);
        let mut reach = lanes.splat(self.least_reach);
        let mut places = [[zero; 3]; 3];
        let [x, y, z] = self.shift;
        let shift = [lanes.splat(x), lanes.splat(y), lanes.splat(z)];
        for (corner, place) in places.iter_mut().enumerate() {
            let mut sums = shift;
            for axis in 0..3 {
                let [high, low] = self.origin[axis];
                let from_high = lanes.load(&corners[3 * corner + axis]) - high;
                let relative = from_high - low;
                reach = reach.max(relative);
                reach = reach.max(zero - relative);
                for (sum, row) in sums.iter_mut().zip(&self.map) {
                    *sum = *sum + relative * row[axis];
                }
            }
            *place = sums;
        }
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = places;
        let in_range = reach.lt(lanes.splat(self.most_reach));
        let [always, by_reach] = self.depth_error;
        let depth_error = lanes.splat(always) + reach * by_reach;
        let front = least((az, bz, cz));
        let back = most((az, bz, cz));
        let behind = back.lt(zero - depth_error);

        let [always, by_depth, by_reach] = self.margin;
        let error = lanes.splat(by_depth) + reach * by_reach;
        let (safe, nearest, margin, [xs, ys, nears]) = if self.perspective {
            let one = lanes.splat(1.0);
            let (ia, ib, ic) = (one / az, one / bz, one / cz);
            let clear = (depth_error * CLEAR).max(lanes.splat((1.0 / RANGE) as f32));
            let nearest = most((ia, ib, ic));
            (
                in_range & clear.lt(front),
                nearest,
                error * nearest,
                [
                    (ax * ia, bx * ib, cx * ic),
                    (ay * ia, by * ib, cy * ic),
                    (ia, ib, ic),
                ],
            )
        } else {
            {
                let (a, b, c) = (zero - az, zero - bz, zero - cz);
                (
                    in_range,
                    zero,
                    error,
                    [(ax, bx, cx), (ay, by, cy), (a, b, c)],
                )
            }
        };
        let margin = lanes.splat(always) + margin;
        let nobody = in_range & behind;
        let ends = Ends {
            margin,
            safe,
            nobody,
        };
        let (left, right, across) = ends.whole(lanes, xs, self.last[0]);
        let (top, bottom, along) = ends.whole(lanes, ys, self.last[1]);
        let empty = right.lt(left) | bottom.lt(top);

        let (nearest, near_error, in_front) = if self.perspective {
            let slack = depth_error * nearest * 1.25 + NEARNESS_SLACK;
            let error = nearest * slack;
            (nearest + error, error, safe)
        } else {
            let magnitude = front.max(zero - front).max(back.max(zero - back));
            let rounding = magnitude * NEARNESS_SLACK;
            let error = depth_error + rounding;
            let nearest = error - front;
            (nearest, error, safe & nearest.lt(zero))
        };

        let size = across.max(along).max(margin * (FEW_SIDE / FEW_MARGIN));
        let small = in_front & size.lt(lanes.splat(FEW_SIDE));
        out.seen = !empty.bits() & ((1 << count) - 1);
        out.few = small.bits() & out.seen;
        let off = margin - (MARGIN - PLACE_ERROR) as f32;
        if out.few != 0 {
            let side = size * 4.0 + 1.0;
            let error = off * side + CROSS_ROUNDING;
            let edges = Edges::new(lanes, [xs, ys, nears], (left, top), error, near_error);
            out.few &= edges.told.bits();
            if self.cull == Cull::Back {
                let culled = out.few & !edges.front.bits();
                out.few &= !culled;
                out.seen &= !culled;
            }
            let size = (right - left, bottom - top);
            out.seen &= !edges.meet(lanes, size, out.few, &mut out.few_rays);
        }
        let boxes = Boxes {
            left,
            right,
            top,
            bottom,
        };
        let placed = Placed {
            xs,
            ys,
            length: across.max(along),
            off,
            safe,
        };
        let (boxes, seen) = boxes.around_thin(lanes, &placed, out.seen);
        out.seen = seen;
        let nearest = safe.select(nearest, lanes.splat(f32::INFINITY));
        let rounder = lanes.splat(ROUNDER);
        (boxes.left + rounder).store(&mut out.left);
        (boxes.right + rounder).store(&mut out.right);
        (boxes.top + rounder).store(&mut out.top);
        (boxes.bottom + rounder).store(&mut out.bottom);
        nearest.store(&mut out.nearest);
    }
}

/// How far triangles reach in one direction.
struct Ends<L: Lanes> {
    margin: L::F32,
    safe: L::Mask,
    nobody: L::Mask,
}

impl<L: Lanes> Ends<L> {
    /// The first whole number not before a triangle's box, and the last not after it; and how far it
    /// reaches.
    #[inline(always)]
    fn whole(
        &self,
        lanes: L,
        (a, b, c): (L::F32, L::F32, L::F32),
        last: f32,
    ) -> (L::F32, L::F32, L::F32) {
        let (zero, none, last) = (lanes.splat(0.0), lanes.splat(-1.0), lanes.splat(last));
        let half = lanes.splat(0.5);
        let (begin, end) = (least((a, b, c)), most((a, b, c)));
        let first = begin - self.margin + half;
        let first = first.max(zero).min(lanes.splat(2.0 * SIDE as f32));
        let first = self.safe.select(first, zero);
        let final_ = end + self.margin - half;
        let final_ = final_.max(none).min(last);
        let final_ = self.safe.select(final_, last);
        let final_ = self.nobody.select(none, final_);
        (round(first), round(final_), end - begin)
    }
}

impl Footprints {
    /// None yet.
    pub(crate) const NONE: Self = Self {
        left: [0.0; LANES],
        right: [0.0; LANES],
        top: [0.0; LANES],
        bottom: [0.0; LANES],
        nearest: [0.0; LANES],
        seen: 0,
        few: 0,
        few_rays: FewRays::NONE,
    };

    /// The box of one that is seen.
    #[inline(always)]
    pub(crate) fn rays(&self, lane: usize) -> RayBox {
        let whole = |x: f32| x.to_bits() as i32 - ROUNDER.to_bits() as i32;
        RayBox {
            left: whole(self.left[lane]),
            right: whole(self.right[lane]),
            top: whole(self.top[lane]),
            bottom: whole(self.bottom[lane]),
        }
    }
}
