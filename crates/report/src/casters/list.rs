//! Brute force: every triangle for every ray.

use super::one_ray::{CasterRay, SingleRay};
use super::triangle::{ClosestHit, TriangleTest};
use super::vector::Vector;
use raycast_core::{Accel, PrimitiveHit};

/// Triangles in the order of their ids: of equal distances the lowest id wins.
pub(super) struct List<T> {
    triangles: Vec<(T, u32)>,
}

impl<T: TriangleTest> List<T> {
    pub(super) fn new(accel: &Accel) -> Self {
        let mut primitives: Vec<u32> = (0..accel.len() as u32).collect();
        primitives.sort_by_key(|&primitive| accel.identify(primitive));
        let prepare = |primitive| {
            (
                T::new(accel.corners(primitive).map(T::V::corner)),
                primitive,
            )
        };
        Self {
            triangles: primitives.into_iter().map(prepare).collect(),
        }
    }
}

impl<T: TriangleTest> SingleRay for List<T> {
    type V = T::V;

    fn tests_per_ray(&self) -> usize {
        self.triangles.len()
    }

    fn nearest(&self, ray: &CasterRay<T::V>) -> PrimitiveHit {
        let mut nearest = ClosestHit::none(ray);
        let ray = T::prepare(ray);
        for (triangle, primitive) in &self.triangles {
            nearest.offer(*primitive, triangle.intersect(&ray));
        }
        nearest.to_primitive_hit()
    }
}
