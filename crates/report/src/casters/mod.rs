//! Ray casters, RayCast's own and other people's, behind one small trait, so that each is
//! given the same rays at the same triangles.
//!
//! The others are here to be compared with and are in nobody's path: small, plain, one file each.
//! All of them get the triangles as RayCast stores them, relative to [`Accel::origin`], so that none
//! is punished for a scene that stands far from the origin in its file.

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
use one_ray::OneAfterAnother;
use plane_inside::PlaneInside;
use raycast_core::glam::{DVec3, Vec3};
use raycast_core::{Accel, Precision, Simd};
use std::sync::Arc;
use watertight::Watertight;

/// RayCast's own casters on this machine's widest instruction set: what a user gets.
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

/// RayCast's tiles as compiled for an instruction set: `accel` must have been built for it.
pub fn raycast_simd(accel: &Arc<Accel>, precision: Precision) -> Box<dyn Caster> {
    Box::new(raycast::Tile::with_simd_in_name(accel, precision))
}

/// This machine's instruction sets, from the plainest to the widest.
pub fn instruction_sets() -> Vec<Simd> {
    [Simd::Plain, Simd::Avx2]
        .into_iter()
        .filter(|&simd| simd <= Simd::best())
        .collect()
}

fn caster<T: one_ray::OneRay + 'static>(name: &str, accel: &Arc<Accel>, one: T) -> Box<dyn Caster> {
    Box::new(OneAfterAnother::new(name, accel, one))
}

/// Other people's casters, but for Embree's.
pub fn baselines(accel: &Arc<Accel>) -> Vec<Box<dyn Caster>> {
    let mut casters = brute_force(accel);
    casters.extend(triangle_tests(accel));
    casters.extend(trees(accel));
    casters
}

/// Every triangle for every ray: what the renderer that RayCast replaces did.
pub fn brute_force(accel: &Arc<Accel>) -> Vec<Box<dyn Caster>> {
    let name = "plane, then inside";
    vec![
        caster(name, accel, List::<PlaneInside<Vec3>>::new(accel)),
        caster(name, accel, List::<PlaneInside<DVec3>>::new(accel)),
    ]
}

/// Published triangle tests, over boxes that lose no ray: their errors are their own, their speed is
/// not what a better tree would give them.
fn triangle_tests(accel: &Arc<Accel>) -> Vec<Box<dyn Caster>> {
    let name = "Möller–Trumbore";
    vec![
        caster(name, accel, Boxes::<MollerTrumbore<Vec3>>::new(accel)),
        caster(name, accel, Boxes::<MollerTrumbore<DVec3>>::new(accel)),
        caster("watertight", accel, Boxes::<Watertight>::new(accel)),
    ]
}

/// Those of other people's casters that have a tree of their own, made for speed.
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

/// Embree's casters: single rays, eight and sixteen at a time, each with its default scene and its
/// robust one.
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

    /// Two balls, one moved and turned, so that there are objects to tell apart.
    fn stage() -> Stage {
        let mut scene = scene_of([scenes::bumpy_sphere(1000), scenes::bumpy_sphere(300)]);
        let moved: &mut Object = &mut scene.objects[1];
        moved.transform = Transform {
            translate: DVec3::new(1.5, 0.25, 0.0),
            ..Transform::IDENTITY
        };
        Stage::new(scene).expect("a valid scene")
    }

    /// Rays at the middles of triangles, where every caster must be right.
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
            let errors = Errors::of(&stage, caster.as_ref(), &rays, &truths, &hits);
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
        let beyond = |ray: &Ray| {
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
        let rays: Vec<Ray> = rays[..40].iter().flat_map(beyond).collect();
        for caster in all(&stage.accel) {
            let mut hits = Vec::new();
            caster.cast(&rays, &mut hits);
            let met = hits.iter().filter(|hit| !hit.is_miss()).count();
            assert_eq!(met, 0, "{}", caster.name());
        }
    }

    /// A picture's rays are made differently for casters in single precision: at silhouettes a few see
    /// something else.
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
