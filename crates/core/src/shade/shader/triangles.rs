//! Preparing shading triangles: what all pixels of a triangle share, computed once.

use super::{Shader, opaque};
use crate::scene::{Attribute, Object, Scene};
use crate::shade::edges::EdgeLines;
use crate::shade::facet::{
    Facet, Interpolation, Needs, SurfaceTriangle, Varied, middle_to_eye, visible_normal,
};
use crate::shade::interpolants::{Interpolants, LinearNormal};
use crate::shade::own_color::{PlacedCorners, normals_to_world};
use crate::shade::sides::Sides;
use crate::shade::{Mode, Shading};
use glam::{DAffine3, DVec3, Mat3, Vec3};
use std::sync::Arc;

impl Shader<'_> {
    /// The shading triangle for [`Shader::surface`]: for pixels at `x` alone where columns have eyes of their own.
    pub(in crate::shade) fn surface_triangle(&self, primitive: u32, x: f64) -> SurfaceTriangle {
        let (object, triangle) = self.accel.identify(primitive);
        let mesh = &self.scene.objects[object as usize].mesh;
        let needs = Needs {
            normal: true,
            ..Needs::default()
        };
        let mut facet = self.facet(primitive, needs, x);
        if mesh.has_normals() {
            facet.normals = self.normals_in_world(object, mesh.corner_normals(triangle));
        }
        facet.uvs = mesh.corner_uvs(triangle);
        SurfaceTriangle {
            object,
            triangle,
            facet,
        }
    }

    /// The eye of the pixels at `x`, relative to the tree's origin.
    #[inline(always)]
    fn eye_at(&self, x: f64) -> DVec3 {
        if self.has_many_eyes() {
            self.camera.seen_at(x, 0.0).pose().eye - self.accel.origin()
        } else {
            self.eye
        }
    }

    /// The shading triangle with what `needs` asks for; `x` as for [`Shader::make_ready`].
    pub(super) fn facet(&self, primitive: u32, needs: Needs, x: f64) -> Facet {
        let mut facet = Facet::NONE;
        self.make_ready(&mut facet, primitive, needs, x);
        facet
    }

    /// Prepares a shading triangle in place of another with the same needs: fields that are not needed stay as they are. It
    /// is valid for all pixels, or for those at `x` alone where columns have eyes of their own.
    pub(in crate::shade) fn make_ready(
        &self,
        facet: &mut Facet,
        primitive: u32,
        needs: Needs,
        x: f64,
    ) {
        let (number, triangle) = self.accel.identify(primitive);
        let object = &self.scene.objects[number as usize];
        facet.object = number;
        if needs.normal || needs.light || needs.edges || needs.ground {
            let corners = self.corners(primitive, x);
            if needs.normal {
                facet.normal = self.normal(corners);
            }
            if needs.light {
                facet.light = self.flat_light(corners, facet.normal);
            }
            if let (true, Some(ground)) = (needs.ground, &self.ground) {
                let origin = self.accel.origin().y;
                facet.shows_ground = !ground.is_hidden_by(self.eye.y, origin, corners);
            }
            if needs.edges {
                // In panoramas edges are curved: `color_on` computes them at each place.
                let edges = EdgeLines::new(&self.camera, corners);
                facet.edges = Some(match &self.lines.choice {
                    None => edges,
                    Some(choice) => edges.chosen(choice.styles(number, triangle)),
                });
            }
        }
        if needs.smooth {
            facet.normals = self.smooth_normals(number, triangle);
        }
        if let (true, Some(rays)) = (needs.interpolants, &self.planar) {
            let interpolants = Interpolants::new(rays, self.accel.corners(primitive));
            facet.linear_normal = match (&interpolants, facet.normals) {
                (_, None) => Some(LinearNormal::constant(facet.normal)),
                (Some(interpolants), Some(normals)) => interpolants.normals(normals, facet.normal),
                (None, Some(_)) => None,
            };
            facet.interpolation = match interpolants {
                Some(interpolants) => Interpolation::Linear(interpolants),
                None => Interpolation::Ray,
            };
        }
        if needs.color {
            let place = || self.placed(number, primitive, x);
            facet.color = self.own_colors.of_triangle(number, object, triangle, place);
        }
        if needs.varied {
            let place = || self.placed(number, primitive, x);
            facet.varied = self.own_colors.within(number, object, triangle, place);
        }
        if needs.texture {
            facet.triangle = triangle;
            facet.is_tinted = object.is_tinted(triangle);
            facet.texture = object.texture_on(triangle).and_then(|_| {
                let in_world = || self.accel.corners(primitive);
                self.texturing.mapping(number, object, triangle, in_world)
            });
            facet.blends = object.blend_numbers(triangle);
        }
        if needs.reflectance {
            facet.material = object.reflecting_material(triangle);
        }
        if needs.uvs {
            facet.uvs = object.mesh.corner_uvs(triangle);
        }
        if let Some(color) = self.back_color(primitive, x) {
            facet.color = color;
            facet.varied = Varied::No;
            facet.texture = None;
        }
    }

    /// The colour of a triangle that is seen from behind, where backs have their own.
    #[inline(always)]
    pub(super) fn back_color(&self, primitive: u32, x: f64) -> Option<Vec3> {
        let (sides, color) = self.backs.as_ref()?;
        let of_column = (self.has_many_eyes())
            .then(|| Sides::new(&self.camera.seen_at(x, 0.0), self.accel.origin()));
        let sides = of_column.as_ref().unwrap_or(sides);
        let is_back = sides.is_back(self.accel.corners(primitive));
        is_back.then_some(*color)
    }

    /// A triangle's corners, relative to the eye of the pixels at `x`.
    pub(super) fn corners(&self, primitive: u32, x: f64) -> [DVec3; 3] {
        let [a, b, c] = self.accel.corners(primitive);
        let eye = self.eye_at(x);
        let from_eye = |corner: Vec3| corner.as_dvec3() - eye;
        [from_eye(a), from_eye(b), from_eye(c)]
    }

    /// A triangle's own colour, or that of backs.
    #[inline(always)]
    pub(in crate::shade) fn triangle_color(
        &self,
        number: u32,
        triangle: u32,
        primitive: u32,
    ) -> Vec3 {
        if let Some(color) = self.back_color(primitive, 0.0) {
            return color;
        }
        let object = &self.scene.objects[number as usize];
        let place = || self.placed(number, primitive, 0.0);
        (self.own_colors).of_triangle(number, object, triangle, place)
    }

    /// The colour of all triangles, where they have one.
    #[inline(always)]
    pub(in crate::shade) fn only_color(&self) -> Option<Vec3> {
        self.own_colors.only.filter(|_| self.backs.is_none())
    }

    /// A triangle in world space, for colour rules that depend on it.
    fn placed(&self, number: u32, primitive: u32, x: f64) -> PlacedCorners {
        PlacedCorners {
            corners: self.corners(primitive, x),
            camera: self.camera.seen_at(x, 0.0),
            world_normals: self.world_normals.get(number as usize).copied().flatten(),
        }
    }

    /// The unit normal of a triangle with these corners, relative to the eye; of one without area, the
    /// way back to the eye.
    #[inline(always)]
    fn normal(&self, corners: [DVec3; 3]) -> Vec3 {
        visible_normal(corners, self.camera.forward(), self.parallel())
    }

    /// The direction of parallel rays.
    #[inline(always)]
    pub(in crate::shade) fn parallel(&self) -> Option<DVec3> {
        let is_parallel = self.camera.projection().is_parallel();
        is_parallel.then(|| self.camera.forward())
    }

    /// The light on all of a triangle with these corners, relative to the eye, and this unit normal.
    #[inline(always)]
    fn flat_light(&self, corners: [DVec3; 3], normal: Vec3) -> Vec3 {
        self.lights
            .on(normal, middle_to_eye(corners, self.parallel()))
    }

    /// [`Shader::color`] of a triangle whose pixels all have one colour, without preparing the shading triangle.
    pub(in crate::shade) fn constant_color(&self, primitive: u32) -> [f32; 4] {
        if self.shading.mode == Mode::Normals {
            let normal = self.normal(self.corners(primitive, 0.0));
            return self.displayed(normal * 0.5 + 0.5);
        }
        let (number, triangle) = self.accel.identify(primitive);
        let color = self.triangle_color(number, triangle, primitive);
        if matches!(self.shading.mode, Mode::Color | Mode::Texture) {
            return opaque(color);
        }
        let corners = self.corners(primitive, 0.0);
        opaque(color * self.flat_light(corners, self.normal(corners)))
    }

    /// The normals at a triangle's corners that lighting interpolates, in world space.
    fn smooth_normals(&self, object: u32, triangle: u32) -> Option<[Vec3; 3]> {
        let (normals, to_world) = self.corner_normals(object, triangle)?;
        Some(normals.map(|normal| (to_world * normal).normalize_or_zero()))
    }

    /// [`Shader::smooth_normals`] in object space, and their matrix to world space.
    #[inline(always)]
    pub(in crate::shade) fn corner_normals(
        &self,
        object: u32,
        triangle: u32,
    ) -> Option<([Vec3; 3], Mat3)> {
        let to_world = (*self.world_normals.get(object as usize)?)?;
        let (normals, indices) = self.normals_of(object)?;
        let [a, b, c] = *indices.get(triangle as usize)?;
        let normal = |corner: u32| normals.values.get(corner as usize).copied();
        Some(([normal(a)?, normal(b)?, normal(c)?], to_world))
    }

    /// The normals at an object's corners that lighting interpolates, and the indices of each triangle's.
    #[inline(always)]
    pub(super) fn normals_of(&self, object: u32) -> Option<(&Attribute<Vec3>, &[[u32; 3]])> {
        let mesh = &self.scene.objects[object as usize].mesh;
        let normals = match self.creased.get(object as usize) {
            Some(Some(creased)) => creased,
            _ => mesh.normals()?,
        };
        let indices = normals.indices.as_deref();
        Some((normals, indices.unwrap_or_else(|| mesh.triangles())))
    }

    /// An object's normals in world space.
    fn normals_in_world(&self, number: u32, normals: Option<[Vec3; 3]>) -> Option<[Vec3; 3]> {
        let world_from_object = self.world_normals.get(number as usize).copied().flatten()?;
        Some(normals?.map(|normal| (world_from_object * normal).normalize_or_zero()))
    }
}

/// Normals by the crease angle of each object that has none of its own; empty where the mode or the angle needs none.
pub(super) fn creased(scene: &Scene, shading: &Shading) -> Vec<Option<Arc<Attribute<Vec3>>>> {
    if !shading.is_creased() {
        return Vec::new();
    }
    let normals = |object: &Object| {
        let has_none = object.visible && !object.mesh.has_normals();
        has_none.then(|| object.mesh.creased(shading.crease))
    };
    scene.objects.iter().map(normals).collect()
}

/// The normal matrix of each object, world from object: the inverse transpose of its transform.
pub(super) fn world_normals(scene: &Scene) -> Vec<Option<Mat3>> {
    let transforms = scene
        .world_from_objects()
        .unwrap_or_else(|_| vec![DAffine3::IDENTITY; scene.objects.len()]);
    transforms.iter().map(normals_to_world).collect()
}
