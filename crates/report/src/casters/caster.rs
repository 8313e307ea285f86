//! The trait of all ray casters, and the rays that they can be given.

use raycast_core::camera::{Lattice, Ray};
use raycast_core::{Accel, PrimitiveHit};

/// Finds the closest triangle of rays.
pub trait Caster: Send + Sync {
    /// What plots and tables call it, its precision included.
    fn name(&self) -> &str;

    /// Which rays it answers.
    fn rays(&self) -> Rays;

    /// How many triangles it tries for every ray; 0 where a tree spares it most of them.
    fn tries(&self) -> usize {
        0
    }

    /// Answers rays, one hit each, in place of the contents of `hits`.
    fn cast(&self, rays: &[Ray], hits: &mut Vec<PrimitiveHit>);

    /// Answers a camera's rays row by row, making them included, in place of the contents of `hits`.
    fn cast_lattice(&self, lattice: &Lattice, hits: &mut Vec<PrimitiveHit>);

    /// Visibility alone: the primitive indices of the triangles that a camera's rays hit, row by row, in place of
    /// the contents of `primitives`.
    fn find_lattice(&self, lattice: &Lattice, primitives: &mut Vec<u32>) {
        let mut hits = Vec::new();
        self.cast_lattice(lattice, &mut hits);
        primitives.clear();
        primitives.extend(hits.iter().map(|hit| hit.primitive));
    }

    /// The object and triangle number of a primitive index that a hit names.
    fn identify(&self, primitive: u32) -> (u32, u32);
}

/// The rays that a caster answers: what it can tell apart from other rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rays {
    /// Rounded to single precision.
    Single,
    /// In double precision.
    Double,
    /// A camera's, and no others.
    Camera,
}

/// A ray that a caster of single precision can be given as it is: origin (relative to the tree's),
/// direction and range rounded.
pub fn rounded(ray: &Ray, accel: &Accel) -> Ray {
    let origin = (ray.origin - accel.origin()).as_vec3().as_dvec3();
    Ray {
        origin: accel.origin() + origin,
        direction: ray.direction.as_vec3().as_dvec3(),
        t_min: f64::from(ray.t_min as f32),
        t_max: f64::from(ray.t_max.min(f64::from(f32::MAX)) as f32),
    }
}
