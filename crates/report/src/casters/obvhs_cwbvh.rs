//! obvhs's eight-wide compressed BVH (Ylitie, Karras and Laine, "Efficient Incoherent Ray Traversal on GPUs Through
//! Compressed Wide BVHs", 2017) and triangle test, used as its examples recommend.

use super::obvhs_triangles::{Triangles, to_obvhs};
use super::one_ray::{CasterRay, SingleRay};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::RayHit;
use raycast_core::glam::Vec3;
use raycast_core::{Accel, PrimitiveHit};
use std::time::Duration;

pub(super) struct ObvhsCwBvh {
    bvh: CwBvh,
    triangles: Triangles,
}

impl ObvhsCwBvh {
    /// Builds it with obvhs's medium preset. `None` if obvhs cannot build it: see [`Triangles::from_accel`].
    pub(super) fn new(accel: &Accel) -> Option<Self> {
        let unordered = Triangles::from_accel(accel)?;
        let bvh = build_cwbvh_from_tris(
            &unordered,
            BvhBuildParams::medium_build(),
            &mut Duration::default(),
        );
        let triangles = Triangles::in_order(&unordered, &bvh.primitive_indices);
        Some(Self { bvh, triangles })
    }
}

impl SingleRay for ObvhsCwBvh {
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
