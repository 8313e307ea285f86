//! Ways of casting rays, RayCast's own and other people's, behind one small trait, so that each is
//! given the same rays at the same triangles.
//!
//! The others are here to be compared with and are in nobody's path: small, plain, one file each.
//! All of them get the triangles as RayCast stores them, relative to [`Accel::origin`], so that none
//! is punished for a scene that stands far from the origin in its file.

mod boxes;
mod embree;
mod list;
mod moller_trumbore;
mod obvhs_bvh2;
mod obvhs_cwbvh;
mod obvhs_triangles;
mod one_ray;
mod plane_inside;
mod raycast;
mod triangle;
mod vector;
mod watertight;

use boxes::Boxes;
use list::List;
use moller_trumbore::MollerTrumbore;
use obvhs_bvh2::ObvhsBvh2;
use obvhs_cwbvh::ObvhsCwBvh;
use one_ray::OneAfterAnother;
use plane_inside::PlaneInside;
use raycast_core::glam::{DVec3, Vec3};
use watertight::Watertight;

use raycast_core::accel::{Accel, Simd, SlotHit};
use raycast_core::camera::{Lattice, Ray};
use raycast_core::intersect::Precision;
use std::sync::Arc;

/// A way of finding the nearest triangle of rays.
pub trait Way: Send + Sync {
    /// What plots and tables call it, its precision included.
    fn name(&self) -> &str;

    /// Which rays it answers.
    fn rays(&self) -> Rays;

    /// How many triangles it tries for every ray; 0 where a tree spares it most of them.
    fn tries(&self) -> usize {
        0
    }

    /// Answers rays, one hit each, in place of what `hits` held.
    fn cast(&self, rays: &[Ray], hits: &mut Vec<SlotHit>);

    /// Answers a camera's rays row by row, making them included, in place of what `hits` held.
    fn cast_lattice(&self, lattice: &Lattice, hits: &mut Vec<SlotHit>);

    /// The object and triangle number of a slot that a hit names.
    fn identify(&self, slot: u32) -> (u32, u32);
}

/// The rays that a way answers: what it can tell apart from other rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rays {
    /// Rounded to single precision.
    Single,
    /// In double precision.
    Double,
    /// A camera's, and no others.
    Camera,
}

/// A ray that a way of single precision can be given as it is: origin (relative to the tree's),
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

/// RayCast's own ways on this machine's widest instruction set: what a user gets.
pub fn raycast(accel: &Arc<Accel>) -> Vec<Box<dyn Way>> {
    let mut ways: Vec<Box<dyn Way>> = Vec::new();
    for precision in [Precision::Exact, Precision::Fast] {
        ways.push(Box::new(raycast::Tile::new(accel, precision)));
    }
    for precision in [Precision::Exact, Precision::Fast] {
        ways.push(Box::new(raycast::Single::new(accel, precision)));
    }
    ways
}

/// RayCast's tiles as compiled for an instruction set: `accel` must have been built for it.
pub fn raycast_simd(accel: &Arc<Accel>, precision: Precision) -> Box<dyn Way> {
    Box::new(raycast::Tile::with_simd_in_name(accel, precision))
}

/// This machine's instruction sets, from the plainest to the widest.
pub fn instruction_sets() -> Vec<Simd> {
    [Simd::Plain, Simd::Avx2, Simd::Avx512]
        .into_iter()
        .filter(|&simd| simd <= Simd::best())
        .collect()
}

/// Other people's ways: brute force, where every triangle for every ray is what they are, and over
/// boxes that lose no ray, where the triangle test is what they are.
pub fn baselines(accel: &Arc<Accel>) -> Vec<Box<dyn Way>> {
    fn way<T: one_ray::OneRay + 'static>(name: &str, accel: &Arc<Accel>, one: T) -> Box<dyn Way> {
        Box::new(OneAfterAnother::new(name, accel, one))
    }
    let brute = "plane, then inside";
    let mut ways = vec![
        way(brute, accel, List::<PlaneInside<Vec3>>::new(accel)),
        way(brute, accel, List::<PlaneInside<DVec3>>::new(accel)),
    ];
    let tested = "Möller–Trumbore";
    ways.push(way(
        tested,
        accel,
        Boxes::<MollerTrumbore<Vec3>>::new(accel),
    ));
    ways.push(way(
        tested,
        accel,
        Boxes::<MollerTrumbore<DVec3>>::new(accel),
    ));
    ways.push(way("watertight", accel, Boxes::<Watertight>::new(accel)));
    if let Some(bvh) = ObvhsBvh2::new(accel) {
        ways.push(way("obvhs BVH2", accel, bvh));
    }
    if let Some(bvh) = ObvhsCwBvh::new(accel) {
        ways.push(way("obvhs CWBVH", accel, bvh));
    }
    ways
}

/// Embree's ways: single rays, eight and sixteen at a time, each with its default scene and its
/// robust one.
///
/// # Errors
/// Embree refuses to build a scene.
pub fn embree(
    accel: &Arc<Accel>,
    library: &Arc<crate::embree::Embree>,
) -> Result<Vec<Box<dyn Way>>, crate::embree::EmbreeError> {
    let corners: Vec<_> = (0..accel.len() as u32).map(|s| accel.corners(s)).collect();
    let mut ways: Vec<Box<dyn Way>> = Vec::new();
    for robust in [false, true] {
        let scene = Arc::new(library.scene(&corners, robust)?);
        ways.push(Box::new(embree::Embree::<1>::new(accel, &scene, robust)));
        ways.push(Box::new(embree::Embree::<8>::new(accel, &scene, robust)));
        ways.push(Box::new(embree::Embree::<16>::new(accel, &scene, robust)));
    }
    Ok(ways)
}
