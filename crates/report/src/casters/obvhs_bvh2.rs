//! obvhs's binary BVH and triangle test, used as its examples recommend.

use super::obvhs_triangles::{Triangles, to_obvhs};
use super::one_ray::{CasterRay, SingleRay};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::ray::RayHit;
use raycast_core::glam::Vec3;
use raycast_core::{Accel, PrimitiveHit};
use std::time::Duration;

pub(super) struct ObvhsBvh2 {
    bvh: Bvh2,
    triangles: Triangles,
}

impl ObvhsBvh2 {
    /// Builds it with obvhs's medium preset. `None` if obvhs cannot build it: see [`Triangles::from_accel`].
    pub(super) fn new(accel: &Accel) -> Option<Self> {
        let unordered = Triangles::from_accel(accel)?;
        let bvh = build_bvh2_from_tris(
            &unordered,
            BvhBuildParams::medium_build(),
            &mut Duration::default(),
        );
        let triangles = Triangles::in_order(&unordered, &bvh.primitive_indices);
        Some(Self { bvh, triangles })
    }
}

impl SingleRay for ObvhsBvh2 {
    type V = Vec3;

    fn nearest(&self, ray: &CasterRay<Vec3>) -> PrimitiveHit {
        let ray = to_obvhs(ray);
        let mut hit = RayHit::none();
        self.bvh.ray_traverse(ray, &mut hit, |ray, index| {
            self.triangles.tests[index].intersect(ray)
        });
        self.triangles.to_primitive_hit(&ray, &hit)
    }
}
