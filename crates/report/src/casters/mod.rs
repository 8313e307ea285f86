//! Ray casters, RayCast's own and others, behind one small trait, so that all get the same rays and the same
//! triangles.
//!
//! The others exist only for comparison: small, plain, one file each. All of them get the triangles as RayCast
//! stores them, relative to [`Accel::origin`], so that a scene far from the origin of its file costs none of them
//! precision.

mod boxes;
mod caster;
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

pub use caster::{Caster, Rays, rounded};

use boxes::Boxes;
use list::List;
use moller_trumbore::MollerTrumbore;
use obvhs_bvh2::ObvhsBvh2;
use obvhs_cwbvh::ObvhsCwBvh;
use one_ray::SingleRayCaster;
use plane_inside::PlaneInside;
use raycast_core::glam::{DVec3, Vec3};
use raycast_core::{Accel, Precision};
use std::sync::Arc;
use watertight::Watertight;

/// RayCast's casters with the widest instruction set of this machine, which users get.
pub fn raycast(accel: &Arc<Accel>) -> Vec<Box<dyn Caster>> {
    let mut casters: Vec<Box<dyn Caster>> = Vec::new();
    for precision in [Precision::Exact, Precision::Fast] {
        casters.push(Box::new(raycast::Tile::new(accel, precision)));
    }
    for precision in [Precision::Exact, Precision::Fast] {
        casters.push(Box::new(raycast::Single::new(accel, precision)));
    }
    casters
}

/// RayCast's packet traversal; `accel` carries the instruction set.
pub fn raycast_simd(accel: &Arc<Accel>, precision: Precision) -> Box<dyn Caster> {
    Box::new(raycast::Tile::with_simd_in_name(accel, precision))
}

fn caster<T: one_ray::SingleRay + 'static>(
    name: &str,
    accel: &Arc<Accel>,
    one: T,
) -> Box<dyn Caster> {
    Box::new(SingleRayCaster::new(name, accel, one))
}

/// All casters that are not RayCast's, except Embree.
pub fn baselines(accel: &Arc<Accel>) -> Vec<Box<dyn Caster>> {
    let mut casters = brute_force(accel);
    casters.extend(triangle_tests(accel));
    casters.extend(trees(accel));
    casters
}

/// Brute force over all triangles, as in the renderer that RayCast replaces.
pub fn brute_force(accel: &Arc<Accel>) -> Vec<Box<dyn Caster>> {
    let name = "plane, then inside";
    vec![
        caster(name, accel, List::<PlaneInside<Vec3>>::new(accel)),
        caster(name, accel, List::<PlaneInside<DVec3>>::new(accel)),
    ]
}

/// Published triangle tests over [`Boxes`], which lose no ray. The errors are those of the tests; a better tree
/// would make them faster.
fn triangle_tests(accel: &Arc<Accel>) -> Vec<Box<dyn Caster>> {
    let name = "Möller–Trumbore";
    vec![
        caster(name, accel, Boxes::<MollerTrumbore<Vec3>>::new(accel)),
        caster(name, accel, Boxes::<MollerTrumbore<DVec3>>::new(accel)),
        caster("watertight", accel, Boxes::<Watertight>::new(accel)),
    ]
}

/// The casters that are not RayCast's and have a BVH built for speed.
pub fn trees(accel: &Arc<Accel>) -> Vec<Box<dyn Caster>> {
    let mut casters = Vec::new();
    if let Some(bvh) = ObvhsBvh2::new(accel) {
        casters.push(caster("obvhs BVH2", accel, bvh));
    }
    if let Some(bvh) = ObvhsCwBvh::new(accel) {
        casters.push(caster("obvhs CWBVH", accel, bvh));
    }
    casters
}

/// Embree's casters: packets of 1, 8 and 16 rays, each with a default and with a robust scene.
///
/// # Errors
/// Embree refuses to build a scene.
pub fn embree(
    accel: &Arc<Accel>,
    library: &Arc<crate::embree::Embree>,
) -> Result<Vec<Box<dyn Caster>>, crate::embree::EmbreeError> {
    let corners: Vec<_> = (0..accel.len() as u32).map(|s| accel.corners(s)).collect();
    let mut casters: Vec<Box<dyn Caster>> = Vec::new();
    for robust in [false, true] {
        let scene = Arc::new(library.scene(&corners, robust)?);
        casters.push(Box::new(embree::Embree::<1>::new(accel, &scene, robust)));
        casters.push(Box::new(embree::Embree::<8>::new(accel, &scene, robust)));
        casters.push(Box::new(embree::Embree::<16>::new(accel, &scene, robust)));
    }
    Ok(casters)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::errors::Errors;
    use crate::stage::scene_of;
    use crate::{Stage, scenes, subject, views};
    use raycast_core::Cull;
    use raycast_core::PrimitiveHit;
    use raycast_core::camera::Ray;
    use raycast_core::scene::{Object, Transform};
    use raycast_oracle::random::Random;

    fn all(accel: &Arc<Accel>) -> Vec<Box<dyn Caster>> {
        let mut casters = raycast(accel);
        casters.extend(baselines(accel));
        if let Ok(library) = crate::embree::Embree::load(1) {
            casters.extend(super::embree(accel, &library).expect("Embree's scenes"));
        }
        casters
    }

    /// Two spheres, the second one translated and rotated, so that object ids matter.
    fn stage() -> Stage {
        let mut scene = scene_of([scenes::bumpy_sphere(1000), scenes::bumpy_sphere(300)]);
        let moved: &mut Object = &mut scene.objects[1];
        moved.transform = Transform {
            translate: DVec3::new(1.5, 0.25, 0.0),
            ..Transform::IDENTITY
        };
        Stage::new(scene).expect("a valid scene")
    }

    /// Rays towards centroids of triangles, where every caster must be right.
    fn easy_rays(stage: &Stage) -> Vec<Ray> {
        let mut random = Random::new(7);
        let accel = &stage.accel;
        let ray = |_| {
            let [a, b, c] = accel.corners(random.below(accel.len() as u32));
            let origin = random.direction() * 6.0;
            let target = accel.origin() + ((a + b + c) / 3.0).as_dvec3();
            rounded(&Ray::new(origin, target - origin), accel)
        };
        (0..400).map(ray).collect()
    }

    #[test]
    fn every_caster_is_right_where_it_is_easy() {
        let stage = stage();
        let rays = easy_rays(&stage);
        let truth = |ray| stage.truth(ray, Cull::None);
        let truths: Vec<_> = rays.iter().map(truth).collect();
        for caster in all(&stage.accel) {
            let mut hits = Vec::new();
            caster.cast(&rays, &mut hits);
            let errors = Errors::compare(&stage, caster.as_ref(), &rays, &truths, &hits);
            let name = caster.name();
            assert_eq!(
                (errors.wrong(), errors.rays, errors.hits),
                (0, 400, 400),
                "{name}"
            );
            assert!(errors.t_count() > 100, "{name}");
            assert!(
                errors.t_ulps(1.0) < 64.0,
                "{name}: t is off by {}",
                errors.t_ulps(1.0)
            );
            assert!(
                errors.weight < 1e-3,
                "{name}: weights are off by {}",
                errors.weight
            );
        }
    }

    #[test]
    fn ranges_are_kept() {
        let stage = stage();
        let rays = easy_rays(&stage);
        let out_of_range = |ray: &Ray| {
            let t = stage.truth(ray, Cull::None).expect("a hit").t;
            let origin = ray.origin;
            let (short, late) = (t * 0.999, t * 1.001);
            [
                Ray {
                    t_max: short,
                    ..*ray
                },
                Ray {
                    t_min: late,
                    t_max: late,
                    origin,
                    ..*ray
                },
            ]
        };
        let rays: Vec<Ray> = rays[..40].iter().flat_map(out_of_range).collect();
        for caster in all(&stage.accel) {
            let mut hits = Vec::new();
            caster.cast(&rays, &mut hits);
            let hit_count = hits.iter().filter(|hit| !hit.is_miss()).count();
            assert_eq!(hit_count, 0, "{}", caster.name());
        }
    }

    /// Casters in single precision set a camera's rays up differently, so a few rays at silhouettes may differ.
    #[test]
    fn every_caster_sees_the_same_picture() {
        let stage = stage();
        let camera = views::filling(&stage.scene, (61, 43), views::FOV, 1.0).expect("a camera");
        let mut expected: Option<Vec<PrimitiveHit>> = None;
        for caster in all(&stage.accel) {
            let mut picture = Vec::new();
            for tile in subject::tiles(&camera, 1) {
                let mut hits = Vec::new();
                caster.cast_lattice(&tile, &mut hits);
                assert_eq!(hits.len(), tile.len());
                picture.extend(hits);
            }
            let expected = expected.get_or_insert_with(|| picture.clone());
            let pairs = picture.iter().zip(expected.iter());
            let same = pairs.filter(|(a, b)| {
                a.is_miss() == b.is_miss() && (a.is_miss() || (a.t - b.t).abs() < 1e-3 * b.t)
            });
            assert!(same.count() + 4 >= picture.len(), "{}", caster.name());
        }
    }
}
