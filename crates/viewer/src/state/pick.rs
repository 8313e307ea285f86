//! Picks: the hit of the ray through a pixel.

use super::State;
use super::document::Document;
use raycast_core::Hit;
use raycast_core::glam::{DVec3, Vec2};
use raycast_core::scene::Color;
use raycast_core::shade::{own_color, texture_point};

/// The hit of a ray through a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// The object, the triangle, the distance and the barycentrics.
    pub hit: Hit,
    /// The point in world space.
    pub point: DVec3,
}

/// A pick with the values at its point, which stays when the camera moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Pinned {
    /// The hit.
    pub pick: Pick,
    /// The object's name.
    pub object: String,
    /// The name of the triangle's group, where its file has groups.
    pub group: Option<String>,
    /// The triangle's corners in world space.
    pub corners: [DVec3; 3],
    /// The unit normal of the triangle's plane, to the side from which its corners turn left.
    pub normal: DVec3,
    /// Texture coordinates, where the mesh has them.
    pub uv: Option<Vec2>,
    /// Whether its object has moved since. The point then stays at its place on the triangle, where no ray has hit it.
    pub has_moved: bool,
}

/// A texel at a pick.
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
    /// The values at a pick; `None` where the scene no longer has its triangle.
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
            group: object.mesh.groups().of(triangle).map(str::to_owned),
            corners,
            normal: (b - a).cross(c - a).normalize_or_zero(),
            uv,
            has_moved: false,
        })
    }

    /// The same pick in the present scene: the point moves with its triangle.
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
    /// The colour at a pick without light and texture, as the present settings show it; `None` where no picture has
    /// computed yet what its object's rule shows.
    pub fn color(&self, pinned: &Pinned) -> Option<Color> {
        let scene = &self.document.as_ref()?.built;
        let shading = &self.settings.shading;
        let camera = self.camera()?;
        let along = match camera.projection().is_parallel() {
            true => camera.forward(),
            false => pinned.pick.point - camera.pose().eye,
        };
        match shading.back_faces {
            Some(color) if pinned.normal.dot(along) > 0.0 => Some(color),
            _ => own_color(scene, &camera, shading, &pinned.pick.hit),
        }
    }

    /// The texel at a pick under the present texture mapping; `None` where there is no image.
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
