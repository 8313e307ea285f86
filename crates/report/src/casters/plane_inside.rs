//! The test against the plane, then against the edges: intersect the ray with the triangle's plane, and test
//! whether the point is on the inner side of each edge (Snyder and Barr, "Ray tracing complex models containing
//! surface tessellations", 1987, and the first ray tracers). The renderer that RayCast replaces did this for every
//! triangle and every ray.

use super::one_ray::CasterRay;
use super::triangle::{Intersection, TriangleTest};
use super::vector::Vector;
use num_traits::{Float, Zero};

pub(super) struct PlaneInside<V> {
    corners: [V; 3],
    normal: V,
}

impl<V: Vector> TriangleTest for PlaneInside<V> {
    type V = V;
    type Ray = CasterRay<V>;

    fn new(corners: [V; 3]) -> Self {
        let [a, b, c] = corners;
        Self {
            corners,
            normal: (b - a).cross(c - a),
        }
    }

    fn prepare(ray: &CasterRay<V>) -> CasterRay<V> {
        *ray
    }

    #[inline(always)]
    fn intersect(&self, ray: &CasterRay<V>) -> Option<Intersection<V::Real>> {
        let [a, b, c] = self.corners;
        let slope = self.normal.dot(ray.direction);
        if slope == V::Real::zero() {
            return None;
        }
        let t = self.normal.dot(a - ray.origin) / slope;
        let point = ray.origin + ray.direction * t;
        let side = |from: V, to: V| (to - from).cross(point - from).dot(self.normal);
        let (first, second, third) = (side(b, c), side(c, a), side(a, b));
        let zero = V::Real::zero();
        if !(first >= zero && second >= zero && third >= zero) {
            return None;
        }
        let whole = self.normal.dot(self.normal);
        Some(Intersection {
            t,
            u: second / whole,
            v: third / whole,
        })
        .filter(|at| at.t.is_finite())
    }
}
