//! Ray bounds: the rays of a packet that may hit each of eight triangles, in single precision. Most triangles
//! smaller than the ray spacing pass between rays and are culled here, before set-up.
//!
//! A corner's place in the packet is X/Z, with (X, Y, Z) its image under T (see [`setup`](super::setup)), or X
//! itself for orthographic packets. A triangle's bounds are those of its corners' places.
//!
//! # Error bounds
//! u = 2⁻²⁴, ε = 2⁻⁵³ (notation: `docs/error-bounds.md`). S_x, S_y, S_z are the lengths of T's rows as sums of
//! magnitudes, S the greater of the first two. Corners are taken relative to a point q on the packet's first
//! ray, about as deep as the scene; r is the greatest magnitude of a triangle's corners there. o is the eye, or
//! the first ray's origin, and t = T(q − o), which is (0, 0, depth of q) but for rounding.
//!
//! * **Corners.** q is the exact sum of two single-precision numbers; t accounts for its distance from the ray.
//!   The difference from the first is exact where the second counts (Sterbenz 1974), else rounded by less than
//!   2u of the result; that from the second is rounded by u. The eye's own error is η. T, rounded in double
//!   precision, moves t by less than 128ε|q − o|·B/D of S (B/D: see [`setup`](super::setup)). r is taken to be
//!   at least the sum of both over u, so corners are off by at most 4ur.
//! * **X, Y, Z.** T's rows are rounded by u of themselves (their errors in double precision are less as long as B/D <
//!   10⁶), products by u, three sums by u each. q's second number is how far q is from single precision, and no
//!   corner is nearer: it is at most r, and rounding it leaves q within ur of the ray. So t_x and t_y, below ur·S,
//!   are rounded by second order. With the corners' errors X is off by 9ur·S plus second order: e_x = 10ur·S. Z's
//!   sums and t add 4u|t_z|: e_z = 10ur·S_z + 5u|t_z|.
//! * **Bounds.** Where Z ≥ 2048·e_z, a place p with |p| ≤ 2·[`SIDE`] is off by (e_x + |p|e_z)/Z · 2048/2047, and
//!   by 3u|p| for the quotient; rays are off by ρ of a column ([`PacketSpace`]). Bounds grow by 2⁻⁹ + m with
//!   m = 2ρ + 1.25(e_x + 64e_z)/Z; 3u|p| and the rounding of the sums need 2⁻¹⁵ of the 2⁻⁹. Places further out
//!   need only stay outside: off by less than 1/2000 and the same e_x/Z, they do. Z is the least of the corners'.
//! * **Edge functions of small triangles.** Bounds less than w = [`SMALL_SIDE`] wide and high that grow by less than
//!   1/8 hold at most 5 rays each way. Places are off by m' = m + 2⁻¹⁵, and no coordinate of a corner relative to a
//!   ray of the bounds exceeds s + 1/8, s the triangle's size. Edge functions are linear in the ray's place: but for
//!   rounding, the value is the cross product of two moved corners relative to the ray, off by 4(s + 1/8)m' + 2m'² ≤
//!   (4s + 1)m'. Rounding: two products and a difference, the steps, and a sum a column and row, eight in all, of
//!   values up to 2(s + 1/8)²: below 20u(s + 1/8)² + 8us. A place needs 192u of its 2⁻¹⁵, and 5u for being taken
//!   relative to the first ray; what is left, 315u·(4s + 1), is more. Where the doubled area, the sum of a ray's
//!   three values, exceeds three times its error, its sign is sure, and edges are turned to be positive inside. A ray
//!   whose three values are surely positive is inside; one with a surely negative value is outside.
//! * **Depth key.** A depth is off by e_z, its inverse by e_z/Z · 2048/2047 of itself and 2u. A hit is no nearer
//!   than the nearest corner. Along a ray the depth key is the corners' by barycentric weights, edge values over
//!   the doubled area. With E the error of an edge value, the area is off by 3E and a weight of at most 1 by 4E
//!   over the computed area, times the spread of the second and the third corner from the first; we take 6E.
//!   Rounding takes less than 26u of the nearest corner (orthographic: of the greatest depth), which the slack
//!   of 2⁻¹⁹ covers with the corners' own.
//!
//! Where Z is smaller, or a number leaves the range, every ray of the packet may hit the triangle. Range: S and
//! r·S < 10³⁰ and Z ≥ 10⁻³⁰ keep products and inverses finite. Underflow loses 10⁻⁴⁴: next to nothing of Z and of
//! columns, and less than depths of orthographic packets are off by, whose steps are 10⁻³⁰ at least and whose origins'
//! error makes r 10⁻³⁶.

mod side_planes;

use super::depth_reference::DepthReference;
use super::lane_math::{ROUNDER, Three, least, most, round};
use super::params::{SIDE, SMALL_SIDE};
use super::ray_box::RayBox;
use super::setup::PacketSpace;
use super::slivers::{ProjectedCorners, SliverBounds};
use super::small_triangles::{SmallCoverage, SmallEdges};
use crate::hit::Cull;
use crate::num::roundoff::U;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use crate::triangle::CornerLanes;
use glam::DVec3;

/// By how much bounds grow beyond the errors of places: 2⁻⁹ columns. Rounding needs [`ROUNDING_MARGIN`] of it; with
/// less, hits are lost; with more, more triangles between rays are set up.
const MARGIN: f64 = 1.0 / 512.0;

/// The least ratio of a corner's depth to its error at which its place is used. With a lesser one the factor
/// 2048/2047 of the bounds grows; with a greater one more triangles close to the eye are set up for every ray.
const LEAST_DEPTH_RATIO: f32 = 2048.0;

/// The most by which bounds of a small triangle may grow. With [`SMALL_SIDE`] it allows at most 5 rays in each
/// direction.
const SMALL_MARGIN: f32 = 0.125;

/// The part of [`MARGIN`] that covers rounding of places and sums, and of small triangles' edge functions.
const ROUNDING_MARGIN: f64 = 1.0 / 32768.0;

/// Bound on the rounding of the depth key, relative to the greatest: 32u, of which 26u and the corners' own are needed.
const DEPTH_KEY_SLACK: f32 = 1.0 / (1 << 19) as f32;

/// The greatest place or depth, and the reciprocal of the least.
const PLACE_RANGE: f64 = 1e30;

/// Projects triangles into a packet.
#[derive(Clone, Debug)]
pub(crate) struct CornerProjector {
    perspective: bool,
    pub(super) cull: Cull,
    /// The point that corners are relative to, as the sum of two numbers.
    origin: [[f32; 2]; 3],
    /// T's rows.
    map: [[f32; 3]; 3],
    /// The least r.
    least_reach: f32,
    /// The greatest r.
    most_reach: f32,
    /// t.
    shift: [f32; 3],
    /// e_z: a constant, and a factor of r.
    depth_error: [f32; 2],
    /// By how much bounds grow: a constant, and factors of 1/Z and of r/Z; for orthographic packets, of 1 and of r.
    margin: [f32; 3],
    /// The last column and row.
    last: [f32; 2],
}

/// The rays that may hit each of eight triangles: bounds as integers, both ends included, plus [`ROUNDER`].
pub(crate) struct ProjectedTriangles {
    left: [f32; LANES],
    right: [f32; LANES],
    top: [f32; LANES],
    bottom: [f32; LANES],
    /// An upper bound of the nearest corner's depth key, as in [`TriangleSetup`](super::setup::TriangleSetup);
    /// infinite where it is unknown.
    pub(crate) nearest: [f32; LANES],
    /// Triangles that some ray may hit, as bits.
    pub(crate) seen: u32,
    /// Those of the seen triangles, as bits, whose bounds and depth keys are unknown: they pass the eye.
    pub(crate) unbounded: u32,
    /// Those of the seen triangles that are small, as bits.
    pub(crate) small: u32,
    /// The rays that hit the small ones.
    pub(crate) coverage: SmallCoverage,
}

impl CornerProjector {
    /// Tightest for triangles about as deep as `depth`; correct for all.
    pub(crate) fn new(space: &PacketSpace, depth: f32) -> Self {
        let length = |row: DVec3| row.abs().element_sum();
        let [x, y, z] = space.map.map(length);
        let wide = if x > y { x } else { y };
        let depth = if (0.0..f32::MAX).contains(&depth) {
            depth
        } else {
            0.0
        };
        let origin = (space.origin + space.unit_depth * f64::from(depth)).to_array();
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
        // NaN fails these comparisons and makes the projector unsound.
        let sound = (far < PLACE_RANGE)
            & (x + y + z < PLACE_RANGE)
            & ((x + y + z) * moved < PLACE_RANGE)
            & (space.obliqueness < 1e6);
        let most_reach = if sound { PLACE_RANGE / (wide + z) } else { 0.0 };
        let place_share = if space.perspective {
            2.0 * SIDE as f64
        } else {
            0.0
        };
        let depth_error = 5.0 * U * shift[2].abs();
        Self {
            perspective: space.perspective,
            cull: space.cull,
            origin,
            map: space.map.map(|row| row.as_vec3().to_array()),
            shift: shift.map(|s| s as f32),
            least_reach: (space.origin_error / U
                + 128.0 * f64::EPSILON * space.obliqueness / U * moved)
                as f32,
            most_reach: most_reach as f32,
            depth_error: [depth_error as f32, (10.0 * U * z) as f32],
            margin: [
                (MARGIN + 2.0 * space.ray_error) as f32,
                (1.25 * place_share * depth_error) as f32,
                (1.25 * 10.0 * U * (wide + place_share * z)) as f32,
            ],
            last: space.last.into(),
        }
    }

    /// Computes the bounds of the rays that may hit each of the first `count` triangles.
    #[inline(always)]
    pub(crate) fn project<L: Lanes>(
        &self,
        lanes: L,
        corners: &CornerLanes,
        count: usize,
        out: &mut ProjectedTriangles,
    ) {
        let projected = self.projected(lanes, corners);
        let extent = Extent {
            margin: projected.margin,
            safe: projected.safe,
            behind: projected.behind,
        };
        let (left, right, across) = extent.rays(lanes, projected.xs, self.last[0]);
        let (top, bottom, along) = extent.rays(lanes, projected.ys, self.last[1]);
        let bounds = SliverBounds {
            left,
            right,
            top,
            bottom,
        };
        let length = across.max(along);

        let empty = right.lt(left) | bottom.lt(top);
        out.seen = !empty.bits() & ((1 << count) - 1);
        self.test_small(lanes, &projected, &bounds, length, out);
        let corners = ProjectedCorners {
            xs: projected.xs,
            ys: projected.ys,
            length,
            off: projected.place_error(),
            safe: projected.safe,
        };
        let (bounds, seen) = bounds.shrunk_to_slivers(lanes, &corners, out.seen);
        out.seen = seen;
        out.unbounded = seen & !projected.safe.bits();

        let nearest = projected.nearest;
        let nearest = projected.safe.select(nearest, lanes.splat(f32::INFINITY));
        (bounds.left + ROUNDER).store(&mut out.left);
        (bounds.right + ROUNDER).store(&mut out.right);
        (bounds.top + ROUNDER).store(&mut out.top);
        (bounds.bottom + ROUNDER).store(&mut out.bottom);
        nearest.store(&mut out.nearest);
    }

    /// Places and depth keys of the corners.
    #[inline(always)]
    pub(super) fn projected<L: Lanes>(&self, lanes: L, corners: &CornerLanes) -> Projected<L> {
        self.divide(lanes, &self.map_corners(lanes, corners))
    }

    /// T of the corners.
    #[inline(always)]
    fn map_corners<L: Lanes>(&self, lanes: L, corners: &CornerLanes) -> MappedCorners<L> {
        let ([ax, ay, az], of_a) = self.map_corner(lanes, corners, 0);
        let ([bx, by, bz], of_b) = self.map_corner(lanes, corners, 1);
        let ([cx, cy, cz], of_c) = self.map_corner(lanes, corners, 2);
        MappedCorners {
            x: (ax, bx, cx),
            y: (ay, by, cy),
            z: (az, bz, cz),
            reach: of_a.max(of_b).max(of_c),
        }
    }

    /// T of one of the corners, and its r.
    #[inline(always)]
    fn map_corner<L: Lanes>(
        &self,
        lanes: L,
        corners: &CornerLanes,
        corner: usize,
    ) -> ([L::F32; 3], L::F32) {
        let mut reach = lanes.splat(self.least_reach);
        let mut mapped = self.shift.map(|shift| lanes.splat(shift));
        for axis in 0..3 {
            let [high, low] = self.origin[axis];
            let relative = lanes.load(&corners[3 * corner + axis]) - high - low;
            reach = reach.max(relative.abs());
            for (sum, row) in mapped.iter_mut().zip(&self.map) {
                *sum = *sum + relative * row[axis];
            }
        }
        (mapped, reach)
    }

    /// Computes places and depth keys of mapped corners, with their errors.
    #[inline(always)]
    fn divide<L: Lanes>(&self, lanes: L, mapped: &MappedCorners<L>) -> Projected<L> {
        let MappedCorners { x, y, z, reach } = *mapped;
        let zero = lanes.splat(0.0);
        let in_range = reach.lt(lanes.splat(self.most_reach));
        let [always, by_reach] = self.depth_error;
        let depth_error = lanes.splat(always) + reach * by_reach;
        let (front, back) = (least(z), most(z));
        let behind = in_range & back.lt(zero - depth_error);
        let [always, by_depth, by_reach] = self.margin;
        let error = lanes.splat(by_depth) + reach * by_reach;
        if self.perspective {
            let one = lanes.splat(1.0);
            let keys = (one / z.0, one / z.1, one / z.2);
            let clear =
                (depth_error * LEAST_DEPTH_RATIO).max(lanes.splat((1.0 / PLACE_RANGE) as f32));
            let safe = in_range & clear.lt(front);
            let nearest = most(keys);
            let key_error = nearest * (depth_error * nearest * 1.25 + DEPTH_KEY_SLACK);
            Projected {
                xs: (x.0 * keys.0, x.1 * keys.1, x.2 * keys.2),
                ys: (y.0 * keys.0, y.1 * keys.1, y.2 * keys.2),
                keys,
                key_error,
                nearest: nearest + key_error,
                margin: lanes.splat(always) + error * nearest,
                safe,
                in_front: safe,
                behind,
            }
        } else {
            let greatest = front.abs().max(back.abs());
            let key_error = depth_error + greatest * DEPTH_KEY_SLACK;
            let nearest = key_error - front;
            Projected {
                xs: x,
                ys: y,
                keys: (zero - z.0, zero - z.1, zero - z.2),
                key_error,
                nearest,
                margin: lanes.splat(always) + error,
                safe: in_range,
                in_front: in_range & nearest.lt(zero),
                behind,
            }
        }
    }

    /// Tests small triangles against their rays, and culls those that no ray hits.
    #[inline(always)]
    fn test_small<L: Lanes>(
        &self,
        lanes: L,
        projected: &Projected<L>,
        bounds: &SliverBounds<L>,
        length: L::F32,
        out: &mut ProjectedTriangles,
    ) {
        let size = length.max(projected.margin * (SMALL_SIDE / SMALL_MARGIN));
        let small = projected.in_front & size.lt(lanes.splat(SMALL_SIDE));
        out.small = small.bits() & out.seen;
        if out.small == 0 {
            return;
        }
        let error = projected.place_error() * (size * 4.0 + 1.0);
        let corners = [projected.xs, projected.ys, projected.keys];
        let first = (bounds.left, bounds.top);
        let edges = SmallEdges::new(lanes, corners, first, error, projected.key_error);
        out.small &= edges.decided.bits();
        if self.cull == Cull::Back {
            let culled = out.small & !edges.front.bits();
            out.small &= !culled;
            out.seen &= !culled;
        }
        let size = (bounds.right - bounds.left, bounds.bottom - bounds.top);
        out.seen &= !edges.test(lanes, size, out.small, &mut out.coverage);
    }
}

/// Corners of eight triangles in packet space.
struct MappedCorners<L: Lanes> {
    x: Three<L::F32>,
    y: Three<L::F32>,
    z: Three<L::F32>,
    /// r.
    reach: L::F32,
}

/// Eight triangles projected into the packet.
pub(super) struct Projected<L: Lanes> {
    /// Places of the corners.
    pub(super) xs: Three<L::F32>,
    pub(super) ys: Three<L::F32>,
    /// Depth keys of the corners, and a bound on the error of a key interpolated between them.
    pub(super) keys: Three<L::F32>,
    pub(super) key_error: L::F32,
    /// An upper bound of the nearest corner's depth key.
    pub(super) nearest: L::F32,
    /// By how much bounds grow.
    pub(super) margin: L::F32,
    /// Lanes whose places and depth keys may be used.
    pub(super) safe: L::Mask,
    /// Of those, the triangles that lie wholly in front of the eye, or the image plane.
    pub(super) in_front: L::Mask,
    /// Triangles that no ray hits, because they lie behind.
    pub(super) behind: L::Mask,
}

impl<L: Lanes> Projected<L> {
    /// m': bound on the error of a place.
    #[inline(always)]
    pub(super) fn place_error(&self) -> L::F32 {
        self.margin - (MARGIN - ROUNDING_MARGIN) as f32
    }
}

/// What turns the corners' places into bounds along one axis.
struct Extent<L: Lanes> {
    margin: L::F32,
    safe: L::Mask,
    behind: L::Mask,
}

impl<L: Lanes> Extent<L> {
    /// The first ray not before a triangle, the last not after it, and the triangle's extent.
    #[inline(always)]
    fn rays(&self, lanes: L, places: Three<L::F32>, last: f32) -> (L::F32, L::F32, L::F32) {
        let (zero, none, last) = (lanes.splat(0.0), lanes.splat(-1.0), lanes.splat(last));
        let half = lanes.splat(0.5);
        let (begin, end) = (least(places), most(places));
        let first = begin - self.margin + half;
        let first = first.max(zero).min(lanes.splat(2.0 * SIDE as f32));
        let first = self.safe.select(first, zero);
        let end_ray = end + self.margin - half;
        let end_ray = end_ray.max(none).min(last);
        let end_ray = self.safe.select(end_ray, last);
        let end_ray = self.behind.select(none, end_ray);
        (round(first), round(end_ray), end - begin)
    }
}

impl ProjectedTriangles {
    /// No triangles.
    pub(crate) const NONE: Self = Self {
        left: [0.0; LANES],
        right: [0.0; LANES],
        top: [0.0; LANES],
        bottom: [0.0; LANES],
        nearest: [0.0; LANES],
        seen: 0,
        unbounded: 0,
        small: 0,
        coverage: SmallCoverage::NONE,
    };

    /// Makes depth keys relative. Those of small triangles are too coarse for that, so small triangles are set up.
    #[inline(never)]
    pub(super) fn relate_to(&mut self, reference: DepthReference) {
        self.small = 0;
        self.nearest = self.nearest.map(|key| reference.relative_above(key));
    }

    /// The bounds of a triangle that is seen.
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
