//! Whether a point of a triangle is visible from another eye.

use super::{Clipped, traversal};
use crate::hit::{Cull, Precision, PrimitiveHit};
use crate::ray::Ray;
use crate::triangle::{BoundedHit, PreparedRay};
use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// The least barycentric weight that a point is given at each corner: the rounding error of a weight near one in
/// single precision, so that the point moves by no more than its weights are known to.
const LEAST_WEIGHT: f64 = f32::EPSILON as f64 / 2.0;

impl Clipped<'_> {
    /// Whether the point of a hit is visible from `eye`, in world space: no other triangle that planes and masks keep
    /// is exactly nearer along the ray from the eye to the point. A triangle at the same distance hides nothing.
    ///
    /// The point is computed from the hit's weights, each raised to at least 2⁻²⁴ and divided by their sum. So it is
    /// strictly inside the triangle: a neighbour cannot hide it where the two join in a fold, and the ray, whose
    /// direction is rounded to double precision, still hits the triangle, as it must to count. If the triangle is too
    /// far away for that, with a height below some 2⁻²⁶ of its distance, the point is the triangle's middle. If the
    /// ray does not hit the triangle there either, because it is edge-on or culled, the point is not visible.
    pub(crate) fn is_seen_from(&self, eye: DVec3, hit: &PrimitiveHit, cull: Cull) -> bool {
        let origin = self.accel.origin;
        let [a, b, c] = self.accel.corners(hit.primitive).map(Vec3::as_dvec3);
        let third = 1.0 / 3.0;
        for [u, v] in [inner(hit.u, hit.v), [third; 2]] {
            let point = a + (b - a) * u + (c - a) * v;
            let ray = Ray::new(eye, point - (eye - origin));
            let Some(ray) = self.accel.prepare(&ray, cull, Precision::Exact) else {
                continue;
            };
            let mut own = BoundedHit::NONE;
            self.accel.intersect(&ray, hit.primitive, &mut own);
            if !own.is_miss() {
                return !self.is_hidden(&ray, &own);
            }
        }
        false
    }

    /// Whether a ray hits another triangle before its own.
    fn is_hidden(&self, ray: &PreparedRay, own: &BoundedHit) -> bool {
        let accel = self.accel;
        let is_nearer = |other: &BoundedHit| {
            let order = || ray.order(other, own, |primitive| accel.corners(primitive), |_| 0);
            !own.is_surely_before(other) && order() == Ordering::Less
        };
        let mut is_hidden = false;
        traversal::visit(accel, &self.clip, ray, |primitives| {
            for primitive in primitives.filter(|&primitive| primitive != own.primitive) {
                let mut other = BoundedHit::NONE;
                accel.intersect(ray, primitive, &mut other);
                if !other.is_miss() && is_nearer(&other) && self.keeps(ray, &other) {
                    is_hidden = true;
                    // Every box begins beyond this.
                    return BoundedHit {
                        t: f64::NEG_INFINITY,
                        ..*own
                    };
                }
            }
            *own
        });
        is_hidden
    }
}

/// The weights of the second and third corner, with at least [`LEAST_WEIGHT`] at each corner.
fn inner(u: f32, v: f32) -> [f64; 2] {
    let [u, v] = [u, v].map(f64::from);
    let [a, b, c] = [1.0 - u - v, u, v].map(|weight| weight.max(LEAST_WEIGHT));
    let sum = a + b + c;
    [b / sum, c / sum]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Accel;
    use crate::random::Random;
    use crate::scene::{ClippingPlane, ClippingPlanes, Mesh, MeshData, Object, Scene};
    use std::sync::Arc;

    fn accel(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Accel {
        let mesh = Mesh::new(MeshData {
            positions,
            triangles,
            ..MeshData::default()
        });
        let scene = Scene {
            objects: vec![Object::new("mesh", Arc::new(mesh))],
        };
        Accel::build(&scene).expect("a valid scene")
    }

    fn hit(primitive: u32, u: f32, v: f32) -> PrimitiveHit {
        PrimitiveHit {
            primitive,
            t: 1.0,
            u,
            v,
        }
    }

    /// Visibility by the closest hit over all triangles: visible where that is the triangle itself, or not nearer.
    fn by_all(accel: &Accel, planes: &ClippingPlanes, eye: DVec3, at: &PrimitiveHit) -> bool {
        let [a, b, c] = accel.corners(at.primitive).map(Vec3::as_dvec3);
        let [u, v] = inner(at.u, at.v);
        let point = a + (b - a) * u + (c - a) * v + accel.origin;
        let ray = Ray::new(eye, point - eye);
        let nearest = accel.clipped(planes).cast_brute_force(&ray, Cull::None);
        nearest.is_none_or(|nearest| {
            let is_own = (nearest.object, nearest.triangle) == accel.identify(at.primitive);
            is_own || nearest.t >= 1.0
        })
    }

    #[test]
    fn the_tree_answers_as_all_triangles_do() {
        let mut random = Random(11);
        let positions: Vec<DVec3> = (0..200)
            .flat_map(|_| {
                let center = random.point();
                [0; 3].map(|_| center + random.point() * 0.4)
            })
            .collect();
        let triangles = (0..200).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let accel = accel(positions, triangles);
        let plane = ClippingPlane::new(DVec3::new(1.0, 0.3, 0.2), -0.2).expect("a plane");
        for planes in [
            ClippingPlanes::NONE,
            ClippingPlanes::new(&[plane]).expect("one"),
        ] {
            let kept = accel.clipped(&planes);
            let mut counts = [0; 2];
            for _ in 0..2000 {
                let eye = random.point() * 3.0;
                let u = random.unit();
                let v = random.unit() * (1.0 - u);
                let primitive = (random.unit() * accel.len() as f64) as u32;
                let at = hit(primitive, u as f32, v as f32);
                let seen = kept.is_seen_from(eye, &at, Cull::None);
                assert_eq!(seen, by_all(&accel, &planes, eye, &at), "{at:?} {eye}");
                counts[usize::from(seen)] += 1;
            }
            assert!(counts.iter().all(|&count| count > 100), "{counts:?}");
        }
    }

    /// The corners of a room: eight corners where three walls join in folds, each wall of 2 n² triangles; optionally
    /// with a cover in front of the middle of each triangle.
    fn room(n: u32, is_covered: bool) -> Accel {
        let mut positions = Vec::new();
        let mut triangles = Vec::new();
        for side in 0..6 {
            let first = positions.len() as u32;
            let axis = side / 2;
            let wall = if side % 2 == 0 { -1.0 } else { 1.0 };
            for i in 0..=n {
                for j in 0..=n {
                    let along = |k: u32| f64::from(k) * 2.0 / f64::from(n) - 1.0;
                    let mut corner = [0.0; 3];
                    corner[axis] = wall;
                    corner[(axis + 1) % 3] = along(i);
                    corner[(axis + 2) % 3] = along(j);
                    positions.push(DVec3::from_array(corner) * 1.1);
                }
            }
            for i in 0..n {
                for j in 0..n {
                    let at = first + i * (n + 1) + j;
                    triangles.push([at, at + 1, at + n + 2]);
                    triangles.push([at, at + n + 2, at + n + 1]);
                }
            }
        }
        for at in 0..triangles.len() * usize::from(is_covered) {
            let corners = triangles[at].map(|corner: u32| positions[corner as usize]);
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let first = positions.len() as u32;
            positions.extend(corners.map(|corner| (middle + (corner - middle) * 0.2) * 0.5));
            triangles.push([first, first + 1, first + 2]);
        }
        accel(positions, triangles)
    }

    /// From inside a convex room all walls are visible, up to their edges and corners.
    #[test]
    fn walls_that_join_in_a_fold_do_not_hide_one_another() {
        let accel = room(7, false);
        let kept = accel.clipped(&ClippingPlanes::NONE);
        let mut random = Random(13);
        let third = 1.0f32 / 3.0;
        for _ in 0..20 {
            let eye = random.point();
            for primitive in accel.primitives() {
                let share = random.unit() as f32;
                for (u, v) in [
                    (0.0, 0.0),
                    (1.0, 0.0),
                    (0.0, 1.0),
                    (0.5, 0.5),
                    (share, 0.0),
                    (0.0, share),
                    (share, 1.0 - share),
                    (third, 1.0 - third),
                    (third, third),
                ] {
                    let at = hit(primitive, u, v);
                    assert!(kept.is_seen_from(eye, &at, Cull::None), "{at:?} {eye}");
                }
            }
        }
    }

    /// Points at an edge are visible past what hides the triangle's middle. Without the least weight half of the rays
    /// miss, and this fails.
    #[test]
    fn points_at_an_edge_are_visible_past_what_hides_the_middle() {
        let accel = room(1, true);
        let kept = accel.clipped(&ClippingPlanes::NONE);
        let mut random = Random(17);
        let walls = |&primitive: &u32| accel.identify(primitive).1 < 12;
        for primitive in accel.primitives().filter(walls) {
            for _ in 0..50 {
                let eye = random.point() * 0.01;
                let share = random.unit() as f32;
                for (u, v) in [(share, 0.0), (0.0, share), (share, 1.0 - share)] {
                    let at = hit(primitive, u, v);
                    assert!(kept.is_seen_from(eye, &at, Cull::None), "{at:?} {eye}");
                }
                let third = 1.0f32 / 3.0;
                assert!(!kept.is_seen_from(eye, &hit(primitive, third, third), Cull::None));
            }
        }
    }

    #[test]
    fn coincident_triangles_hide_nothing_and_back_faces_are_culled() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let both = accel(corners.clone(), vec![[0, 1, 2], [2, 1, 0], [0, 1, 2]]);
        let planes = ClippingPlanes::NONE;
        let eye = DVec3::new(0.2, 0.3, 4.0);
        for primitive in both.primitives() {
            let at = hit(primitive, 0.25, 0.5);
            assert!(both.clipped(&planes).is_seen_from(eye, &at, Cull::None));
            let (_, triangle) = both.identify(primitive);
            let seen = both.clipped(&planes).is_seen_from(eye, &at, Cull::Back);
            assert_eq!(seen, triangle != 1);
        }
        // From within its own plane nothing of a triangle is visible, nor from the point itself.
        let one = accel(corners, vec![[0, 1, 2]]);
        for eye in [DVec3::new(5.0, 0.5, 0.0), DVec3::new(0.25, 0.25, 0.0)] {
            assert!(
                !one.clipped(&planes)
                    .is_seen_from(eye, &hit(0, 0.25, 0.25), Cull::None)
            );
        }
    }
}
