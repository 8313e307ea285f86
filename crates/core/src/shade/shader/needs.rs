//! What a mode needs of hits and of triangles, and whether it is shaded eight samples at once. What is not needed is not
//! computed.

use super::Shader;
use crate::hit::{Detail, HitNumbers};
use crate::scene::{Object, Reflectance, Scene};
use crate::shade::eight_colors::{EightColors, RowColors};
use crate::shade::facet::Needs;
use crate::shade::interpolants::PlanarRays;
use crate::shade::own_color::OwnColors;
use crate::shade::{Mode, Shading};
use std::sync::Arc;

/// The fewest pixels of the picture for each of the scene's triangles with which depths and weights come from linear
/// functions.
///
/// Linear functions are prepared once a triangle, while interpolating from the corners prepares nothing. Chosen between two
/// measured scenes: with 30 pixels a triangle functions saved a fifth of the picture's time, with 5 shading took twice as
/// long. A lower limit slows fine meshes, a higher one leaves coarse ones slow. It counts the whole picture, so that the
/// colours of a tile do not depend on its size.
const PIXELS_A_TRIANGLE: f64 = 16.0;

impl Shader<'_> {
    /// Whether colours depend on where rays hit, or on the triangles and the places of the samples alone.
    pub fn detail(&self) -> Detail {
        if !self.needs.interpolants && (self.varies_within_triangles() || self.needs_hits()) {
            Detail::Full
        } else {
            Detail::Triangle
        }
    }

    /// Whether colours depend on t, u or v.
    fn varies_within_triangles(&self) -> bool {
        let needs = self.needs;
        let weighs = needs.smooth || needs.texture || needs.uvs || needs.varied;
        weighs || matches!(self.shading.mode, Mode::Barycentric | Mode::Depth)
    }

    /// Whether t, u and v of the hits themselves are needed beside colours: by lines and grounds that they are nearer than,
    /// and by what casts other rays from them.
    fn needs_hits(&self) -> bool {
        let has_silhouettes = self.needs.edges && self.lines.has_silhouettes();
        has_silhouettes || self.ground.is_some()
    }

    /// Whether colours can take t, u and v from linear functions of the place.
    pub(super) fn can_interpolate(&self) -> bool {
        let casts_others = self.has_photographs() || self.translucent.is_some();
        self.varies_within_triangles()
            && !self.needs_hits()
            && !casts_others
            && !self.shows_numbers_of_small_triangles()
            && self.eight_colors().is_some()
    }

    /// Whether pictures show t, u or v themselves, for which nothing else of a triangle is prepared, and have few pixels
    /// for each of the scene's triangles.
    fn shows_numbers_of_small_triangles(&self) -> bool {
        let shows_numbers = matches!(self.shading.mode, Mode::Barycentric | Mode::Depth);
        shows_numbers && self.has_small_triangles()
    }

    /// Which of t, u and v colours depend on.
    pub(crate) fn hit_numbers(&self) -> HitNumbers {
        let has_lines = self.needs.edges || self.ground.is_some();
        match self.shading.mode {
            _ if has_lines || self.has_photographs() || self.translucent.is_some() => {
                HitNumbers::All
            }
            Mode::Depth => HitNumbers::T,
            _ => HitNumbers::Weights,
        }
    }

    /// Which of t, u and v a picture with layers depends on.
    pub(crate) fn layer_numbers(&self) -> HitNumbers {
        let colors = match self.detail() {
            Detail::Full => self.hit_numbers(),
            Detail::Triangle => HitNumbers::T,
        };
        let mut meshes = self.scene.objects.iter().map(|object| &object.mesh);
        let weighs = meshes.any(|mesh| mesh.has_normals() || mesh.has_uvs());
        match colors {
            HitNumbers::T if !weighs => HitNumbers::T,
            _ => HitNumbers::All,
        }
    }

    /// Whether all pixels of a triangle have one colour.
    pub(in crate::shade) fn is_constant(&self) -> bool {
        self.has_constant_surfaces() && !self.needs.edges
    }

    /// Whether all pixels of a triangle that no lines cover have one colour.
    pub(in crate::shade) fn has_constant_surfaces(&self) -> bool {
        let is_flat = match self.shading.mode {
            Mode::Color | Mode::Flat | Mode::Texture => true,
            Mode::Normals => !self.needs.smooth,
            _ => false,
        };
        is_flat
            && !self.needs.texture
            && !self.needs.varied
            && self.ground.is_none()
            && !self.has_many_eyes()
    }

    /// Whether that colour is the triangle's own under the light on all of it.
    pub(in crate::shade) fn has_flat_triangles(&self) -> bool {
        self.needs.light && self.is_constant()
    }

    /// Whether the picture has few pixels for each of the scene's triangles.
    fn has_small_triangles(&self) -> bool {
        let plane = self.camera.plane();
        let pixels = f64::from(plane.columns) * f64::from(plane.rows);
        pixels < PIXELS_A_TRIANGLE * self.accel.len() as f64
    }

    /// Whether colours of eight samples at once depend on the direction to the eye.
    pub(in crate::shade) fn looks_at_eyes(&self) -> bool {
        let colors = self.eight_colors();
        matches!(colors, Some(EightColors::Smooth | EightColors::Material))
    }

    /// How eight samples are shaded at once; `None` where samples are shaded one by one.
    pub(in crate::shade) fn eight_colors(&self) -> Option<EightColors> {
        let is_parallel = self.camera.projection().is_parallel();
        let shows_ground = self.ground.is_some() && is_parallel;
        let bends_lines = self.needs.edges && self.is_panoramic();
        if shows_ground || bends_lines || self.has_many_eyes() {
            return None;
        }
        match self.shading.mode {
            Mode::Color | Mode::Texture => Some(EightColors::Own),
            Mode::Flat => Some(EightColors::Flat),
            Mode::Smooth | Mode::XRay => Some(EightColors::Smooth),
            // Images of metal and roughness are read one by one.
            Mode::Material if !self.needs.uvs => Some(EightColors::Material),
            Mode::Normals => Some(EightColors::Normals),
            Mode::Depth if self.depth.are_grey() => Some(EightColors::Depth),
            Mode::Barycentric => Some(EightColors::Barycentric),
            Mode::Uv => Some(EightColors::Uv),
            Mode::Wireframe if self.background.is_some() => Some(EightColors::Lines),
            _ => None,
        }
    }
}

impl Shader<'_> {
    /// How whole rows are shaded, and by which rays; `None` where eight samples are shaded at once.
    pub(in crate::shade) fn row_colors(
        &self,
        colors: EightColors,
    ) -> Option<(RowColors, &PlanarRays)> {
        let needs = self.needs;
        let has_footprints = needs.texture && self.filter().has_footprint();
        let has_chosen_lines = needs.edges && self.lines.choice.is_some();
        let others = has_chosen_lines || has_footprints || needs.varied || self.has_overlay();
        if others {
            return None;
        }
        let rays = self.planar.as_ref()?;
        let colors = match colors {
            EightColors::Smooth if !needs.smooth && !needs.texture => Some(RowColors::Facets),
            _ if !needs.interpolants => None,
            EightColors::Own if needs.texture => Some(RowColors::Own),
            EightColors::Flat if needs.texture => Some(RowColors::Flat),
            EightColors::Smooth if needs.texture => Some(RowColors::SmoothTextured),
            EightColors::Smooth => Some(RowColors::Smooth),
            EightColors::Normals => Some(RowColors::Normals),
            EightColors::Depth => Some(RowColors::Depth),
            EightColors::Barycentric => Some(RowColors::Barycentric),
            EightColors::Uv => Some(RowColors::Uv),
            _ => None,
        };
        Some((colors?, rays))
    }
}

/// What a mode needs of triangles.
pub(super) fn needs_of(scene: &Scene, shading: &Shading, own_colors: &OwnColors) -> Needs {
    let shows = shading.mode.shows();
    let has_normals = || {
        let mut objects = scene.objects.iter();
        shading.is_creased() || objects.any(|object| object.mesh.has_normals())
    };
    let reflects = shading.mode == Mode::Material;
    let has_images = || {
        let mut objects = scene.objects.iter();
        objects.any(|object| {
            let mut materials = object.mesh.materials().iter();
            let has_images = |known: &Arc<Reflectance>| known.has_textures();
            materials.any(|material| material.reflectance.as_ref().is_some_and(has_images))
        })
    };
    let has_texture = || scene.objects.iter().any(Object::has_texture);
    Needs {
        normal: shading.mode == Mode::Flat || shows.normals,
        light: shading.mode == Mode::Flat,
        smooth: shows.normals && has_normals(),
        color: shows.colors,
        varied: shows.colors && own_colors.vary,
        texture: shows.textures && shading.blend > 0.0 && has_texture(),
        uvs: shading.mode == Mode::Uv || reflects && has_images(),
        reflectance: reflects,
        edges: shading.wireframe.is_some() || shading.mode == Mode::Wireframe,
        ground: false,
        interpolants: false,
    }
}
