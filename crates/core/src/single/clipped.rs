use super::traversal;
use crate::bvh::Accel;
use crate::hit::{Cull, Hit, Precision, PrimitiveHit};
use crate::ray::Ray;
use crate::scene::ClippingPlanes;
use crate::triangle::clip::Clip;
use crate::triangle::{Nearest, PreparedRay};

/// What clipping planes leave of a tree's triangles: a hit counts where every plane keeps its exact point.
#[derive(Clone, Debug)]
pub struct Clipped<'a> {
    pub(crate) accel: &'a Accel,
    pub(crate) clip: Clip,
}

impl Accel {
    /// The triangles as far as clipping planes keep them. It costs nothing to make, whatever the tree's size.
    pub fn clipped(&self, planes: &ClippingPlanes) -> Clipped<'_> {
        Clipped {
            accel: self,
            clip: Clip::new(planes, self.origin),
        }
    }

    /// [`Accel::intersect`], for hits whose points are kept.
    #[inline(always)]
    pub(crate) fn intersect_kept(
        &self,
        clip: &Clip,
        ray: &PreparedRay,
        primitive: u32,
        nearest: &mut Nearest,
    ) {
        if clip.is_empty() || self.is_kept(clip, ray, primitive) {
            self.intersect(ray, primitive, nearest);
        }
    }

    /// Whether a ray hits a triangle at a point that is kept.
    #[inline(never)]
    fn is_kept(&self, clip: &Clip, ray: &PreparedRay, primitive: u32) -> bool {
        let mut hit = Nearest::NONE;
        self.intersect(ray, primitive, &mut hit);
        !hit.is_miss() && clip.keeps(&ray.ray, self.corners(primitive), &hit)
    }
}

impl Clipped<'_> {
    /// The closest hit that is kept, else as [`Accel::cast`].
    pub fn cast(&self, ray: &Ray, cull: Cull) -> Option<Hit> {
        self.accel.to_hit(self.nearest(ray, cull, Precision::Exact))
    }

    /// The closest hit that is kept, else as [`Accel::cast_primitive`].
    pub fn cast_primitive(&self, ray: &Ray, cull: Cull, precision: Precision) -> PrimitiveHit {
        self.nearest(ray, cull, precision).to_primitive_hit()
    }

    /// What [`Clipped::cast`] answers, found by testing every triangle: for tests.
    pub fn cast_brute_force(&self, ray: &Ray, cull: Cull) -> Option<Hit> {
        let ray = PreparedRay::new(ray, self.accel.origin, cull, Precision::Exact)?;
        let mut nearest = Nearest::NONE;
        for primitive in self.accel.primitives() {
            self.accel
                .intersect_kept(&self.clip, &ray, primitive, &mut nearest);
        }
        self.accel.to_hit(nearest)
    }

    fn nearest(&self, ray: &Ray, cull: Cull, precision: Precision) -> Nearest {
        match PreparedRay::new(ray, self.accel.origin, cull, precision) {
            Some(ray) => traversal::nearest(self.accel, &self.clip, &ray),
            None => Nearest::NONE,
        }
    }
}
