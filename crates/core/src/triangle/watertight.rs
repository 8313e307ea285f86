//! One ray and one triangle: rounded arithmetic where it is sure, exact arithmetic where it is not.
//!
//! The ray is sheared onto the axis along which its direction is longest; inside or outside is then three signs in
//! two dimensions (Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2013). Theirs are exact for the
//! sheared, rounded vertices; these are exact for the vertices and the ray as given, since each sign and each order
//! of depth has an error bound. What the bound leaves undecided goes to determinants with bounds of their own
//! ([`componentwise`](super::componentwise)), and what those leave to [`exact`] (Shewchuk, "Adaptive Precision
//! Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997).

use super::Nearest;
use super::componentwise::{Determinant, Determinants};
use super::coplanar::are_coplanar;
use super::exact::{self, Placed};
use crate::hit::{Cull, Precision};
use crate::ray::Ray;
use glam::{DVec3, Vec3};
use std::cell::Cell;
use std::cmp::Ordering;

/// The unit roundoff of double precision.
const EPSILON: f64 = f64::EPSILON / 2.0;

/// The relative error of a weight that is still good to single precision, in units of the weights' sum.
const WELL_CONDITIONED: f64 = 1.0 / (1u64 << 28) as f64;

/// A ray prepared for many triangles.
#[derive(Clone, Debug)]
pub(crate) struct PreparedRay {
    /// The ray as given, in world space.
    pub(crate) ray: Ray,
    /// What corners are relative to, in world space.
    frame: DVec3,
    /// The ray's origin relative to that, rounded.
    pub(crate) origin: DVec3,
    /// Bound on the error of its coordinates.
    pub(crate) origin_error: f64,
    /// The axis along which the direction is longest.
    pub(crate) major: usize,
    /// `direction[axis] / direction[major]` of the next axis and the one after; at most 1.
    shear: [f64; 2],
    /// The direction along the major axis.
    pub(crate) advance: f64,
    /// Whether back faces are culled.
    cull: Cull,
    /// Whether what double precision leaves undecided is decided exactly, or by the rounded values.
    precision: Precision,
    /// Whether any triangle so far was decided exactly.
    was_exact: Cell<bool>,
}

/// The answer of one triangle to one ray.
enum Verdict {
    Miss,
    Hit(Nearest),
    /// Undecided in double precision.
    Open,
}

impl PreparedRay {
    /// Prepares a ray for triangles whose corners are relative to `frame`. `None` if the ray is not valid.
    pub(crate) fn new(ray: &Ray, frame: DVec3, cull: Cull, precision: Precision) -> Option<Self> {
        if !ray.is_valid() {
            return None;
        }
        let origin = ray.origin - frame;
        // Nothing is rounded where nothing is subtracted.
        let off = frame != DVec3::ZERO;
        let origin_error = if off {
            origin.abs().max_element() * EPSILON
        } else {
            0.0
        };
        let DVec3 { x, y, z } = ray.direction;
        let major = major_axis(x, y, z);
        let d = ray.direction.to_array();
        let advance = d[major];
        let [kx, ky, _] = axes(major);
        let shear = [d[kx] / advance, d[ky] / advance];
        Some(Self {
            ray: *ray,
            frame,
            origin,
            origin_error,
            major,
            shear,
            advance,
            cull,
            precision,
            was_exact: Cell::new(false),
        })
    }

    /// Whether some triangle tested so far was decided exactly.
    pub(crate) fn was_exact(&self) -> bool {
        self.was_exact.get()
    }

    /// Tests the triangle with primitive index `primitive`, and keeps it if it is nearer than `nearest`, or as near
    /// with a lower primitive id; `number` gives the id of an index.
    pub(crate) fn meet(
        &self,
        primitive: u32,
        corners: impl Fn(u32) -> [Vec3; 3],
        number: impl Fn(u32) -> u32,
        nearest: &mut Nearest,
    ) {
        let candidate = match self.judge(primitive, corners(primitive)) {
            Verdict::Miss => return,
            Verdict::Hit(hit) => hit,
            Verdict::Open => match self.settle(primitive, corners(primitive)) {
                Some(hit) => hit,
                None => return,
            },
        };
        if nearest.is_miss() || candidate.is_surely_before(nearest) {
            *nearest = candidate;
        } else if !nearest.is_surely_before(&candidate) {
            let order = self.compare(&candidate, nearest, corners);
            let wins = order == Ordering::Less
                || order == Ordering::Equal && number(primitive) < number(nearest.primitive);
            if wins {
                *nearest = candidate;
            }
        }
    }

    /// The hit at a triangle that [`PreparedRay::judge`] leaves undecided, if there is one.
    fn settle(&self, primitive: u32, corners: [Vec3; 3]) -> Option<Nearest> {
        match self.precision {
            Precision::Exact => match self.judge_closely(primitive, corners) {
                Verdict::Miss => None,
                Verdict::Hit(hit) => Some(hit),
                Verdict::Open => match self.judge_in_double_double(primitive, corners) {
                    Verdict::Miss => None,
                    Verdict::Hit(hit) => Some(hit),
                    Verdict::Open => {
                        self.was_exact.set(true);
                        exact::hit(&self.ray, &self.placed(corners), self.cull, primitive)
                    }
                },
            },
            Precision::Fast => self.guess(primitive, corners),
        }
    }

    /// Decides by componentwise bounds, or leaves undecided.
    fn judge_closely(&self, primitive: u32, corners: [Vec3; 3]) -> Verdict {
        let relative = corners.map(|corner| corner.as_dvec3() - self.origin);
        let off = self.origin_error / EPSILON;
        self.judge_by(
            primitive,
            Determinants::new(self.ray.direction, relative, off),
        )
    }

    /// Decides in twice double precision, or leaves undecided.
    fn judge_in_double_double(&self, primitive: u32, corners: [Vec3; 3]) -> Verdict {
        let Ray {
            origin, direction, ..
        } = self.ray;
        let determinants = Determinants::in_double_double(origin, direction, corners, self.frame);
        self.judge_by(primitive, determinants)
    }

    /// Decides by the signs of determinants, or leaves undecided.
    fn judge_by(&self, primitive: u32, determinants: Option<Determinants>) -> Verdict {
        let Some(Determinants { weights, numerator }) = determinants else {
            return Verdict::Open;
        };
        let [first, second, third] = weights.map(Determinant::signum);
        let is_any = |sign| [first, second, third].contains(&Some(sign));
        if is_any(1) && is_any(-1) {
            return Verdict::Miss;
        }
        let (Some(_), Some(_), Some(_)) = (first, second, third) else {
            return Verdict::Open;
        };
        let is_culled = self.cull == Cull::Back && is_any(1);
        if is_culled || !(is_any(1) || is_any(-1)) {
            return Verdict::Miss;
        }
        // All weights have one sign, or are zero: neither their sum nor its bound cancels, and rounding three terms
        // takes less than 3ε of it.
        let [a, b, c] = weights;
        let sum = a.value + b.value + c.value;
        let sum_error = (a.error + b.error + c.error) * 1.001 + 3.0 * EPSILON * sum.abs();
        let is_well_conditioned = sum_error <= WELL_CONDITIONED * sum.abs();
        if !is_well_conditioned {
            return Verdict::Open;
        }
        // (N ± n) / (S ± s) is off by n/|S| + |t|·s/|S| and the quotient's rounding; second orders, and the
        // bound's own rounding, are far below a thousandth of it.
        let t = numerator.value / sum;
        let t_error =
            1.001 * (numerator.error + t.abs() * sum_error) / sum.abs() + 2.0 * EPSILON * t.abs();
        let point = Point {
            t,
            t_error,
            u: b.value / sum,
            v: c.value / sum,
        };
        self.within_range(primitive, point)
    }

    /// A hit at a point surely inside a triangle, if it is surely in the ray's range and good to single
    /// precision.
    fn within_range(&self, primitive: u32, point: Point) -> Verdict {
        let Point { t, t_error, u, v } = point;
        let Ray { t_min, t_max, .. } = self.ray;
        if t + t_error <= t_min || t - t_error > t_max {
            return Verdict::Miss;
        }
        if !point.is_single() || t - t_error <= t_min || t + t_error > t_max {
            return Verdict::Open;
        }
        Verdict::Hit(Nearest {
            primitive,
            t,
            t_error,
            u,
            v,
        })
    }

    /// A triangle with these corners, where it is.
    fn placed(&self, corners: [Vec3; 3]) -> Placed {
        Placed {
            corners,
            origin: self.frame,
        }
    }

    /// Which of two hits is nearer, where their errors overlap.
    fn compare(
        &self,
        candidate: &Nearest,
        nearest: &Nearest,
        corners: impl Fn(u32) -> [Vec3; 3],
    ) -> Ordering {
        if self.precision == Precision::Fast {
            return candidate.t.total_cmp(&nearest.t);
        }
        if same_corners(corners(candidate.primitive), corners(nearest.primitive)) {
            return Ordering::Equal;
        }
        let [first, second] =
            [candidate, nearest].map(|hit| (hit.primitive, corners(hit.primitive)));
        let closely = [first, second].map(|(primitive, at)| self.judge_closely(primitive, at));
        if let Some(order) = order_of(closely) {
            return order;
        }
        if are_coplanar(first.1, second.1) {
            self.was_exact.set(true);
            return Ordering::Equal;
        }
        let more =
            [first, second].map(|(primitive, at)| self.judge_in_double_double(primitive, at));
        if let Some(order) = order_of(more) {
            return order;
        }
        self.was_exact.set(true);
        let [candidate, nearest] =
            [candidate, nearest].map(|hit| self.placed(corners(hit.primitive)));
        // Both were decided to be hits.
        exact::compare(&self.ray, &candidate, &nearest, self.cull).unwrap_or(Ordering::Greater)
    }

    /// The hit at a triangle that the ray is known to hit.
    pub(crate) fn evaluate(&self, primitive: u32, corners: [Vec3; 3]) -> Nearest {
        match self.judge(primitive, corners) {
            Verdict::Hit(hit) => hit,
            _ => self.settle(primitive, corners).unwrap_or(Nearest::NONE),
        }
    }

    /// A triangle's edge functions for this ray.
    fn edges(&self, corners: [Vec3; 3]) -> Edges {
        let relative = corners.map(|corner| corner.as_dvec3() - self.origin);
        let [x, y, z] = axes(self.major).map(|axis| relative.map(|corner| corner[axis]));
        Edges::new(x, y, z, self.shear, self.origin_error)
    }

    /// Whether a triangle with these edge functions shows its back. It is seen along the major axis, so its
    /// orientation is the sign of the determinant, against the sense in which the ray runs along the axis.
    fn is_culled(&self, edges: &Edges) -> bool {
        self.cull == Cull::Back && (edges.determinant > 0.0) != (self.advance > 0.0)
    }

    /// What rounded double precision makes of a triangle, bounds aside.
    fn guess(&self, primitive: u32, corners: [Vec3; 3]) -> Option<Nearest> {
        let edges = self.edges(corners);
        let inside =
            edges.functions.iter().all(|&f| f >= 0.0) || edges.functions.iter().all(|&f| f <= 0.0);
        if !inside || edges.determinant == 0.0 || self.is_culled(&edges) {
            return None;
        }
        let Point { t, u, v, .. } = edges.point(self.advance);
        (self.ray.t_min < t && t <= self.ray.t_max).then_some(Nearest {
            primitive,
            t,
            t_error: 0.0,
            u,
            v,
        })
    }

    /// Decides in double precision, or leaves undecided.
    fn judge(&self, primitive: u32, corners: [Vec3; 3]) -> Verdict {
        let edges = self.edges(corners);
        if edges.surely_outside() {
            return Verdict::Miss;
        }
        if !edges.surely_inside() {
            return Verdict::Open;
        }
        if self.is_culled(&edges) {
            return Verdict::Miss;
        }
        self.within_range(primitive, edges.point(self.advance))
    }
}

/// Which of two hits is surely nearer.
fn order_of(verdicts: [Verdict; 2]) -> Option<Ordering> {
    let [Verdict::Hit(a), Verdict::Hit(b)] = verdicts else {
        return None;
    };
    if a.is_surely_before(&b) {
        Some(Ordering::Less)
    } else if b.is_surely_before(&a) {
        Some(Ordering::Greater)
    } else {
        None
    }
}

/// The axes in turn, the major one last.
pub(super) const fn axes(major: usize) -> [usize; 3] {
    [(major + 1) % 3, (major + 2) % 3, major]
}

/// The axis along which a direction is longest.
#[inline(always)]
pub(super) fn major_axis(x: f64, y: f64, z: f64) -> usize {
    let (x, y, z) = (x.abs(), y.abs(), z.abs());
    if (z >= x) & (z >= y) {
        2
    } else if y >= x {
        1
    } else {
        0
    }
}

/// A triangle's edge functions for one ray, in double precision.
///
/// # Error bounds
/// ε = 2⁻⁵³ (notation: `docs/error-bounds.md`), m the greatest coordinate of the corners relative to the ray's
/// origin, η the error of that origin.
///
/// * **Sheared corners.** A corner relative to the origin is off by εm + η a coordinate, a shear factor of
///   at most 1 by ε, so their product by 3εm + η, and a sheared coordinate, after one more subtraction of numbers up to m
///   each, by 2·εm + 4·εm + 2η. With higher orders: δ = 8εm + 3η.
/// * **Edge functions.** `cx·by − cy·bx` of coordinates within δ is off by δ(|cx| + |by| + |cy| + |bx|) + 2δ², and
///   by 2ε(|cx·by| + |cy·bx|) from its own rounding, which is below half the first term since |cx| ≤ 2m. Summed over
///   all corners: E = 2δ(Σ|x| + Σ|y| + δ).
/// * **Depth.** It is the mean of the corners' depths z weighted by the edge functions. Errors of E move it by at
///   most 3E·(max z − min z)/|D|, D their sum; its own rounding, and that of the depths, is below 10εm + η. With
///   higher orders: 4E·(max z − min z)/|D| + 2δ.
///
/// Two terms are covered by others, and stand for the derivation's sake. Where Σ|x| + Σ|y| < 4δ, every function is
/// less than δ(Σ|x| + Σ|y|) and undecided without the δ² of E; elsewhere the quarter of E's first term that rounding
/// leaves is at least 2δ². And the rounding of the quotient by the advance, 2ε of t, is less than 2δ, which is 16εm.
#[derive(Clone, Copy)]
pub(super) struct Edges {
    functions: [f64; 3],
    error: f64,
    determinant: f64,
    depths: [f64; 3],
    delta: f64,
}

/// Where a ray hits a triangle, in double precision.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub(super) t: f64,
    pub(super) t_error: f64,
    pub(super) u: f64,
    pub(super) v: f64,
}

impl Edges {
    /// `x`, `y` and `z` are the corners' coordinates relative to the ray's origin, z along its major axis.
    #[inline(always)]
    pub(super) fn new(
        x: [f64; 3],
        y: [f64; 3],
        z: [f64; 3],
        shear: [f64; 2],
        origin_error: f64,
    ) -> Self {
        let largest = |[a, b, c]: [f64; 3]| greater(greater(a.abs(), b.abs()), c.abs());
        let m = greater(greater(largest(x), largest(y)), largest(z));
        let delta = 8.0 * EPSILON * m + 3.0 * origin_error;

        let x = [
            x[0] - shear[0] * z[0],
            x[1] - shear[0] * z[1],
            x[2] - shear[0] * z[2],
        ];
        let y = [
            y[0] - shear[1] * z[0],
            y[1] - shear[1] * z[1],
            y[2] - shear[1] * z[2],
        ];
        let u = x[2] * y[1] - y[2] * x[1];
        let v = x[0] * y[2] - y[0] * x[2];
        let w = x[1] * y[0] - y[1] * x[0];
        let sum = (x[0].abs() + x[1].abs() + x[2].abs()) + (y[0].abs() + y[1].abs() + y[2].abs());
        Self {
            functions: [u, v, w],
            error: 2.0 * delta * (sum + delta),
            determinant: u + v + w,
            depths: z,
            delta,
        }
    }

    /// Whether two functions surely have different signs.
    #[inline(always)]
    fn surely_outside(&self) -> bool {
        let [u, v, w] = self.functions;
        let below = (u < -self.error) | (v < -self.error) | (w < -self.error);
        let above = (u > self.error) | (v > self.error) | (w > self.error);
        below & above
    }

    /// Whether all functions surely have one sign, and the weights are good to single precision.
    #[inline(always)]
    pub(super) fn surely_inside(&self) -> bool {
        let [u, v, w] = self.functions;
        let above = (u > self.error) & (v > self.error) & (w > self.error);
        let below = (u < -self.error) & (v < -self.error) & (w < -self.error);
        let well_conditioned = self.error <= WELL_CONDITIONED * self.determinant.abs();
        (above | below) & well_conditioned
    }

    /// Where the ray hits the triangle that it is surely inside of.
    #[inline(always)]
    pub(super) fn point(&self, advance: f64) -> Point {
        let [t, u, v] = self.weights(advance);
        let depth_error =
            4.0 * self.error * self.span() / self.determinant.abs() + 2.0 * self.delta;
        Point {
            t,
            t_error: depth_error / advance.abs() * (1.0 + 4.0 * EPSILON) + 2.0 * EPSILON * t.abs(),
            u,
            v,
        }
    }

    /// What [`Edges::point`] gives, without its error.
    #[inline(always)]
    pub(super) fn weights(&self, advance: f64) -> [f64; 3] {
        let [_, v, w] = self.functions;
        let depth = self.depth_sum() / self.determinant;
        [depth / advance, v / self.determinant, w / self.determinant]
    }

    /// Whether the parameter is surely good to single precision: [`Point::is_single`] multiplied by the
    /// determinant, which saves two divisions, with half the limit to cover the roundings of each side.
    #[inline(always)]
    pub(super) fn surely_single(&self) -> bool {
        let error = 4.0 * self.error * self.span() + 2.0 * self.delta * self.determinant.abs();
        error <= 1.0 / (1u64 << 28) as f64 * self.depth_sum().abs()
    }

    /// The depth times the determinant.
    #[inline(always)]
    fn depth_sum(&self) -> f64 {
        let ([u, v, w], z) = (self.functions, self.depths);
        u * z[0] + v * z[1] + w * z[2]
    }

    /// From the nearest corner along the major axis to the furthest.
    #[inline(always)]
    fn span(&self) -> f64 {
        let z = self.depths;
        greater(greater(z[0], z[1]), z[2]) + greater(greater(-z[0], -z[1]), -z[2])
    }
}

impl Point {
    /// Whether the parameter is good to single precision.
    #[inline(always)]
    pub(super) fn is_single(&self) -> bool {
        self.t_error <= 1.0 / (1u64 << 27) as f64 * self.t.abs()
    }
}

#[inline(always)]
pub(super) fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Whether two triangles have the same corners, in any order.
fn same_corners(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    a.iter().all(|p| b.contains(p)) && b.iter().all(|p| a.contains(p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::double_double::DoubleDouble;
    use crate::random::Random;

    fn ray_along_z() -> PreparedRay {
        let ray = Ray::new(DVec3::ZERO, DVec3::Z);
        let prepared = PreparedRay::new(&ray, DVec3::ZERO, Cull::None, Precision::Exact);
        prepared.expect("a valid ray")
    }

    fn hit_by(numerator: Determinant, weights: [Determinant; 3]) -> Nearest {
        let determinants = Some(Determinants { weights, numerator });
        match ray_along_z().judge_by(0, determinants) {
            Verdict::Hit(hit) => hit,
            _ => panic!("a hit"),
        }
    }

    #[test]
    fn what_the_numerator_is_off_by_moves_the_hit() {
        let exact = |value| Determinant { value, error: 0.0 };
        let numerator = Determinant {
            value: 3.0,
            error: 1e-10,
        };
        let hit = hit_by(numerator, [exact(1.0); 3]);
        assert!(hit.t + hit.t_error >= (3.0 + 1e-10) / 3.0);
    }

    /// Weights and numerator are exact: what is left is the rounding of the sum and of the quotient. The truth is
    /// twice double precision.
    #[test]
    fn rounding_the_sum_of_the_weights_moves_the_hit() {
        let mut random = Random(63);
        let exact = |value| Determinant { value, error: 0.0 };
        for _ in 0..50_000 {
            // What is lost to the first weight is nearly half a unit in its last place, twice.
            let first = 1.0 + random.unit();
            let lost = EPSILON * (0.9 + 0.0999 * random.unit());
            let weights = [first, lost, lost];
            let numerator = 1.0 + random.unit();
            let hit = hit_by(exact(numerator), weights.map(exact));
            let [a, b, c] = weights.map(DoubleDouble::from);
            let residual = DoubleDouble::from(hit.t) * (a + b + c) - numerator.into();
            assert!(
                residual.high.abs() <= hit.t_error * first,
                "{weights:?} {numerator}"
            );
        }
    }

    #[test]
    fn what_the_weights_are_off_by_moves_the_hit() {
        let weight = Determinant {
            value: 1.0,
            error: 1e-10,
        };
        let numerator = Determinant {
            value: 3.0,
            error: 0.0,
        };
        let hit = hit_by(numerator, [weight; 3]);
        // The sum may be as small as this.
        let furthest = 3.0 / (3.0 * (1.0 - 1e-10));
        assert!(hit.t + hit.t_error >= furthest, "{}", hit.t_error);
    }

    /// What doubles are sure of is so, of rays at edges and corners but for roundings: next to the eye
    /// and far from it, and with an eye that is rounded itself. The truth is integer arithmetic.
    #[test]
    fn what_doubles_are_sure_of_is_so() {
        let mut random = Random(61);
        for (frame, place) in [
            (DVec3::ZERO, 0.0),
            (DVec3::ZERO, 1e6),
            // Corners are stored about the frame, and the eye's place there is rounded.
            (DVec3::new(1e7, -0.1, 3e3), 2e7),
            (DVec3::new(1e-9, 2e-9, -1e-9), 3e7),
        ] {
            let [
                mut decided,
                mut closely_decided,
                mut widely_decided,
                mut hits,
            ] = [0; 4];
            for _ in 0..8000 {
                let middle = DVec3::new(place, place * 0.7, -place);
                let size = place.max(1.0) * crate::math::pow(10.0, -6.0 * random.unit());
                let mut near = || (middle + random.point() * size).as_vec3();
                let mut corners = [near(), near(), near()];
                if random.unit() < 0.2 {
                    // Seen along z, all corners have one depth.
                    corners = corners.map(|corner| corner.with_z(corners[0].z));
                }
                let [a, b, c] = corners.map(|corner| frame + corner.as_dvec3());
                let target = match (random.unit() * 4.0) as u32 {
                    0 => a,
                    1 => a + (b - a) * random.unit(),
                    2 => (a + b + c) / 3.0,
                    _ => b + (c - b) * random.unit() + random.point() * (size * 1e-14),
                };
                // Nearly in the triangle's plane, next to it, far from it, or anywhere.
                let beside = random.point() * (size * crate::math::pow(10.0, -9.0 * random.unit()));
                let origin = match (random.unit() * 5.0) as u32 {
                    0 => a + ((b - a) * random.signed() + (c - a) * random.signed()) * 9.0 + beside,
                    1 => target + beside,
                    2 => {
                        let distance = size * crate::math::pow(10.0, 1.0 + 8.0 * random.unit());
                        frame + middle + random.point() * distance
                    }
                    _ => frame + middle + random.point() * (size * 10.0),
                };
                let mut ray = Ray::new(origin, target - origin);
                if random.unit() < 0.3 {
                    // Begins or ends where it meets the triangle, or so.
                    let t = 1.0 + (random.unit() * 5.0 - 2.0).floor() * f64::EPSILON;
                    (ray.t_min, ray.t_max) = if random.unit() < 0.5 {
                        (t, 9.0)
                    } else {
                        (0.0, t)
                    };
                }
                let prepared = PreparedRay::new(&ray, frame, Cull::None, Precision::Exact);
                let prepared = prepared.expect("a valid ray");
                let truth = exact::hit(&ray, &prepared.placed(corners), Cull::None, 0);
                let verdicts = [
                    (prepared.judge(0, corners), &mut decided),
                    (prepared.judge_closely(0, corners), &mut closely_decided),
                    (
                        prepared.judge_in_double_double(0, corners),
                        &mut widely_decided,
                    ),
                ];
                for (verdict, decided) in verdicts {
                    match verdict {
                        Verdict::Open => continue,
                        Verdict::Miss => assert!(truth.is_none(), "{ray:?} {corners:?}"),
                        Verdict::Hit(hit) => {
                            let truth = truth.expect("a hit that is one");
                            let off = (hit.t - truth.t).abs();
                            assert!(off <= hit.t_error + truth.t_error, "{ray:?} {corners:?}");
                            let single = 2f64.powi(-24);
                            assert!(off <= single * truth.t, "{ray:?} {corners:?}");
                            assert!((hit.u - truth.u).abs() <= single);
                            assert!((hit.v - truth.v).abs() <= single);
                        }
                    }
                    *decided += 1;
                }
                hits += u32::from(truth.is_some());
            }
            assert!(hits > 1000, "{hits}");
            assert!(decided > 300, "{decided}");
            assert!(closely_decided > 200, "{closely_decided} of {decided}");
            assert!(widely_decided > 1500, "{widely_decided}");
        }
    }
}
