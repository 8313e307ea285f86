//! The directions of a small rectangle of places through a lens, for packets: as places on the image plane, in single
//! precision, which is what the packet kernel computes with. Within a rectangle directions are a smooth function of the
//! place: every second row of them is found by chord steps, and the rows between are interpolated.
//!
//! # Error bound
//! f is the distortion and g its inverse, J the derivative of f, as in [`lens_region`](super::lens_region); m = g(middle),
//! β = ‖J(m)⁻¹‖. All places of the rectangle, and of four rows more on both sides, are within ρ of its middle.
//!
//! * **The disc.** With R = 1.5βρ, L a bound of ‖D²f‖ within R of m, and q = βLR ≤ ⅓, the map x ↦ x − J(m)⁻¹(f(x) − to)
//!   contracts the disc of radius R about m by q, and maps m no further than βρ ≤ (1 − q)R: g(to) is in the disc. There
//!   ‖J⁻¹‖ ≤ β' = β/(1 − q). These are the rays' directions, which the region knows: the two agree in the middle, both
//!   depend continuously on the place, and f is one to one near each of them, so that they agree everywhere.
//! * **The window.** g(middle + h) differs from m + Dg·h by at most ½Lβ'³|h|².
//! * **Chord steps.** c is near the directions of a block of the rectangle, and A = J(c)⁻¹. For x within r of c and a step
//!   σ = A(f(x) − to) with |σ| ≤ ½r(1 − κ), κ = β'L·1.5r, the map x ↦ x − A(f(x) − to) contracts the disc of radius 1.5r
//!   about c by κ: x is within |σ|/(1 − κ) of g(to), and x − σ within κ|σ|/(1 − κ).
//! * **Interpolation.** Between the values a, b, c, d at four equal steps of 2h lies (9(b + c) − (a + d))/16, off by
//!   3/128·(2h)⁴ times the fourth derivative (Steffensen, "Interpolation", 1927) and by 20/16 of what the values are. With M₃
//!   and M₄ bounds of the third and fourth derivative of f, that of g is at most 15L³β'⁷ + 10LM₃β'⁶ + M₄β'⁵, as the terms of
//!   the fourth derivative of x = g(f(x)) are counted; each has four factors J⁻¹e, with e down the column, at most β'ₑ =
//!   |J(m)⁻¹e|/(1 − q): β'ₑ⁴(15L³β'³ + 10LM₃β'² + M₄β'). M₃ and M₄ are l₃ and l₄ for R.
//! * **Rounding.** A step's end is off by 460ε as Newton's are, with half of that more from the step's own rounding; times
//!   20/16, with the places' own 4ε and those of the ray's direction, 720ε: below 2000ε, which is less than a quarter of the
//!   least tolerance and is set aside.
//! * **Dominated terms.** Where interpolation serves, extrapolation does, too, and leaves steps that are shorter than their
//!   limit needs: it and r close the proof, and no test needs them.

use super::brown_conrady::BrownConrady;
use super::distortion::Distortion;
use super::lens_region::{LensRegion, MOST_CONTRACTION, Near, REACH_FACTOR};
use crate::num::simd::LANES;

/// How far off directions may be, as a share of the distance of neighbouring rows of places: 2⁻¹⁶ = 256u, a sixth of what
/// rounding moves an edge function by in columns (48u of a sum of magnitudes, of up to 32 slopes: 1536u). With a lesser share more packets take Newton's steps for every ray; a greater one shows
/// in the kernel's error bounds.
const TOLERANCE: f64 = 1.0 / (1 << 16) as f64;

/// The least tolerance, 2¹³ε: beneath it rounding counts.
const LEAST_TOLERANCE: f64 = 1.0 / (1u64 << 40) as f64;

/// Rows of places on both sides of the rectangle that interpolation needs, at most.
const ROWS_BESIDE: f64 = 4.0;

/// Blocks of a packet: four strips of eight columns, and four blocks in each.
const BLOCKS: usize = 16;
const STRIPS: usize = 4;

/// Chord steps of the first rows of nodes, which less is extrapolated to; later rows take one. With fewer, more packets take
/// Newton's steps for every ray; with more, time is lost where these suffice.
const FIRST_STEPS: [usize; 4] = [4, 3, 3, 2];

/// The directions of a rectangle of places, to the right and down.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LensPatch {
    pub(crate) region: LensRegion,
    lens: Distortion,
    /// The rectangle's middle, half its sides, and the direction that is seen in the middle.
    place: [f64; 2],
    half: [f64; 2],
    middle: [f64; 2],
    /// Dg there, a symmetric matrix: xx, xy, yy.
    slopes: [f64; 3],
    /// ½ max ‖D²g‖.
    bend: f64,
    smooth: Option<Smooth>,
}

/// What is known where a rectangle is small.
#[derive(Clone, Copy, Debug)]
struct Smooth {
    /// β'.
    inverse: f64,
    /// L.
    bent: f64,
    /// R.
    reach: f64,
    /// A bound of |D⁴g| down a column.
    fourth: f64,
}

/// How places on the image plane become those of a packet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlaceScale {
    /// The point of the image plane, to the right and up, that lies `margin` columns and rows from the packet's corner.
    pub(crate) corner: (f64, f64),
    /// Columns to one of the plane's.
    pub(crate) inverse: f64,
    pub(crate) margin: f64,
}

/// The places of a rectangle: of its columns, and of its rows by the first and the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PatchPlaces<'a> {
    /// To the right, of as many columns as the rectangle has, and seven more.
    pub(crate) columns: &'a [f64],
    pub(crate) width: usize,
    /// Down.
    pub(crate) first: f64,
    pub(crate) step: f64,
    pub(crate) height: usize,
}

impl LensPatch {
    /// What is known of a rectangle of places, to the right and up, in which neighbouring rows are `step` apart; `larger` is
    /// a patch that contains it.
    pub(super) fn new(
        lens: &BrownConrady,
        (left, right): (f64, f64),
        (low, high): (f64, f64),
        step: f64,
        larger: Option<&Self>,
    ) -> Option<Self> {
        let half = [(right - left) * 0.5, (high - low) * 0.5];
        let place = [left + half[0], -(low + half[1])];
        // A larger region's disc contains these directions, too.
        let (region, start) = match larger {
            Some(larger) => (larger.region, larger.linear(place[0], place[1])),
            None => {
                let region = lens.region((left, right), (low, high))?;
                let is_mild = lens.is_well_behaved(place[0], place[1]);
                (region, if is_mild { place } else { region.centre })
            }
        };
        let [to_x, to_y] = place;
        let near =
            region.undistort_from(&lens.distortion, [&[to_x], &[to_y]], start.map(|it| [it]));
        let middle = match near {
            Some([[x], [y]]) => [x, y],
            None => lens.direction(to_x, -to_y).map(|d| [d.x, -d.y])?,
        };
        let at = Near::of(&lens.distortion, middle[0], middle[1], 0.0)?;
        let beside = half[1] + ROWS_BESIDE * step.abs();
        let smooth = Smooth::within(
            &lens.distortion,
            &at,
            (half[0] * half[0] + beside * beside).sqrt(),
        );
        Some(Self {
            region,
            lens: lens.distortion,
            place,
            half,
            middle,
            slopes: at.inverse(),
            bend: smooth.map_or(region.bend, |smooth| smooth.bend()),
            smooth,
        })
    }

    /// The least and the greatest tangents, to the right and up, of the rays through the rectangle.
    pub(crate) fn window(&self) -> [(f64, f64); 2] {
        let ([across, along], [xx, xy, yy]) = (self.half, self.slopes);
        let bend = self.bend * (across * across + along * along);
        let reach = |by_x: f64, by_y: f64| {
            let reach = by_x.abs() * across + by_y.abs() * along + bend;
            // Far more than the rounding of directions and derivatives.
            reach * (1.0 + 1e-9) + 1e-9
        };
        let ([x, y], dx, dy) = (self.middle, reach(xx, xy), reach(xy, yy));
        [(x - dx, x + dx), (-y - dy, -y + dy)]
    }

    /// How far off the directions of [`Self::find_places`] are, where rows are `step` apart; `None` where they are not found.
    pub(crate) fn tolerance(&self, step: f64) -> Option<f64> {
        self.smooth?;
        let tolerance = TOLERANCE * step.abs();
        (tolerance >= LEAST_TOLERANCE).then_some(tolerance)
    }

    /// Finds a packet's places, of `SIDE` to a row. Returns whether they are within the tolerance; otherwise they are of no
    /// use.
    #[inline(always)]
    pub(crate) fn find_places<const SIDE: usize>(
        &self,
        places: &PatchPlaces<'_>,
        scale: &PlaceScale,
        (out_x, out_y): (&mut [f32], &mut [f32]),
    ) -> bool {
        const { assert!(SIDE == STRIPS * LANES) };
        let (Some(smooth), Some(tolerance)) = (self.smooth, self.tolerance(places.step)) else {
            return false;
        };
        let Some(blocks) = self.blocks(&smooth, places, tolerance) else {
            return false;
        };
        let mut strips = [[0.0; LANES]; STRIPS];
        let count = places.width.div_ceil(LANES).min(STRIPS);
        let last = places.columns.get(places.width.max(1) - 1);
        let last = last.copied().unwrap_or(f64::INFINITY);
        for (strip, to_x) in strips.iter_mut().enumerate().take(count) {
            let ahead = places.columns.get(strip * LANES..);
            let Some(columns) = ahead.and_then(|rest| rest.first_chunk::<LANES>()) else {
                return false;
            };
            for lane in 0..LANES {
                let at = columns[lane];
                to_x[lane] = if at < last { at } else { last };
            }
        }
        // The last four rows of nodes of each strip, a row at its number modulo four.
        let mut known = [[[[0.0; LANES]; 2]; 4]; STRIPS];
        let mut worst = Worst::default();
        for node in 0..blocks.count(places.height) {
            let block = (node / blocks.nodes).min(STRIPS - 1) * STRIPS;
            let row = (node * blocks.every) as f64 - blocks.rows_before as f64;
            let to_y = places.first + places.step * row;
            let steps = FIRST_STEPS.get(node).copied().unwrap_or(1);
            for (strip, to_x) in strips.iter().enumerate().take(count) {
                let known = &mut known[strip];
                let [by_x, by_y] = [blocks.xy[block + strip], blocks.yy[block + strip]]
                    .map(|slope| slope * places.step * blocks.every as f64);
                let mut at = match node {
                    0 => {
                        let mut at = [[0.0; LANES]; 2];
                        for lane in 0..LANES {
                            [at[0][lane], at[1][lane]] = self.linear(to_x[lane], to_y);
                        }
                        at
                    }
                    1 => moved(&known[0], by_x, by_y),
                    2 => extrapolated(known, node, [2.0, -1.0, 0.0, 0.0]),
                    3 => extrapolated(known, node, [3.0, -3.0, 1.0, 0.0]),
                    _ => extrapolated(known, node, [4.0, -6.0, 4.0, -1.0]),
                };
                for _ in 0..steps {
                    blocks.step(&self.lens, block + strip, (to_x, to_y), &mut at, &mut worst);
                }
                worst.end_steps();
                known[node % 4] = at;
                if blocks.every == 1 {
                    scale.write::<SIDE>(&at, (node, strip), (out_x, out_y));
                } else if node >= 3 {
                    let row = 2 * (node - 3);
                    scale.write::<SIDE>(&known[(node - 2) % 4], (row, strip), (out_x, out_y));
                    let between = [-1.0 / 16.0, 9.0 / 16.0, 9.0 / 16.0, -1.0 / 16.0];
                    let between = extrapolated(known, node + 1, between);
                    if row + 1 < places.height {
                        scale.write::<SIDE>(&between, (row + 1, strip), (out_x, out_y));
                    }
                }
            }
        }
        worst.is_within(&blocks)
    }

    /// m + Dg·h for a place to the right and down.
    #[inline(always)]
    fn linear(&self, to_x: f64, to_y: f64) -> [f64; 2] {
        let ([xx, xy, yy], [x, y]) = (self.slopes, self.middle);
        let (across, down) = (to_x - self.place[0], to_y - self.place[1]);
        [x + (xx * across + xy * down), y + (xy * across + yy * down)]
    }

    /// c and A of each block; `None` where κ or what is left of the tolerance does not serve.
    #[inline(always)]
    fn blocks(&self, smooth: &Smooth, places: &PatchPlaces<'_>, tolerance: f64) -> Option<Blocks> {
        let step = places.step;
        let first = *places.columns.first()?;
        let across = places.columns.get(1)? - first;
        let squared = step * step;
        let by_interpolation = 0.375 * squared * squared * smooth.fourth;
        // Interpolation must leave a third of the tolerance; the last quarter is rounding's.
        // A packet's 19 or 32 rows of nodes make four blocks.
        let (every, nodes, each) = if by_interpolation <= 0.42 * tolerance {
            (2, 5, (0.75 * tolerance - by_interpolation) / 1.25)
        } else {
            (1, 8, 0.75 * tolerance)
        };
        let rows_before = 2 * (every - 1);
        let half_y = (every * (nodes - 1)) as f64 * 0.5 * step;
        let half_x = 0.5 * (LANES - 1) as f64 * across;
        let mut blocks = Blocks {
            every,
            nodes,
            rows_before,
            ..Blocks::default()
        };
        let ([xx, xy, yy], [m_x, m_y]) = (self.slopes, self.middle);
        let mut furthest = [0.0; BLOCKS];
        let mut aside = [0.0; BLOCKS];
        for block in 0..BLOCKS {
            let strip = (block % STRIPS * LANES) as f64;
            let row = (block / STRIPS * every * nodes) as f64 - rows_before as f64;
            let right = first + across * strip + half_x - self.place[0];
            let down = places.first + step * row + half_y - self.place[1];
            let (by_x, by_y) = (xx * right + xy * down, xy * right + yy * down);
            let at = self.lens.at(m_x + by_x, m_y + by_y);
            let inverse = 1.0 / at.determinant();
            blocks.x[block] = m_x + by_x;
            blocks.y[block] = m_y + by_y;
            blocks.xx[block] = at.yy * inverse;
            blocks.xy[block] = -at.xy * inverse;
            blocks.yy[block] = at.xx * inverse;
            furthest[block] = by_x * by_x + by_y * by_y;
            aside[block] = right * right + down * down;
        }
        let greatest = |all: &[f64; BLOCKS]| {
            let strips = places.width.div_ceil(LANES);
            let rows = (blocks.count(places.height) - 1) / nodes;
            let used =
                (0..BLOCKS).filter(|block| block % STRIPS < strips && block / STRIPS <= rows);
            used.fold(0.0, |most: f64, block| most.max(all[block]))
        };
        // Directions of a block are that far from its middle's, and this from c.
        let block = smooth.inverse * (half_x * half_x + half_y * half_y).sqrt();
        let reach = 1.01 * block + self.bend * greatest(&aside);
        let turn = smooth.inverse * smooth.bent * 1.5 * reach;
        let settled = (each * (1.0 - turn) / turn).min(0.5 * reach * (1.0 - turn));
        // NaN fails these comparisons.
        let serves =
            turn <= MOST_CONTRACTION && greatest(&furthest).sqrt() + 1.5 * reach <= smooth.reach;
        blocks.reach_squared = reach * reach;
        blocks.settled_squared = settled * settled;
        serves.then_some(blocks)
    }
}

/// c and A of the blocks of a packet, and what holds for all of them.
#[derive(Clone, Copy, Default)]
struct Blocks {
    x: [f64; BLOCKS],
    y: [f64; BLOCKS],
    xx: [f64; BLOCKS],
    xy: [f64; BLOCKS],
    yy: [f64; BLOCKS],
    /// Rows from one row of nodes to the next: two, or one where interpolation is off by too much. Rows of places before
    /// the first of the rectangle.
    every: usize,
    rows_before: usize,
    /// Rows of nodes of a block.
    nodes: usize,
    /// r², and the square of the longest step behind which a direction is known.
    reach_squared: f64,
    settled_squared: f64,
}

impl Smooth {
    /// What holds for places within `radius` of the one whose direction is known; `None` where q is too great.
    fn within(lens: &Distortion, at: &Near, radius: f64) -> Option<Self> {
        let beta = at.beta * (1.0 + 1e-9);
        let reach = REACH_FACTOR * beta * radius;
        let bent = at.curvature(lens, reach);
        let turn = beta * bent * reach;
        let inverse = beta / (1.0 - turn);
        // NaN fails the comparisons.
        let is_small = turn <= MOST_CONTRACTION && at.is_precise(lens, reach, inverse);
        if !is_small {
            return None;
        }
        let (third, highest) = (at.third(lens, reach), at.fourth(lens, reach));
        let [_, xy, yy] = at.inverse();
        let down = (xy * xy + yy * yy) * (1.0 + 1e-9) / ((1.0 - turn) * (1.0 - turn));
        let cube = inverse * (15.0 * bent * bent * bent);
        let fourth = down * down * inverse * (highest + inverse * (10.0 * bent * third + cube));
        Some(Self {
            inverse,
            bent,
            reach,
            fourth,
        })
    }

    /// ½ max ‖D²g‖.
    fn bend(&self) -> f64 {
        0.5 * self.bent * self.inverse * self.inverse * self.inverse
    }
}

/// The sum of the four rows of nodes before `node`, the last one first, with these weights.
#[inline(always)]
fn extrapolated(
    known: &[[[f64; LANES]; 2]; 4],
    node: usize,
    weights: [f64; 4],
) -> [[f64; LANES]; 2] {
    let ([a, b, c, d], mut out) = (weights, [[0.0; LANES]; 2]);
    let before = |rows: usize| &known[(node + 4 - rows) % 4];
    let (first, second, third, fourth) = (before(1), before(2), before(3), before(4));
    for axis in 0..2 {
        for lane in 0..LANES {
            let last = a * first[axis][lane] + b * second[axis][lane];
            out[axis][lane] = last + (c * third[axis][lane] + d * fourth[axis][lane]);
        }
    }
    out
}

#[inline(always)]
fn moved([x, y]: &[[f64; LANES]; 2], by_x: f64, by_y: f64) -> [[f64; LANES]; 2] {
    let mut out = [[0.0; LANES]; 2];
    for lane in 0..LANES {
        out[0][lane] = x[lane] + by_x;
        out[1][lane] = y[lane] + by_y;
    }
    out
}

/// The longest last steps and the greatest distances from c so far, squared. NaN stays, since later rows are
/// extrapolated from it.
#[derive(Default)]
struct Worst {
    step: [f64; LANES],
    longest: [f64; LANES],
    furthest: [f64; LANES],
}

impl Worst {
    /// Counts the last step that was taken.
    #[inline(always)]
    fn end_steps(&mut self) {
        for lane in 0..LANES {
            let step = self.step[lane];
            self.longest[lane] = if step <= self.longest[lane] {
                self.longest[lane]
            } else {
                step
            };
        }
    }

    fn is_within(&self, blocks: &Blocks) -> bool {
        let is_near = self.furthest.iter().all(|&it| it <= blocks.reach_squared);
        is_near && self.longest.iter().all(|&it| it <= blocks.settled_squared)
    }
}

impl Blocks {
    /// The rows of nodes of a rectangle of so many rows.
    fn count(&self, height: usize) -> usize {
        // Interpolation needs one row before a rectangle, and two behind it.
        height.div_ceil(self.every) + 3 * (self.every - 1)
    }

    /// Takes a chord step towards eight places.
    #[inline(always)]
    fn step(
        &self,
        lens: &Distortion,
        block: usize,
        (to_x, to_y): (&[f64; LANES], f64),
        [x, y]: &mut [[f64; LANES]; 2],
        worst: &mut Worst,
    ) {
        let [k1, k2, p1, p2, k3] = lens.coefficients;
        let (q1, q2) = (2.0 * p1, 2.0 * p2);
        let (centre_x, centre_y) = (self.x[block], self.y[block]);
        let (xx, xy, yy) = (self.xx[block], self.xy[block], self.yy[block]);
        for lane in 0..LANES {
            let (u, v) = (x[lane], y[lane]);
            let squared = u * u + v * v;
            let radial = 1.0 + squared * (k1 + squared * (k2 + squared * k3));
            let sum = radial + (q2 * u + q1 * v);
            let off_x = u * sum + p2 * squared - to_x[lane];
            let off_y = v * sum + p1 * squared - to_y;
            let by_x = xx * off_x + xy * off_y;
            let by_y = xy * off_x + yy * off_y;
            let (from_x, from_y) = (u - centre_x, v - centre_y);
            let far = from_x * from_x + from_y * from_y;
            let furthest = worst.furthest[lane];
            worst.furthest[lane] = if far <= furthest { furthest } else { far };
            worst.step[lane] = by_x * by_x + by_y * by_y;
            x[lane] = u - by_x;
            y[lane] = v - by_y;
        }
    }
}

impl PlaceScale {
    /// Writes the places of eight directions of a row and strip.
    #[inline(always)]
    fn write<const SIDE: usize>(
        &self,
        [x, y]: &[[f64; LANES]; 2],
        (row, strip): (usize, usize),
        (out_x, out_y): (&mut [f32], &mut [f32]),
    ) {
        let (at, (left, high)) = (row * SIDE + strip * LANES, self.corner);
        if let Some(out) = out_x
            .get_mut(at..)
            .and_then(|rest| rest.first_chunk_mut::<LANES>())
        {
            for lane in 0..LANES {
                out[lane] = ((x[lane] - left) * self.inverse + self.margin) as f32;
            }
        }
        if let Some(out) = out_y
            .get_mut(at..)
            .and_then(|rest| rest.first_chunk_mut::<LANES>())
        {
            for lane in 0..LANES {
                out[lane] = ((high + y[lane]) * self.inverse + self.margin) as f32;
            }
        }
    }
}

#[cfg(test)]
#[path = "lens_patch_tests.rs"]
mod tests;
