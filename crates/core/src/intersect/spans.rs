//! Boxes of rays around long thin triangles, eight at once, no larger than the rows' spans make them:
//! such triangles pass between most of their box's rays, and many meet none.
//!
//! # Error bounds
//! Places in a block are off by at most M in each coordinate. What is inside of the true triangle is then at
//! most M from T, the triangle of the corners as placed: a point of the one is a mean of its corners, and the
//! same mean of the other's is no further from it than they are. So where e(x, y) = e₀ + e_x·x + e_y·y is an
//! edge of T, at least 0 inside, e ≥ −M(|e_x| + |e_y|) for all such points.
//!
//! With u = 2⁻²⁴, and P the greatest coordinate of a corner relative to a box's first ray, or a block's
//! size: corners relative to that ray are rounded by uP, which is one more M. Rounded are e₀, a difference of
//! two products of at most P² (4uP²), e_x and e_y (2uP each, times x and y: 4uP²), and e_y·y and two sums
//! (10uP²); we take 24uP². Where the doubled area is more than four times that, its sign is known, and
//! with it the side that is inside. Dividing by e_x moves a column by 6u of at most 2·[`SIDE`], less
//! than [`SLACK`]; what is further out stays there.

use super::footprint::{FEW_SIDE, most, round};
use super::setup::SIDE;
use super::sides::{Three, cross, magnitude, relative_to};
use crate::accel::simd::{LANES, Lanes};

/// u.
const UNIT: f32 = 1.0 / (1 << 24) as f32;

/// How thick a thin triangle is at most, as its doubled area over its length.
const THIN: f32 = 2.0;

/// How many of eight are thin at least: spans of all eight are found together, and take longer than what
/// fewer spare.
const SEVERAL: u32 = 3;

/// By how much spans are longer at both ends, in columns.
const SLACK: f32 = 1.0 / 1024.0;

/// What e_x is taken to be at least: that moves e by less than 10⁻¹⁸ in a block.
const STEEPEST: f32 = 1e-20;

/// Boxes of rays, both ends included, of eight triangles.
#[derive(Clone, Copy)]
pub(super) struct Boxes<L: Lanes> {
    pub(super) left: L::Singles,
    pub(super) right: L::Singles,
    pub(super) top: L::Singles,
    pub(super) bottom: L::Singles,
}

/// Triangles by the places of their corners.
#[derive(Clone, Copy)]
pub(super) struct Placed<L: Lanes> {
    pub(super) xs: Three<L>,
    pub(super) ys: Three<L>,
    /// How wide or high they are, whichever is more.
    pub(super) length: L::Singles,
    /// What places of up to 2·[`SIDE`] are off by; others by as much more as they are further out.
    pub(super) off: L::Singles,
    /// Where all this holds.
    pub(super) safe: L::Mask,
}

impl<L: Lanes> Boxes<L> {
    /// The boxes, smaller where thin triangles leave their sides, and which of `seen`, as bits, still have
    /// rays.
    #[inline(always)]
    pub(super) fn around_thin(self, lanes: L, placed: &Placed<L>, seen: u32) -> (Self, u32) {
        let Placed {
            xs,
            ys,
            length,
            safe,
            ..
        } = *placed;
        let to_b = (lanes.sub(xs.1, xs.0), lanes.sub(ys.1, ys.0));
        let to_c = (lanes.sub(xs.2, xs.0), lanes.sub(ys.2, ys.0));
        let area = cross(lanes, to_b, to_c);
        let wide = lanes.mul(length, lanes.splat(THIN));
        let long = lanes.less(lanes.splat(FEW_SIDE), length);
        let thin = lanes.and(long, lanes.less(magnitude(lanes, area), wide));
        let thin = lanes.and(thin, safe);
        let which = lanes.bits(thin) & seen;
        if which.count_ones() < SEVERAL {
            return (self, seen);
        }
        let (spans, sure) = self.spans(lanes, placed, area, which);
        let thin = lanes.and(thin, sure);
        let empty = lanes.bits(lanes.and(thin, lanes.less(spans.bottom, spans.top)));
        let boxes = Self {
            left: lanes.pick(thin, spans.left, self.left),
            right: lanes.pick(thin, spans.right, self.right),
            top: lanes.pick(thin, spans.top, self.top),
            bottom: lanes.pick(thin, spans.bottom, self.bottom),
        };
        (boxes, seen & !empty)
    }

    /// Boxes around the rows' spans of the triangles in `which`, as bits, and which of those are to be
    /// trusted.
    #[inline(always)]
    fn spans(self, lanes: L, placed: &Placed<L>, area: L::Singles, which: u32) -> (Self, L::Mask) {
        let zero = lanes.splat(0.0);
        let side = lanes.splat(SIDE as f32);
        let (ax, bx, cx) = relative_to(lanes, placed.xs, self.left);
        let (ay, by, cy) = relative_to(lanes, placed.ys, self.top);
        let across = furthest(lanes, (ax, bx, cx));
        let along = furthest(lanes, (ay, by, cy));
        let reach = lanes.max(lanes.max(across, along), side);
        // Places are at most `reach` and the box's own place from zero.
        let scale = lanes.add(
            lanes.mul(reach, lanes.splat(0.5 / SIDE as f32)),
            lanes.splat(1.0),
        );
        let off = lanes.mul(placed.off, scale);
        let off = lanes.add(off, lanes.mul(reach, lanes.splat(UNIT)));
        let rounding = lanes.mul(lanes.mul(reach, reach), lanes.splat(24.0 * UNIT));
        let sure = lanes.less(
            lanes.mul(rounding, lanes.splat(4.0)),
            magnitude(lanes, area),
        );
        let slack = Slack {
            turned: lanes.less(area, zero),
            off,
            rounding,
        };
        let ab = Edge::new(lanes, (ax, ay), (bx, by), slack);
        let bc = Edge::new(lanes, (bx, by), (cx, cy), slack);
        let ca = Edge::new(lanes, (cx, cy), (ax, ay), slack);

        let (width, height) = (
            lanes.sub(self.right, self.left),
            lanes.sub(self.bottom, self.top),
        );
        let (mut left, mut right) = (lanes.splat(2.0 * SIDE as f32), lanes.splat(-1.0));
        let (mut top, mut bottom) = (left, right);
        for row in 0..=highest(lanes, height, which) {
            let y = lanes.splat(row as f32);
            let span = ab.cut(lanes, y, (zero, width));
            let span = bc.cut(lanes, y, span);
            let (begin, end) = ca.cut(lanes, y, span);
            // The first column not before the span, and the last not after it.
            let first = round(lanes, lanes.add(begin, lanes.splat(0.5 - SLACK)));
            let last = round(lanes, lanes.sub(end, lanes.splat(0.5 - SLACK)));
            let none = lanes.or(lanes.less(last, first), lanes.less(height, y));
            left = lanes.pick(none, left, lanes.min(left, first));
            right = lanes.pick(none, right, lanes.max(right, last));
            top = lanes.pick(none, top, lanes.min(top, y));
            bottom = lanes.pick(none, bottom, y);
        }
        let spans = Self {
            left: lanes.add(self.left, left),
            right: lanes.add(self.left, right),
            top: lanes.add(self.top, top),
            bottom: lanes.add(self.top, bottom),
        };
        (spans, sure)
    }
}

/// What edges need besides corners.
#[derive(Clone, Copy)]
struct Slack<L: Lanes> {
    /// Where the triangle's area is negative.
    turned: L::Mask,
    /// M.
    off: L::Singles,
    /// What values are off by besides.
    rounding: L::Singles,
}

/// An edge, at least 0 inside.
#[derive(Clone, Copy)]
struct Edge<L: Lanes> {
    /// What it is at the first ray at most, and what a row adds.
    first: L::Singles,
    down: L::Singles,
    /// What a value is times this is how many columns further it would be zero.
    columns: L::Singles,
    /// Where rows' spans begin at it; elsewhere they end.
    begins: L::Mask,
}

impl<L: Lanes> Edge<L> {
    #[inline(always)]
    fn new(
        lanes: L,
        (px, py): (L::Singles, L::Singles),
        (qx, qy): (L::Singles, L::Singles),
        Slack {
            turned,
            off,
            rounding,
        }: Slack<L>,
    ) -> Self {
        let zero = lanes.splat(0.0);
        let constant = cross(lanes, (px, py), (qx, qy));
        let (right, down) = (lanes.sub(py, qy), lanes.sub(qx, px));
        let constant = lanes.pick(turned, lanes.sub(zero, constant), constant);
        let right = lanes.pick(turned, lanes.sub(zero, right), right);
        let down = lanes.pick(turned, lanes.sub(zero, down), down);
        let steep = lanes.max(magnitude(lanes, right), lanes.splat(STEEPEST));
        let slope = lanes.add(steep, magnitude(lanes, down));
        let slack = lanes.add(lanes.mul(off, slope), rounding);
        let columns = lanes.div(lanes.splat(1.0), steep);
        let begins = lanes.less(zero, right);
        Self {
            first: lanes.add(constant, slack),
            down,
            columns: lanes.pick(begins, lanes.sub(zero, columns), columns),
            begins,
        }
    }

    /// What is inside of a row's span.
    #[inline(always)]
    fn cut(
        &self,
        lanes: L,
        y: L::Singles,
        (begin, end): (L::Singles, L::Singles),
    ) -> (L::Singles, L::Singles) {
        let value = lanes.add(self.first, lanes.mul(self.down, y));
        let zero_at = lanes.mul(value, self.columns);
        (
            lanes.pick(self.begins, lanes.max(zero_at, begin), begin),
            lanes.pick(self.begins, end, lanes.min(zero_at, end)),
        )
    }
}

/// The greatest of those of `heights` that are in `which`, as bits; they are whole numbers.
#[inline(always)]
fn highest<L: Lanes>(lanes: L, heights: L::Singles, which: u32) -> u32 {
    let mut all = [0.0; LANES];
    lanes.store(heights, &mut all);
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
fn furthest<L: Lanes>(lanes: L, (a, b, c): Three<L>) -> L::Singles {
    let (a, b, c) = (
        magnitude(lanes, a),
        magnitude(lanes, b),
        magnitude(lanes, c),
    );
    most(lanes, a, b, c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::simd::Plain;
    use crate::random::Random;

    type Corners = [[f64; 2]; 3];

    fn holds(corners: &Corners, [x, y]: [f64; 2]) -> bool {
        let side =
            |[px, py]: [f64; 2], [qx, qy]: [f64; 2]| (px - x) * (qy - y) - (py - y) * (qx - x);
        let [a, b, c] = *corners;
        let sides = [side(a, b), side(b, c), side(c, a)];
        sides.iter().all(|&s| s >= 0.0) || sides.iter().all(|&s| s <= 0.0)
    }

    /// A thin triangle with an edge that passes by a ray, no further than `past`.
    fn thin(random: &mut Random, length: f64, past: f64) -> Corners {
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
        let thickness = 0.9 * random.unit();
        [
            at(-length * random.unit(), aside),
            at(length * random.unit(), aside),
            at(length * random.signed(), aside + thickness),
        ]
    }

    /// The boxes of triangles: as they come, and as small as their spans, where there still are rays.
    fn boxes(placed: &[Corners; LANES], off: f64) -> [([f32; 4], Option<[f32; 4]>); LANES] {
        let lanes = Plain;
        let each =
            |of: &dyn Fn(&Corners) -> f64| lanes.load(&placed.each_ref().map(|c| of(c) as f32));
        let corner = |corner: usize, axis: usize| each(&move |c| c[corner][axis]);
        let low = |axis: usize| move |c: &Corners| c[0][axis].min(c[1][axis]).min(c[2][axis]);
        let high = |axis: usize| move |c: &Corners| c[0][axis].max(c[1][axis]).max(c[2][axis]);
        let first = |axis: usize| each(&move |c| (low(axis)(c) - off).ceil().clamp(0.0, 64.0));
        let last = |axis: usize| each(&move |c| (high(axis)(c) + off).floor().clamp(-1.0, 31.0));
        let length = |axis: usize| each(&move |c| high(axis)(c) - low(axis)(c));
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        let whole = Boxes::<Plain> {
            left: first(0),
            right: last(0),
            top: first(1),
            bottom: last(1),
        };
        let placed = Placed {
            xs: (corner(0, 0), corner(1, 0), corner(2, 0)),
            ys: (corner(0, 1), corner(1, 1), corner(2, 1)),
            length: lanes.max(length(0), length(1)),
            off: lanes.splat(off as f32),
            safe: lanes.less(zero, one),
        };
        let none = lanes.or(
            lanes.less(whole.right, whole.left),
            lanes.less(whole.bottom, whole.top),
        );
        let (small, seen) = whole.around_thin(lanes, &placed, !lanes.bits(none));
        let sides = |boxes: Boxes<Plain>| {
            let mut sides = [[0.0; LANES]; 4];
            lanes.store(boxes.left, &mut sides[0]);
            lanes.store(boxes.right, &mut sides[1]);
            lanes.store(boxes.top, &mut sides[2]);
            lanes.store(boxes.bottom, &mut sides[3]);
            sides
        };
        let (whole, small) = (sides(whole), sides(small));
        std::array::from_fn(|lane| {
            let left = (seen >> lane & 1 != 0).then(|| small.map(|side| side[lane]));
            (whole.map(|side| side[lane]), left)
        })
    }

    /// How many of many triangles no ray meets, and how many of those were left out.
    fn try_many(length: f64, off: f64, past: f64) -> [usize; 2] {
        let mut random = Random(7);
        let [mut empty, mut left_out] = [0; 2];
        for _ in 0..500 {
            let real: [Corners; LANES] = std::array::from_fn(|_| thin(&mut random, length, past));
            let placed = real.map(|corners| {
                corners.map(|c| c.map(|at| f64::from((at + 0.999 * off * random.signed()) as f32)))
            });
            for (real, (whole, small)) in real.iter().zip(boxes(&placed, off)) {
                let mut any = false;
                for y in 0..SIDE {
                    for x in 0..SIDE {
                        if !holds(real, [x as f64, y as f64]) {
                            continue;
                        }
                        any = true;
                        let (x, y) = (x as f32, y as f32);
                        let held = small.is_some_and(|[left, right, top, bottom]| {
                            (left..=right).contains(&x) && (top..=bottom).contains(&y)
                        });
                        assert!(held, "{x} {y} of {real:?} in {small:?}");
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
                left_out += usize::from(!any && small.is_none());
            }
        }
        [empty, left_out]
    }

    #[test]
    fn no_ray_of_a_thin_triangle_is_left_out() {
        // Places off by much, and by nothing but what far corners' rounding makes of it.
        for (length, off, past) in [
            (30.0, 0.25, 0.3),
            (30.0, 1e-3, 1e-3),
            (200.0, 1e-3, 1e-3),
            (5e4, 0.0, 4e-3),
            (2e6, 0.0, 0.1),
        ] {
            try_many(length, off, past);
        }
    }

    #[test]
    fn thin_triangles_between_rays_are_left_out() {
        let [empty, left_out] = try_many(30.0, 1e-5, 0.5);
        assert!(empty > 500, "{empty} met no ray");
        assert!(
            left_out * 100 >= empty * 95,
            "{left_out} of {empty} were left out"
        );
    }
}
