//! On which side of eight triangles' edges a few rays are, by their places.

use super::footprint::{FEW, least, most};
use crate::accel::simd::Lanes;

/// A ray's side of eight triangles, as bits; of those in none it is not sure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides {
    /// Inside of those seen from the front.
    pub(super) front: u32,
    /// Inside of those seen from the back.
    pub(super) back: u32,
    /// Outside.
    pub(super) outside: u32,
}

/// A number for each of three corners, or edges.
type Three<L> = (
    <L as Lanes>::Singles,
    <L as Lanes>::Singles,
    <L as Lanes>::Singles,
);

impl Sides {
    /// For the first ray, the one beside it, the one below, and the one below that beside it. Corners
    /// are at `xs` and `ys`; cross products of two, relative to a ray, are off by less than `error`.
    #[inline(always)]
    pub(super) fn of_few<L: Lanes>(
        lanes: L,
        xs: Three<L>,
        ys: Three<L>,
        (x, y): (L::Singles, L::Singles),
        error: L::Singles,
    ) -> [Self; FEW] {
        let (ax, bx, cx) = relative_to(lanes, xs, x);
        let (ay, by, cy) = relative_to(lanes, ys, y);
        let first = (
            cross(lanes, (ax, ay), (bx, by)),
            cross(lanes, (bx, by), (cx, cy)),
            cross(lanes, (cx, cy), (ax, ay)),
        );
        let to_right = (lanes.sub(ay, by), lanes.sub(by, cy), lanes.sub(cy, ay));
        let down = (lanes.sub(bx, ax), lanes.sub(cx, bx), lanes.sub(ax, cx));
        let beside = sum(lanes, first, to_right);
        let below = sum(lanes, first, down);
        let diagonal = sum(lanes, beside, down);
        [
            Self::of(lanes, first, error),
            Self::of(lanes, beside, error),
            Self::of(lanes, below, error),
            Self::of(lanes, diagonal, error),
        ]
    }

    /// Columns run right and rows down, so that what is seen from the front has negative products.
    #[inline(always)]
    fn of<L: Lanes>(lanes: L, (a, b, c): Three<L>, error: L::Singles) -> Self {
        let (low, high) = (least(lanes, a, b, c), most(lanes, a, b, c));
        let minus_error = lanes.sub(lanes.splat(0.0), error);
        let differ = lanes.and(lanes.less(error, high), lanes.less(low, minus_error));
        Self {
            front: lanes.bits(lanes.less(high, minus_error)),
            back: lanes.bits(lanes.less(error, low)),
            outside: lanes.bits(differ),
        }
    }
}

#[inline(always)]
fn relative_to<L: Lanes>(lanes: L, (a, b, c): Three<L>, origin: L::Singles) -> Three<L> {
    (
        lanes.sub(a, origin),
        lanes.sub(b, origin),
        lanes.sub(c, origin),
    )
}

#[inline(always)]
fn sum<L: Lanes>(lanes: L, (a, b, c): Three<L>, (d, e, f): Three<L>) -> Three<L> {
    (lanes.add(a, d), lanes.add(b, e), lanes.add(c, f))
}

#[inline(always)]
fn cross<L: Lanes>(
    lanes: L,
    (px, py): (L::Singles, L::Singles),
    (qx, qy): (L::Singles, L::Singles),
) -> L::Singles {
    lanes.sub(lanes.mul(px, qy), lanes.mul(py, qx))
}
