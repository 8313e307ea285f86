//! Triangles in the world.

use super::Triangle;
use super::tree::TRIANGLE_LIMIT;
use crate::scene::{COORDINATE_LIMIT, Scene, SceneError};
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// A scene's triangles in one space.
pub(super) struct Placed {
    /// What all corners are relative to.
    pub(super) origin: DVec3,
    /// All that rays can meet, by number.
    pub(super) triangles: Vec<Triangle>,
    /// The first number of each object, and the number after the last.
    pub(super) first_numbers: Vec<u32>,
    /// Kept triangles that a transform has moved out of range.
    pub(super) out_of_range: u32,
}

/// Places every object's kept triangles in the world.
pub(super) fn place(scene: &Scene) -> Result<Placed, SceneError> {
    let transforms = scene.world_from_objects()?;
    let first_numbers = number(scene)?;
    let origin = common_origin(scene, &transforms);
    let mut triangles = Vec::with_capacity(scene.objects.iter().map(|o| o.mesh.kept().len()).sum());
    let out_of_range = AtomicU32::new(0);
    for ((object, world_from_object), &first) in
        scene.objects.iter().zip(&transforms).zip(&first_numbers)
    {
        let mesh = &object.mesh;
        let as_stored = *world_from_object == DAffine3::IDENTITY && mesh.offset() == origin;
        let in_world = |corner: Vec3| {
            let in_object = mesh.offset() + corner.as_dvec3();
            (world_from_object.transform_point3(in_object) - origin).as_vec3()
        };
        triangles.par_extend(mesh.kept().par_iter().map(|&triangle| {
            let corners = mesh.corners(triangle).unwrap_or([Vec3::NAN; 3]);
            let corners = if as_stored {
                corners
            } else {
                corners.map(in_world)
            };
            if !in_range(&corners) {
                out_of_range.fetch_add(1, Ordering::Relaxed);
            }
            Triangle {
                corners,
                number: first + triangle,
            }
        }));
    }
    let out_of_range = out_of_range.into_inner();
    if out_of_range > 0 {
        triangles.retain(|triangle| in_range(&triangle.corners));
    }
    Ok(Placed {
        origin,
        triangles,
        first_numbers,
        out_of_range,
    })
}

/// Whether rays can meet a triangle: all its coordinates are within twice the limit, since a mesh at
/// the limit may have been moved off its offset.
fn in_range(corners: &[Vec3; 3]) -> bool {
    let within = |corner: &Vec3| f64::from(corner.abs().max_element()) <= 2.0 * COORDINATE_LIMIT;
    corners
        .iter()
        .all(|corner| corner.is_finite() && within(corner))
}

/// The first number of each object, and the number after the last.
fn number(scene: &Scene) -> Result<Vec<u32>, SceneError> {
    let limit = TRIANGLE_LIMIT;
    let mut next: u64 = 0;
    let mut first_numbers = vec![0];
    for object in &scene.objects {
        next += object.mesh.triangles().len() as u64;
        first_numbers.push(next.min(limit.into()) as u32);
    }
    if next > limit.into() {
        return Err(SceneError::TooManyTriangles {
            triangles: next,
            limit,
        });
    }
    Ok(first_numbers)
}

/// What all corners are stored relative to: the first object's place if it lies far from zero.
///
/// A mesh at rest keeps its positions as they are when this is its own offset; for others it is as
/// good as any other point nearby.
fn common_origin(scene: &Scene, transforms: &[DAffine3]) -> DVec3 {
    let mut offsets = scene
        .objects
        .iter()
        .zip(transforms)
        .filter(|(object, _)| !object.mesh.kept().is_empty())
        .map(|(object, world_from_object)| {
            let offset = object.mesh.offset();
            if offset == DVec3::ZERO && world_from_object.translation.abs().max_element() < 1e6 {
                DVec3::ZERO
            } else {
                let place = world_from_object.transform_point3(offset);
                // Whole numbers of a coarse grain, so that differences from it stay exact.
                if *world_from_object == DAffine3::IDENTITY {
                    offset
                } else {
                    place.round()
                }
            }
        });
    let first = offsets.next().unwrap_or(DVec3::ZERO);
    // Objects far apart share no good origin but zero itself.
    let shared =
        offsets.all(|offset| (offset - first).abs().max_element() <= first.abs().max_element());
    if shared { first } else { DVec3::ZERO }
}
