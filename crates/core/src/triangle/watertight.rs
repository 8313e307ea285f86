//! One ray and one triangle: rounded arithmetic where its error bounds decide, exact arithmetic elsewhere.
//!
//! The ray is sheared onto the axis along which its direction is longest; inside or outside is then a matter of three
//! signs in two dimensions (Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2013). Their test is
//! exact for the sheared, rounded vertices. This one is exact for the vertices and the ray as given, since each sign
//! and each order of depth has an error bound. What the bounds leave undecided goes to determinants with tighter
//! bounds ([`componentwise`](super::componentwise)), and what those leave undecided to [`exact`] (Shewchuk, "Adaptive
//! Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997).

mod order;

use super::BoundedHit;
use super::close_start::CloseStart;
use super::componentwise::{Determinant, Determinants};
use super::edges::{Edges, Point, WELL_CONDITIONED, axes, major_axis};
use super::exact::{self, OffsetTriangle};
use super::eye_triangle::EyeTriangle;
use super::shared_triangles::SharedTriangles;
use crate::hit::{Cull, Detail, Precision};
use crate::num::double_double::DoubleDouble;
use crate::num::roundoff::EPSILON;
use crate::ray::{Ray, relative_origin};
use glam::{DVec3, Vec3};
use std::cell::Cell;
use std::cmp::Ordering;
use std::rc::Rc;

/// A ray prepared for tests against many triangles.
#[derive(Clone, Debug)]
pub(crate) struct PreparedRay {
    /// The ray as given, in world space.
    pub(crate) ray: Ray,
    /// The point that corners are relative to, in world space.
    tree_origin: DVec3,
    /// The ray's origin relative to `tree_origin`, rounded.
    pub(crate) origin: DVec3,
    /// Bound on the error of its coordinates.
    origin_error: f64,
    /// The origin or, where that is far away, a point of the ray close to the scene, and the bound on its error.
    pub(crate) start: DVec3,
    pub(crate) start_error: f64,
    /// The ray's parameter there; `None` at the origin.
    pub(crate) skipped: Option<DoubleDouble>,
    /// The axis along which the direction is longest.
    pub(crate) major: usize,
    /// `direction[axis] / direction[major]` for the two axes after the major one; at most 1.
    shear: [f64; 2],
    /// The direction along the major axis.
    pub(crate) advance: f64,
    /// Which faces are culled.
    cull: Cull,
    /// Whether cases that double precision leaves undecided are decided exactly, or by rounded values.
    precision: Precision,
    /// Whether any triangle so far was decided exactly.
    was_exact: Cell<bool>,
    /// What other rays know of triangles; `None` for a ray of its own.
    shared: Option<Rc<SharedTriangles>>,
    /// Which numbers of its hits are needed.
    detail: Detail,
    /// A corner of a triangle that the ray is known to pass through exactly.
    corner: Cell<Option<Vec3>>,
}

/// The outcome of a test with error bounds.
enum Verdict {
    Miss,
    Hit(BoundedHit),
    /// The error bound leaves it undecided.
    Undecided,
}

impl PreparedRay {
    /// Prepares a ray for triangles whose corners are relative to `tree_origin`. `None` if the ray is not valid.
    pub(crate) fn new(
        ray: &Ray,
        tree_origin: DVec3,
        cull: Cull,
        precision: Precision,
    ) -> Option<Self> {
        if !ray.is_valid() {
            return None;
        }
        let (origin, origin_error) = relative_origin(ray.origin, tree_origin);
        let DVec3 { x, y, z } = ray.direction;
        let major = major_axis(x, y, z);
        let d = ray.direction.to_array();
        let advance = d[major];
        let [kx, ky, _] = axes(major);
        let shear = [d[kx] / advance, d[ky] / advance];
        Some(Self {
            ray: *ray,
            tree_origin,
            origin,
            origin_error,
            start: origin,
            start_error: origin_error,
            skipped: None,
            major,
            shear,
            advance,
            cull,
            precision,
            was_exact: Cell::new(false),
            shared: None,
            detail: Detail::Full,
            corner: Cell::new(None),
        })
    }

    /// The same ray, one of many, with what they share of triangles. With [`Detail::Full`] its hits' t, u and v are
    /// those of the ray alone, bit for bit; with [`Detail::Triangle`], from an eye, more triangles are decided without
    /// integers, by numbers that round otherwise.
    #[must_use]
    pub(crate) fn sharing(self, shared: &Rc<SharedTriangles>, detail: Detail) -> Self {
        Self {
            // Numbers that are worth computing for many rays from an eye.
            detail: if shared.have_eye() {
                detail
            } else {
                self.detail
            },
            shared: Some(Rc::clone(shared)),
            ..self
        }
    }

    /// The same ray for triangles that are all in a box, from its `min` to its `max`: where the ray comes from far
    /// away, it is measured from a point close to them.
    #[must_use]
    pub(crate) fn close_to(self, bounds: [DVec3; 2]) -> Self {
        let origin = (self.origin, self.origin_error);
        match CloseStart::new(&self.ray, self.tree_origin, origin, bounds) {
            Some(close) => Self {
                start: close.point,
                start_error: close.error,
                skipped: Some(close.parameter),
                ..self
            },
            None => self,
        }
    }

    /// Whether some triangle tested so far was decided exactly.
    pub(crate) fn was_exact(&self) -> bool {
        self.was_exact.get()
    }

    /// Intersects the ray with the triangle of index `primitive`, and replaces `nearest` if this hit is nearer, or
    /// equally near with a lower primitive id. `id` maps an index to its id.
    pub(crate) fn intersect(
        &self,
        primitive: u32,
        corners: impl Fn(u32) -> [Vec3; 3],
        id: impl Fn(u32) -> u32,
        nearest: &mut BoundedHit,
    ) {
        let candidate = match self.intersect_in_double(primitive, corners(primitive)) {
            Verdict::Miss => return,
            Verdict::Hit(hit) => hit,
            Verdict::Undecided => {
                // Hits at one corner are equally near.
                if self.corner.get().is_some()
                    && !nearest.is_miss()
                    && id(nearest.primitive) < id(primitive)
                    && self.meet_at_corner([primitive, nearest.primitive].map(&corners))
                {
                    return;
                }
                match self.intersect_undecided(primitive, corners(primitive)) {
                    Some(hit) => hit,
                    None => return,
                }
            }
        };
        if nearest.is_miss() || candidate.is_surely_before(nearest) {
            *nearest = candidate;
        } else if !nearest.is_surely_before(&candidate) {
            let order = self.compare(&candidate, nearest, corners);
            let wins = order == Ordering::Less
                || order == Ordering::Equal && id(primitive) < id(nearest.primitive);
            if wins {
                *nearest = candidate;
            }
        }
    }

    /// Whether the ray passes exactly through a corner that two triangles share, as it does where they are two of many
    /// around a vertex. Where it hits both, it hits them there, since a ray in a triangle's plane misses it.
    pub(super) fn meet_at_corner(&self, triangles: [[Vec3; 3]; 2]) -> bool {
        (self.corner.get())
            .is_some_and(|corner| triangles.iter().all(|corners| corners.contains(&corner)))
    }

    /// The hit, if any, with a triangle that [`PreparedRay::intersect_in_double`] leaves undecided.
    #[inline(never)]
    fn intersect_undecided(&self, primitive: u32, corners: [Vec3; 3]) -> Option<BoundedHit> {
        if self.precision == Precision::Fast {
            return self.intersect_rounded(primitive, corners);
        }
        let mut verdict = self.intersect_from_start(primitive, corners);
        if matches!(verdict, Verdict::Undecided) {
            verdict = self.with_shared(primitive, |from_eye| {
                self.intersect_closely(primitive, corners, from_eye)
            });
        }
        match verdict {
            Verdict::Miss => None,
            Verdict::Hit(hit) => Some(hit),
            Verdict::Undecided => {
                self.was_exact.set(true);
                let placed = self.placed(corners);
                let (hit, corner) =
                    exact::hit_and_corner(&self.ray, &placed, self.cull, primitive)?;
                if corner.is_some() {
                    self.corner.set(corner);
                }
                Some(hit)
            }
        }
    }

    /// Calls a function with what rays from the same eye share of a triangle.
    fn with_shared<T>(&self, primitive: u32, function: impl FnOnce(&EyeTriangle) -> T) -> T {
        match &self.shared {
            Some(shared) => shared.with(primitive, function),
            None => function(&EyeTriangle::default()),
        }
    }

    /// The ray's determinants with a triangle from cross products that are known within roundings.
    fn closest_determinants(
        &self,
        corners: [Vec3; 3],
        from_eye: &EyeTriangle,
    ) -> Option<Determinants> {
        let shared = from_eye.closest_determinants(self.ray.origin, &self.placed(corners))?;
        shared.of(self.ray.direction)
    }

    /// Their weights.
    fn closest_weights(&self, primitive: u32, corners: [Vec3; 3]) -> Option<[Determinant; 3]> {
        let determinants = self.with_shared(primitive, |from_eye| {
            self.closest_determinants(corners, from_eye)
        });
        determinants.map(|determinants| determinants.weights)
    }

    /// Intersects by determinants with bounds of their own: each more closely where the ones before leave it undecided.
    fn intersect_closely(
        &self,
        primitive: u32,
        corners: [Vec3; 3],
        from_eye: &EyeTriangle,
    ) -> Verdict {
        let determinants = self.componentwise(corners);
        let verdict = self.intersect_by_determinants(primitive, determinants);
        if !matches!(verdict, Verdict::Undecided) {
            return verdict;
        }
        // Where the weights' signs are sure, accuracy is missing: where a ray starts next to the triangle's plane its
        // parameter's numerator alone may cancel, and in a needle the weights do.
        if let Some(determinants) = determinants.filter(Determinants::have_sure_weights) {
            let (eye, triangle) = (self.ray.origin, self.placed(corners));
            let closer = from_eye.numerator(eye, &triangle);
            let closer = closer.map(|numerator| Determinants {
                numerator,
                ..determinants
            });
            let verdict = self.intersect_by_determinants(primitive, closer);
            if !matches!(verdict, Verdict::Undecided) {
                return verdict;
            }
            let verdict = self.intersect_from_eye(primitive, corners, from_eye);
            if !matches!(verdict, Verdict::Undecided) {
                return verdict;
            }
        }
        if self.detail == Detail::Triangle {
            let determinants = self.closest_determinants(corners, from_eye);
            let verdict = self.intersect_by_determinants(primitive, determinants);
            if !matches!(verdict, Verdict::Undecided) {
                return verdict;
            }
        }
        self.intersect_in_double_double(primitive, corners, from_eye)
    }

    /// Intersects in double precision with componentwise bounds.
    fn intersect_componentwise(&self, primitive: u32, corners: [Vec3; 3]) -> Verdict {
        self.intersect_by_determinants(primitive, self.componentwise(corners))
    }

    /// The determinants in double precision with componentwise bounds.
    fn componentwise(&self, corners: [Vec3; 3]) -> Option<Determinants> {
        let relative = corners.map(|corner| corner.as_dvec3() - self.origin);
        let off = self.origin_error / EPSILON;
        Determinants::new(self.ray.direction, relative, off)
    }

    /// Intersects by what rays from one eye share of the triangle.
    fn intersect_from_eye(
        &self,
        primitive: u32,
        corners: [Vec3; 3],
        from_eye: &EyeTriangle,
    ) -> Verdict {
        let shared = from_eye.determinants(self.ray.origin, &self.placed(corners));
        let determinants = shared.and_then(|shared| shared.of(self.ray.direction));
        self.intersect_by_determinants(primitive, determinants)
    }

    /// Intersects in double-double arithmetic.
    fn intersect_in_double_double(
        &self,
        primitive: u32,
        corners: [Vec3; 3],
        from_eye: &EyeTriangle,
    ) -> Verdict {
        let shared = from_eye.wide_determinants(self.ray.origin, &self.placed(corners));
        let determinants = shared.and_then(|shared| shared.of(self.ray.direction));
        self.intersect_by_determinants(primitive, determinants)
    }

    /// Intersects by the signs of determinants; undecided without determinants.
    fn intersect_by_determinants(
        &self,
        primitive: u32,
        determinants: Option<Determinants>,
    ) -> Verdict {
        let Some(Determinants { weights, numerator }) = determinants else {
            return Verdict::Undecided;
        };
        let [first, second, third] = weights.map(Determinant::signum);
        let is_any = |sign| [first, second, third].contains(&Some(sign));
        if is_any(1) && is_any(-1) {
            return Verdict::Miss;
        }
        let (Some(_), Some(_), Some(_)) = (first, second, third) else {
            return Verdict::Undecided;
        };
        let is_culled = self.cull == Cull::Back && is_any(1);
        if is_culled || !(is_any(1) || is_any(-1)) {
            return Verdict::Miss;
        }
        // All weights have one sign or are zero, so neither their sum nor its bound cancels. The two sums and the
        // quotient below add 3ε.
        let [a, b, c] = weights;
        let sum = a.value + b.value + c.value;
        let sum_error = (a.error + b.error + c.error) * 1.001 + 3.0 * EPSILON * sum.abs();
        let is_well_conditioned = sum_error <= WELL_CONDITIONED * sum.abs();
        if !is_well_conditioned {
            return Verdict::Undecided;
        }
        // (N ± n) / (S ± s) is off by n/|S| + |t|·s/|S|; a thousandth of that covers second orders and the bound's
        // own rounding.
        let t = numerator.value / sum;
        let t_error = 1.001 * (numerator.error + t.abs() * sum_error) / sum.abs();
        let point = Point {
            t,
            t_error,
            u: b.value / sum,
            v: c.value / sum,
        };
        self.within_range(primitive, point)
    }

    /// The hit at a point that is surely inside a triangle. Undecided where the ray's range, or accuracy in single
    /// precision, needs a smaller error than the point has.
    fn within_range(&self, primitive: u32, point: Point) -> Verdict {
        let Point { t, t_error, u, v } = point;
        let Ray { t_min, t_max, .. } = self.ray;
        if t + t_error <= t_min || t - t_error > t_max {
            return Verdict::Miss;
        }
        if !point.is_single() || t - t_error <= t_min || t + t_error > t_max {
            return Verdict::Undecided;
        }
        Verdict::Hit(BoundedHit {
            primitive,
            t,
            t_error,
            u,
            v,
        })
    }

    /// The triangle with these corners, for exact arithmetic.
    fn placed(&self, corners: [Vec3; 3]) -> OffsetTriangle {
        OffsetTriangle {
            corners,
            origin: self.tree_origin,
        }
    }

    /// The hit of a triangle that the ray is known to hit.
    pub(crate) fn hit_on(&self, primitive: u32, corners: [Vec3; 3]) -> BoundedHit {
        match self.intersect_in_double(primitive, corners) {
            Verdict::Hit(hit) => hit,
            _ => self
                .intersect_undecided(primitive, corners)
                .unwrap_or(BoundedHit::NONE),
        }
    }

    /// The triangle's edge functions for this ray.
    #[inline(always)]
    fn edges(&self, corners: [Vec3; 3]) -> Edges {
        self.edges_from(corners, self.origin, self.origin_error)
    }

    /// The triangle's edge functions for this ray, from a point of it that is off by at most `error`.
    #[inline(always)]
    fn edges_from(&self, corners: [Vec3; 3], point: DVec3, error: f64) -> Edges {
        let [a, b, c] = [
            corners[0].to_array(),
            corners[1].to_array(),
            corners[2].to_array(),
        ];
        let origin = point.to_array();
        let along = |axis: usize| {
            let origin = origin[axis];
            [
                f64::from(a[axis]) - origin,
                f64::from(b[axis]) - origin,
                f64::from(c[axis]) - origin,
            ]
        };
        let [x, y, z] = axes(self.major);
        Edges::new(along(x), along(y), along(z), self.shear, error)
    }

    /// Whether a triangle with these edge functions shows a culled back face. It is seen along the major axis, so its
    /// orientation is the sign of the determinant times the ray's direction along that axis.
    fn is_culled(&self, edges: &Edges) -> bool {
        self.cull == Cull::Back && (edges.determinant > 0.0) != (self.advance > 0.0)
    }

    /// Intersects in double precision and trusts rounded signs.
    fn intersect_rounded(&self, primitive: u32, corners: [Vec3; 3]) -> Option<BoundedHit> {
        let edges = self.edges(corners);
        let inside =
            edges.functions.iter().all(|&f| f >= 0.0) || edges.functions.iter().all(|&f| f <= 0.0);
        if !inside || edges.determinant == 0.0 || self.is_culled(&edges) {
            return None;
        }
        let Point { t, u, v, .. } = edges.point(self.advance);
        (self.ray.t_min < t && t <= self.ray.t_max).then_some(BoundedHit {
            primitive,
            t,
            t_error: 0.0,
            u,
            v,
        })
    }

    /// Intersects in double precision; undecided where the bounds of [`Edges`] do not suffice.
    fn intersect_in_double(&self, primitive: u32, corners: [Vec3; 3]) -> Verdict {
        self.intersect_by_edges(primitive, self.edges(corners), |point| point)
    }

    /// As [`PreparedRay::intersect_in_double`], from a point close to the scene; undecided where the origin is close to
    /// it.
    fn intersect_from_start(&self, primitive: u32, corners: [Vec3; 3]) -> Verdict {
        let Some(skipped) = self.skipped else {
            return Verdict::Undecided;
        };
        let edges = self.edges_from(corners, self.start, self.start_error);
        self.intersect_by_edges(primitive, edges, |point| {
            let t = (skipped + point.t.into()).high;
            // A sum's error is 3.1ε² of itself, before it is rounded.
            let t_error = point.t_error + 1.01 * EPSILON * t.abs();
            Point {
                t,
                t_error,
                ..point
            }
        })
    }

    #[inline(always)]
    fn intersect_by_edges(
        &self,
        primitive: u32,
        edges: Edges,
        from_origin: impl Fn(Point) -> Point,
    ) -> Verdict {
        if edges.surely_outside() {
            return Verdict::Miss;
        }
        if !edges.surely_inside() {
            return Verdict::Undecided;
        }
        if self.is_culled(&edges) {
            return Verdict::Miss;
        }
        self.within_range(primitive, from_origin(edges.point(self.advance)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::double_double::DoubleDouble;
    use crate::random::Random;
    use std::cell::OnceCell;
    use std::fmt;

    fn ray_along_z() -> PreparedRay {
        let ray = Ray::new(DVec3::ZERO, DVec3::Z);
        let prepared = PreparedRay::new(&ray, DVec3::ZERO, Cull::None, Precision::Exact);
        prepared.expect("a valid ray")
    }

    fn hit_by(numerator: Determinant, weights: [Determinant; 3]) -> BoundedHit {
        let determinants = Some(Determinants { weights, numerator });
        match ray_along_z().intersect_by_determinants(0, determinants) {
            Verdict::Hit(hit) => hit,
            _ => panic!("a hit"),
        }
    }

    #[test]
    fn the_numerators_error_widens_the_hits_interval() {
        let exact = |value| Determinant { value, error: 0.0 };
        let numerator = Determinant {
            value: 3.0,
            error: 1e-10,
        };
        let hit = hit_by(numerator, [exact(1.0); 3]);
        assert!(hit.t + hit.t_error >= (3.0 + 1e-10) / 3.0);
    }

    /// Weights and numerator are exact, which leaves the rounding of the sum and of the quotient. The truth is
    /// double-double arithmetic.
    #[test]
    fn rounding_the_weights_sum_widens_the_hits_interval() {
        let mut random = Random(63);
        let exact = |value| Determinant { value, error: 0.0 };
        for _ in 0..50_000 {
            // What the first weight loses is nearly half a unit in its last place, twice.
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
    fn the_weights_errors_widen_the_hits_interval() {
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

    /// Rays in a triangle's plane except for rounding see either side of it, whatever rounded signs say. The truth is
    /// integer arithmetic.
    #[test]
    fn back_faces_seen_edge_on_are_culled_exactly() {
        let mut random = Random(64);
        let (mut seen, mut misjudged) = (0, 0);
        for _ in 0..20_000 {
            let corners = [(); 3].map(|()| random.point().as_vec3());
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let origin = a + ((b - a) * random.signed() + (c - a) * random.signed()) * 3.0;
            let target = a + ((b - a) * random.unit() + (c - a) * random.unit()) * 0.5;
            let ray = Ray::new(origin, target - origin);
            let prepared = PreparedRay::new(&ray, DVec3::ZERO, Cull::Back, Precision::Exact);
            let prepared = prepared.expect("a valid ray");
            let truth = exact::hit(&ray, &prepared.placed(corners), Cull::Back, 0);
            let mut nearest = BoundedHit::NONE;
            prepared.intersect(0, |_| corners, |index| index, &mut nearest);
            assert_eq!(nearest.is_miss(), truth.is_none(), "{ray:?} {corners:?}");
            seen += u32::from(truth.is_some());
            let is_culled = prepared.is_culled(&prepared.edges(corners));
            misjudged += u32::from(truth.is_some() && is_culled);
        }
        assert!(seen > 100 && misjudged > 20, "{misjudged} of {seen}");
    }

    /// Whether a verdict is sure; where it is, it must be what integers say.
    fn is_decided(verdict: &Verdict, truth: Option<&BoundedHit>, what: impl fmt::Debug) -> bool {
        match (verdict, truth) {
            (Verdict::Undecided, _) => return false,
            (Verdict::Miss, truth) => assert!(truth.is_none(), "{what:?}"),
            (Verdict::Hit(_), None) => panic!("a hit that is none: {what:?}"),
            (Verdict::Hit(hit), Some(truth)) => {
                let off = (hit.t - truth.t).abs();
                assert!(off <= hit.t_error + truth.t_error, "{what:?}");
                let single = 2f64.powi(-24);
                assert!(off <= single * truth.t, "{what:?}");
                assert!((hit.u - truth.u).abs() <= single, "{what:?}");
                assert!((hit.v - truth.v).abs() <= single, "{what:?}");
            }
        }
        true
    }

    /// Rays from a point of a triangle except for rounding, where the parameter's numerator cancels. The truth is
    /// integer arithmetic. That it is the numerator which decides is seen where twice of it gives twice the parameter.
    #[test]
    fn rays_from_next_to_a_plane_are_decided_by_their_numerator() {
        let mut random = Random(66);
        for tree_origin in [DVec3::ZERO, DVec3::new(0.1, -7.3, 1e3)] {
            let mut by_numerator = 0;
            for _ in 0..4000 {
                let corners = [(); 3].map(|()| random.point().as_vec3());
                let [a, b, c] = corners.map(Vec3::as_dvec3);
                let (u, v) = (random.unit() * 0.5, random.unit() * 0.5);
                let beside = random.point() * crate::math::pow(10.0, -14.0 - 6.0 * random.unit());
                let origin = a + (b - a) * u + (c - a) * v + beside + tree_origin;
                let ray = Ray::new(origin, random.point());
                let prepared = PreparedRay::new(&ray, tree_origin, Cull::None, Precision::Exact);
                let prepared = prepared.expect("a valid ray");
                let truth = exact::hit(&ray, &prepared.placed(corners), Cull::None, 0);
                let from_eye = EyeTriangle::default();
                let verdict = prepared.intersect_closely(0, corners, &from_eye);
                is_decided(&verdict, truth.as_ref(), (ray, corners));
                let numerator = from_eye.numerator.get().copied().flatten();
                let twice = numerator.map(|Determinant { value, error }| Determinant {
                    value: 2.0 * value,
                    error: 2.0 * error,
                });
                let from_eye = EyeTriangle {
                    numerator: OnceCell::from(twice),
                    ..EyeTriangle::default()
                };
                let twice = prepared.intersect_closely(0, corners, &from_eye);
                if let (Verdict::Hit(once), Verdict::Hit(twice)) = (verdict, twice) {
                    by_numerator += u32::from(twice.t == 2.0 * once.t);
                }
            }
            assert!(by_numerator > 1000, "{by_numerator}");
        }
    }

    /// Triangles of 10⁻¹³ of their distance and less, which double precision hardly tells apart from the eye: from a
    /// point of the ray close to them nearly all are decided. The truth is integer arithmetic.
    #[test]
    fn triangles_that_are_tiny_and_far_are_decided_from_a_start_close_to_them() {
        let mut random = Random(67);
        let [mut from_eye, mut from_start, mut rays] = [0; 3];
        for _ in 0..4000 {
            let size = crate::math::pow(10.0, -13.0 - 3.0 * random.unit());
            let corners = [(); 3].map(|()| (random.point() * size).as_vec3());
            let eye = random.point() * 3.0;
            let direction = random.point() * size - eye;
            let ray = Ray::new(eye, direction * random.unit());
            let bounds = [DVec3::splat(-size), DVec3::splat(size)];
            let cull = [Cull::None, Cull::Back][rays as usize % 2];
            let prepared = PreparedRay::new(&ray, DVec3::ZERO, cull, Precision::Exact);
            let Some(prepared) = prepared.map(|ray| ray.close_to(bounds)) else {
                continue;
            };
            rays += 1;
            let truth = exact::hit(&ray, &prepared.placed(corners), cull, 0);
            let what = (ray, corners);
            let verdict = prepared.intersect_in_double(0, corners);
            from_eye += u32::from(is_decided(&verdict, truth.as_ref(), what));
            let verdict = prepared.intersect_from_start(0, corners);
            from_start += u32::from(is_decided(&verdict, truth.as_ref(), what));
        }
        assert!(
            rays > 3900 && from_start > rays * 19 / 20,
            "{from_start} of {rays}"
        );
        assert!(from_eye < rays / 2, "{from_eye} of {rays}");
    }

    /// The numerator of this ray's parameter is about 10⁻³⁸⁰, which no double is: not zero, as in a plane that contains
    /// the origin.
    #[test]
    fn a_numerator_less_than_any_double_is_not_zero() {
        let corners = [[1.0, -1.0], [-1.0, -1.0], [2.0, 3.0]]
            .map(|[x, z]| Vec3::new(x, x, z) * 2f32.powi(-132));
        let ray = Ray::new(DVec3::X * 1e-300, DVec3::new(-1.0, 1.0, 0.25));
        let prepared = PreparedRay::new(&ray, DVec3::ZERO, Cull::None, Precision::Exact);
        let prepared = prepared.expect("a valid ray");
        let determinants = prepared.componentwise(corners);
        assert!(determinants.is_some_and(|all| all.have_sure_weights()));
        let hit = prepared.hit_on(0, corners);
        assert!((hit.t - 5e-301).abs() <= 1e-315, "{}", hit.t);
    }

    /// Rays through edges and corners except for rounding: close to the eye and far from it, and with a rounded eye.
    /// The truth is integer arithmetic.
    #[test]
    fn what_double_precision_decides_is_what_integers_decide() {
        let mut random = Random(61);
        for (tree_origin, place) in [
            (DVec3::ZERO, 0.0),
            (DVec3::ZERO, 1e6),
            // Corners are stored relative to the tree's origin, where the eye's position is rounded.
            (DVec3::new(1e7, -0.1, 3e3), 2e7),
            (DVec3::new(1e-9, 2e-9, -1e-9), 3e7),
        ] {
            let [
                mut decided,
                mut decided_from_start,
                mut closely_decided,
                mut decided_from_eye,
                mut widely_decided,
                mut hits,
            ] = [0; 6];
            for _ in 0..8000 {
                let middle = DVec3::new(place, place * 0.7, -place);
                let size = place.max(1.0) * crate::math::pow(10.0, -6.0 * random.unit());
                let mut near = || (middle + random.point() * size).as_vec3();
                let mut corners = [near(), near(), near()];
                if random.unit() < 0.2 {
                    // Seen along z, all corners have the same depth.
                    corners = corners.map(|corner| corner.with_z(corners[0].z));
                }
                let [a, b, c] = corners.map(|corner| tree_origin + corner.as_dvec3());
                let target = match (random.unit() * 4.0) as u32 {
                    0 => a,
                    1 => a + (b - a) * random.unit(),
                    2 => (a + b + c) / 3.0,
                    _ => b + (c - b) * random.unit() + random.point() * (size * 1e-14),
                };
                // Nearly in the triangle's plane, close to it, far from it, or anywhere.
                let beside = random.point() * (size * crate::math::pow(10.0, -9.0 * random.unit()));
                let origin = match (random.unit() * 5.0) as u32 {
                    0 => a + ((b - a) * random.signed() + (c - a) * random.signed()) * 9.0 + beside,
                    1 => target + beside,
                    2 => {
                        let distance = size * crate::math::pow(10.0, 1.0 + 8.0 * random.unit());
                        tree_origin + middle + random.point() * distance
                    }
                    _ => tree_origin + middle + random.point() * (size * 10.0),
                };
                let mut ray = Ray::new(origin, target - origin);
                if random.unit() < 0.3 {
                    // The ray starts or ends at the hit, within some roundings.
                    let t = 1.0 + (random.unit() * 5.0 - 2.0).floor() * f64::EPSILON;
                    (ray.t_min, ray.t_max) = if random.unit() < 0.5 {
                        (t, 9.0)
                    } else {
                        (0.0, t)
                    };
                }
                let prepared = PreparedRay::new(&ray, tree_origin, Cull::None, Precision::Exact);
                let [a, b, c] = corners.map(Vec3::as_dvec3);
                let bounds = [a.min(b).min(c), a.max(b).max(c)];
                let prepared = prepared.expect("a valid ray").close_to(bounds);
                let truth = exact::hit(&ray, &prepared.placed(corners), Cull::None, 0);
                let verdicts = [
                    (prepared.intersect_in_double(0, corners), &mut decided),
                    (
                        prepared.intersect_from_start(0, corners),
                        &mut decided_from_start,
                    ),
                    (
                        prepared.intersect_componentwise(0, corners),
                        &mut closely_decided,
                    ),
                    (
                        prepared.intersect_from_eye(0, corners, &EyeTriangle::default()),
                        &mut decided_from_eye,
                    ),
                    (
                        prepared.intersect_in_double_double(0, corners, &EyeTriangle::default()),
                        &mut widely_decided,
                    ),
                ];
                for (verdict, decided) in verdicts {
                    *decided += u32::from(is_decided(&verdict, truth.as_ref(), (ray, corners)));
                }
                hits += u32::from(truth.is_some());
            }
            assert!(hits > 1000, "{hits}");
            assert!(decided > 300, "{decided}");
            assert!(decided_from_start > 300, "{decided_from_start}");
            assert!(closely_decided > 200, "{closely_decided} of {decided}");
            assert!(decided_from_eye > 2000, "{decided_from_eye}");
            assert!(widely_decided > 1500, "{widely_decided}");
        }
    }
}
