use super::traversal;
use crate::bvh::Accel;
use crate::camera::Lattice;
use crate::hit::{Cull, Hit, MISS, Precision, PrimitiveHit};
use crate::ray::Ray;
use crate::scene::{ClippingPlanes, Masks};
use crate::triangle::clip::Clip;
use crate::triangle::{BoundedHit, PreparedRay};

/// A tree's triangles as clipping planes and opacity masks leave them: a hit counts where every plane keeps its exact
/// point, and the mask of its material keeps its barycentrics, rounded to single precision.
#[derive(Clone, Debug)]
pub struct Clipped<'a> {
    pub(crate) accel: &'a Accel,
    pub(crate) clip: Clip,
    masks: Option<&'a Masks<'a>>,
}

impl Accel {
    /// The triangles as clipping planes keep them. This only makes a view: it costs nothing, whatever the tree's
    /// size.
    pub fn clipped(&self, planes: &ClippingPlanes) -> Clipped<'_> {
        Clipped {
            accel: self,
            clip: Clip::new(planes, self.origin),
            masks: None,
        }
    }

    /// As [`Accel::intersect`], for hits whose points the planes keep. A hit that is not kept is rejected before it
    /// replaces another, so that the rule for equal distances holds as it is.
    #[inline(always)]
    pub(crate) fn intersect_kept(
        &self,
        clip: &Clip,
        ray: &PreparedRay,
        primitive: u32,
        nearest: &mut BoundedHit,
    ) {
        if clip.is_empty() {
            self.intersect(ray, primitive, nearest);
        } else {
            let keeps = |hit: &BoundedHit| clip.keeps(&ray.ray, self.corners(primitive), hit);
            self.intersect_where(keeps, ray, primitive, nearest);
        }
    }

    /// As [`Accel::intersect`], for hits that `keeps` keeps.
    #[inline(never)]
    fn intersect_where(
        &self,
        keeps: impl Fn(&BoundedHit) -> bool,
        ray: &PreparedRay,
        primitive: u32,
        nearest: &mut BoundedHit,
    ) {
        let mut closer = *nearest;
        self.intersect(ray, primitive, &mut closer);
        if closer.primitive != nearest.primitive && keeps(&closer) {
            *nearest = closer;
        }
    }
}

impl<'a> Clipped<'a> {
    /// Also rejects the hits that masks reject; `masks` are those of the scene that the tree was built over.
    #[must_use]
    pub fn masked(self, masks: Option<&'a Masks<'a>>) -> Self {
        Self { masks, ..self }
    }

    /// As [`Accel::cast`], for the closest hit that is kept.
    pub fn cast(&self, ray: &Ray, cull: Cull) -> Option<Hit> {
        self.accel.to_hit(self.nearest(ray, cull, Precision::Exact))
    }

    /// As [`Accel::cast_primitive`], for the closest hit that is kept.
    pub fn cast_primitive(&self, ray: &Ray, cull: Cull, precision: Precision) -> PrimitiveHit {
        self.nearest(ray, cull, precision).to_primitive_hit()
    }

    /// As [`Clipped::cast`], by testing every triangle: for tests.
    pub fn cast_brute_force(&self, ray: &Ray, cull: Cull) -> Option<Hit> {
        let ray = self.accel.prepare(ray, cull, Precision::Exact)?;
        let mut nearest = BoundedHit::NONE;
        for primitive in self.accel.primitives() {
            let mut hit = BoundedHit::NONE;
            (self.accel).intersect_kept(&self.clip, &ray, primitive, &mut hit);
            if !hit.is_miss() && self.passes_mask(&hit) {
                self.accel.intersect(&ray, primitive, &mut nearest);
            }
        }
        self.accel.to_hit(nearest)
    }

    /// Replaces each hit of a lattice that a mask rejects by the next hit along its ray that is kept. `primitives`
    /// are the closest hits that the planes keep. Returns how many rays have no hit left.
    ///
    /// A ray that is not rejected costs one test of its material; a rejected one is traversed once more, however many
    /// layers there are.
    pub(crate) fn reject_masked(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        primitives: &mut [u32],
    ) -> u64 {
        let Some(masks) = self.masks else { return 0 };
        let mut lost = 0;
        let mut last = (MISS, false);
        for (at, primitive) in (0..).zip(primitives) {
            if *primitive != last.0 {
                let (object, triangle) = match *primitive {
                    MISS => (MISS, MISS),
                    hit => self.accel.identify(hit),
                };
                last = (*primitive, masks.is_masked(object, triangle));
            }
            if !last.1 {
                continue;
            }
            let ray = lattice.ray(at % lattice.columns, at / lattice.columns);
            let Some(ray) = self.accel.prepare(&ray, cull, precision) else {
                continue;
            };
            let hit = ray.hit_on(*primitive, self.accel.corners(*primitive));
            // With rounded arithmetic the single ray may miss what its packet hit.
            if hit.is_miss() || self.passes_mask(&hit) {
                continue;
            }
            *primitive = self.nearest_kept(&ray).primitive;
            lost += u64::from(*primitive == MISS);
        }
        lost
    }

    fn nearest(&self, ray: &Ray, cull: Cull, precision: Precision) -> BoundedHit {
        match self.accel.prepare(ray, cull, precision) {
            Some(ray) if self.masks.is_some() => self.nearest_kept(&ray),
            Some(ray) => traversal::nearest(self.accel, &self.clip, &ray),
            None => BoundedHit::NONE,
        }
    }

    /// The closest hit that planes and masks keep.
    fn nearest_kept(&self, ray: &PreparedRay) -> BoundedHit {
        let mut nearest = BoundedHit::NONE;
        let keeps = |hit: &BoundedHit| self.keeps(ray, hit);
        traversal::visit(self.accel, &self.clip, ray, |primitives| {
            for primitive in primitives {
                (self.accel).intersect_where(keeps, ray, primitive, &mut nearest);
            }
            nearest
        });
        nearest
    }

    /// Whether planes and masks keep a hit.
    pub(super) fn keeps(&self, ray: &PreparedRay, hit: &BoundedHit) -> bool {
        let corners = || self.accel.corners(hit.primitive);
        (self.clip.is_empty() || self.clip.keeps(&ray.ray, corners(), hit)) && self.passes_mask(hit)
    }

    /// Whether a mask may reject hits with a triangle.
    pub(crate) fn is_masked(&self, primitive: u32) -> bool {
        self.masks.is_some_and(|masks| {
            let (object, triangle) = self.accel.identify(primitive);
            masks.is_masked(object, triangle)
        })
    }

    fn passes_mask(&self, hit: &BoundedHit) -> bool {
        self.masks.is_none_or(|masks| {
            let (object, triangle) = self.accel.identify(hit.primitive);
            let PrimitiveHit { u, v, .. } = hit.to_primitive_hit();
            masks.keeps(object, triangle, (u, v))
        })
    }
}
