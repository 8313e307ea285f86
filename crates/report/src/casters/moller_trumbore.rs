//! Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", Journal of Graphics Tools 2(1), 1997:
//! the variant without culling. The paper's epsilon for rays parallel to the triangle, 1e-6, is left out: it
//! depends on the scene's units, and every small triangle would be missed.

use super::one_ray::CasterRay;
use super::triangle::{Intersection, TriangleTest};
use super::vector::Vector;
use num_traits::{One, Zero};

pub(super) struct MollerTrumbore<V> {
    corner: V,
    edges: [V; 2],
}

impl<V: Vector> TriangleTest for MollerTrumbore<V> {
    type V = V;
    type Ray = CasterRay<V>;

    fn new([a, b, c]: [V; 3]) -> Self {
        Self {
            corner: a,
            edges: [b - a, c - a],
        }
    }

    fn prepare(ray: &CasterRay<V>) -> CasterRay<V> {
        *ray
    }

    #[inline(always)]
    fn intersect(&self, ray: &CasterRay<V>) -> Option<Intersection<V::Real>> {
        let (zero, one) = (V::Real::zero(), V::Real::one());
        let [to_b, to_c] = self.edges;
        let p = ray.direction.cross(to_c);
        let determinant = to_b.dot(p);
        if determinant == zero {
            return None;
        }
        let inverse = one / determinant;
        let from_corner = ray.origin - self.corner;
        let u = from_corner.dot(p) * inverse;
        if !(u >= zero && u <= one) {
            return None;
        }
        let q = from_corner.cross(to_b);
        let v = ray.direction.dot(q) * inverse;
        if !(v >= zero && u + v <= one) {
            return None;
        }
        let t = to_c.dot(q) * inverse;
        Some(Intersection { t, u, v })
    }
}
