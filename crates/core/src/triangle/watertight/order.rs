//! Which of two hits of a ray comes first, where their errors overlap.

use super::{PreparedRay, Verdict};
use crate::hit::Precision;
use crate::num::roundoff::EPSILON;
use crate::triangle::BoundedHit;
use crate::triangle::componentwise::Determinant;
use crate::triangle::coplanar::share_plane_of_axis;
use crate::triangle::exact;
use crate::triangle::plane::{LEAST_SURE, Plane, side_of_plane};
use glam::Vec3;
use std::cmp::Ordering;

impl PreparedRay {
    /// Which of two hits comes first along the ray; of two at one distance, the lower primitive id.
    pub(crate) fn order(
        &self,
        first: &BoundedHit,
        second: &BoundedHit,
        corners: impl Fn(u32) -> [Vec3; 3],
        id: impl Fn(u32) -> u32,
    ) -> Ordering {
        if first.is_surely_before(second) {
            return Ordering::Less;
        }
        if second.is_surely_before(first) {
            return Ordering::Greater;
        }
        let by_id = || id(first.primitive).cmp(&id(second.primitive));
        self.compare(first, second, corners).then_with(by_id)
    }

    /// Which of two hits is nearer, where their errors overlap.
    pub(super) fn compare(
        &self,
        candidate: &BoundedHit,
        nearest: &BoundedHit,
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
        if share_plane_of_axis(first.1, second.1) || self.meet_at_corner([first.1, second.1]) {
            return Ordering::Equal;
        }
        let placed = [(candidate, first.1), (nearest, second.1)];
        if let Some(order) = self.compare_by_planes(placed) {
            return order;
        }
        let closely =
            [first, second].map(|(primitive, at)| self.intersect_componentwise(primitive, at));
        if let Some(order) = order_of(closely) {
            return order;
        }
        self.was_exact.set(true);
        if let Some(order) = self.compare_by_exact_planes(placed) {
            return order;
        }
        let more = [first, second].map(|(primitive, at)| {
            self.with_shared(primitive, |from_eye| {
                self.intersect_in_double_double(primitive, at, from_eye)
            })
        });
        if let Some(order) = order_of(more) {
            return order;
        }
        let [candidate, nearest] =
            [candidate, nearest].map(|hit| self.placed(corners(hit.primitive)));
        // Both are known to be hits.
        exact::compare(&self.ray, &candidate, &nearest, self.cull).unwrap_or(Ordering::Greater)
    }

    /// Which of two hits is nearer, by the plane of either triangle and the corners of the other; `None` where that is
    /// not sure.
    fn compare_by_planes(&self, hits: [PlacedHit; 2]) -> Option<Ordering> {
        by_either_plane(hits, |(hit, corners), (_, of)| {
            let plane = Plane::new(of).turned_along(self.ray.direction, 0.0)?;
            side_of_plane(corners.map(|corner| plane.distance(corner)), hit)
        })
    }

    /// The same by exact distances from the planes: `Equal` where both triangles lie in one.
    fn compare_by_exact_planes(&self, hits: [PlacedHit; 2]) -> Option<Ordering> {
        by_either_plane(hits, |(hit, corners), (plane, of)| {
            let distances = self.exact_distances((hit.primitive, corners), (plane.primitive, of));
            if distances == [0.0; 3] {
                return Some(0.0);
            }
            let turned = Plane::new(of).turned_along(self.ray.direction, 0.0)?;
            let distances = turned.with_bounds(distances);
            side_of_plane(distances, hit).or_else(|| {
                let weights = self.closest_weights(hit.primitive, corners)?;
                side_by_weights(distances, weights)
            })
        })
    }

    /// The distances of a triangle's corners from another's plane, computed exactly and rounded.
    fn exact_distances(&self, triangle: Placed, plane: Placed) -> [f64; 3] {
        match &self.shared {
            Some(shared) => shared.distances_from_plane(triangle, plane),
            None => exact::distances_from_plane(triangle.1, plane.1),
        }
    }
}

/// A triangle's primitive index and its corners.
type Placed = (u32, [Vec3; 3]);

/// A hit, and the corners of its triangle.
type PlacedHit<'a> = (&'a BoundedHit, [Vec3; 3]);

/// Which of two hits is nearer. `side` says where its first hit lies from the plane of the second one's triangle:
/// positive behind it, zero in it; `None` where that is not sure.
#[inline(always)]
fn by_either_plane(
    [a, b]: [PlacedHit; 2],
    side: impl Fn(PlacedHit, PlacedHit) -> Option<f64>,
) -> Option<Ordering> {
    let against = |hit, plane| side(hit, plane)?.partial_cmp(&0.0);
    against(a, b).or_else(|| against(b, a).map(Ordering::reverse))
}

/// On which side of a plane a triangle's hit lies, as [`side_of_plane`] says it, by weights that each have an error of
/// their own: next to a corner in the plane the hit's distance is as small as the weights of the other corners.
///
/// Each product is rounded, and the sum twice: 3ε of the terms' magnitudes, and one ε for the bound itself.
fn side_by_weights(distances: [(f64, f64); 3], weights: [Determinant; 3]) -> Option<f64> {
    let (mut value, mut error, mut sum) = (0.0, 0.0, 0.0);
    for ((distance, distance_error), weight) in distances.into_iter().zip(weights) {
        let size = weight.value.abs() + weight.error;
        value += distance * weight.value;
        error += distance.abs() * (weight.error + 4.0 * EPSILON * size) + distance_error * size;
        sum += weight.value;
    }
    // The weights of a hit have one sign. That of the side is the value's in units of their sum.
    let is_sure = value.abs() > error + LEAST_SURE;
    is_sure.then(|| value.signum() * sum.signum())
}

/// Which of two hits is surely nearer; `None` where their intervals overlap.
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

/// Whether two triangles have the same corners, in any order.
fn same_corners(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    a.iter().all(|p| b.contains(p)) && b.iter().all(|p| a.contains(p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hit::{Cull, Detail};
    use crate::num::double_double::DoubleDouble;
    use crate::random::Random;
    use crate::ray::Ray;
    use crate::triangle::SharedTriangles;
    use glam::DVec3;
    use std::rc::Rc;

    fn weight(value: f64, error: f64) -> Determinant {
        Determinant { value, error }
    }

    /// With the error of weights at zero this fails.
    #[test]
    fn sums_within_the_error_of_weights_decide_nothing() {
        let distances = [(1.0, 0.0), (-1.0, 0.0), (0.0, 0.0)];
        let side = |more: f64, sign: f64| {
            let weights = [1.0 + more, 1.0, 1.0].map(|value| weight(sign * value, 1e-9));
            side_by_weights(distances, weights)
        };
        for sign in [1.0, -1.0] {
            assert_eq!([side(1.9e-9, sign), side(-1.9e-9, sign)], [None; 2]);
            assert_eq!(
                [side(2.1e-9, sign), side(-2.1e-9, sign)],
                [Some(1.0), Some(-1.0)]
            );
        }
    }

    /// With the error of distances at zero this fails.
    #[test]
    fn sums_within_the_error_of_distances_decide_nothing() {
        let weights = [weight(1.0, 0.0); 3];
        let side = |more: f64| {
            let distances = [(1.0 + more, 1e-9), (-1.0, 1e-9), (0.0, 0.0)];
            side_by_weights(distances, weights)
        };
        assert_eq!([side(1.9e-9), side(-1.9e-9)], [None; 2]);
        assert_eq!([side(2.1e-9), side(-2.1e-9)], [Some(1.0), Some(-1.0)]);
    }

    /// Distances and weights are exact, and their sum cancels but for rounding. The truth is double-double arithmetic.
    /// With the term for roundings at zero this fails.
    #[test]
    fn sums_within_their_roundings_decide_nothing() {
        let mut random = Random(68);
        let mut decided = 0;
        for _ in 0..20_000 {
            let [a, b, c] = [(); 3].map(|()| random.unit());
            let [s, t] = [(); 2].map(|()| random.signed());
            let last = -(s * a + t * b) / c;
            let distances = [s, t, last].map(|distance| (distance, 0.0));
            let side = side_by_weights(distances, [a, b, c].map(|value| weight(value, 0.0)));
            let product = |x: f64, y: f64| DoubleDouble::from(x) * DoubleDouble::from(y);
            let truth = product(s, a) + product(t, b) + product(last, c);
            if let Some(side) = side {
                assert_eq!(side, truth.high.signum(), "{s} {t} {last} {a} {b} {c}");
                decided += 1;
            }
        }
        assert!(decided < 2000, "{decided}");
    }

    /// Triangles that share a corner next to which the rays start, so that they hit all of them next to it: alone, and
    /// sharing what they know of triangles. The truth is integer arithmetic.
    #[test]
    fn hits_next_to_a_corner_of_both_are_ordered_as_integers_order_them() {
        let mut random = Random(69);
        let least = f64::from(f32::from_bits(1));
        let mut hits = 0;
        for round in 0..3000 {
            let mut corner = || {
                let [x, y] = [(); 2].map(|()| (random.signed() * 3.0).round());
                let z = x - 2.0 * y;
                let off = (random.signed() * 4.0).round() * 1e3 * least;
                DVec3::new(x, y, if z == 0.0 { off } else { z }).as_vec3()
            };
            let pair = [(); 2].map(|()| [Vec3::ZERO, corner(), corner()]);
            let eye = random.point() * [1e-30, 1e-40][round % 2];
            let inside = (pair[0][1] + pair[0][2]).as_dvec3() * random.unit() * 1e-29;
            let ray = Ray::new(eye, inside - eye);
            let prepared = PreparedRay::new(&ray, DVec3::ZERO, Cull::None, Precision::Exact);
            let Some(alone) = prepared else { continue };
            let [a, b] = pair.map(|corners| alone.placed(corners));
            let truth = exact::compare(&ray, &a, &b, Cull::None);
            let shared = Rc::new(SharedTriangles::new(true));
            let of_both =
                |ray: &PreparedRay| [0, 1].map(|which| ray.hit_on(which, pair[which as usize]));
            for detail in [None, Some(Detail::Full), Some(Detail::Triangle)] {
                let ray = match detail {
                    Some(detail) => alone.clone().sharing(&shared, detail),
                    None => alone.clone(),
                };
                let [a, b] = of_both(&ray);
                assert_eq!(
                    !a.is_miss() && !b.is_miss(),
                    truth.is_some(),
                    "{pair:?} {ray:?}"
                );
                if let Some(truth) = truth {
                    let order = ray.order(&a, &b, |which| pair[which as usize], |_| 0);
                    assert_eq!(order, truth, "{pair:?} {ray:?}");
                    hits += 1;
                }
                if detail == Some(Detail::Full) {
                    let bits = |[a, b]: [BoundedHit; 2]| {
                        [a, b].map(|hit| [hit.t, hit.u, hit.v].map(f64::to_bits))
                    };
                    assert_eq!(bits(of_both(&ray)), bits(of_both(&alone)));
                }
            }
        }
        assert!(hits > 900, "{hits}");
    }

    /// Rays through two vertices, each with triangles around it, some of them in the ray's plane, and through others
    /// inside or beside. The truth is integer arithmetic.
    #[test]
    fn of_many_triangles_around_a_vertex_the_closest_is_as_integers_say() {
        let mut random = Random(70);
        let (mut at_vertices, mut misses) = (0, 0);
        for _ in 0..400 {
            let mut near = |point: Vec3| {
                let [x, y, z] = [(); 3].map(|()| (random.signed() * 4.0).round() as f32);
                point + Vec3::new(x, y, z)
            };
            let (eye, along) = (near(Vec3::ZERO), near(Vec3::ZERO));
            let vertices = [4.0, 5.0].map(|steps| eye + along * steps);
            let triangles: Vec<[Vec3; 3]> = (0..24)
                .map(|number| {
                    let vertex = vertices[number % 2];
                    let first = if number < 16 { vertex } else { near(vertex) };
                    let mut corners = [first, near(vertex), near(vertex)];
                    corners.rotate_left(number % 3);
                    corners
                })
                .collect();
            for cull in [Cull::None, Cull::Back] {
                let ray = Ray::new(eye.as_dvec3(), along.as_dvec3());
                let prepared = PreparedRay::new(&ray, DVec3::ZERO, cull, Precision::Exact);
                let Some(prepared) = prepared else { continue };
                let mut truth = None;
                for (number, &corners) in triangles.iter().enumerate() {
                    let placed = prepared.placed(corners);
                    if exact::hit(&ray, &placed, cull, 0).is_none() {
                        continue;
                    }
                    let is_first = truth.is_none_or(|best: usize| {
                        let best = prepared.placed(triangles[best]);
                        let order = exact::compare(&ray, &placed, &best, cull);
                        order == Some(Ordering::Less)
                    });
                    if is_first {
                        truth = Some(number);
                    }
                }
                let count = triangles.len();
                for (from, step) in [(0, 1), (count - 1, count - 1), (5, 7), (11, 5)] {
                    let prepared = prepared.clone();
                    let mut nearest = BoundedHit::NONE;
                    for turn in 0..count {
                        let primitive = ((from + turn * step) % count) as u32;
                        let corners = |primitive: u32| triangles[primitive as usize];
                        prepared.intersect(primitive, corners, |primitive| primitive, &mut nearest);
                    }
                    let found = (!nearest.is_miss()).then_some(nearest.primitive as usize);
                    assert_eq!(found, truth, "{triangles:?} {ray:?}");
                    at_vertices += u32::from(prepared.corner.get().is_some());
                }
                misses += u32::from(truth.is_none());
            }
        }
        assert!(at_vertices > 1000 && misses < 200, "{at_vertices} {misses}");
    }
}
