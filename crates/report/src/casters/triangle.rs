//! The interface of published ray–triangle tests.

use super::one_ray::CasterRay;
use super::vector::Vector;
use num_traits::{Float, ToPrimitive};
use raycast_core::{MISS, PrimitiveHit};

/// A published test of a ray against a triangle.
pub(super) trait TriangleTest: Send + Sync {
    /// The precision that it works in.
    type V: Vector;
    /// What is precomputed for a ray and used for all triangles.
    type Ray;

    /// Precomputes a triangle.
    fn new(corners: [Self::V; 3]) -> Self;

    /// Precomputes a ray.
    fn prepare(ray: &CasterRay<Self::V>) -> Self::Ray;

    /// Intersects the line along the ray with the triangle; the ray's range does not matter.
    fn intersect(&self, ray: &Self::Ray) -> Option<Intersection<<Self::V as Vector>::Real>>;
}

/// Where a ray hits a triangle.
#[derive(Clone, Copy)]
pub(super) struct Intersection<R> {
    /// The ray's parameter.
    pub(super) t: R,
    /// Barycentric coordinate of the second corner.
    pub(super) u: R,
    /// Barycentric coordinate of the third corner.
    pub(super) v: R,
}

/// The closest intersection so far.
#[derive(Clone, Copy)]
pub(super) struct ClosestHit<R> {
    t_min: R,
    t_max: R,
    primitive: u32,
    at: Intersection<R>,
}

impl<R: Float + ToPrimitive> ClosestHit<R> {
    /// No intersection yet; hits must be within the ray's range.
    pub(super) fn none<V: Vector<Real = R>>(ray: &CasterRay<V>) -> Self {
        Self {
            t_min: ray.t_min,
            t_max: ray.t_max,
            primitive: MISS,
            at: Intersection {
                t: R::infinity(),
                u: R::zero(),
                v: R::zero(),
            },
        }
    }

    /// Keeps an intersection if it is within the ray's range and nearer than the closest so far.
    #[inline(always)]
    pub(super) fn offer(&mut self, primitive: u32, intersection: Option<Intersection<R>>) {
        if let Some(at) = intersection
            && at.t > self.t_min
            && at.t <= self.t_max
            && at.t < self.at.t
        {
            self.primitive = primitive;
            self.at = at;
        }
    }

    /// The parameter beyond which no box or triangle matters.
    #[inline(always)]
    pub(super) fn limit(&self) -> f64 {
        self.at.t.min(self.t_max).to_f64().unwrap_or(f64::INFINITY)
    }

    pub(super) fn to_primitive_hit(self) -> PrimitiveHit {
        let single = |number: R| number.to_f32().unwrap_or(f32::NAN);
        PrimitiveHit {
            primitive: self.primitive,
            t: single(self.at.t),
            u: single(self.at.u),
            v: single(self.at.v),
        }
    }
}
