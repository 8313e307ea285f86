//! What a ray through a pixel meets.

use super::State;
use super::document::Document;
use raycast_core::Hit;
use raycast_core::glam::{DVec3, Vec2};
use raycast_core::scene::Color;
use raycast_core::shade::texture_point;

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

/// A pixel of an image on an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Texel {
    /// Its column in the image's file.
    pub column: u32,
    /// Its row there, from the top.
    pub row: u32,
    /// Red, green, blue and alpha, sRGB.
    pub color: [u8; 4],
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
        let world_from_object = scene.world_from_object(number).ok()?;
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

impl State {
    /// The texel that a pick's object has there by the mapping as it is; `None` where no image lies.
    pub fn texel(&self, pinned: &Pinned) -> Option<Texel> {
        let scene = &self.document.as_ref()?.built;
        let Hit {
            object,
            triangle,
            u,
            v,
            ..
        } = pinned.pick.hit;
        let number = object as usize;
        let object = scene.objects.get(number)?;
        let texture = object.texture_on(triangle)?;
        let projection = self.settings.shading.projection;
        let world_from_object = scene.world_from_object(number).ok()?;
        let point = texture_point(object, (triangle, [u, v]), projection, &world_from_object)?;
        let (column, row) = texture.texel_at(point.x, point.y)?;
        let index = row as usize * texture.width() as usize + column as usize;
        let first = texture.crop().map_or((0, 0), |crop| (crop.x, crop.y));
        Some(Texel {
            column: first.0 + column,
            row: first.1 + row,
            color: *texture.texels().get(index)?,
        })
    }
}
