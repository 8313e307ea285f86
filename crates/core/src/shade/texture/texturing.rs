//! Colours of textures on surfaces.

use super::footprint::{Footprint, sample_over};
use super::mapping::ObjectMapping;
use super::triplanar::Triplanar;
use crate::hit::PrimitiveHit;
use crate::scene::{Object, Reflectance, Scene, Texture};
use crate::shade::facet::{Mapping, blend};
use crate::shade::sample::sample;
use crate::shade::srgb::{self, Tables};
use crate::shade::texels;
use crate::shade::{Filter, Shading};
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::sync::Arc;

/// The mappings of a scene's textures, and how they are filtered.
#[derive(Debug)]
pub(in crate::shade) struct Texturing {
    /// For each object; empty where no texture is shown.
    mappings: Vec<Option<ObjectMapping>>,
    shading: Shading,
    tables: &'static Tables,
}

impl Texturing {
    /// For the objects of a scene, if textures are shown. Corners in world space are relative to `origin`.
    pub(in crate::shade) fn new(
        scene: &Scene,
        shading: Shading,
        origin: DVec3,
        is_shown: bool,
    ) -> Self {
        let mapping = |object: &Object| {
            let has_texture = object.has_texture();
            has_texture.then(|| ObjectMapping::new(object, shading.projection, origin))?
        };
        let tables = srgb::tables();
        if is_shown && shading.filter == Filter::Bilinear {
            texels::keep(tables, scene);
        }
        Self {
            mappings: if is_shown {
                scene.objects.iter().map(mapping).collect()
            } else {
                Vec::new()
            },
            shading,
            tables,
        }
    }

    /// The mapping of an object's texture to a triangle, whose corners `in_world` gives; `None` where it has none.
    pub(in crate::shade) fn mapping(
        &self,
        number: u32,
        object: &Object,
        triangle: u32,
        in_world: impl FnOnce() -> [Vec3; 3],
    ) -> Option<Mapping> {
        self.of(number)?.on(object, triangle, in_world)
    }

    /// Whether any texture is a photograph.
    pub(in crate::shade) fn has_photographs(&self) -> bool {
        let mut mappings = self.mappings.iter().flatten();
        mappings.any(|mapping| matches!(mapping, ObjectMapping::Photographed(_)))
    }

    /// The eye of the photograph that a hit shows if it is visible from there.
    pub(in crate::shade) fn taken_from(
        &self,
        (number, texture): (u32, &Texture),
        mapping: &Mapping,
        hit: &PrimitiveHit,
    ) -> Option<DVec3> {
        let (Mapping::Photographed(corners), Some(ObjectMapping::Photographed(photographed))) =
            (mapping, self.of(number))
        else {
            return None;
        };
        let place = photographed.within(between(*corners, hit), texture);
        place.map(|_| photographed.eye())
    }

    /// How an object's textures are mapped from three sides, if they are.
    #[inline]
    pub(in crate::shade) fn triplanar(&self, number: u32) -> Option<&Triplanar> {
        match self.of(number)? {
            ObjectMapping::Triplanar(triplanar) => Some(triplanar),
            _ => None,
        }
    }

    /// The texture's colour at a hit: linear light, premultiplied alpha.
    pub(in crate::shade) fn sampled(
        &self,
        (number, texture): (u32, &Texture),
        mapping: &Mapping,
        hit: &PrimitiveHit,
    ) -> [f32; 4] {
        let read = |u, v| sample(self.tables, texture, u, v, self.shading.filter);
        match mapping {
            Mapping::Uv(uvs) => {
                // In double precision, so that large coordinates stay accurate within a repeat.
                let [a, b, c] = uvs.map(|uv| uv.as_dvec2());
                let (u, v) = (f64::from(hit.u), f64::from(hit.v));
                let uv = a + (b - a) * u + (c - a) * v;
                read(uv.x, uv.y)
            }
            Mapping::Triplanar(corners, normals) => {
                let Some(ObjectMapping::Triplanar(triplanar)) = self.of(number) else {
                    return [0.0; 4];
                };
                let point = blend(*corners, hit.u, hit.v);
                let normal = blend(*normals, hit.u, hit.v).normalize_or_zero();
                let mut color = [0.0; 4];
                for side in triplanar.sides(point, normal) {
                    if side.weight > 0.0 {
                        let part = read(side.uv[0], side.uv[1]);
                        for (sum, channel) in color.iter_mut().zip(part) {
                            *sum += channel * side.weight;
                        }
                    }
                }
                color
            }
            Mapping::Placed(corners) => {
                let Some(ObjectMapping::Placed(placed)) = self.of(number) else {
                    return [0.0; 4];
                };
                let uv = placed.at(between(*corners, hit));
                read(uv.x, uv.y)
            }
            Mapping::Photographed(corners) => {
                let Some(ObjectMapping::Photographed(photographed)) = self.of(number) else {
                    return [0.0; 4];
                };
                let place = photographed.within(between(*corners, hit), texture);
                place.map_or([0.0; 4], |uv| read(uv.x, uv.y))
            }
        }
    }

    /// A material's metallic, roughness and emission at a hit. Their images are read as textures are, but without a
    /// footprint: bilinear or nearest.
    pub(in crate::shade) fn reflectance(
        &self,
        material: &Reflectance,
        uvs: Option<[Vec2; 3]>,
        hit: &PrimitiveHit,
    ) -> ([f32; 2], Vec3) {
        let filter = match self.shading.filter {
            Filter::Nearest => Filter::Nearest,
            Filter::Bilinear | Filter::Trilinear | Filter::Ewa => Filter::Bilinear,
        };
        // An image without texture coordinates is ignored.
        let read = |texture: &Option<Arc<Texture>>, tables| {
            let (texture, [a, b, c]) = (texture.as_ref()?, uvs?.map(|uv| uv.as_dvec2()));
            let uv = a + (b - a) * f64::from(hit.u) + (c - a) * f64::from(hit.v);
            let [r, g, b, alpha] = sample(tables, texture, uv.x, uv.y, filter);
            // Alpha does not apply to them.
            (alpha > 0.0).then(|| Vec3::new(r, g, b) / alpha)
        };
        let factors = read(&material.texture, srgb::numbers()).unwrap_or(Vec3::ONE);
        let glow = read(&material.emission_texture, self.tables).unwrap_or(Vec3::ONE);
        let metallic = (material.metallic * factors.z).clamp(0.0, 1.0);
        let roughness = (material.roughness * factors.y).clamp(0.0, 1.0);
        ([metallic, roughness], Vec3::from(material.emission) * glow)
    }

    /// As [`Texturing::sampled`], over the pixel's footprint; `slopes` are the change of the hit's barycentrics from
    /// pixel to pixel, to the right and down.
    pub(in crate::shade) fn filtered(
        &self,
        (number, texture): (u32, &Texture),
        mapping: &Mapping,
        hit: &PrimitiveHit,
        slopes: [DVec2; 2],
    ) -> [f32; 4] {
        let read = |uv: DVec2, [across, down]: [DVec2; 2]| {
            let footprint = Footprint { across, down };
            sample_over(self.tables, texture, uv, footprint, self.shading.filter)
        };
        match mapping {
            Mapping::Uv(uvs) => {
                let [a, b, c] = uvs.map(|uv| uv.as_dvec2());
                let (u, v) = (f64::from(hit.u), f64::from(hit.v));
                let along = |slope: DVec2| (b - a) * slope.x + (c - a) * slope.y;
                read(a + (b - a) * u + (c - a) * v, slopes.map(along))
            }
            Mapping::Triplanar(corners, normals) => {
                let Some(ObjectMapping::Triplanar(triplanar)) = self.of(number) else {
                    return [0.0; 4];
                };
                let point = blend(*corners, hit.u, hit.v);
                let normal = blend(*normals, hit.u, hit.v).normalize_or_zero();
                let steps = slopes.map(|slope| triplanar.along(moved(*corners, slope), normal));
                let mut color = [0.0; 4];
                for (at, side) in triplanar.sides(point, normal).into_iter().enumerate() {
                    if side.weight > 0.0 {
                        let steps = steps.map(|sides| DVec2::from_array(sides[at]));
                        let part = read(DVec2::from_array(side.uv), steps);
                        for (sum, channel) in color.iter_mut().zip(part) {
                            *sum += channel * side.weight;
                        }
                    }
                }
                color
            }
            Mapping::Placed(corners) => {
                let Some(ObjectMapping::Placed(placed)) = self.of(number) else {
                    return [0.0; 4];
                };
                let point = between(*corners, hit);
                let steps = slopes.map(|slope| placed.along(point, moved(*corners, slope)));
                read(placed.at(point), steps)
            }
            Mapping::Photographed(corners) => {
                let Some(ObjectMapping::Photographed(photographed)) = self.of(number) else {
                    return [0.0; 4];
                };
                let point = between(*corners, hit);
                let along = |slope| photographed.along(point, moved(*corners, slope), texture);
                let place = photographed.within(point, texture);
                place.map_or([0.0; 4], |uv| read(uv, slopes.map(along)))
            }
        }
    }

    fn of(&self, number: u32) -> Option<&ObjectMapping> {
        self.mappings.get(number as usize)?.as_ref()
    }
}

/// A hit's point between corners, in double precision.
fn between(corners: [Vec3; 3], hit: &PrimitiveHit) -> DVec3 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    a + (b - a) * f64::from(hit.u) + (c - a) * f64::from(hit.v)
}

/// The movement of a point between corners for a change of its barycentrics.
fn moved(corners: [Vec3; 3], by: DVec2) -> DVec3 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    (b - a) * by.x + (c - a) * by.y
}
