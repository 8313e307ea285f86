//! The colour of a surface at a hit: its own, its texture's, and its material's.

use super::photograph::{self, ShownPart};
use super::range::{Single, Vector, plus};
use super::{Expected, Hit, light, normal, reflection, srgb, texture};
use raycast_core::scene::{ColorRule, Reflectance, Texture, TextureProjection, Wrap};
use raycast_core::shade::Filter;
use std::sync::Arc;

impl Expected<'_> {
    /// The triangle's colour and the texture, blended in linear light.
    pub(super) fn surface_color(&self, hit: &Hit<'_>) -> Vector<24> {
        let color = self.own_color(hit);
        let Some(texture) = hit.object.texture_on(hit.triangle) else {
            return color;
        };
        if self.shading.blend <= 0.0 {
            return color;
        }
        let mesh = &hit.object.mesh;
        let filter = self.shading.filter;
        let own = hit.object.mapping.projection;
        let projection = own.unwrap_or(self.shading.projection);
        let by_uv = match projection {
            TextureProjection::Uv => mesh.has_uvs(),
            TextureProjection::Camera => false,
            TextureProjection::Triplanar => false,
            // Not computed independently.
            TextureProjection::PerTriangle
            | TextureProjection::Plane
            | TextureProjection::Sphere
            | TextureProjection::Cylinder => return [Single::UNKNOWN; 3],
        };
        let is_photograph = projection == TextureProjection::Camera;
        if texture.wrap() != [Wrap::Repeat; 2] && !is_photograph
            || !matches!(filter, Filter::Nearest | Filter::Bilinear)
        {
            return [Single::UNKNOWN; 3];
        }
        let [r, g, b, a] = if is_photograph {
            let Some(taken) = &hit.object.mapping.photograph else {
                return color;
            };
            let numbers = (hit.number, hit.triangle);
            let stage = (self.stage, self.cull);
            match photograph::place(stage, numbers, hit.weights, taken, texture) {
                ShownPart::None => return color,
                ShownPart::At(place) => texture::sample(texture, place, filter),
                ShownPart::Unknown => return [Single::UNKNOWN; 3],
            }
        } else if !by_uv {
            let Some(Some(repeat)) = self.repeats.get(hit.number as usize) else {
                return [Single::UNKNOWN; 3];
            };
            let surface = (&**mesh, repeat);
            texture::triplanar(surface, hit.triangle, hit.weights, texture, filter)
        } else {
            let Some(uvs) = mesh.corner_uvs(hit.triangle) else {
                return color;
            };
            let [_, u, v] = hit.weights;
            texture::sample(texture, texture::place(uvs, u, v), filter)
        };
        // A file's material multiplies its image by the vertex colours.
        let of_material = hit
            .object
            .texture
            .is_none()
            .then(|| mesh.material(hit.triangle));
        let is_tinted = of_material
            .flatten()
            .is_some_and(|material| material.by_vertex);
        let [r, g, b] = match is_tinted {
            true => std::array::from_fn(|i| [r, g, b][i] * color[i]),
            false => [r, g, b],
        };
        let mut blend = Single::exactly(self.shading.blend.into());
        if let Some(numbers) = hit.object.blend_numbers(hit.triangle) {
            if !numbers.iter().all(|number| number.is_finite()) {
                return [Single::UNKNOWN; 3];
            }
            let corners = numbers.map(|number| [Single::exactly(number.into())]);
            let [share] = normal::blend(corners, hit.weights);
            blend = blend * share.max(0.0).min(1.0);
        }
        let rest = Single::exactly(1.0) - a * blend;
        plus(color.map(|c| c * rest), [r, g, b].map(|c| c * blend))
    }

    /// The light that a material reflects and emits.
    pub(super) fn reflected(&self, hit: &Hit<'_>, (x, y): (f64, f64)) -> Vector<24> {
        let base = self.surface_color(hit);
        let mesh = &hit.object.mesh;
        let by_file = matches!(hit.object.color, ColorRule::File);
        let material = mesh.material(hit.triangle).filter(|_| by_file);
        let usual = Reflectance::default();
        let known = material.and_then(|material| material.reflectance.as_deref());
        let known = known.unwrap_or(&usual);
        if known.is_unlit {
            return base;
        }
        let filter = match self.shading.filter {
            Filter::Nearest => Filter::Nearest,
            _ => Filter::Bilinear,
        };
        let place = mesh.corner_uvs(hit.triangle).map(|uvs| {
            let [_, u, v] = hit.weights;
            texture::place(uvs, u, v)
        });
        let one = Single::exactly(1.0);
        let number = |factor: f32| Single::exactly(factor.into());
        // Images with other wrapping or with transparency are not computed independently.
        let is_plain = |texture: &Texture| {
            texture.wrap() == [Wrap::Repeat; 2] && texture.texels().iter().all(|t| t[3] == 255)
        };
        let read = |texture: &Option<Arc<Texture>>, of: fn(u8) -> Single| -> Vector<24> {
            match (texture, place) {
                (Some(texture), Some(place)) if is_plain(texture) => {
                    let [r, g, b, a] = texture::sample_bytes_as(texture, place, filter, of);
                    [r, g, b].map(|channel| channel / a)
                }
                (Some(_), Some(_)) => [Single::UNKNOWN; 3],
                _ => [one; 3],
            }
        };
        let share = |byte: u8| Single::exactly(f64::from(byte) / 255.0).rounded();
        let [_, rough, metal] = read(&known.texture, share);
        let glow = read(&known.emission_texture, srgb::byte_to_linear);
        let shares = [
            number(known.metallic) * metal,
            number(known.roughness) * rough,
        ];
        let shares = shares.map(|share| share.max(0.0).min(1.0));
        let normal = self.shown_normal(hit);
        let to_eye = light::to_eye(&self.camera, x, y);
        let light = reflection::reflected(&self.lights, base, shares, normal, to_eye);
        std::array::from_fn(|i| light[i] + number(known.emission[i]) * glow[i])
    }
}
