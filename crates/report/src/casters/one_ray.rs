//! Casters that trace one ray at a time.

use super::caster::{Caster, Rays};
use super::vector::Vector;
use raycast_core::camera::{Lattice, Projection, Ray};
use raycast_core::glam::DVec3;
use raycast_core::{Accel, PrimitiveHit};
use std::sync::Arc;

/// A ray in the precision of a caster, relative to the tree's origin.
#[derive(Clone, Copy)]
pub(super) struct CasterRay<V: Vector> {
    pub(super) origin: V,
    pub(super) direction: V,
    pub(super) t_min: V::Real,
    pub(super) t_max: V::Real,
}

/// Finds the nearest triangle of a single ray.
pub(super) trait SingleRay: Send + Sync {
    /// The precision of its rays.
    type V: Vector;

    /// As [`Caster::tests_per_ray`].
    fn tests_per_ray(&self) -> usize {
        0
    }

    /// The nearest hit.
    fn nearest(&self, ray: &CasterRay<Self::V>) -> PrimitiveHit;
}

/// Makes a [`Caster`] of a [`SingleRay`] by tracing rays one by one.
pub(super) struct SingleRayCaster<T> {
    name: String,
    rays: Rays,
    accel: Arc<Accel>,
    one: T,
}

impl<T: SingleRay> SingleRayCaster<T> {
    pub(super) fn new(name: &str, accel: &Arc<Accel>, one: T) -> Self {
        let is_single = size_of::<<T::V as Vector>::Real>() == size_of::<f32>();
        Self {
            name: format!("{name}, {}", if is_single { "f32" } else { "f64" }),
            rays: if is_single {
                Rays::Single
            } else {
                Rays::Double
            },
            accel: Arc::clone(accel),
            one,
        }
    }
}

impl<T: SingleRay> Caster for SingleRayCaster<T> {
    fn name(&self) -> &str {
        &self.name
    }

    fn rays(&self) -> Rays {
        self.rays
    }

    fn tests_per_ray(&self) -> usize {
        self.one.tests_per_ray()
    }

    fn cast(&self, rays: &[Ray], hits: &mut Vec<PrimitiveHit>) {
        hits.clear();
        hits.extend(rays.iter().map(|ray| {
            self.one.nearest(&CasterRay {
                origin: T::V::rounded(ray.origin - self.accel.origin()),
                direction: T::V::rounded(ray.direction),
                t_min: T::V::number(ray.t_min),
                t_max: T::V::number(ray.t_max),
            })
        }));
    }

    fn cast_lattice(&self, lattice: &Lattice, hits: &mut Vec<PrimitiveHit>) {
        hits.clear();
        hits.reserve(lattice.len());
        for row in 0..lattice.rows {
            let rays = RowOfRays::<T::V>::new(lattice, row, self.accel.origin());
            hits.extend((0..lattice.columns).map(|column| self.one.nearest(&rays.ray(column))));
        }
    }

    fn identify(&self, primitive: u32) -> (u32, u32) {
        self.accel.identify(primitive)
    }
}

/// The rays of one row of a camera, set up incrementally in the caster's precision: one step added per ray is the
/// cheapest set-up, so that it does not dominate the measured time.
pub(super) struct RowOfRays<V: Vector> {
    projection: Projection,
    origin: V,
    direction: V,
    step: V,
}

impl<V: Vector> RowOfRays<V> {
    pub(super) fn new(lattice: &Lattice, row: u32, accel_origin: DVec3) -> Self {
        let (x, y) = lattice.place(0, row);
        let camera = &lattice.camera;
        let step = camera.right() * (camera.plane().step * f64::from(lattice.stride));
        Self {
            projection: camera.projection(),
            origin: V::rounded(camera.ray(x, y).origin - accel_origin),
            direction: V::rounded(camera.direction(x, y)),
            step: V::rounded(step),
        }
    }

    #[inline(always)]
    pub(super) fn ray(&self, column: u32) -> CasterRay<V> {
        let along = self.step * V::number(f64::from(column));
        let (origin, direction) = match self.projection {
            Projection::Orthographic => (self.origin + along, self.direction),
            // The report does not measure panoramas.
            Projection::Perspective | Projection::Panoramic(_) => {
                (self.origin, (self.direction + along).normalized())
            }
        };
        CasterRay {
            origin,
            direction,
            t_min: V::number(0.0),
            t_max: V::number(f64::MAX),
        }
    }
}
