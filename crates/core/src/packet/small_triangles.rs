//! Coverage of small triangles: eight triangles, each tested against the few rays of its bounds by edge functions in
//! single precision (Pineda, "A Parallel Algorithm for Polygon Rasterization", 1988).
//! [`ray_bounds`](super::ray_bounds) derives the bounds on their errors.

use super::lane_math::{Three, cross, least, relative_to};
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};

/// The largest edge error, relative to the doubled area, of a triangle whose orientation is used. At a third and
/// beyond no orientation is sure, and the closer to that, the wider the bounds of depth keys. With a smaller limit
/// more slivers are set up.
pub(super) const MAX_AREA_ERROR: f32 = 1.0 / 16.0;

/// Relative error of the interpolated depth key, in units of (edge error / doubled area) · (spread of the
/// depth key over the corners): derived in [`ray_bounds`](super::ray_bounds).
pub(super) const DEPTH_KEY_ERROR: f32 = 6.0;

/// The most columns, and rows, of rays in the bounds of a small triangle.
const SMALL_COLUMNS: usize = 5;

/// The number of rows of rays that one single-precision number holds: the greater half of five, in 15 of its 24 bits.
const ROWS: usize = 3;

/// Adding a smaller integer to this puts the integer in the low bits of the mantissa.
const WHOLE: f32 = 8_388_608.0;

/// Edge functions of eight triangles, positive inside: cross products of two corners relative to a ray, linear
/// in the ray's place.
pub(super) struct SmallEdges<L: Lanes> {
    /// Values at the first ray of each triangle's bounds.
    first: Three<L::F32>,
    /// Steps from column to column, and from row to row.
    to_right: Three<L::F32>,
    down: Three<L::F32>,
    /// Bound on the error of the values.
    error: L::F32,
    /// The depth key along a ray: its value at the first corner, and its slopes by the third and the first edge
    /// function.
    depth_key: Three<L::F32>,
    /// Bound on its error inside the triangle.
    depth_key_error: L::F32,
    /// Triangles whose orientation is decided. Slivers are not: nothing here holds for them.
    pub(super) decided: L::Mask,
    /// Of those, the triangles that face the eye.
    pub(super) front: L::Mask,
}

/// The rays that hit eight small triangles. Rays are numbered from the first of a triangle's bounds, in rows of
/// [`SMALL_COLUMNS`].
pub(crate) struct SmallCoverage {
    /// Rays surely inside, as the low bits of numbers that hold some rows each.
    inside: [[f32; LANES]; 2],
    /// Rays not surely outside, including those surely inside.
    perhaps: [[f32; LANES]; 2],
    /// The depth key along each ray.
    depth_key: [[f32; LANES]; SMALL_COLUMNS * SMALL_COLUMNS],
    /// Bound on its error.
    depth_key_error: [f32; LANES],
}

impl<L: Lanes> SmallEdges<L> {
    /// `xs`, `ys` and `depth_keys` are places and depth keys of the corners, `(x, y)` is the first ray of each
    /// triangle's bounds; `error` bounds the error of the edge functions, `corner_error` that of `depth_keys`.
    #[inline(always)]
    pub(super) fn new(
        lanes: L,
        [xs, ys, depth_keys]: [Three<L::F32>; 3],
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
        // Columns run right and rows down, so a triangle that faces the eye has a negative area.
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        let front = area.lt(zero);
        let sign = front.select(lanes.splat(-1.0), one);

        let (a_key, b_key, c_key) = depth_keys;
        let (to_b, to_c) = (b_key - a_key, c_key - a_key);
        // Of an area of minus zero too this is plus infinity: nothing is sure of it.
        let inverse = one / area.abs();
        let area_error = error * inverse;
        let slope = to_b.abs() + to_c.abs();
        let by_slope = area_error * slope * DEPTH_KEY_ERROR;
        Self {
            first: times(first, sign),
            to_right: times(to_right, sign),
            down: times(down, sign),
            error,
            depth_key: (a_key, to_b * inverse, to_c * inverse),
            depth_key_error: corner_error + by_slope,
            decided: area_error.lt(lanes.splat(MAX_AREA_ERROR)),
            front,
        }
    }

    /// Tests the triangles in `which` (as bits) against the rays of their bounds, of `width + 1` columns and
    /// `height + 1` rows, at most five each. Returns those that no ray hits, as bits.
    #[inline(always)]
    pub(super) fn test(
        &self,
        lanes: L,
        (width, height): (L::F32, L::F32),
        which: u32,
        out: &mut SmallCoverage,
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
                let bit = lanes.splat((1u32 << (row % ROWS * SMALL_COLUMNS + column)) as f32);
                let if_inside = self.error.lt(least).select(bit, zero);
                let unless_outside = least.lt(minus_error).select(zero, bit);
                inside[half] = inside[half] + if_inside;
                perhaps[half] = perhaps[half] + unless_outside;
                let key = depth_key(values, self.depth_key);
                key.store(&mut out.depth_key[row * SMALL_COLUMNS + column]);
                values = sum(values, self.to_right);
            }
            along_row = sum(along_row, self.down);
        }
        for half in 0..2 {
            inside[half].store(&mut out.inside[half]);
            perhaps[half].store(&mut out.perhaps[half]);
        }
        self.depth_key_error.store(&mut out.depth_key_error);
        which & !none.lt(perhaps[0].max(perhaps[1])).bits()
    }
}

impl SmallCoverage {
    /// No triangles.
    pub(super) const NONE: Self = Self {
        inside: [[WHOLE; LANES]; 2],
        perhaps: [[WHOLE; LANES]; 2],
        depth_key: [[0.0; LANES]; SMALL_COLUMNS * SMALL_COLUMNS],
        depth_key_error: [0.0; LANES],
    };

    /// The rays surely inside a triangle, as bits.
    #[inline(always)]
    pub(super) fn inside(&self, lane: usize) -> u32 {
        bits(&self.inside, lane)
    }

    /// The rays not surely outside a triangle, as bits.
    #[inline(always)]
    pub(super) fn perhaps(&self, lane: usize) -> u32 {
        bits(&self.perhaps, lane)
    }

    /// Column and row of a ray relative to the first one, and the bounds of the depth key along it.
    #[inline(always)]
    pub(super) fn ray(&self, lane: usize, ray: u32) -> ([usize; 2], [f32; 2]) {
        let ray = ray as usize % (SMALL_COLUMNS * SMALL_COLUMNS);
        let (key, error) = (self.depth_key[ray][lane], self.depth_key_error[lane]);
        (
            [ray % SMALL_COLUMNS, ray / SMALL_COLUMNS],
            [key - error, key + error],
        )
    }
}

/// The bits of both halves of the rows.
#[inline(always)]
fn bits(halves: &[[f32; LANES]; 2], lane: usize) -> u32 {
    let [first, second] = [halves[0][lane], halves[1][lane]];
    let of = |half: f32| half.to_bits() - WHOLE.to_bits();
    of(first) | of(second) << (ROWS * SMALL_COLUMNS)
}

/// The greatest number of columns, or rows, in the bounds of the triangles in `which` (as bits), at least two, which
/// is the most frequent. `more` is one less than the number in each lane.
#[inline(always)]
fn most<L: Lanes>(lanes: L, more: L::F32, which: u32) -> usize {
    let mut most = 2;
    while most < SMALL_COLUMNS {
        let larger = lanes.splat(most as f32 - 1.0).lt(more);
        if larger.bits() & which == 0 {
            break;
        }
        most += 1;
    }
    most
}

/// The depth key interpolated by edge functions: base at the first corner, slopes by the third and the first
/// function.
#[inline(always)]
fn depth_key<F: F32x8>((first, _, third): Three<F>, (base, by_third, by_first): Three<F>) -> F {
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
