//! Which of a block's rays may meet a triangle, eight triangles at once, in single precision: most of
//! those smaller than the rays' spacing pass between them, and need not be set up.
//!
//! A corner's place in the block is X/Z, with X, Y, Z what T (see [`setup`](super::setup)) makes of it,
//! or X itself for orthographic blocks; a triangle's box is that of its corners' places.
//!
//! # Error bounds
//! u = 2⁻²⁴. T's rows are S_x, S_y, S_z long as sums of magnitudes, S the greatest of the first two; r is
//! the greatest magnitude of a triangle's corners relative to the eye.
//!
//! * **Corners.** The eye o is kept as two singles, which leaves u²|o| of it, beside its own error η. The
//!   difference from the first is exact where the second counts (Sterbenz), else rounded by less than 2u of
//!   the result; that from the second is rounded by u. r is taken to be no less than (η + u²|o|)/u, so that
//!   corners are off by 4ur.
//! * **X, Y, Z.** T's rows are rounded by u of themselves (their own errors in doubles are less as long
//!   as B/D < 10⁶), products by u, two sums by u each: with the corners' errors X is off by 8ur·S and the
//!   second order. We take e_x = 9ur·S and e_z = 9ur·S_z.
//! * **Boxes.** Where Z ≥ 2048·e_z, a place p with |p| ≤ 2·[`SIDE`] is off by
//!   (e_x + |p|e_z)/Z · 2048/2047 and 3u|p| for the quotient; rays are off by ρ of a column, which
//!   [`BlockSpace`] gives. Boxes are made larger by 2⁻⁹ + 2ρ + 1.25(e_x + 64e_z)/Z, of which 3u|p| and the
//!   rounding of the sums need 2⁻¹⁵. Of places further out it is enough that they stay outside: off by
//!   less than a 2000th and the same e_x/Z, they do. Z is the least of the three corners'.
//! * **Few rays.** Where a box is less than 7/4 wide and high, and made larger by m < 1/8, it holds 2 × 2
//!   rays at most, and corners are within 7/4 + m of each a coordinate. A place is off by no more than m,
//!   cross products of two by 2(7/2·m + 3m²) and some 40u of rounding: below 8m. Where a ray's three surely
//!   have one sign it is inside, where two surely differ it is outside, and else the triangle is set up.
//! * **How near.** A depth is off by e_z, its inverse by e_z/Z · 2048/2047 of itself and 2u. Where a triangle
//!   is met it is no nearer than its nearest corner, and no further than its furthest.
//!
//! Where Z is less than that, or a number leaves the range, every ray of the block may meet the
//! triangle. Range: S and r·S < 10³⁰ and Z ≥ 10⁻³⁰ keep products and inverses finite; r is taken to be
//! 10⁻³⁰ at least as well, which keeps what underflow leaves out, 10⁻⁴⁴, far below the bounds.

use super::Cull;
use super::setup::{BlockSpace, CornerLanes, LANES, SIDE};
use super::sides::Sides;
use crate::accel::simd::Lanes;

/// u.
const UNIT: f64 = 1.0 / (1u64 << 24) as f64;

/// By how much boxes are larger than the places' errors alone would have it.
const MARGIN: f64 = 1.0 / 512.0;

/// How much greater than its error a corner's depth has to be.
const CLEAR: f32 = 2048.0;

/// Rays of the largest boxes of which it is told ray by ray who meets the triangle.
pub(crate) const FEW: usize = 4;

/// How large a box of few rays is at most, and by how much at most it is made larger.
const FEW_SIDE: f32 = 1.75;
const FEW_MARGIN: f32 = 0.125;

/// What cross products are off by, as a share of what the box is made larger by.
const CROSS_ERROR: f32 = 8.0;

/// What how near a corner is may be off by as a share of itself, but for the corner's error: a division,
/// a product and a sum.
const NEARNESS_SLACK: f32 = 1.0 / (1 << 20) as f32;

/// The greatest that places and depths may be, and the inverse of the least.
const RANGE: f64 = 1e30;

/// Adding this to a single of at most 2²² rounds it to a whole number, which then stands in the low
/// bits.
const ROUNDER: f32 = 12_582_912.0;

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
    /// e_z as a share of r.
    depth_error: f32,
    /// By how much boxes are made larger: always, and as a share of r/Z, or of r for orthographic
    /// blocks.
    margin: [f32; 2],
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
    /// At most how near the furthest corner is; of no meaning where the nearest is infinite.
    pub(crate) furthest: [f32; LANES],
    /// Those that a ray may meet, as bits.
    pub(crate) seen: u32,
    /// Those of them with [`FEW`] rays at most, of which it is known which they meet, as bits.
    pub(crate) few: u32,
    /// Which of those the first ray of the box meets, the one beside it, the one below, and the one
    /// below that beside it, as bits.
    inside: [u32; FEW],
}

/// A box of rays, both ends included.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RayBox {
    pub(crate) left: i32,
    pub(crate) right: i32,
    pub(crate) top: i32,
    pub(crate) bottom: i32,
}

impl RayBox {
    /// How many rays it holds.
    #[inline(always)]
    pub(crate) fn count(self) -> i32 {
        (self.right - self.left + 1) * (self.bottom - self.top + 1)
    }
}

impl Placer {
    pub(crate) fn new(space: &BlockSpace) -> Self {
        let length = |row: glam::DVec3| row.abs().element_sum();
        let [x, y, z] = space.map.map(length);
        let wide = if x > y { x } else { y };
        let from_origin = space.origin.abs().max_element();
        // Written so that what is not a number is not sound.
        let sound = (from_origin < RANGE) & (x + y + z < RANGE) & (space.obliqueness < 1e6);
        let most_reach = if sound { RANGE / (wide + z) } else { 0.0 };
        let per_reach = 9.0 * UNIT * 1.25;
        let depth_share = if space.perspective {
            2.0 * SIDE as f64 * z
        } else {
            0.0
        };
        Self {
            perspective: space.perspective,
            cull: space.cull,
            origin: space.origin.to_array().map(|o| {
                let high = o as f32;
                [high, (o - f64::from(high)) as f32]
            }),
            map: space.map.map(|row| row.as_vec3().to_array()),
            least_reach: (space.origin_error / UNIT + UNIT * from_origin + 1.0 / RANGE) as f32,
            most_reach: most_reach as f32,
            depth_error: (9.0 * UNIT * z) as f32,
            margin: [
                (MARGIN + 2.0 * space.ray_error) as f32,
                (per_reach * (wide + depth_share)) as f32,
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
    ) -> Footprints {
        let zero = lanes.splat(0.0);
        let mut reach = lanes.splat(self.least_reach);
        let mut places = [[zero; 3]; 3];
        for (corner, place) in places.iter_mut().enumerate() {
            let mut sums = [zero; 3];
            for axis in 0..3 {
                let [high, low] = self.origin[axis];
                let from_high =
                    lanes.sub(lanes.load(&corners[3 * corner + axis]), lanes.splat(high));
                let relative = lanes.sub(from_high, lanes.splat(low));
                reach = lanes.max(reach, relative);
                reach = lanes.max(reach, lanes.sub(zero, relative));
                for (sum, row) in sums.iter_mut().zip(&self.map) {
                    *sum = lanes.add(*sum, lanes.mul(relative, lanes.splat(row[axis])));
                }
            }
            *place = sums;
        }
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = places;
        let in_range = lanes.less(reach, lanes.splat(self.most_reach));
        let depth_error = lanes.mul(reach, lanes.splat(self.depth_error));
        let front = least(lanes, az, bz, cz);
        let back = most(lanes, az, bz, cz);
        let behind = lanes.less(back, lanes.sub(zero, depth_error));

        let (safe, nearest, furthest, spread, [xs, ys]) = if self.perspective {
            let one = lanes.splat(1.0);
            let (ia, ib, ic) = (lanes.div(one, az), lanes.div(one, bz), lanes.div(one, cz));
            let clear = lanes.max(
                lanes.mul(depth_error, lanes.splat(CLEAR)),
                lanes.splat((1.0 / RANGE) as f32),
            );
            let nearest = most(lanes, ia, ib, ic);
            (
                lanes.and(in_range, lanes.less(clear, front)),
                nearest,
                least(lanes, ia, ib, ic),
                lanes.mul(reach, nearest),
                [
                    (lanes.mul(ax, ia), lanes.mul(bx, ib), lanes.mul(cx, ic)),
                    (lanes.mul(ay, ia), lanes.mul(by, ib), lanes.mul(cy, ic)),
                ],
            )
        } else {
            (in_range, zero, zero, reach, [(ax, bx, cx), (ay, by, cy)])
        };
        let [always, by_spread] = self.margin;
        let margin = lanes.add(
            lanes.splat(always),
            lanes.mul(spread, lanes.splat(by_spread)),
        );
        let rounder = lanes.splat(ROUNDER);
        let nobody = lanes.and(in_range, behind);
        let ends = Ends {
            margin,
            safe,
            nobody,
        };
        let (left, right, across) = ends.whole(lanes, xs, self.last[0]);
        let (top, bottom, along) = ends.whole(lanes, ys, self.last[1]);
        let empty = lanes.or(lanes.less(right, left), lanes.less(bottom, top));

        let (nearest, furthest, in_front) = if self.perspective {
            let slack = lanes.add(
                lanes.mul(lanes.mul(depth_error, nearest), lanes.splat(1.25)),
                lanes.splat(NEARNESS_SLACK),
            );
            (
                lanes.add(nearest, lanes.mul(nearest, slack)),
                lanes.sub(furthest, lanes.mul(furthest, slack)),
                safe,
            )
        } else {
            let magnitude = lanes.max(
                lanes.max(front, lanes.sub(zero, front)),
                lanes.max(back, lanes.sub(zero, back)),
            );
            let rounding = lanes.mul(magnitude, lanes.splat(NEARNESS_SLACK));
            let slack = lanes.add(depth_error, rounding);
            let nearest = lanes.sub(slack, front);
            let furthest = lanes.sub(zero, lanes.add(back, slack));
            (
                nearest,
                furthest,
                lanes.and(safe, lanes.less(nearest, zero)),
            )
        };

        let size = lanes.max(
            lanes.max(across, along),
            lanes.mul(margin, lanes.splat(FEW_SIDE / FEW_MARGIN)),
        );
        let small = lanes.and(in_front, lanes.less(size, lanes.splat(FEW_SIDE)));
        let mut out = Footprints {
            seen: !lanes.bits(empty) & ((1 << count) - 1),
            ..Footprints::NONE
        };
        let small = lanes.bits(small) & out.seen;
        if small != 0 {
            let one = lanes.splat(1.0);
            let no_right = lanes.bits(lanes.less(right, lanes.add(left, one)));
            let no_below = lanes.bits(lanes.less(bottom, lanes.add(top, one)));
            let absent = [0, no_right, no_below, no_right | no_below];
            let first = (lanes.sub(left, rounder), lanes.sub(top, rounder));
            let error = lanes.mul(margin, lanes.splat(CROSS_ERROR));
            let sides = Sides::of_few(lanes, xs, ys, first, error);
            let (mut unsure, mut any) = (0, 0);
            for (which, side) in sides.into_iter().enumerate() {
                let kept = match self.cull {
                    Cull::None => side.front | side.back,
                    Cull::Back => side.front,
                };
                unsure |= !(side.front | side.back | side.outside | absent[which]);
                out.inside[which] = kept & !absent[which];
                any |= out.inside[which];
            }
            out.few = small & !unsure;
            out.seen &= !out.few | any;
        }
        let nearest = lanes.pick(safe, nearest, lanes.splat(f32::INFINITY));
        lanes.store(furthest, &mut out.furthest);
        lanes.store(left, &mut out.left);
        lanes.store(right, &mut out.right);
        lanes.store(top, &mut out.top);
        lanes.store(bottom, &mut out.bottom);
        lanes.store(nearest, &mut out.nearest);
        out
    }
}

/// How far triangles reach in one direction.
struct Ends<L: Lanes> {
    margin: L::Singles,
    safe: L::Mask,
    nobody: L::Mask,
}

impl<L: Lanes> Ends<L> {
    /// The first whole number not before a triangle's box, and the last not after it, with
    /// [`ROUNDER`] added; and how far it reaches.
    #[inline(always)]
    fn whole(
        &self,
        lanes: L,
        (a, b, c): (L::Singles, L::Singles, L::Singles),
        last: f32,
    ) -> (L::Singles, L::Singles, L::Singles) {
        let (zero, none, last) = (lanes.splat(0.0), lanes.splat(-1.0), lanes.splat(last));
        let (half, rounder) = (lanes.splat(0.5), lanes.splat(ROUNDER));
        let (begin, end) = (least(lanes, a, b, c), most(lanes, a, b, c));
        let first = lanes.add(lanes.sub(begin, self.margin), half);
        let first = lanes.min(lanes.max(first, zero), lanes.splat(2.0 * SIDE as f32));
        let first = lanes.pick(self.safe, first, zero);
        let final_ = lanes.sub(lanes.add(end, self.margin), half);
        let final_ = lanes.min(lanes.max(final_, none), last);
        let final_ = lanes.pick(self.safe, final_, last);
        let final_ = lanes.pick(self.nobody, none, final_);
        (
            lanes.add(first, rounder),
            lanes.add(final_, rounder),
            lanes.sub(end, begin),
        )
    }
}

/// The least of three.
#[inline(always)]
pub(super) fn least<L: Lanes>(lanes: L, a: L::Singles, b: L::Singles, c: L::Singles) -> L::Singles {
    lanes.min(lanes.min(a, b), c)
}

/// The greatest of three.
#[inline(always)]
pub(super) fn most<L: Lanes>(lanes: L, a: L::Singles, b: L::Singles, c: L::Singles) -> L::Singles {
    lanes.max(lanes.max(a, b), c)
}

impl Footprints {
    /// None yet.
    pub(crate) const NONE: Self = Self {
        left: [0.0; LANES],
        right: [0.0; LANES],
        top: [0.0; LANES],
        bottom: [0.0; LANES],
        nearest: [0.0; LANES],
        furthest: [0.0; LANES],
        seen: 0,
        few: 0,
        inside: [0; FEW],
    };

    /// Which of a triangle's few rays meet it, as bits.
    #[inline(always)]
    pub(crate) fn inside(&self, lane: usize) -> u32 {
        let [a, b, c, d] = self.inside.map(|bits| bits >> lane & 1);
        a | b << 1 | c << 2 | d << 3
    }

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
