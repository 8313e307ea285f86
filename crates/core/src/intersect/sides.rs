//! Which of a few rays meet eight triangles, by their places, and how near the triangles are along them. The
//! bounds are derived in [`footprint`](super::footprint).

use super::footprint::least;
use super::setup::LANES;
use crate::accel::simd::Lanes;

/// The greatest share of a triangle's area, doubled, that its edges' values may be off by.
const LEAST_SHARE: f32 = 1.0 / 16.0;

/// By how many such shares of how much nearer one corner is than another a nearness may be off.
const SHARES: f32 = 6.0;

/// How many columns, and rows, of few rays there are at most.
const FEW_COLUMNS: usize = 5;

/// How many rows' rays are told by the bits of one single: its 24 bits are fewer than all.
const ROWS: usize = 3;

/// The sum of this and a smaller whole number has that number in its low bits.
const WHOLE: f32 = 8_388_608.0;

/// A number for each of three corners, or edges.
pub(super) type Three<L> = (
    <L as Lanes>::Singles,
    <L as Lanes>::Singles,
    <L as Lanes>::Singles,
);

/// Edges of eight triangles as cross products of two corners relative to a ray, above zero inside: linear
/// functions of its place.
pub(super) struct Edges<L: Lanes> {
    /// Their values at the first ray of a triangle's box.
    first: Three<L>,
    /// What is added from column to column, and from row to row.
    to_right: Three<L>,
    down: Three<L>,
    /// What the values are off by at most.
    error: L::Singles,
    /// How near the triangle is along a ray: what it is at the first corner, and what each of the values
    /// of the third and the first edge adds.
    nearness: Three<L>,
    /// What that is off by at most inside.
    nearness_error: L::Singles,
    /// Those that are no slivers, of which nothing here is to be trusted.
    pub(super) told: L::Mask,
    /// Those of them that are seen from the front.
    pub(super) front: L::Mask,
}

/// Eight triangles of few rays. Rays are counted from the first of a triangle's box, row by row of
/// [`FEW_COLUMNS`].
pub(crate) struct FewRays {
    /// Rays that surely meet a triangle: the low bits of singles, some rows each.
    inside: [[f32; LANES]; 2],
    /// Rays that perhaps meet it, those included.
    perhaps: [[f32; LANES]; 2],
    /// How near it is, where they do.
    nearness: [[f32; LANES]; FEW_COLUMNS * FEW_COLUMNS],
    /// What that is off by at most.
    nearness_error: [f32; LANES],
}

impl<L: Lanes> Edges<L> {
    /// Corners are at `xs` and `ys` and as near as `nears`, the boxes' first rays at `(x, y)`; values in
    /// the boxes are off by less than `error`, `nears` by less than `corner_error`.
    #[inline(always)]
    pub(super) fn new(
        lanes: L,
        [xs, ys, nears]: [Three<L>; 3],
        (x, y): (L::Singles, L::Singles),
        error: L::Singles,
        corner_error: L::Singles,
    ) -> Self {
        let (ax, bx, cx) = relative_to(lanes, xs, x);
        let (ay, by, cy) = relative_to(lanes, ys, y);
        let first = (
            cross(lanes, (ax, ay), (bx, by)),
            cross(lanes, (bx, by), (cx, cy)),
            cross(lanes, (cx, cy), (ax, ay)),
        );
        let to_right = (lanes.sub(ay, by), lanes.sub(by, cy), lanes.sub(cy, ay));
        let down = (lanes.sub(bx, ax), lanes.sub(cx, bx), lanes.sub(ax, cx));
        let area = lanes.add(lanes.add(first.0, first.1), first.2);
        // Columns run right and rows down: what is seen from the front has negative values.
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        let front = lanes.less(area, zero);
        let sign = lanes.pick(front, lanes.splat(-1.0), one);

        let (a_near, b_near, c_near) = nears;
        let (to_b, to_c) = (lanes.sub(b_near, a_near), lanes.sub(c_near, a_near));
        let inverse = lanes.div(one, lanes.mul(area, sign));
        let share = lanes.mul(error, inverse);
        let slope = lanes.add(magnitude(lanes, to_b), magnitude(lanes, to_c));
        let by_slope = lanes.mul(lanes.mul(share, slope), lanes.splat(SHARES));
        Self {
            first: times(lanes, first, sign),
            to_right: times(lanes, to_right, sign),
            down: times(lanes, down, sign),
            error,
            nearness: (a_near, lanes.mul(to_b, inverse), lanes.mul(to_c, inverse)),
            nearness_error: lanes.add(corner_error, by_slope),
            told: lanes.less(share, lanes.splat(LEAST_SHARE)),
            front,
        }
    }

    /// Meets the triangles in `which`, as bits, with the rays of their boxes, which hold as many more
    /// columns than one, and as many more rows, four at most. Returns those that all rays are surely
    /// outside of, as bits.
    #[inline(always)]
    pub(super) fn meet(
        &self,
        lanes: L,
        (width, height): (L::Singles, L::Singles),
        which: u32,
        out: &mut FewRays,
    ) -> u32 {
        let (columns, rows) = (most(lanes, width, which), most(lanes, height, which));
        let minus_error = lanes.sub(lanes.splat(0.0), self.error);
        let (zero, never) = (lanes.splat(0.0), lanes.splat(f32::NEG_INFINITY));
        let none = lanes.splat(WHOLE);
        let (mut inside, mut perhaps) = ([none; 2], [none; 2]);
        let mut along_row = self.first;
        for row in 0..rows {
            let below = lanes.less(height, lanes.splat(row as f32));
            let half = row / ROWS;
            let mut values = along_row;
            for column in 0..columns {
                let beyond = lanes.or(below, lanes.less(width, lanes.splat(column as f32)));
                let (a, b, c) = values;
                let least = lanes.pick(beyond, never, least(lanes, a, b, c));
                let bit = lanes.splat((1u32 << (row % ROWS * FEW_COLUMNS + column)) as f32);
                let if_inside = lanes.pick(lanes.less(self.error, least), bit, zero);
                let unless_outside = lanes.pick(lanes.less(least, minus_error), zero, bit);
                inside[half] = lanes.add(inside[half], if_inside);
                perhaps[half] = lanes.add(perhaps[half], unless_outside);
                let near = nearness(lanes, values, self.nearness);
                lanes.store(near, &mut out.nearness[row * FEW_COLUMNS + column]);
                values = sum(lanes, values, self.to_right);
            }
            along_row = sum(lanes, along_row, self.down);
        }
        for half in 0..2 {
            lanes.store(inside[half], &mut out.inside[half]);
            lanes.store(perhaps[half], &mut out.perhaps[half]);
        }
        lanes.store(self.nearness_error, &mut out.nearness_error);
        which & !lanes.bits(lanes.less(none, lanes.max(perhaps[0], perhaps[1])))
    }
}

impl FewRays {
    /// No triangles.
    pub(super) const NONE: Self = Self {
        inside: [[WHOLE; LANES]; 2],
        perhaps: [[WHOLE; LANES]; 2],
        nearness: [[0.0; LANES]; FEW_COLUMNS * FEW_COLUMNS],
        nearness_error: [0.0; LANES],
    };

    /// The rays that surely meet a triangle, as bits.
    #[inline(always)]
    pub(super) fn inside(&self, lane: usize) -> u32 {
        bits(&self.inside, lane)
    }

    /// The rays that perhaps meet a triangle, as bits.
    #[inline(always)]
    pub(super) fn perhaps(&self, lane: usize) -> u32 {
        bits(&self.perhaps, lane)
    }

    /// How many columns and rows a ray is from the first one; how near the triangle is at least, and at most,
    /// where it meets it.
    #[inline(always)]
    pub(super) fn ray(&self, lane: usize, ray: u32) -> ([usize; 2], [f32; 2]) {
        let ray = ray as usize % (FEW_COLUMNS * FEW_COLUMNS);
        let (near, error) = (self.nearness[ray][lane], self.nearness_error[lane]);
        (
            [ray % FEW_COLUMNS, ray / FEW_COLUMNS],
            [near - error, near + error],
        )
    }
}

/// Bits of both halves of the rows.
#[inline(always)]
fn bits(halves: &[[f32; LANES]; 2], lane: usize) -> u32 {
    let [first, second] = [halves[0][lane], halves[1][lane]];
    let of = |half: f32| half.to_bits() - WHOLE.to_bits();
    of(first) | of(second) << (ROWS * FEW_COLUMNS)
}

/// How many columns, or rows, those of eight boxes in `which`, as bits, hold at most, and two at least: most
/// have as many. They are told by how many more than one they hold.
#[inline(always)]
fn most<L: Lanes>(lanes: L, more: L::Singles, which: u32) -> usize {
    let mut most = 2;
    while most < FEW_COLUMNS {
        let larger = lanes.less(lanes.splat(most as f32 - 1.0), more);
        if lanes.bits(larger) & which == 0 {
            break;
        }
        most += 1;
    }
    most
}

/// How near triangles are by their edges' values: what they are at the first corner, and what each of the
/// third edge's and the first one's adds.
#[inline(always)]
fn nearness<L: Lanes>(
    lanes: L,
    (first, _, third): Three<L>,
    (base, by_third, by_first): Three<L>,
) -> L::Singles {
    let sloped = lanes.add(lanes.mul(third, by_third), lanes.mul(first, by_first));
    lanes.add(base, sloped)
}

#[inline(always)]
fn sum<L: Lanes>(lanes: L, (a, b, c): Three<L>, (d, e, f): Three<L>) -> Three<L> {
    (lanes.add(a, d), lanes.add(b, e), lanes.add(c, f))
}

#[inline(always)]
fn times<L: Lanes>(lanes: L, (a, b, c): Three<L>, by: L::Singles) -> Three<L> {
    (lanes.mul(a, by), lanes.mul(b, by), lanes.mul(c, by))
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
