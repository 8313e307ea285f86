//! The common trait of ray casters, and the kinds of rays that they accept.

use raycast_core::camera::{Lattice, Ray};
use raycast_core::{Accel, PrimitiveHit};

/// Finds the closest triangle along each ray.
pub trait Caster: Send + Sync {
    /// The name in charts and tables, with the precision.
    fn name(&self) -> &str;

    /// The kind of rays that it accepts.
    fn rays(&self) -> Rays;

    /// How many triangles it tests for every ray, if it tests all of them; 0 for a caster with a tree.
    fn tests_per_ray(&self) -> usize {
        0
    }

    /// Casts rays; replaces the contents of `hits` with one hit per ray.
    fn cast(&self, rays: &[Ray], hits: &mut Vec<PrimitiveHit>);

    /// Casts a camera's rays in row-major order, and sets them up itself; replaces the contents of `hits`.
    fn cast_lattice(&self, lattice: &Lattice, hits: &mut Vec<PrimitiveHit>);

    /// Visibility only: replaces the contents of `primitives` with the primitive indices of the triangles that a
    /// camera's rays hit, in row-major order.
    fn find_lattice(&self, lattice: &Lattice, primitives: &mut Vec<u32>) {
        let mut hits = Vec::new();
        self.cast_lattice(lattice, &mut hits);
        primitives.clear();
        primitives.extend(hits.iter().map(|hit| hit.primitive));
    }

    /// The object and the triangle id of a primitive index.
    fn identify(&self, primitive: u32) -> (u32, u32);
}

/// The kinds of rays that casters accept. The oracle must get the same ray as the caster, so rays are rounded to
/// what it can represent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rays {
    /// Single precision.
    Single,
    /// Double precision.
    Double,
    /// Only rays of a camera.
    Camera,
}

/// Rounds a ray to one that single precision represents exactly: its origin relative to the tree's, its direction,
/// and its range.
pub fn rounded(ray: &Ray, accel: &Accel) -> Ray {
    let origin = (ray.origin - accel.origin()).as_vec3().as_dvec3();
    Ray {
        origin: accel.origin() + origin,
        direction: ray.direction.as_vec3().as_dvec3(),
        t_min: f64::from(ray.t_min as f32),
        t_max: f64::from(ray.t_max.min(f64::from(f32::MAX)) as f32),
    }
}
