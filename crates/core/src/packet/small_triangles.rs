//! Which of a few rays meet eight triangles, by their places, and how near the triangles are along them. The
//! bounds are derived in [`ray_bounds`](super::ray_bounds).

use super::lane_math::{Three, cross, least, relative_to};
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};

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

/// Edges of eight triangles as cross products of two corners relative to a ray, above zero inside: linear
/// functions of its place.
pub(super) struct Edges<L: Lanes> {
    /// Their values at the first ray of a triangle's box.
    first: Three<L::F32>,
    /// What is added from column to column, and from row to row.
    to_right: Three<L::F32>,
    down: Three<L::F32>,
    /// What the values are off by at most.
    error: L::F32,
    /// How near the triangle is along a ray: what it is at the first corner, and what each of the values
    /// of the third and the first edge adds.
    nearness: Three<L::F32>,
    /// What that is off by at most inside.
    nearness_error: L::F32,
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
        [xs, ys, nears]: [Three<L::F32>; 3],
        (x, y): (L::F32, L::F32),
        error: L::F32,
        corner_error: L::F32,
    ) -> Self {
        let (ax, bx, cx) = relative_to(xs, x);
        let (ay, by, cy) = relative_to(ys, y);
        let first = (
            cross((ax, ay), (bx, by)),
            cross((bx, by), (cx, cy)),
            cross((cx, cy), (ax, ay)),
        );
        let to_right = (ay - by, by - cy, cy - ay);
        let down = (bx - ax, cx - bx, ax - cx);
        let area = first.0 + first.1 + first.2;
        // Columns run right and rows down: what is seen from the front has negative values.
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        let front = area.lt(zero);
        let sign = front.select(lanes.splat(-1.0), one);

        let (a_near, b_near, c_near) = nears;
        let (to_b, to_c) = (b_near - a_near, c_near - a_near);
        let inverse = one / (area * sign);
        let share = error * inverse;
        let slope = to_b.abs() + to_c.abs();
        let by_slope = share * slope * SHARES;
        Self {
            first: times(first, sign),
            to_right: times(to_right, sign),
            down: times(down, sign),
            error,
            nearness: (a_near, to_b * inverse, to_c * inverse),
            nearness_error: corner_error + by_slope,
            told: share.lt(lanes.splat(LEAST_SHARE)),
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
        (width, height): (L::F32, L::F32),
        which: u32,
        out: &mut FewRays,
    ) -> u32 {
        let (columns, rows) = (most(lanes, width, which), most(lanes, height, which));
        let minus_error = lanes.splat(0.0) - self.error;
        let (zero, never) = (lanes.splat(0.0), lanes.splat(f32::NEG_INFINITY));
        let none = lanes.splat(WHOLE);
        let (mut inside, mut perhaps) = ([none; 2], [none; 2]);
        let mut along_row = self.first;
        for row in 0..rows {
            let below = height.lt(lanes.splat(row as f32));
            let half = row / ROWS;
            let mut values = along_row;
            for column in 0..columns {
                let beyond = below | width.lt(lanes.splat(column as f32));
                let (a, b, c) = values;
                let least = beyond.select(never, least((a, b, c)));
                let bit = lanes.splat((1u32 << (row % ROWS * FEW_COLUMNS + column)) as f32);
                let if_inside = self.error.lt(least).select(bit, zero);
                let unless_outside = least.lt(minus_error).select(zero, bit);
                inside[half] = inside[half] + if_inside;
                perhaps[half] = perhaps[half] + unless_outside;
                let near = nearness(values, self.nearness);
                near.store(&mut out.nearness[row * FEW_COLUMNS + column]);
                values = sum(values, self.to_right);
            }
            along_row = sum(along_row, self.down);
        }
        for half in 0..2 {
            inside[half].store(&mut out.inside[half]);
            perhaps[half].store(&mut out.perhaps[half]);
        }
        self.nearness_error.store(&mut out.nearness_error);
        which & !none.lt(perhaps[0].max(perhaps[1])).bits()
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
fn most<L: Lanes>(lanes: L, more: L::F32, which: u32) -> usize {
    let mut most = 2;
    while most < FEW_COLUMNS {
        let larger = lanes.splat(most as f32 - 1.0).lt(more);
        if larger.bits() & which == 0 {
            break;
        }
        most += 1;
    }
    most
}

/// How near triangles are by their edges' values: what they are at the first corner, and what each of the
/// third edge's and the first one's adds.
#[inline(always)]
fn nearness<F: F32x8>((first, _, third): Three<F>, (base, by_third, by_first): Three<F>) -> F {
    base + (third * by_third + first * by_first)
}

#[inline(always)]
fn sum<F: F32x8>((a, b, c): Three<F>, (d, e, f): Three<F>) -> Three<F> {
    (a + d, b + e, c + f)
}

#[inline(always)]
fn times<F: F32x8>((a, b, c): Three<F>, by: F) -> Three<F> {
    (a * by, b * by, c * by)
}
