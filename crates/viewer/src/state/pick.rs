//! What a ray through a pixel meets.

use super::document::Document;
use raycast_core::Hit;
use raycast_core::glam::{DVec3, Vec2};
use raycast_core::scene::Color;

/// The triangle under a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// Which, and where on it.
    pub hit: Hit,
    /// The point in world space.
    pub point: DVec3,
}

/// A pick with all that is known of its place. It stays what it was when the camera moves on.
#[derive(Clone, Debug, PartialEq)]
pub struct Pinned {
    /// Which, and where.
    pub pick: Pick,
    /// The object's name.
    pub object: String,
    /// The triangle's corners in world space.
    pub corners: [DVec3; 3],
    /// The unit normal of the triangle's plane, to the side from which its corners turn left.
    pub normal: DVec3,
    /// Texture coordinates, where the mesh has them.
    pub uv: Option<Vec2>,
    /// The triangle's own colour.
    pub color: Color,
    /// Whether its object has moved since: then the point is the same on the triangle, and no ray's.
    pub has_moved: bool,
}

impl Pinned {
    /// What is known of a pick; `None` where the scene no longer has its triangle.
    pub fn of(document: &Document, pick: Pick) -> Option<Self> {
        let scene = &document.built;
        let Hit {
            object,
            triangle,
            u,
            v,
            ..
        } = pick.hit;
        let number = object as usize;
        let object = scene.objects.get(number)?;
        let world_from_object = *scene.world_from_objects().ok()?.get(number)?;
        let offset = object.mesh.offset();
        let corners = object.mesh.corners(triangle)?;
        let corners =
            corners.map(|corner| world_from_object.transform_point3(offset + corner.as_dvec3()));
        let [a, b, c] = corners;
        let uv = object.mesh.corner_uvs(triangle).map(|[a, b, c]| {
            let (u, v) = (u as f32, v as f32);
            a * (1.0 - u - v) + b * u + c * v
        });
        Some(Self {
            pick,
            object: object.name.clone(),
            corners,
            normal: (b - a).cross(c - a).normalize_or_zero(),
            uv,
            color: object.triangle_color(triangle),
            has_moved: false,
        })
    }

    /// The same in the scene as it is now: where its triangle has moved, the point has moved with it.
    pub(super) fn renewed(&self, document: &Document) -> Option<Self> {
        let mut new = Self::of(document, self.pick)?;
        new.has_moved = self.has_moved || new.corners != self.corners;
        if new.corners != self.corners {
            let Hit { u, v, .. } = new.pick.hit;
            let [a, b, c] = new.corners;
            new.pick.point = a * (1.0 - u - v) + b * u + c * v;
        }
        Some(new)
    }
}
