//! How textures are mapped to objects and triangles.

use super::per_triangle::laid;
use super::photograph::Photographed;
use super::placed_image::PlacedImage;
use super::triplanar::Triplanar;
use crate::scene::{Object, Projector, TextureProjection};
use crate::shade::facet::{Mapping, unit};
use glam::{DAffine3, DVec2, DVec3, Vec3};

/// What all triangles of an object share.
#[derive(Clone, Debug)]
pub(in crate::shade) enum ObjectMapping {
    /// By the mesh's texture coordinates.
    Uv,
    /// Each triangle laid flat into the image.
    PerTriangle,
    /// Along three axes.
    Triplanar(Triplanar),
    /// From a placed image.
    Placed(PlacedImage),
    /// From the camera that took the image.
    Photographed(Box<Photographed>),
}

impl ObjectMapping {
    /// An object's mapping: its own, else by `projection`. `None` where its projector or photograph is invalid.
    /// Corners in world space are relative to `origin`.
    pub(in crate::shade) fn new(
        object: &Object,
        projection: TextureProjection,
        origin: DVec3,
    ) -> Option<Self> {
        let mesh = &object.mesh;
        let projection = object.mapping.projection.unwrap_or(projection);
        match projection {
            TextureProjection::Uv if mesh.has_uvs() => Some(Self::Uv),
            TextureProjection::Uv | TextureProjection::Triplanar => {
                Some(Self::Triplanar(Triplanar::new(mesh)))
            }
            TextureProjection::PerTriangle => Some(Self::PerTriangle),
            TextureProjection::Plane | TextureProjection::Sphere | TextureProjection::Cylinder => {
                let projector = object
                    .mapping
                    .projector
                    .unwrap_or_else(|| Projector::about(&mesh.bounds()));
                PlacedImage::new(projection, &projector, mesh.offset()).map(Self::Placed)
            }
            TextureProjection::Camera => {
                let photograph = object.mapping.photograph.as_ref()?;
                let photographed = Photographed::new(photograph, origin)?;
                Some(Self::Photographed(Box::new(photographed)))
            }
        }
    }

    /// The mapping of one triangle, whose corners `in_world` gives; `None` where it has no texture coordinates or no
    /// image.
    pub(in crate::shade) fn on(
        &self,
        object: &Object,
        triangle: u32,
        in_world: impl FnOnce() -> [Vec3; 3],
    ) -> Option<Mapping> {
        let mesh = &object.mesh;
        match self {
            Self::Uv => mesh.corner_uvs(triangle).map(Mapping::Uv),
            Self::PerTriangle => {
                let texture = object.texture_on(triangle)?;
                let corners = mesh.corners(triangle)?.map(Vec3::as_dvec3);
                let laid = laid(corners, texture.width(), texture.height());
                Some(Mapping::Uv(laid.map(DVec2::as_vec2)))
            }
            Self::Triplanar(_) => {
                let corners = mesh.corners(triangle)?;
                let normals = mesh
                    .corner_normals(triangle)
                    .unwrap_or_else(|| [flat_normal(corners); 3]);
                Some(Mapping::Triplanar(corners, normals))
            }
            Self::Placed(_) => mesh.corners(triangle).map(Mapping::Placed),
            Self::Photographed(_) => Some(Mapping::Photographed(in_world())),
        }
    }
}

/// The unit normal of a triangle, by its winding; zero without area.
fn flat_normal(corners: [Vec3; 3]) -> Vec3 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    unit((b - a).cross(c - a)).as_vec3()
}

/// The texture coordinates of a triangle's corners: (u, v) in sides of the image from its bottom left, outside 0 to 1
/// where the texture wraps. For a triplanar mapping they are those along the axis that the triangle faces most. Where
/// u goes around an axis, the corners are on one side of the seam. For a photograph they are where the camera sees
/// the corners, hidden or not.
///
/// Straight lines between corners stay straight, except with [`TextureProjection::Sphere`],
/// [`TextureProjection::Cylinder`] and a [`TextureProjection::Camera`] with a lens. `None` where the triangle has no
/// texture, or no coordinates in it.
pub fn texture_corners(
    object: &Object,
    triangle: u32,
    projection: TextureProjection,
    world_from_object: &DAffine3,
) -> Option<[DVec2; 3]> {
    let texture = object.texture_on(triangle)?;
    let mapping = ObjectMapping::new(object, projection, DVec3::ZERO)?;
    let corners = object.mesh.corners(triangle)?;
    if let ObjectMapping::Photographed(photographed) = mapping {
        let [a, b, c] = corners.map(|corner| {
            let in_object = object.mesh.offset() + corner.as_dvec3();
            photographed.project(world_from_object.transform_point3(in_object), texture)
        });
        return Some([a?, b?, c?]);
    }
    match (mapping.on(object, triangle, || corners)?, mapping) {
        (Mapping::Triplanar(corners, _), ObjectMapping::Triplanar(triplanar)) => {
            Some(corners.map(|corner| faced_most(&triplanar, corners, corner)))
        }
        (Mapping::Placed(_), ObjectMapping::Placed(placed)) => {
            let [a, b, c] = corners.map(|corner| placed.at(corner.as_dvec3()));
            if !placed.goes_round() {
                return Some([a, b, c]);
            }
            let beside = |uv: DVec2| DVec2::new(uv.x - (uv.x - a.x).round(), uv.y);
            Some([a, beside(b), beside(c)])
        }
        (Mapping::Uv(uvs), _) => Some(uvs.map(|uv| uv.as_dvec2())),
        _ => None,
    }
}

/// Where an object's texture has a point of one of its triangles, which the weights of the second and the third corner
/// give: (u, v) in sides of the image from its bottom left, beyond 0 to 1 where the texture wraps. As
/// [`texture_corners`] has the corners, but round an axis and through a lens as well.
///
/// `None` where the triangle has no texture, or the point no place in it.
pub fn texture_point(
    object: &Object,
    (triangle, [u, v]): (u32, [f64; 2]),
    projection: TextureProjection,
    world_from_object: &DAffine3,
) -> Option<DVec2> {
    let texture = object.texture_on(triangle)?;
    let mapping = ObjectMapping::new(object, projection, DVec3::ZERO)?;
    let corners = object.mesh.corners(triangle)?;
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let point = a * (1.0 - u - v) + b * u + c * v;
    match (mapping.on(object, triangle, || corners)?, mapping) {
        (Mapping::Uv(uvs), _) => {
            let [a, b, c] = uvs.map(|uv| uv.as_dvec2());
            Some(a * (1.0 - u - v) + b * u + c * v)
        }
        (Mapping::Triplanar(corners, _), ObjectMapping::Triplanar(triplanar)) => {
            Some(faced_most(&triplanar, corners, point.as_vec3()))
        }
        (_, ObjectMapping::Placed(placed)) => Some(placed.at(point)),
        (_, ObjectMapping::Photographed(photographed)) => {
            let in_object = object.mesh.offset() + point;
            photographed.project(world_from_object.transform_point3(in_object), texture)
        }
        _ => None,
    }
}

/// Where the side that a triangle faces most has a point.
fn faced_most(triplanar: &Triplanar, corners: [Vec3; 3], point: Vec3) -> DVec2 {
    let normal = flat_normal(corners);
    let sizes = normal.abs().to_array();
    let side = (0..3).fold(0, |best, i| if sizes[i] > sizes[best] { i } else { best });
    DVec2::from_array(triplanar.sides(point, normal)[side].uv)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Attribute, Mesh, MeshData, Photograph, Texture};
    use glam::Vec2;
    use std::sync::Arc;

    /// Two triangles of a square in the plane z = 1, far from the origin; only the first has texture coordinates.
    fn object() -> Object {
        let far = DVec3::new(1e7, 0.0, 0.0);
        let corners = [(-1.0, 0.0), (1.0, 0.0), (1.0, 4.0), (-1.0, 4.0)];
        let mesh = Mesh::new(MeshData {
            positions: corners.map(|(x, y)| far + DVec3::new(x, y, 1.0)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            uvs: Some(Attribute {
                values: vec![Vec2::ZERO, Vec2::X, Vec2::ONE],
                indices: Some(vec![[0, 1, 2], [u32::MAX; 3]]),
            }),
            ..MeshData::default()
        });
        let mut object = Object::new("square", Arc::new(mesh));
        object.texture = Texture::new(16, 16, vec![[255; 4]; 256]).map(Arc::new);
        object
    }

    fn corners(object: &Object, triangle: u32, projection: TextureProjection) -> [DVec2; 3] {
        texture_corners(object, triangle, projection, &DAffine3::IDENTITY).expect("a place")
    }

    fn unplaced(
        object: &Object,
        triangle: u32,
        projection: TextureProjection,
    ) -> Option<[DVec2; 3]> {
        texture_corners(object, triangle, projection, &DAffine3::IDENTITY)
    }

    #[test]
    fn a_point_lies_where_its_weights_put_it_between_the_corners() {
        let mut object = object();
        object.mapping.photograph = Some(Photograph {
            eye: DVec3::new(1e7, 2.0, 9.0),
            target: DVec3::new(1e7, 2.0, 1.0),
            up: DVec3::Y,
            fov: 60.0,
            shift: [0.0; 2],
            lens: None,
        });
        // What keeps straight lines straight; a photograph of a plane that it faces does.
        for projection in [
            TextureProjection::Uv,
            TextureProjection::PerTriangle,
            TextureProjection::Triplanar,
            TextureProjection::Plane,
            TextureProjection::Camera,
        ] {
            let [a, b, c] = corners(&object, 0, projection);
            for [u, v] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.25, 0.5]] {
                let hit = (0, [u, v]);
                let found = texture_point(&object, hit, projection, &DAffine3::IDENTITY);
                let expected = a * (1.0 - u - v) + b * u + c * v;
                let found = found.expect("a place");
                assert!(
                    (found - expected).length() < 1e-6,
                    "{projection:?} {found} {expected}"
                );
            }
        }
        let hit = (1, [0.25, 0.25]);
        let none = texture_point(&object, hit, TextureProjection::Uv, &DAffine3::IDENTITY);
        assert_eq!(none, None);
    }

    fn near(found: [DVec2; 3], expected: [(f64, f64); 3]) {
        for (found, (u, v)) in found.iter().zip(expected) {
            assert!(
                (*found - DVec2::new(u, v)).length() < 1e-7,
                "{found}, not {u} {v}"
            );
        }
    }

    #[test]
    fn each_projection_gives_the_corners_their_place() {
        let mut object = object();
        near(
            corners(&object, 0, TextureProjection::Uv),
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)],
        );
        assert_eq!(unplaced(&object, 1, TextureProjection::Uv), None);
        // One repeat over the longest side, 4, around the middle, (1e7, 2, 1).
        near(
            corners(&object, 0, TextureProjection::Triplanar),
            [(0.25, 0.0), (0.75, 0.0), (0.75, 1.0)],
        );
        // Once over the box.
        near(
            corners(&object, 1, TextureProjection::Plane),
            [(0.0, 0.0), (1.0, 1.0), (0.0, 1.0)],
        );
        // An axis through x = 1e7, z = 0: the corners are at 45 degrees on both sides of the front.
        object.mapping.projector = Some(Projector {
            center: DVec3::new(1e7, 2.0, 0.0),
            front: DVec3::Z,
            up: DVec3::Y,
            size: DVec2::new(1.0, 8.0),
        });
        let right = [(0.375, 0.25), (0.625, 0.25), (0.625, 0.75)];
        near(corners(&object, 0, TextureProjection::Cylinder), right);
        // The object's own mapping takes precedence.
        object.mapping.projection = Some(TextureProjection::Cylinder);
        near(corners(&object, 0, TextureProjection::Uv), right);
        // The moved square is 4 from the camera, as high as the frame there, and half as wide.
        let moved = DAffine3::from_translation(DVec3::new(0.0, 5.0, 0.0));
        let eye = DVec3::new(1e7, 7.0, 5.0);
        object.mapping.photograph = Some(Photograph {
            eye,
            target: eye - DVec3::Z,
            up: DVec3::Y,
            fov: 2.0 * crate::math::atan(0.5).to_degrees(),
            shift: [0.0; 2],
            lens: None,
        });
        object.mapping.projection = Some(TextureProjection::Camera);
        let taken = texture_corners(&object, 0, TextureProjection::Uv, &moved);
        near(
            taken.expect("a place"),
            [(0.25, 0.0), (0.75, 0.0), (0.75, 1.0)],
        );
        // Behind the eye there are no coordinates.
        let behind = DAffine3::from_translation(DVec3::Z * 9.0);
        assert_eq!(
            texture_corners(&object, 0, TextureProjection::Uv, &behind),
            None
        );
        object.mapping.projection = Some(TextureProjection::Cylinder);
        // Across the seam the corners stay together.
        if let Some(projector) = &mut object.mapping.projector {
            projector.front = DVec3::NEG_Z;
        }
        let [a, b, _] = corners(&object, 0, TextureProjection::Uv);
        assert!((a.x - b.x).abs() < 0.3, "{a} {b}");
    }

    #[test]
    fn triangles_without_texture_have_no_coordinates() {
        let mut object = object();
        object.mapping.projector = Some(Projector {
            size: DVec2::ZERO,
            ..Projector::about(&object.mesh.bounds())
        });
        assert_eq!(unplaced(&object, 0, TextureProjection::Plane), None);
        assert_eq!(unplaced(&object, 0, TextureProjection::Camera), None);
        object.texture = None;
        assert_eq!(unplaced(&object, 0, TextureProjection::Uv), None);
        assert_eq!(unplaced(&object, 9, TextureProjection::Uv), None);
    }
}
