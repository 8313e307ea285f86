//! A ray's closest triangle, by exact arithmetic.
//!
//! A filter in double precision, with bounds that are proven beside it, excludes triangles that a ray certainly
//! misses; every other triangle is decided exactly. So no answer depends on rounding.

use crate::filter::Filter;
use crate::hit::{ExactHit, ExactRay};
use crate::tree::Tree;
use crate::{HalfSpace, Ray, Triangle, Truth};
use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// Triangles, prepared for queries.
///
/// A ray hits a triangle where the three determinants of the direction and two corners (relative to its origin) are
/// all ≥ 0 or all ≤ 0 and not all zero, and `t_min < t ≤ t_max`: edges and vertices belong to all triangles that have
/// them, and a triangle without area is never hit. A triangle with a corner that is not finite is never hit either; a
/// ray with a number that is not finite (but for a `t_max` of +infinity), or a direction of length zero, hits
/// nothing.
#[derive(Clone, Debug)]
pub struct Oracle {
    triangles: Vec<Triangle>,
    tree: Tree,
    /// The index of each triangle, in the order of their numbers.
    by_number: Vec<u32>,
    /// Half-spaces that must contain a hit's point.
    half_spaces: Vec<HalfSpace>,
}

impl Oracle {
    /// The oracle of these triangles; their numbers must be distinct.
    pub fn new(mut triangles: Vec<Triangle>) -> Self {
        triangles.retain(|triangle| triangle.rounded().iter().all(|corner| corner.is_finite()));
        let tree = Tree::new(&mut triangles);
        let mut by_number: Vec<u32> = (0..triangles.len() as u32).collect();
        by_number.sort_unstable_by_key(|&at| triangles[at as usize].number());
        Self {
            triangles,
            tree,
            by_number,
            half_spaces: Vec::new(),
        }
    }

    /// The same oracle, in which only hits inside all of these half-spaces count.
    #[must_use]
    pub fn clipped(self, half_spaces: Vec<HalfSpace>) -> Self {
        Self {
            half_spaces,
            ..self
        }
    }

    /// The oracle of triangles given by their corners, all of object 0 and numbered in order.
    pub fn from_corners(corners: &[[Vec3; 3]]) -> Self {
        let triangle = |(triangle, &corners)| Triangle {
            object: 0,
            triangle: triangle as u32,
            base: DVec3::ZERO,
            corners,
        };
        Self::new(corners.iter().enumerate().map(triangle).collect())
    }

    /// The closest triangle that `ray` hits; ties go to the lowest object, then the lowest triangle. With
    /// `cull_backs`, only triangles whose corners run counter-clockwise as the ray sees them.
    pub fn closest_hit(&self, ray: &Ray, cull_backs: bool) -> Option<Truth> {
        self.closest_hit_in(ray, cull_backs, &self.half_spaces)
    }

    /// The closest of the hits for which `accepts` holds.
    pub fn closest_hit_where(
        &self,
        ray: &Ray,
        cull_backs: bool,
        accepts: impl Fn(&Truth) -> bool,
    ) -> Option<Truth> {
        self.closest_hit_filtered(ray, cull_backs, &self.half_spaces, accepts)
    }

    /// [`Oracle::closest_hit`], clipped to these half-spaces instead of its own.
    pub fn closest_hit_in(
        &self,
        ray: &Ray,
        cull_backs: bool,
        half_spaces: &[HalfSpace],
    ) -> Option<Truth> {
        self.closest_hit_filtered(ray, cull_backs, half_spaces, |_| true)
    }

    fn closest_hit_filtered(
        &self,
        ray: &Ray,
        cull_backs: bool,
        half_spaces: &[HalfSpace],
        accepts: impl Fn(&Truth) -> bool,
    ) -> Option<Truth> {
        if !ray.is_valid() {
            return None;
        }
        closest_of(self.possible(ray), ray, cull_backs, half_spaces, accepts)
    }

    /// All triangles that `ray` hits, nearest first; equal distances go by object, then by triangle.
    pub fn hits_in_order(&self, ray: &Ray, cull_backs: bool) -> Vec<Truth> {
        if !ray.is_valid() {
            return Vec::new();
        }
        let exact_ray = ExactRay::new(ray);
        let possible = self.possible(ray).into_iter();
        let mut hits: Vec<ExactHit<'_>> = possible
            .filter_map(|triangle| exact_ray.hit(triangle, cull_backs))
            .filter(|hit| hit.is_in(&exact_ray, &self.half_spaces))
            .collect();
        hits.sort_by(ExactHit::order);
        hits.iter().map(|hit| hit.rounded(ray)).collect()
    }

    /// The triangles that a valid ray may hit.
    fn possible(&self, ray: &Ray) -> Vec<&Triangle> {
        let filter = Filter::new(ray);
        let mut possible = Vec::new();
        self.tree.visit(&filter, |ball| {
            let inside = self.triangles[ball].iter();
            possible.extend(inside.filter(|triangle| !filter.misses_triangle(triangle)));
        });
        possible
    }

    /// [`Oracle::closest_hit`], deciding every triangle exactly, without filter and tree.
    pub fn brute_force(&self, ray: &Ray, cull_backs: bool) -> Option<Truth> {
        if !ray.is_valid() {
            return None;
        }
        closest_of(&self.triangles, ray, cull_backs, &self.half_spaces, |_| {
            true
        })
    }

    /// How `ray` hits the triangle with these numbers, whether or not others are nearer; `None` where it misses, or
    /// where the triangle does not exist.
    pub fn intersect(
        &self,
        object: u32,
        triangle: u32,
        ray: &Ray,
        cull_backs: bool,
    ) -> Option<Truth> {
        let triangle = self.triangle(object, triangle)?;
        if !ray.is_valid() {
            return None;
        }
        let exact_ray = ExactRay::new(ray);
        let hit = exact_ray.hit(triangle, cull_backs)?;
        hit.is_in(&exact_ray, &self.half_spaces)
            .then(|| hit.rounded(ray))
    }

    /// The triangle with these numbers.
    pub fn triangle(&self, object: u32, triangle: u32) -> Option<&Triangle> {
        let number = |at: u32| self.triangles[at as usize].number();
        let found = self
            .by_number
            .binary_search_by_key(&(object, triangle), |&at| number(at))
            .ok()?;
        Some(&self.triangles[self.by_number[found] as usize])
    }

    /// All triangles, in an order in which neighbours are close.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }
}

fn closest_of<'a>(
    triangles: impl IntoIterator<Item = &'a Triangle>,
    ray: &Ray,
    cull_backs: bool,
    half_spaces: &[HalfSpace],
    accepts: impl Fn(&Truth) -> bool,
) -> Option<Truth> {
    let exact_ray = ExactRay::new(ray);
    let mut closest_hit: Option<ExactHit<'_>> = None;
    for triangle in triangles {
        if let Some(hit) = exact_ray.hit(triangle, cull_backs)
            && closest_hit
                .as_ref()
                .is_none_or(|best| hit.order(best) == Ordering::Less)
            && hit.is_in(&exact_ray, half_spaces)
            && accepts(&hit.rounded(ray))
        {
            closest_hit = Some(hit);
        }
    }
    closest_hit.map(|hit| hit.rounded(ray))
}

#[cfg(test)]
mod tests {
    use super::Oracle;
    use crate::random::Random;
    use crate::{HalfSpace, Ray};
    use glam::{DVec3, Vec3};

    const UNIT: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    fn down(x: f64, y: f64) -> Ray {
        Ray::new(DVec3::new(x, y, 5.0), DVec3::NEG_Z)
    }

    #[test]
    fn a_triangle_that_pencil_and_paper_solve() {
        let oracle = Oracle::from_corners(&[UNIT]);
        let hit = oracle
            .closest_hit(&down(0.25, 0.5), false)
            .expect("a hit inside");
        assert_eq!((hit.object, hit.triangle), (0, 0));
        assert_eq!((hit.t, hit.u, hit.v), (5.0, 0.25, 0.5));
        assert_eq!(hit.cosine, 1.0);
        for (x, y, is_hit) in [
            (0.0, 0.0, true),
            (1.0, 0.0, true),
            (0.5, 0.5, true),
            (0.0, 0.3, true),
            (0.5, 0.5f64.next_up(), false),
            (-f64::from_bits(1), 0.5, false),
            (1.0, f64::from_bits(1), false),
            (2.0, 2.0, false),
        ] {
            let hit = oracle.closest_hit(&down(x, y), false);
            assert_eq!(hit.is_some(), is_hit, "{x} {y}");
        }
    }

    #[test]
    fn the_range_begins_behind_t_min_and_includes_t_max() {
        let oracle = Oracle::from_corners(&[UNIT]);
        let hit = |t_min, t_max| {
            let ray = Ray {
                t_min,
                t_max,
                ..down(0.2, 0.2)
            };
            oracle.closest_hit(&ray, false).is_some()
        };
        assert!(hit(5f64.next_down(), 5.0));
        assert!(!hit(5.0, 9.0));
        assert!(!hit(0.0, 5f64.next_down()));
        assert!(hit(0.0, f64::INFINITY) && hit(-1.0, f64::MAX));
        assert!(!hit(0.0, f64::NAN) && !hit(0.0, f64::NEG_INFINITY));
        assert!(!hit(f64::NEG_INFINITY, 9.0) && !hit(f64::INFINITY, f64::INFINITY));
        let away = Ray::new(DVec3::new(0.2, 0.2, 5.0), DVec3::Z);
        assert_eq!(oracle.closest_hit(&away, false), None);
        // Backwards: t counts in the opposite direction.
        let behind = |t_min, t_max| {
            let ray = Ray {
                t_min,
                t_max,
                ..away
            };
            oracle.closest_hit(&ray, false).is_some()
        };
        assert!(behind(-9.0, -5.0) && behind(-9.0, f64::INFINITY));
        assert!(!behind(-5.0, 0.0) && !behind(-9.0, (-5f64).next_down()));
    }

    #[test]
    fn a_triangle_that_only_touches_the_eye_is_not_hit() {
        let oracle = Oracle::from_corners(&[UNIT, UNIT.map(|p| p - Vec3::Z)]);
        for eye in [
            DVec3::ZERO,
            DVec3::new(0.5, 0.0, 0.0),
            DVec3::new(0.2, 0.2, 0.0),
        ] {
            let ray = Ray::new(eye, DVec3::new(0.01, 0.02, -1.0));
            let hit = oracle.closest_hit(&ray, false).expect("the one below");
            assert_eq!((hit.triangle, hit.t), (1, 1.0));
            let open = Ray {
                t_min: -1e-9,
                ..ray
            };
            let hit = oracle
                .closest_hit(&open, false)
                .expect("the one at the eye");
            assert_eq!((hit.triangle, hit.t), (0, 0.0));
        }
    }

    #[test]
    fn fronts_run_counter_clockwise_to_the_ray() {
        // Seen from +Z, with X to the right and Y up, 0 → X → Y is counter-clockwise.
        let [a, b, c] = UNIT;
        let front = Oracle::from_corners(&[[a, b, c]]);
        let back = Oracle::from_corners(&[[a, c, b]]);
        let ray = down(0.2, 0.2);
        assert!(front.closest_hit(&ray, true).is_some());
        assert!(back.closest_hit(&ray, true).is_none());
        let from_below = Ray::new(DVec3::new(0.2, 0.2, -5.0), DVec3::Z);
        assert!(front.closest_hit(&from_below, true).is_none());
        assert!(back.closest_hit(&from_below, true).is_some());
    }

    #[test]
    fn equal_distances_go_to_the_lowest_number_and_nearer_wins() {
        let [a, b, c] = UNIT;
        let nearer = UNIT.map(|p| p + Vec3::Z * f32::EPSILON);
        let oracle = Oracle::from_corners(&[UNIT, [b, a, c], nearer, [c, b, a]]);
        let hit = oracle.closest_hit(&down(0.2, 0.2), false).expect("a hit");
        assert_eq!(hit.triangle, 2);
        let from_below = Ray::new(DVec3::new(0.2, 0.2, -5.0), DVec3::Z);
        let hit = oracle.closest_hit(&from_below, false).expect("a hit");
        assert_eq!(hit.triangle, 0);
    }

    /// Each next hit is the closest of those that are left.
    #[test]
    fn hits_in_order_are_the_closest_ones_after_one_another() {
        let mut random = Random::new(5);
        let mut most = 0;
        for round in 0..40 {
            // Some of them in one plane, so that distances are equal.
            let flat = if round % 2 == 0 { 0.0 } else { 1.0 };
            let mut corner = || random.in_cube() * DVec3::new(1.0, 1.0, flat);
            let corners: Vec<[Vec3; 3]> = (0..60)
                .map(|_| std::array::from_fn(|_| corner().as_vec3()))
                .collect();
            let oracle = Oracle::from_corners(&corners).clipped(vec![HalfSpace {
                normal: DVec3::new(1.0, 0.2, -0.1),
                offset: -0.3,
            }]);
            for _ in 0..20 {
                let from = random.in_cube() + DVec3::Z * 3.0;
                let ray = Ray::new(from, random.in_cube() * 0.5 - from);
                for cull in [false, true] {
                    let hits = oracle.hits_in_order(&ray, cull);
                    most = most.max(hits.len());
                    let mut seen = Vec::new();
                    for hit in hits {
                        let is_left = |truth: &crate::Truth| !seen.contains(&truth.triangle);
                        let next = oracle.closest_hit_where(&ray, cull, is_left);
                        assert_eq!(next, Some(hit));
                        seen.push(hit.triangle);
                    }
                    let is_left = |truth: &crate::Truth| !seen.contains(&truth.triangle);
                    assert_eq!(oracle.closest_hit_where(&ray, cull, is_left), None);
                }
            }
        }
        assert!(most > 8, "{most}");
    }

    #[test]
    fn a_ray_in_the_plane_and_a_triangle_without_area_are_misses() {
        let oracle = Oracle::from_corners(&[UNIT]);
        let along = Ray::new(DVec3::new(-1.0, 0.2, 0.0), DVec3::X);
        assert_eq!(oracle.closest_hit(&along, false), None);
        let flat = Oracle::from_corners(&[[Vec3::ZERO, Vec3::X, Vec3::X * 2.0], [Vec3::ONE; 3]]);
        assert_eq!(flat.closest_hit(&down(0.5, 0.0), false), None);
        assert_eq!(flat.closest_hit(&down(1.0, 1.0), false), None);
    }

    /// The filter excludes no triangle that is hit: over many decades, with rays at the hardest targets. The truth is
    /// the same rule without the filter.
    #[test]
    fn the_filter_changes_no_answer() {
        let mut random = Random::new(3);
        let mut hits = 0;
        for round in 0..300 {
            let scale = random.decade(-12.0, 12.0);
            let middle = random.in_cube() * scale * random.decade(-3.0, 4.0);
            let size = random.decade(-4.0, 0.0);
            let corners: Vec<[Vec3; 3]> = (0..40)
                .map(|_| {
                    let place = random.in_cube() * scale + middle;
                    std::array::from_fn(|_| (place + random.in_cube() * scale * size).as_vec3())
                })
                .collect();
            let oracle = Oracle::from_corners(&corners);
            for _ in 0..10 {
                let origin = middle + random.in_cube() * scale * random.decade(-1.0, 2.0);
                let [a, b, c] = corners[random.below(40) as usize].map(|p| p.as_dvec3());
                let target = match random.below(4) {
                    0 => a,
                    1 => (a + b) * 0.5,
                    2 => (a + b + c) / 3.0,
                    _ => middle + random.in_cube() * scale,
                };
                let direction = (random.nudge(target, 2) - origin) * random.decade(-9.0, 9.0);
                let ray = Ray::new(origin, direction);
                let plain = oracle.brute_force(&ray, false);
                assert_eq!(oracle.closest_hit(&ray, false), plain, "{round}: {ray:?}");
                hits += u32::from(plain.is_some());
            }
        }
        assert!(hits > 1000, "only {hits} hits");
    }

    /// Products leave the range of double precision long before coordinates do.
    #[test]
    fn origins_at_the_end_of_the_doubles_are_answered() {
        let oracle = Oracle::from_corners(&[UNIT]);
        for far in [1e100, 1e155, 1e200, 1e307] {
            for target in [DVec3::new(0.25, 0.25, 0.0), DVec3::new(2.0, 2.0, 0.0)] {
                let ray = Ray::new(target + DVec3::Z * far, DVec3::NEG_Z);
                let truth = oracle.closest_hit(&ray, false);
                assert_eq!(truth, oracle.brute_force(&ray, false));
                assert_eq!(truth.is_some(), target.x < 1.0, "{far}");
            }
        }
    }

    #[test]
    fn only_what_lies_in_every_half_space_counts_and_their_borders_do() {
        let below = UNIT.map(|p| p - Vec3::Z);
        let oracle = |normal: DVec3, offset| {
            let half_spaces = vec![HalfSpace { normal, offset }];
            Oracle::from_corners(&[UNIT, below]).clipped(half_spaces)
        };
        let hit = |oracle: &Oracle, x| {
            let ray = down(x, 0.25);
            let found = oracle.closest_hit(&ray, false);
            assert_eq!(found, oracle.brute_force(&ray, false));
            found.map(|hit| hit.triangle)
        };
        let right = oracle(DVec3::X * 3.0, 1.5);
        assert_eq!(hit(&right, 0.5), Some(0));
        assert_eq!(hit(&right, 0.5f64.next_down()), None);
        let left = oracle(DVec3::NEG_X, -0.5);
        assert_eq!(hit(&left, 0.5), Some(0));
        assert_eq!(hit(&left, 0.5f64.next_up()), None);
        // The nearer triangle is clipped away, so the one below is hit.
        let low = oracle(DVec3::NEG_Z, 0.5);
        assert_eq!(hit(&low, 0.5), Some(1));
        assert_eq!(low.intersect(0, 0, &down(0.5, 0.25), false), None);
        // Points on the plane are kept, whichever side is.
        for normal in [DVec3::Z, DVec3::NEG_Z] {
            assert_eq!(hit(&oracle(normal, 0.0), 0.5), Some(0));
        }
    }

    #[test]
    fn a_given_triangle_is_hit_even_behind_others() {
        let [a, b, c] = UNIT;
        let nearer = UNIT.map(|p| p + Vec3::Z);
        let oracle = Oracle::from_corners(&[UNIT, nearer, [b, b + b, c], [a, c, b]]);
        let ray = down(0.25, 0.25);
        let at = |triangle, cull| oracle.intersect(0, triangle, &ray, cull).map(|hit| hit.t);
        assert_eq!(at(0, false), Some(5.0));
        assert_eq!(at(1, false), Some(4.0));
        assert_eq!(at(2, false), None);
        assert_eq!((at(3, false), at(3, true)), (Some(5.0), None));
        assert_eq!(at(4, false), None);
        assert_eq!(oracle.intersect(1, 0, &ray, false), None);
        assert_eq!(oracle.triangle(0, 1).map(|t| t.corners), Some(nearer));
    }
}
