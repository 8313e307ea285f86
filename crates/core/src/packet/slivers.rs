//! Sliver bounds: the bounding boxes of eight long thin triangles, shrunk to the spans of their rows. Slivers pass
//! between most rays of their box, and many hit none.
//!
//! # Error bounds
//! With u = 2⁻²⁴ (notation: `docs/error-bounds.md`).
//!
//! **Places.** A corner's place in the packet is off by at most M in each coordinate. A point of the true
//! triangle is a convex combination of its corners; the same combination of the projected corners is within M of
//! it. So where e(x, y) = e₀ + e_x·x + e_y·y is an edge function of the projected triangle, non-negative inside,
//! e ≥ −M(|e_x| + |e_y|) holds throughout the true one.
//!
//! **Rounding.** Let P be the greatest coordinate of a corner relative to the box's first ray, or the packet's
//! size. Corners relative to that ray are rounded by uP: one more M. Rounding moves e₀, a difference of two
//! products of at most P², by 4uP²; e_x and e_y by 2uP each, times x and y 4uP²; e_y·y and two sums by 10uP².
//! We take 24uP². Where the doubled area exceeds four times that, its sign is sure, and with it the inner side.
//! Dividing by e_x moves a column by 6u of at most 2·[`SIDE`], less than [`SLACK`]; what lies further out stays
//! outside.
//!
//! **Dominated terms.** Of the 24uP² rounding needs 18. The rest covers the rounding of relative corners once more,
//! uP(|e_x| + |e_y|) ≤ 4uP². [`SLACK`] is for dividing alone; 24uP², divided by |e_x| ≤ 2P with P ≥ [`SIDE`], is as
//! much as dividing takes, 384u columns.
//! Where the area's sign is wrong, the area is less than 24uP², and so is every edge function inside: turned, none is
//! below the bound.
//!
//! **Level edges.** Where e_x is zero, or too small to have an inverse, e crosses zero infinitely far away: a row is kept
//! or dropped by e's sign, which 2P·10⁻³⁸ does not change, and where the product is no number `min` and `max` pass over
//! it.

use super::lane_math::{Three, cross, most, relative_to, round};
use super::params::{SIDE, SMALL_SIDE};
use crate::num::roundoff::U32;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};

/// The largest thickness of a sliver, in columns: its doubled area over its length. With a larger limit spans would
/// be computed for triangles that hit most rows of their box, where they cull little; with a smaller one slivers
/// would be set up that no ray hits.
const SLIVER: f32 = 2.0;

/// The fewest slivers among eight for which spans are computed, always for all eight together. With a smaller number it
/// takes longer than setting up those that it would cull; with a larger one slivers are set up that no ray hits.
const SEVERAL: u32 = 3;

/// The slack at either end of a span, in columns. It must exceed the 384u by which dividing moves a column (above);
/// with more, spans keep columns beside them.
const SLACK: f32 = 1.0 / 1024.0;

/// The bounds of the rays that may hit eight triangles, both ends included.
#[derive(Clone, Copy)]
pub(super) struct SliverBounds<L: Lanes> {
    pub(super) left: L::F32,
    pub(super) right: L::F32,
    pub(super) top: L::F32,
    pub(super) bottom: L::F32,
}

/// Eight triangles, by the places of their corners.
#[derive(Clone, Copy)]
pub(super) struct ProjectedCorners<L: Lanes> {
    pub(super) xs: Three<L::F32>,
    pub(super) ys: Three<L::F32>,
    /// The greater of width and height.
    pub(super) length: L::F32,
    /// A bound on the error of places up to 2·[`SIDE`]; beyond, the error grows in proportion.
    pub(super) off: L::F32,
    /// The triangles for which these bounds hold.
    pub(super) safe: L::Mask,
}

impl<L: Lanes> SliverBounds<L> {
    /// The bounds, shrunk for slivers, and which of the triangles `seen` (as bits) still bound any ray.
    #[inline(always)]
    pub(super) fn shrunk_to_slivers(
        self,
        lanes: L,
        projected: &ProjectedCorners<L>,
        seen: u32,
    ) -> (Self, u32) {
        let ProjectedCorners {
            xs,
            ys,
            length,
            safe,
            ..
        } = *projected;
        let to_b = (xs.1 - xs.0, ys.1 - ys.0);
        let to_c = (xs.2 - xs.0, ys.2 - ys.0);
        let area = cross(to_b, to_c);
        let wide = length * SLIVER;
        let long = lanes.splat(SMALL_SIDE).lt(length);
        let thin = long & area.abs().lt(wide);
        let thin = thin & safe;
        let which = thin.bits() & seen;
        if which.count_ones() < SEVERAL {
            return (self, seen);
        }
        let (spans, sure) = self.spans(lanes, projected, area, which);
        let thin = thin & sure;
        let empty = (thin & spans.bottom.lt(spans.top)).bits();
        let boxes = Self {
            left: thin.select(spans.left, self.left),
            right: thin.select(spans.right, self.right),
            top: thin.select(spans.top, self.top),
            bottom: thin.select(spans.bottom, self.bottom),
        };
        (boxes, seen & !empty)
    }

    /// The bounding boxes of the row spans of the triangles in `which` (as bits), and the lanes where they are sure.
    #[inline(always)]
    fn spans(
        self,
        lanes: L,
        projected: &ProjectedCorners<L>,
        area: L::F32,
        which: u32,
    ) -> (Self, L::Mask) {
        let zero = lanes.splat(0.0);
        let side = lanes.splat(SIDE as f32);
        let (ax, bx, cx) = relative_to(projected.xs, self.left);
        let (ay, by, cy) = relative_to(projected.ys, self.top);
        let across = furthest((ax, bx, cx));
        let along = furthest((ay, by, cy));
        let reach = across.max(along).max(side);
        // Places lie within `reach` of the box's own first place.
        let scale = reach * (0.5 / SIDE as f32) + 1.0;
        let off = projected.off * scale;
        let off = off + reach * U32;
        let rounding = reach * reach * (24.0 * U32);
        let sure = (rounding * 4.0).lt(area.abs());
        let slack = Slack {
            turned: area.lt(zero),
            off,
            rounding,
        };
        let ab = Edge::new(lanes, (ax, ay), (bx, by), slack);
        let bc = Edge::new(lanes, (bx, by), (cx, cy), slack);
        let ca = Edge::new(lanes, (cx, cy), (ax, ay), slack);

        let (width, height) = (self.right - self.left, self.bottom - self.top);
        let (mut left, mut right) = (lanes.splat(2.0 * SIDE as f32), lanes.splat(-1.0));
        let (mut top, mut bottom) = (left, right);
        for row in 0..=highest(height, which) {
            let y = lanes.splat(row as f32);
            let span = ab.cut(y, (zero, width));
            let span = bc.cut(y, span);
            let (begin, end) = ca.cut(y, span);
            // The first column not before the span, and the last not after it.
            let first = round(begin + (0.5 - SLACK));
            let last = round(end - (0.5 - SLACK));
            let none = last.lt(first) | height.lt(y);
            left = none.select(left, left.min(first));
            right = none.select(right, right.max(last));
            top = none.select(top, top.min(y));
            bottom = none.select(bottom, y);
        }
        let spans = Self {
            left: self.left + left,
            right: self.left + right,
            top: self.top + top,
            bottom: self.top + bottom,
        };
        (spans, sure)
    }
}

/// The amounts by which edges are moved outwards.
#[derive(Clone, Copy)]
struct Slack<L: Lanes> {
    /// Lanes with negative area.
    turned: L::Mask,
    /// M.
    off: L::F32,
    /// A bound on the rounding of edge functions.
    rounding: L::F32,
}

/// An edge function, non-negative inside.
#[derive(Clone, Copy)]
struct Edge<L: Lanes> {
    /// An upper bound of its value at the first ray, and its step from row to row.
    first: L::F32,
    down: L::F32,
    /// A value times this is the column, from the first, at which the function is zero.
    columns: L::F32,
    /// Lanes where spans start at this edge; elsewhere they end at it.
    begins: L::Mask,
}

impl<L: Lanes> Edge<L> {
    #[inline(always)]
    fn new(
        lanes: L,
        (px, py): (L::F32, L::F32),
        (qx, qy): (L::F32, L::F32),
        Slack {
            turned,
            off,
            rounding,
        }: Slack<L>,
    ) -> Self {
        let zero = lanes.splat(0.0);
        let constant = cross((px, py), (qx, qy));
        let (right, down) = (py - qy, qx - px);
        let constant = turned.select(zero - constant, constant);
        let right = turned.select(zero - right, right);
        let down = turned.select(zero - down, down);
        let slope = right.abs() + down.abs();
        let slack = off * slope + rounding;
        let columns = lanes.splat(1.0) / right.abs();
        let begins = zero.lt(right);
        Self {
            first: constant + slack,
            down,
            columns: begins.select(zero - columns, columns),
            begins,
        }
    }

    /// Clips a row's span to the inner side of the edge.
    #[inline(always)]
    fn cut(&self, y: L::F32, (begin, end): (L::F32, L::F32)) -> (L::F32, L::F32) {
        let value = self.first + self.down * y;
        let zero_at = value * self.columns;
        (
            self.begins.select(zero_at.max(begin), begin),
            self.begins.select(end, zero_at.min(end)),
        )
    }
}

/// The greatest of the `heights` in `which` (as bits), which are integers.
#[inline(always)]
fn highest<F: F32x8>(heights: F, which: u32) -> u32 {
    let mut all = [0.0; LANES];
    heights.store(&mut all);
    let mut highest = 0.0;
    for (lane, height) in all.into_iter().enumerate() {
        if (which >> lane & 1 != 0) & (height > highest) {
            highest = height;
        }
    }
    highest as u32
}

/// The greatest magnitude of three.
#[inline(always)]
fn furthest<F: F32x8>((a, b, c): Three<F>) -> F {
    most((a.abs(), b.abs(), c.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::simd::Plain;
    use crate::random::Random;

    type Corners = [[f64; 2]; 3];

    fn holds(corners: &Corners, [x, y]: [f64; 2]) -> bool {
        let side =
            |[px, py]: [f64; 2], [qx, qy]: [f64; 2]| (px - x) * (qy - y) - (py - y) * (qx - x);
        let [a, b, c] = *corners;
        let sides = [side(a, b), side(b, c), side(c, a)];
        sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0)
    }

    /// A sliver with an edge no further than `past` from a ray.
    fn thin(random: &mut Random, length: f64, past: f64, thickness: f64) -> Corners {
        let ray = [
            (random.unit() * 32.0).floor(),
            (random.unit() * 32.0).floor(),
        ];
        let (sin, cos) = crate::math::sin_cos(random.unit() * std::f64::consts::TAU);
        let aside = past * random.signed();
        let at = |along: f64, aside: f64| {
            let x = ray[0] + cos * along - sin * aside;
            let y = ray[1] + sin * along + cos * aside;
            [f64::from(x as f32), f64::from(y as f32)]
        };
        let thickness = thickness * random.unit();
        [
            at(-length * random.unit(), aside),
            at(length * random.unit(), aside),
            at(length * random.signed(), aside + thickness),
        ]
    }

    /// The boxes of projected triangles, and the shrunk boxes where any ray is left.
    fn boxes(projected: &[Corners; LANES], off: f64) -> [([f32; 4], Option<[f32; 4]>); LANES] {
        let lanes = Plain;
        let each =
            |of: &dyn Fn(&Corners) -> f64| lanes.load(&projected.each_ref().map(|c| of(c) as f32));
        let corner = |corner: usize, axis: usize| each(&move |c| c[corner][axis]);
        let low = |axis: usize| move |c: &Corners| c[0][axis].min(c[1][axis]).min(c[2][axis]);
        let high = |axis: usize| move |c: &Corners| c[0][axis].max(c[1][axis]).max(c[2][axis]);
        let first = |axis: usize| each(&move |c| (low(axis)(c) - off).ceil().clamp(0.0, 64.0));
        let last = |axis: usize| each(&move |c| (high(axis)(c) + off).floor().clamp(-1.0, 31.0));
        let length = |axis: usize| each(&move |c| high(axis)(c) - low(axis)(c));
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        let whole = SliverBounds::<Plain> {
            left: first(0),
            right: last(0),
            top: first(1),
            bottom: last(1),
        };
        let projected = ProjectedCorners {
            xs: (corner(0, 0), corner(1, 0), corner(2, 0)),
            ys: (corner(0, 1), corner(1, 1), corner(2, 1)),
            length: length(0).max(length(1)),
            off: lanes.splat(off as f32),
            safe: zero.lt(one),
        };
        let none = whole.right.lt(whole.left) | whole.bottom.lt(whole.top);
        let (small, seen) = whole.shrunk_to_slivers(lanes, &projected, !none.bits());
        let sides = |boxes: SliverBounds<Plain>| {
            let mut sides = [[0.0; LANES]; 4];
            boxes.left.store(&mut sides[0]);
            boxes.right.store(&mut sides[1]);
            boxes.top.store(&mut sides[2]);
            boxes.bottom.store(&mut sides[3]);
            sides
        };
        let (whole, small) = (sides(whole), sides(small));
        std::array::from_fn(|lane| {
            let left = (seen >> lane & 1 != 0).then(|| small.map(|side| side[lane]));
            (whole.map(|side| side[lane]), left)
        })
    }

    /// Tries many triangles; returns how many no ray hits, and how many of those were culled.
    fn try_many(length: f64, off: f64, past: f64, thickness: f64) -> [usize; 2] {
        let mut random = Random(7);
        let [mut empty, mut culled] = [0; 2];
        for _ in 0..500 {
            let real: [Corners; LANES] =
                std::array::from_fn(|_| thin(&mut random, length, past, thickness));
            // Places beyond 2·SIDE are off in proportion.
            let mut moved = |at: f64| {
                let off = off * (at.abs() / (2 * SIDE) as f64).max(1.0);
                f64::from((at + 0.999 * off * random.signed()) as f32)
            };
            let projected = real.map(|corners| corners.map(|c| c.map(&mut moved)));
            for (real, (whole, small)) in real.iter().zip(boxes(&projected, off)) {
                let mut any = false;
                for y in 0..SIDE {
                    for x in 0..SIDE {
                        if !holds(real, [x as f64, y as f64]) {
                            continue;
                        }
                        any = true;
                        let (x, y) = (x as f32, y as f32);
                        let is_in_bounds = small.is_some_and(|[left, right, top, bottom]| {
                            (left..=right).contains(&x) && (top..=bottom).contains(&y)
                        });
                        assert!(is_in_bounds, "{x} {y} of {real:?} in {small:?}");
                    }
                }
                if let Some(small) = small {
                    let within = small[0] >= whole[0]
                        && small[1] <= whole[1]
                        && small[2] >= whole[2]
                        && small[3] <= whole[3];
                    assert!(within, "{small:?} in {whole:?}");
                }
                empty += usize::from(!any);
                culled += usize::from(!any && small.is_none());
            }
        }
        [empty, culled]
    }

    #[test]
    fn no_ray_of_a_sliver_is_culled() {
        // With large errors of places, and with the rounding of far corners alone.
        for (length, off, past, thickness) in [
            (30.0, 0.25, 0.3, 0.9),
            (30.0, 1e-3, 1e-3, 0.9),
            (200.0, 1e-3, 1e-3, 0.9),
            (2000.0, 0.02, 0.6, 0.9),
            (5e4, 0.0, 4e-3, 0.9),
            (5e4, 0.0, 4e-3, 0.01),
            (2e6, 0.0, 0.1, 0.9),
        ] {
            try_many(length, off, past, thickness);
        }
    }

    /// Edges between integer places, so that the truth is integer arithmetic: their functions are below the upper
    /// bound at every row, and would not be without the bound on their rounding.
    #[test]
    fn edges_lose_no_ray_to_rounding() {
        let lanes = Plain;
        let mut random = Random(13);
        let (mut below, mut below_without) = (0, 0);
        for _ in 0..20_000 {
            let [p, q] = [(); 2].map(|()| [(); 2].map(|()| (random.signed() * 1e6).round()));
            let reach = p
                .into_iter()
                .chain(q)
                .fold(0.0f64, |most, x| most.max(x.abs()));
            let [(px, py), (qx, qy)] =
                [p, q].map(|[x, y]| (lanes.splat(x as f32), lanes.splat(y as f32)));
            let bound = lanes.splat((reach * reach) as f32 * (24.0 * U32));
            let [upper, upper_without] = [bound, lanes.splat(0.0)].map(|rounding| {
                let slack = Slack {
                    turned: lanes.splat(1.0).lt(lanes.splat(0.0)),
                    off: lanes.splat(0.0),
                    rounding,
                };
                let edge = Edge::<Plain>::new(lanes, (px, py), (qx, qy), slack);
                let at_row = edge.first + edge.down * 7.0;
                f64::from(at_row.reduce_min())
            });
            let truth = p[0] * q[1] - p[1] * q[0] + (q[0] - p[0]) * 7.0;
            below += usize::from(upper < truth);
            below_without += usize::from(upper_without < truth);
        }
        assert!(
            below == 0 && below_without > 1000,
            "{below} {below_without}"
        );
    }

    #[test]
    fn slivers_between_rays_are_culled() {
        let [empty, culled] = try_many(30.0, 1e-5, 0.5, 0.9);
        assert!(empty > 500, "{empty} are hit by no ray");
        assert!(
            culled * 100 >= empty * 95,
            "{culled} of {empty} were culled"
        );
    }
}
