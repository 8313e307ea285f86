//! On which side of eight triangles' edges a few rays are, by their places, and how near the triangles are
//! along them. The bounds are derived in [`footprint`](super::footprint).

use super::Cull;
use super::footprint::{least, most};
use super::setup::LANES;
use crate::accel::simd::Lanes;

/// A row's columns.
pub(super) const COLUMNS: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// The greatest share of a triangle's area, doubled, that its edges' values may be off by.
const LEAST_SHARE: f32 = 1.0 / 16.0;

/// By how many such shares of how much nearer one corner is than another a nearness may be off.
const SHARES: f32 = 6.0;

/// A number for each of three corners, or edges.
pub(super) type Three<L> = (
    <L as Lanes>::Singles,
    <L as Lanes>::Singles,
    <L as Lanes>::Singles,
);

/// Edges of eight triangles as cross products of two corners relative to a ray: linear functions of
/// its place.
pub(crate) struct Edges {
    /// Their values at the first ray of a triangle's box.
    first: [[f32; LANES]; 3],
    /// What is added from column to column, and from row to row.
    to_right: [[f32; LANES]; 3],
    down: [[f32; LANES]; 3],
    /// What the values are off by at most.
    error: [f32; LANES],
    /// How near the triangle is along a ray: what it is at the first corner, and what each of the values
    /// of the third and the first edge adds.
    nearness: [[f32; LANES]; 3],
    /// What that is off by at most inside.
    pub(super) nearness_error: [f32; LANES],
}

/// What is known of eight triangles together, as bits.
pub(super) struct Known<L: Lanes> {
    /// Those that are no slivers, which are not told.
    pub(super) told: L::Mask,
    /// Those that the first ray of their box is surely outside of, the one beside it, the one below, and
    /// the one below that beside it.
    pub(super) outside: [u32; 4],
}

/// A triangle's edges along a row of its few rays.
#[derive(Clone, Copy)]
pub(super) struct EdgeRow<L: Lanes> {
    values: Three<L>,
    down: Three<L>,
    error: L::Singles,
    minus_error: L::Singles,
    nearness: Three<L>,
}

/// On which side of a triangle's edges rays are; of those on neither it is not sure.
pub(super) struct Sides<L: Lanes> {
    /// Inside, and not culled.
    pub(super) inside: L::Mask,
    /// Outside, or culled.
    pub(super) outside: L::Mask,
}

impl Edges {
    /// Of no triangles.
    pub(super) const NONE: Self = Self {
        first: [[0.0; LANES]; 3],
        to_right: [[0.0; LANES]; 3],
        down: [[0.0; LANES]; 3],
        error: [0.0; LANES],
        nearness: [[0.0; LANES]; 3],
        nearness_error: [0.0; LANES],
    };

    /// Corners are at `xs` and `ys` and as near as `nears`, the boxes' first rays at `(x, y)`; values in
    /// the boxes are off by less than `error`, `nears` by less than `corner_error`.
    #[inline(always)]
    pub(super) fn new<L: Lanes>(
        lanes: L,
        [xs, ys, nears]: [Three<L>; 3],
        (x, y): (L::Singles, L::Singles),
        error: L::Singles,
        corner_error: L::Singles,
    ) -> (Self, Known<L>) {
        let (ax, bx, cx) = relative_to(lanes, xs, x);
        let (ay, by, cy) = relative_to(lanes, ys, y);
        let mut out = Self::NONE;
        let (ab, bc, ca) = (
            cross(lanes, (ax, ay), (bx, by)),
            cross(lanes, (bx, by), (cx, cy)),
            cross(lanes, (cx, cy), (ax, ay)),
        );
        let [first, second, third] = &mut out.first;
        lanes.store(ab, first);
        lanes.store(bc, second);
        lanes.store(ca, third);
        let to_right = (lanes.sub(ay, by), lanes.sub(by, cy), lanes.sub(cy, ay));
        let [first, second, third] = &mut out.to_right;
        lanes.store(to_right.0, first);
        lanes.store(to_right.1, second);
        lanes.store(to_right.2, third);
        let down = (lanes.sub(bx, ax), lanes.sub(cx, bx), lanes.sub(ax, cx));
        let [first, second, third] = &mut out.down;
        lanes.store(down.0, first);
        lanes.store(down.1, second);
        lanes.store(down.2, third);
        lanes.store(error, &mut out.error);

        let (a_near, b_near, c_near) = nears;
        let (to_b, to_c) = (lanes.sub(b_near, a_near), lanes.sub(c_near, a_near));
        let inverse = lanes.div(lanes.splat(1.0), lanes.add(lanes.add(ab, bc), ca));
        let [base, third, first] = &mut out.nearness;
        lanes.store(a_near, base);
        lanes.store(lanes.mul(to_b, inverse), third);
        lanes.store(lanes.mul(to_c, inverse), first);
        let share = magnitude(lanes, lanes.mul(error, inverse));
        let slope = lanes.add(magnitude(lanes, to_b), magnitude(lanes, to_c));
        let by_slope = lanes.mul(lanes.mul(share, slope), lanes.splat(SHARES));
        lanes.store(lanes.add(corner_error, by_slope), &mut out.nearness_error);

        let first = (ab, bc, ca);
        let beside = sum(lanes, first, to_right);
        let below = sum(lanes, first, down);
        let diagonal = sum(lanes, beside, down);
        let known = Known {
            told: lanes.less(share, lanes.splat(LEAST_SHARE)),
            outside: [
                lanes.bits(outside(lanes, first, error)),
                lanes.bits(outside(lanes, beside, error)),
                lanes.bits(outside(lanes, below, error)),
                lanes.bits(outside(lanes, diagonal, error)),
            ],
        };
        (out, known)
    }

    /// A triangle's edges along the first row of its box.
    #[inline(always)]
    pub(super) fn first_row<L: Lanes>(&self, lanes: L, lane: usize) -> EdgeRow<L> {
        let [a, b, c] = self.down;
        let [base, third, first] = self.nearness;
        EdgeRow {
            values: (
                self.along_first(lanes, 0, lane),
                self.along_first(lanes, 1, lane),
                self.along_first(lanes, 2, lane),
            ),
            down: (
                lanes.splat(a[lane]),
                lanes.splat(b[lane]),
                lanes.splat(c[lane]),
            ),
            error: lanes.splat(self.error[lane]),
            minus_error: lanes.splat(-self.error[lane]),
            nearness: (
                lanes.splat(base[lane]),
                lanes.splat(third[lane]),
                lanes.splat(first[lane]),
            ),
        }
    }

    /// Whether a ray, by its place from the first one of the box, may meet the triangle where it has met
    /// something as near as `low` at least and `high` at most, and which is nearer is not sure.
    pub(super) fn is_rival(&self, lane: usize, [x, y]: [f32; 2], [low, high]: [f32; 2]) -> bool {
        let value = |edge: usize| {
            let [right, down] = [self.to_right[edge][lane], self.down[edge][lane]];
            self.first[edge][lane] + right * x + down * y
        };
        let values = [value(0), value(1), value(2)];
        let error = self.error[lane];
        let outside =
            values.iter().any(|&value| value > error) && values.iter().any(|&value| value < -error);
        let [base, by_third, by_first] = self.nearness.map(|all| all[lane]);
        let near = base + values[2] * by_third + values[0] * by_first;
        let near_error = self.nearness_error[lane];
        !(outside || near - near_error > high || near + near_error < low)
    }

    #[inline(always)]
    fn along_first<L: Lanes>(&self, lanes: L, edge: usize, lane: usize) -> L::Singles {
        let right = lanes.mul(lanes.splat(self.to_right[edge][lane]), lanes.load(&COLUMNS));
        lanes.add(lanes.splat(self.first[edge][lane]), right)
    }
}

impl<L: Lanes> EdgeRow<L> {
    /// The rays' sides. Columns run right and rows down, so that what is seen from the front has
    /// negative values.
    #[inline(always)]
    pub(super) fn sides(&self, lanes: L, cull: Cull) -> Sides<L> {
        let (a, b, c) = self.values;
        let (low, high) = (least(lanes, a, b, c), most(lanes, a, b, c));
        let front = lanes.less(high, self.minus_error);
        let back = lanes.less(self.error, low);
        let outside = outside(lanes, self.values, self.error);
        match cull {
            Cull::None => Sides {
                inside: lanes.or(front, back),
                outside,
            },
            Cull::Back => Sides {
                inside: front,
                outside: lanes.or(outside, back),
            },
        }
    }

    /// How near the triangle is.
    #[inline(always)]
    pub(super) fn nearness(&self, lanes: L) -> L::Singles {
        let (base, by_third, by_first) = self.nearness;
        let (first, _, third) = self.values;
        let sloped = lanes.add(lanes.mul(third, by_third), lanes.mul(first, by_first));
        lanes.add(base, sloped)
    }

    /// The next row.
    #[inline(always)]
    pub(super) fn next(self, lanes: L) -> Self {
        let ((a, b, c), (down_a, down_b, down_c)) = (self.values, self.down);
        let values = (
            lanes.add(a, down_a),
            lanes.add(b, down_b),
            lanes.add(c, down_c),
        );
        Self { values, ..self }
    }
}

/// Whether two of three edges' values surely differ in sign.
#[inline(always)]
fn outside<L: Lanes>(lanes: L, (a, b, c): Three<L>, error: L::Singles) -> L::Mask {
    let (low, high) = (least(lanes, a, b, c), most(lanes, a, b, c));
    let minus_error = lanes.sub(lanes.splat(0.0), error);
    lanes.and(lanes.less(error, high), lanes.less(low, minus_error))
}

#[inline(always)]
fn sum<L: Lanes>(lanes: L, (a, b, c): Three<L>, (d, e, f): Three<L>) -> Three<L> {
    (lanes.add(a, d), lanes.add(b, e), lanes.add(c, f))
}

#[inline(always)]
pub(super) fn magnitude<L: Lanes>(lanes: L, x: L::Singles) -> L::Singles {
    lanes.max(x, lanes.sub(lanes.splat(0.0), x))
}

#[inline(always)]
pub(super) fn relative_to<L: Lanes>(lanes: L, (a, b, c): Three<L>, origin: L::Singles) -> Three<L> {
    (
        lanes.sub(a, origin),
        lanes.sub(b, origin),
        lanes.sub(c, origin),
    )
}

#[inline(always)]
pub(super) fn cross<L: Lanes>(
    lanes: L,
    (px, py): (L::Singles, L::Singles),
    (qx, qy): (L::Singles, L::Singles),
) -> L::Singles {
    lanes.sub(lanes.mul(px, qy), lanes.mul(py, qx))
}
