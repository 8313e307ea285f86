//! A scene's triangles in one space, by number.

use super::Triangle;
use super::corner_hash::hash;
use super::placement::Placement;
use super::tree::{Box32, TRIANGLE_LIMIT};
use crate::scene::{COORDINATE_LIMIT, Mesh, Object, Opacity, Scene, SceneError, TreeTopology};
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// All objects' triangles, and how they are placed.
pub(super) struct World<'s> {
    /// The point that all corners are relative to.
    pub(super) origin: DVec3,
    /// The number of each object's first triangle, and the number after the last.
    pub(super) first_numbers: Vec<u32>,
    pub(super) objects: Vec<PlacedObject<'s>>,
}

/// An object with its placement.
#[derive(Clone, Copy)]
pub(super) struct PlacedObject<'s> {
    pub(super) mesh: &'s Mesh,
    /// The numbers of the triangles that rays can hit where it is visible.
    pub(super) kept: &'s [u32],
    /// The known topology of a tree over these.
    pub(super) tree: Option<&'s TreeTopology>,
    pub(super) visible: bool,
    /// `None` where the mesh's positions are relative to the world's origin as they are.
    pub(super) placement: Option<Placement>,
}

impl<'s> PlacedObject<'s> {
    fn new(object: &'s Object, world_from_object: DAffine3, origin: DVec3) -> Self {
        let mesh = &*object.mesh;
        let as_stored = world_from_object == DAffine3::IDENTITY && mesh.offset() == origin;
        let placement = Placement::new(world_from_object, mesh.offset(), origin);
        Self {
            placement: (!as_stored).then_some(placement),
            ..Self::in_place(object)
        }
    }

    /// With its mesh's own positions.
    fn in_place(object: &'s Object) -> Self {
        Self {
            mesh: &object.mesh,
            kept: object.kept(),
            tree: (object.mesh.tree()).filter(|_| object.hidden().is_none()),
            visible: object.visible,
            placement: None,
        }
    }
}

/// The triangles that rays can hit.
pub(super) struct Reachable {
    /// Triangle numbers.
    pub(super) numbers: Vec<u32>,
    /// The boxes around them.
    pub(super) boxes: Vec<Box32>,
    /// Hashes of their corners.
    pub(super) hashes: Vec<u32>,
    /// Kept triangles that a transform has moved out of range.
    pub(super) out_of_range: u32,
}

impl<'s> World<'s> {
    pub(super) fn of(scene: &'s Scene) -> Result<Self, SceneError> {
        let transforms = scene.world_from_objects()?;
        let origin = common_origin(scene, &transforms);
        Self::about(scene, &transforms, origin)
    }

    /// As [`World::of`], about a given origin.
    pub(super) fn about(
        scene: &'s Scene,
        transforms: &[DAffine3],
        origin: DVec3,
    ) -> Result<Self, SceneError> {
        let objects = scene.objects.iter().zip(transforms);
        let place = |(object, &world_from_object): (&'s Object, _)| {
            PlacedObject::new(object, world_from_object, origin)
        };
        Ok(Self {
            origin,
            first_numbers: number(scene)?,
            objects: objects.map(place).collect(),
        })
    }

    /// One mesh alone, with its own positions.
    pub(super) fn of_mesh(mesh: &'s Mesh) -> Self {
        Self::alone(PlacedObject {
            mesh,
            kept: mesh.kept(),
            tree: mesh.tree(),
            visible: true,
            placement: None,
        })
    }

    /// One object alone, visible or not, with its mesh's own positions.
    pub(super) fn of_object(object: &'s Object) -> Self {
        Self::alone(PlacedObject::in_place(object))
    }

    /// One object alone, visible or not.
    pub(super) fn alone(object: PlacedObject<'s>) -> Self {
        Self {
            origin: DVec3::ZERO,
            first_numbers: vec![0, object.mesh.triangles().len() as u32],
            objects: vec![PlacedObject {
                visible: true,
                ..object
            }],
        }
    }

    /// The same world with those objects hidden whose mesh has a known tree.
    pub(super) fn without_known_trees(&self) -> Self {
        let objects = self.objects.iter().map(|object| PlacedObject {
            visible: object.visible && object.tree.is_none(),
            ..*object
        });
        Self {
            origin: self.origin,
            first_numbers: self.first_numbers.clone(),
            objects: objects.collect(),
        }
    }

    /// The object that a triangle number belongs to.
    fn object(&self, number: u32) -> usize {
        match &self.objects[..] {
            // One object: nothing to search.
            [_] => 0,
            _ => self.first_numbers.partition_point(|&first| first <= number) - 1,
        }
    }

    /// Whether a triangle's material is opaque.
    pub(super) fn is_opaque(&self, number: u32) -> bool {
        let object = self.object(number);
        let triangle = number - self.first_numbers[object];
        *self.objects[object].mesh.opacity(triangle) == Opacity::Opaque
    }

    /// The triangle of a number. A number out of range gives NaN corners.
    pub(super) fn triangle(&self, number: u32) -> Triangle {
        let object = self.object(number);
        let corners = self.corners(object, number - self.first_numbers[object]);
        Triangle { corners, number }
    }

    fn corners(&self, object: usize, triangle: u32) -> [Vec3; 3] {
        let PlacedObject {
            mesh, placement, ..
        } = &self.objects[object];
        let corners = mesh.corners(triangle).unwrap_or([Vec3::NAN; 3]);
        match placement {
            Some(placement) => corners.map(|corner| placement.corner(corner)),
            None => corners,
        }
    }

    /// All kept triangles that are within range.
    pub(super) fn reachable(&self) -> Reachable {
        let mut numbers = Vec::with_capacity(self.objects.iter().map(|o| o.kept.len()).sum());
        let numbered = self.objects.iter().zip(&self.first_numbers);
        for (object, first) in numbered.filter(|(object, _)| object.visible) {
            numbers.par_extend(object.kept.par_iter().map(|kept| first + kept));
        }
        let out_of_range = AtomicU32::new(0);
        let around = |&number: &u32| {
            let corners = self.triangle(number).corners;
            if !in_range(&corners) {
                out_of_range.fetch_add(1, Ordering::Relaxed);
            }
            (
                Box32::around(&corners),
                hash(corners.map(|corner| corner.to_array())),
            )
        };
        let (mut boxes, mut hashes) = (Vec::new(), Vec::new());
        let all = numbers.par_iter().map(around);
        all.unzip_into_vecs(&mut boxes, &mut hashes);
        let out_of_range = out_of_range.load(Ordering::Relaxed);
        if out_of_range > 0 {
            numbers.retain(|&number| in_range(&self.triangle(number).corners));
            let all = numbers.par_iter().map(around);
            all.unzip_into_vecs(&mut boxes, &mut hashes);
        }
        Reachable {
            numbers,
            boxes,
            hashes,
            out_of_range,
        }
    }
}

/// Whether rays can hit a triangle: all coordinates are within twice the limit, since a mesh at the limit may have
/// been moved off its offset.
pub(super) fn in_range(corners: &[Vec3; 3]) -> bool {
    let within = |corner: &Vec3| f64::from(corner.abs().max_element()) <= 2.0 * COORDINATE_LIMIT;
    corners
        .iter()
        .all(|corner| corner.is_finite() && within(corner))
}

/// The number of each object's first triangle, and the number after the last.
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

/// The point that all corners are stored relative to: the first object's position, if that is far from zero.
///
/// A mesh without transform keeps its positions as they are when this is its own offset. For other meshes any point
/// nearby is as good.
pub(super) fn common_origin(scene: &Scene, transforms: &[DAffine3]) -> DVec3 {
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
                // Integers, so that differences from them stay exact.
                if *world_from_object == DAffine3::IDENTITY {
                    offset
                } else {
                    place.round()
                }
            }
        });
    let first = offsets.next().unwrap_or(DVec3::ZERO);
    // Objects far apart share no good origin except zero.
    let shared =
        offsets.all(|offset| (offset - first).abs().max_element() <= first.abs().max_element());
    if shared { first } else { DVec3::ZERO }
}
