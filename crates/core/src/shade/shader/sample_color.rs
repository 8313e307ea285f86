//! The colour of a sample on a triangle.

use super::{Shader, opaque};
use crate::hit::{Cull, Precision, PrimitiveHit};
use crate::num::simd::Lanes;
use crate::scene::{Reflectance, Texture};
use crate::shade::Mode;
use crate::shade::edges::EdgeLines;
use crate::shade::facet::{Facet, Interpolation, Mapping, Varied, blend, unit};
use crate::shade::interpolants::HitParameters;
use crate::shade::reflection::{self, PlainReflectance, Surface, Surfaces};
use crate::shade::slopes::slopes;
use crate::shade::vectors::Vectors;
use crate::triangle::BoundedHit;
use glam::{DVec3, Vec2, Vec3};

impl Shader<'_> {
    /// The colour of a sample on a triangle: linear light, straight alpha.
    pub(in crate::shade) fn color_on(
        &self,
        facet: &Facet,
        x: f64,
        y: f64,
        hit: &PrimitiveHit,
    ) -> [f32; 4] {
        let color = self.with_lines(facet, x, y, hit);
        // Behind translucent surfaces the ground is composited last, by `behind`.
        if self.translucent.is_some() {
            color
        } else {
            self.grounded(x, y, hit.t, color)
        }
    }

    /// The colour of a sample on a triangle and the lines over it.
    fn with_lines(&self, facet: &Facet, x: f64, y: f64, hit: &PrimitiveHit) -> [f32; 4] {
        let inside = self.inside(facet, x, y, hit);
        let Some(edges) = &facet.edges else {
            return inside;
        };
        let lines = &self.lines;
        if self.is_panoramic() {
            let corners = self.corners(hit.primitive, x);
            let edges = EdgeLines::at(&self.camera, corners, (x, y)).chosen_as(edges);
            return lines.over(edges.coverage(x, y, lines.width), inside);
        }
        let inside = lines.seen_through(x, y, inside);
        let lined = lines.over(edges.coverage(x, y, lines.width), inside);
        lines.outlined(x, y, hit.t, lined)
    }

    /// The colour of a sample on a triangle, without lines.
    pub(in crate::shade) fn inside(
        &self,
        facet: &Facet,
        x: f64,
        y: f64,
        hit: &PrimitiveHit,
    ) -> [f32; 4] {
        let hit = &self.interpolated(facet, (x, y), hit);
        match self.shading.mode {
            Mode::Color => opaque(self.own_color(facet, hit.u, hit.v)),
            Mode::Texture => opaque(self.surface_color(facet, || (x, y), hit)),
            Mode::Flat => opaque(self.surface_color(facet, || (x, y), hit) * facet.light),
            Mode::Smooth | Mode::XRay => {
                let to_eye = self.to_eye_at(x, y);
                let light = self.lights.on(facet.normal_of(x, y, hit), to_eye);
                opaque(self.surface_color(facet, || (x, y), hit) * light)
            }
            Mode::Material => opaque(self.reflected(facet, (x, y), hit)),
            Mode::Normals => self.displayed(facet.normal_of(x, y, hit) * 0.5 + 0.5),
            Mode::Depth => opaque(self.depth.at(hit.t, self.tables)),
            Mode::Barycentric => self.displayed(Vec3::new(1.0 - hit.u - hit.v, hit.u, hit.v)),
            Mode::Uv => {
                let uv = facet.uvs.map_or(Vec2::ZERO, |uvs| blend(uvs, hit.u, hit.v));
                let uv = uv - uv.floor();
                self.displayed(Vec3::new(uv.x, uv.y, 0.25))
            }
            Mode::Wireframe => self.backdrop(y),
        }
    }

    /// An opaque colour given in sRGB, 0 to 1.
    pub(super) fn displayed(&self, value: Vec3) -> [f32; 4] {
        opaque(value.to_array().map(|v| self.tables.display(v)).into())
    }

    /// The light that a material reflects and emits.
    fn reflected(&self, facet: &Facet, (x, y): (f64, f64), hit: &PrimitiveHit) -> Vec3 {
        let base = self.surface_color(facet, || (x, y), hit);
        let PlainReflectance {
            mut factors,
            mut emission,
            is_unlit,
        } = self.plain_reflectance(facet);
        if is_unlit {
            return base;
        }
        if let Some(material) = self.reflectance(facet) {
            (factors, emission) = self.texturing.reflectance(material, facet.uvs, hit);
        }
        let [metallic, roughness] = factors;
        let surface = Surface {
            base,
            metallic,
            roughness,
        };
        let to_eye = self.to_eye_at(x, y);
        let normal = facet.normal_of(x, y, hit);
        reflection::reflected(&self.lights, surface, normal, to_eye) + emission
    }

    /// The reflectance of a triangle's material, where the file gives it.
    fn reflectance(&self, facet: &Facet) -> Option<&Reflectance> {
        let materials = self.scene.objects[facet.object as usize].mesh.materials();
        let material = materials.get(facet.material? as usize)?;
        material.reflectance.as_deref()
    }

    /// The reflectance of a triangle's material without its images; the default where the file gives none.
    pub(in crate::shade) fn plain_reflectance(&self, facet: &Facet) -> PlainReflectance {
        let default = Reflectance::default();
        let material = self.reflectance(facet);
        let &Reflectance {
            metallic,
            roughness,
            emission,
            is_unlit,
            ..
        } = material.unwrap_or(&default);
        PlainReflectance {
            // A file's values are clamped; the default is in range.
            factors: [metallic, roughness].map(|factor| factor.clamp(0.0, 1.0)),
            emission: match material {
                Some(_) => Vec3::from(emission),
                None => Vec3::ZERO,
            },
            is_unlit,
        }
    }

    /// The light that eight surfaces reflect.
    #[inline(always)]
    pub(in crate::shade) fn eight_reflected<L: Lanes>(
        &self,
        lanes: L,
        surfaces: &Surfaces<L>,
        normal: Vectors<L>,
        to_eye: Vectors<L>,
    ) -> Vectors<L> {
        reflection::eight_reflected(lanes, &self.lights, surfaces, normal, to_eye)
    }

    /// The unit vector from a sample to the eye.
    pub(in crate::shade) fn to_eye_at(&self, x: f64, y: f64) -> Vec3 {
        if self.is_panoramic() {
            return -unit(self.camera.direction(x, y)).as_vec3();
        }
        let [corner, right, down] = self.to_eye;
        let to_eye = corner + right * x as f32 + down * y as f32;
        to_eye * (1.0 / to_eye.length())
    }

    /// The triangle's own colour at barycentrics (u, v): linear light.
    #[inline(always)]
    pub(in crate::shade) fn own_color(&self, facet: &Facet, u: f32, v: f32) -> Vec3 {
        match &facet.varied {
            Varied::No => facet.color,
            Varied::Colors(colors) => blend(*colors, u, v),
            varied => self.own_colors.of_number(facet.object, varied, u, v),
        }
    }

    /// The triangle's colour and its texture, mixed in linear light. `place`, the sample's place in the picture, is asked for
    /// by filters with a footprint alone.
    #[inline]
    pub(in crate::shade) fn surface_color(
        &self,
        facet: &Facet,
        place: impl FnOnce() -> (f64, f64),
        hit: &PrimitiveHit,
    ) -> Vec3 {
        let color = self.own_color(facet, hit.u, hit.v);
        let Some(mapping) = &facet.texture else {
            return color;
        };
        let Some(texture) = self.texture_on(facet) else {
            return color;
        };
        let texture = (facet.object, texture);
        let [r, g, b, a] = if self.shading.filter.has_footprint() {
            self.filtered(texture, mapping, place(), hit)
        } else {
            self.texturing.sampled(texture, mapping, hit)
        };
        let blend = self.shading.blend * facet.blend_at(hit.u, hit.v);
        let texel = Vec3::new(r, g, b);
        let texel = if facet.is_tinted {
            texel * color
        } else {
            texel
        };
        color * (1.0 - a * blend) + texel * blend
    }

    /// Whether any hit's colour depends on [`TileShader::taken_from`](super::TileShader::taken_from).
    pub(crate) fn has_photographs(&self) -> bool {
        self.texturing.has_photographs()
    }

    /// The eye of the photograph that a hit on a triangle shows if it is visible from there.
    pub(in crate::shade) fn taken_from(&self, facet: &Facet, hit: &PrimitiveHit) -> Option<DVec3> {
        let mapping = facet.texture.as_ref()?;
        let texture = self.texture_on(facet)?;
        self.texturing
            .taken_from((facet.object, texture), mapping, hit)
    }

    /// The texture filtered over the footprint of the sample at a place.
    #[inline(never)]
    fn filtered(
        &self,
        texture: (u32, &Texture),
        mapping: &Mapping,
        place: (f64, f64),
        hit: &PrimitiveHit,
    ) -> [f32; 4] {
        let corners = self.corners(hit.primitive, place.0);
        let slopes = slopes(&self.camera, corners, place, (hit.u, hit.v));
        let slopes = slopes.map(|slope| slope * self.sample_width);
        self.texturing.filtered(texture, mapping, hit, slopes)
    }

    /// The hit of a triangle's sample with t, u and v as colours take them.
    #[inline(always)]
    fn interpolated(&self, facet: &Facet, (x, y): (f64, f64), hit: &PrimitiveHit) -> PrimitiveHit {
        match (&facet.interpolation, &self.planar) {
            (Interpolation::Linear(interpolants), Some(rays)) => {
                let HitParameters { t, u, v } = interpolants.at(rays, x, y);
                PrimitiveHit { t, u, v, ..*hit }
            }
            (Interpolation::Ray, _) => self.cast_again(hit.primitive, (x, y)),
            _ => *hit,
        }
    }

    /// The hit of a sample's ray with the triangle that it is known to hit.
    #[inline(never)]
    fn cast_again(&self, primitive: u32, (x, y): (f64, f64)) -> PrimitiveHit {
        let ray = self.camera.ray(x, y);
        let ray = self.accel.prepare(&ray, Cull::None, Precision::Exact);
        let hit = ray.map(|ray| ray.hit_on(primitive, self.accel.corners(primitive)));
        PrimitiveHit {
            primitive,
            ..hit.map_or(PrimitiveHit::NONE, BoundedHit::to_primitive_hit)
        }
    }
}
