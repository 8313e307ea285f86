//! A glTF file's materials.

use super::data::{Bytes, Data};
use super::json::{Material as MaterialJson, Primitive, TextureInfo, TextureTransform};
use crate::formats::error::FormatError;
use crate::formats::texture;
use crate::math;
use crate::quote;
use crate::scene::{Alpha, Color, Material, Opacity, Reflectance, Texture, Wrap};
use crate::shade::srgb;
use glam::{DVec2, Vec2};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::ops::Deref;
use std::path::Path;
use std::sync::Arc;

/// The brightest emission of a material: far beyond any picture, and far from the end of single precision.
const MAX_EMISSION: f64 = 1e30;

/// White, opaque.
const WHITE: [f64; 4] = [1.0; 4];

/// A material's base colour, as the file has it.
#[derive(Clone, Copy)]
pub(super) struct Base<'d> {
    /// Linear light.
    pub(super) factor: [f64; 4],
    pub(super) texture: Option<&'d TextureInfo>,
    /// The image whose coordinates are used for the mesh: that of the base colour, else another of the material's
    /// images.
    pub(super) placed: Option<&'d TextureInfo>,
}

/// An image's index and its wrapping.
type ImageKey = (u32, [Wrap; 2]);

/// The materials of one file, and the textures made of their images.
pub(super) struct Materials<'m, 'd> {
    data: &'m Data<'d>,
    /// By image and wrapping; `None` for an image that cannot be read, which is warned about once.
    images: HashMap<ImageKey, Option<Arc<Texture>>>,
    /// Images that were decoded before they were asked for.
    ahead: HashMap<u32, Texture>,
    /// By image, wrapping and factor.
    tinted: HashMap<(u32, [Wrap; 2], [u64; 3]), Arc<Texture>>,
    /// Counts of used materials, by feature that is not shown.
    unused: BTreeMap<&'static str, usize>,
    is_reported: Vec<bool>,
    /// The number of used materials that are blended.
    pub(super) blended: usize,
    pub(super) warnings: Vec<String>,
}

impl<'m, 'd> Materials<'m, 'd> {
    pub(super) fn new(data: &'m Data<'d>) -> Self {
        Self {
            data,
            images: HashMap::new(),
            ahead: HashMap::new(),
            tinted: HashMap::new(),
            unused: BTreeMap::new(),
            is_reported: vec![false; data.root.materials.len()],
            blended: 0,
            warnings: Vec::new(),
        }
    }

    /// Decodes the images of the materials of these meshes, all at once.
    pub(super) fn decode_ahead(&mut self, meshes: impl IntoIterator<Item = u32>) {
        let data = self.data;
        let meshes: BTreeSet<u32> = meshes.into_iter().collect();
        let lists = meshes.into_iter().filter_map(|mesh| {
            let mesh = data.root.meshes.get(mesh as usize)?;
            Some(&mesh.primitives)
        });
        let wanted: BTreeSet<u32> = lists
            .flatten()
            .flat_map(|primitive| self.images_of(primitive))
            .collect();
        if wanted.len() < 2 {
            return;
        }
        let found: Vec<_> = wanted
            .into_iter()
            .filter_map(|image| Some((image, self.image_bytes(image).ok()?)))
            .collect();
        let files: Vec<_> = found
            .iter()
            .map(|(image, bytes)| (*image, bytes.path(data.path), &**bytes))
            .collect();
        let ahead = texture::decode_ahead(&files, data.files.budget());
        let good = ahead
            .into_iter()
            .filter_map(|(image, read)| Some((image, read.ok()?)));
        self.ahead = good.collect();
    }

    /// The images that [`Materials::material`] will ask for, as far as nothing is wrong with them.
    fn images_of(&self, primitive: &Primitive) -> Vec<u32> {
        let (root, material) = (self.data.root, primitive.material);
        let json = material.and_then(|index| root.materials.get(index as usize));
        let base = material.and_then(|index| self.base(index, "").ok());
        let Some((json, placed)) = json.zip(base.and_then(|base| base.placed)) else {
            return Vec::new();
        };
        let coordinates = format!("TEXCOORD_{}", Coordinates::set(placed));
        if !primitive.attributes.contains_key(coordinates.as_str()) {
            return Vec::new();
        }
        let pbr = &json.pbr_metallic_roughness;
        let others = match json.extensions.specular_glossiness {
            Some(_) => [None, json.emissive_texture.as_ref()],
            None => [
                pbr.metallic_roughness_texture.as_ref(),
                json.emissive_texture.as_ref(),
            ],
        };
        let others = others.into_iter().flatten();
        let others = others.filter(|info| are_placed_alike(placed, info));
        let all = base.and_then(|base| base.texture).into_iter().chain(others);
        let source = |info: &TextureInfo| root.textures.get(info.index as usize)?.source;
        all.filter_map(source).collect()
    }

    /// A material's base colour.
    pub(super) fn base(&self, index: u32, location: &str) -> Result<Base<'d>, FormatError> {
        let list: &'d [MaterialJson] = &self.data.root.materials;
        let material = self.data.one(list, index, location, "materials")?;
        let other = material.extensions.specular_glossiness.as_ref();
        let pbr = &material.pbr_metallic_roughness;
        let (factor, texture, rough) = match other {
            Some(other) => (other.diffuse_factor, other.diffuse_texture.as_ref(), None),
            None => (
                pbr.base_color_factor,
                pbr.base_color_texture.as_ref(),
                pbr.metallic_roughness_texture.as_ref(),
            ),
        };
        Ok(Base {
            factor: factor.unwrap_or(WHITE),
            texture,
            placed: texture.or(rough).or(material.emissive_texture.as_ref()),
        })
    }

    /// A material's reflectance and emission. Images with other coordinates than `base` are left out, with a warning.
    fn reflectance(
        &mut self,
        json: &'d MaterialJson,
        base: Base<'d>,
        has_coordinates: bool,
        location: &str,
    ) -> Result<Reflectance, FormatError> {
        let mut image = |info: &'d Option<TextureInfo>, what| {
            let Some(info) = info.as_ref() else {
                return Ok(None);
            };
            let fits = base
                .placed
                .is_some_and(|placed| are_placed_alike(placed, info));
            if !has_coordinates || !fits {
                *self.unused.entry(what).or_default() += 1;
                return Ok(None);
            }
            let Some((image, key)) = self.find_image(info, location)? else {
                return Ok(None);
            };
            self.tinted(image, key, WHITE)
        };
        let pbr = &json.pbr_metallic_roughness;
        let other = json.extensions.specular_glossiness.as_ref();
        let texture = match other {
            Some(_) => None,
            None => image(
                &pbr.metallic_roughness_texture,
                "images of metal and roughness by other coordinates than of colour",
            )?,
        };
        let emission_texture = image(
            &json.emissive_texture,
            "images of emission by other coordinates than of colour",
        )?;
        let share = |factor: Option<f64>| factor.unwrap_or(1.0).clamp(0.0, 1.0) as f32;
        let (metallic, roughness) = match other {
            Some(other) => (0.0, 1.0 - share(other.glossiness_factor)),
            None => (share(pbr.metallic_factor), share(pbr.roughness_factor)),
        };
        let strength = json.extensions.emissive_strength.as_ref();
        let strength = strength.and_then(|strength| strength.emissive_strength);
        let emission = json.emissive_factor.unwrap_or_default();
        Ok(Reflectance {
            metallic,
            roughness,
            texture,
            emission: emission
                .map(|light| (light * strength.unwrap_or(1.0)).clamp(0.0, MAX_EMISSION) as f32),
            emission_texture,
            is_unlit: json.extensions.unlit.is_some(),
        })
    }

    /// A material of the scene, with its image where there are coordinates for it.
    pub(super) fn material(
        &mut self,
        index: u32,
        has_coordinates: bool,
        by_vertex: bool,
    ) -> Result<Material, FormatError> {
        let location = format!("materials[{index}]");
        let base = self.base(index, &location)?;
        let data = self.data;
        let list: &'d [MaterialJson] = &data.root.materials;
        let json = data.one(list, index, &location, "materials")?;
        self.count_unused(index, json);
        let image = match base.texture {
            Some(info) if has_coordinates => self.find_image(info, &location)?,
            _ => None,
        };
        let opacity = opacity(json, base.factor, image.as_ref().map(|(image, _)| image));
        let texture = match image {
            Some((image, key)) => self.tinted(image, key, base.factor)?,
            None => None,
        };
        let reflectance = self.reflectance(json, base, has_coordinates, &location)?;
        let name = json.name.clone();
        Ok(Material {
            texture,
            by_vertex,
            reflectance: Some(Arc::new(reflectance)),
            opacity,
            ..Material::new(
                name.unwrap_or_else(|| format!("material {index}")),
                color(base.factor),
            )
        })
    }

    /// Counts a material's features that are not shown.
    fn count_unused(&mut self, index: u32, material: &MaterialJson) {
        let Some(is_reported) = self.is_reported.get_mut(index as usize) else {
            return;
        };
        if std::mem::replace(is_reported, true) {
            return;
        }
        let mode = material.alpha_mode.as_deref();
        self.blended += usize::from(mode == Some("BLEND"));
        let is_unknown = mode.is_some_and(|mode| !["OPAQUE", "MASK", "BLEND"].contains(&mode));
        let other = material.extensions.specular_glossiness.as_ref();
        let gloss = other.and_then(|other| other.specular_glossiness_texture.as_ref());
        let parts = [
            (gloss.is_some(), "images of specular colour and gloss"),
            (material.normal_texture.is_some(), "images of normals"),
            (material.occlusion_texture.is_some(), "images of occlusion"),
            (is_unknown, "opacity of another mode"),
        ];
        for (_, part) in parts.iter().filter(|(has, _)| *has) {
            *self.unused.entry(part).or_default() += 1;
        }
    }

    /// The features of used materials that are not shown, as a list for a message.
    pub(super) fn unused(&self) -> Vec<String> {
        let of = |(what, count): (&&str, &usize)| format!("{what} ({count} materials)");
        self.unused.iter().map(of).collect()
    }

    /// A texture's image as the file has it, and its key.
    fn find_image(
        &mut self,
        info: &TextureInfo,
        location: &str,
    ) -> Result<Option<(Arc<Texture>, ImageKey)>, FormatError> {
        let root = self.data.root;
        let json = self
            .data
            .one(&root.textures, info.index, location, "textures")?;
        let location = format!("textures[{}]", info.index);
        let Some(source) = json.source else {
            let path = quote::path(self.data.path);
            let warning = format!("{path}: {location}: its image is of a kind that is not read");
            if !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
            return Ok(None);
        };
        self.data.one(&root.images, source, &location, "images")?;
        let wrap = self.wrap(json.sampler, &location)?;
        let image = match self.images.get(&(source, wrap)) {
            Some(image) => image.clone(),
            None => {
                let image = match self.image(source) {
                    Ok(image) => Some(Arc::new(image.wrapped(wrap))),
                    Err(warning) => {
                        if !self.warnings.contains(&warning) {
                            self.warnings.push(warning);
                        }
                        None
                    }
                };
                self.images.insert((source, wrap), image.clone());
                image
            }
        };
        Ok(image.map(|image| (image, (source, wrap))))
    }

    /// An image multiplied by a material's colour.
    fn tinted(
        &mut self,
        image: Arc<Texture>,
        (source, wrap): ImageKey,
        factor: [f64; 4],
    ) -> Result<Option<Arc<Texture>>, FormatError> {
        let [r, g, b, _] = factor;
        let is_plain = [r, g, b] == [1.0; 3] && image.texels().iter().all(|texel| texel[3] == 255);
        if is_plain {
            return Ok(Some(image));
        }
        let key = (source, wrap, [r, g, b].map(f64::to_bits));
        if let Some(tinted) = self.tinted.get(&key) {
            return Ok(Some(Arc::clone(tinted)));
        }
        let bytes = 4 * image.texels().len() as u64;
        let share = self
            .data
            .files
            .budget()
            .share(self.data.path, "a tinted image", bytes)?;
        let Some(tinted) = tint(&image, [r, g, b]).map(Arc::new) else {
            return Ok(None);
        };
        share.keep(bytes);
        self.tinted.insert(key, Arc::clone(&tinted));
        Ok(Some(tinted))
    }

    /// The wrapping of a sampler, by OpenGL's numbers; repeating by default.
    fn wrap(&mut self, sampler: Option<u32>, location: &str) -> Result<[Wrap; 2], FormatError> {
        let Some(index) = sampler else {
            return Ok([Wrap::Repeat; 2]);
        };
        let data = self.data;
        let sampler = data.one(&data.root.samplers, index, location, "samplers")?;
        let mut wrap = |number: Option<u32>| match number {
            None | Some(10497) => Wrap::Repeat,
            Some(33071) => Wrap::Clamp,
            Some(33648) => Wrap::Mirror,
            Some(other) => {
                let path = quote::path(data.path);
                let warning = format!(
                    "{path}: samplers[{index}]: its image is repeated: expected 10497, 33071 or 33648, \
                     found {other}"
                );
                if !self.warnings.contains(&warning) {
                    self.warnings.push(warning);
                }
                Wrap::Repeat
            }
        };
        Ok([wrap(sampler.wrap_s), wrap(sampler.wrap_t)])
    }

    /// An image, or one line that says why it cannot be read.
    fn image(&mut self, index: u32) -> Result<Texture, String> {
        if let Some(image) = self.ahead.remove(&index) {
            return Ok(image);
        }
        let data = self.data;
        let bytes = self.image_bytes(index)?;
        let decoded = texture::decode(bytes.path(data.path), &bytes, data.files.budget());
        decoded.map_err(|error| match bytes {
            ImageBytes::Resource(Bytes::File(..)) => error.to_string(),
            _ => {
                let path = quote::path(data.path);
                format!("{path}: images[{index}]: {}", error.reason())
            }
        })
    }

    /// The file of an image, or one line that says why it cannot be read.
    fn image_bytes(&self, index: u32) -> Result<ImageBytes<'m, 'd>, String> {
        let data = self.data;
        let location = format!("images[{index}]");
        let Some(image) = data.root.images.get(index as usize) else {
            let path = quote::path(data.path);
            return Err(format!("{path}: {location}: there is none"));
        };
        let found = match image.buffer_view {
            Some(view) => data
                .view(view, &location)
                .map(|(bytes, _)| ImageBytes::View(bytes)),
            None => data
                .resource(&location, &image.uri)
                .map(ImageBytes::Resource),
        };
        found.map_err(|error| error.to_string())
    }
}

/// An image as a file, in a buffer or beside it.
enum ImageBytes<'m, 'd> {
    View(&'m [u8]),
    Resource(Bytes<'d>),
}

impl ImageBytes<'_, '_> {
    /// The image's own file, or the one that it is a part of.
    fn path<'p>(&'p self, whole: &'p Path) -> &'p Path {
        match self {
            Self::Resource(Bytes::File(_, path)) => path,
            _ => whole,
        }
    }
}

impl Deref for ImageBytes<'_, '_> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::View(bytes) => bytes,
            Self::Resource(bytes) => bytes,
        }
    }
}

/// Whether two textures have the same coordinates.
fn are_placed_alike(a: &TextureInfo, b: &TextureInfo) -> bool {
    Coordinates::set(a) == Coordinates::set(b) && Coordinates::new(a) == Coordinates::new(b)
}

/// A colour of linear light.
pub(super) fn color([r, g, b, _]: [f64; 4]) -> Color {
    let tables = srgb::tables();
    Color([r, g, b].map(|channel| tables.encode(channel as f32)))
}

/// A material's opacity. Its alpha is that of the base colour's factor and image.
fn opacity(
    material: &MaterialJson,
    [_, _, _, factor]: [f64; 4],
    image: Option<&Arc<Texture>>,
) -> Opacity {
    let has_alpha = |image: &&Arc<Texture>| image.texels().iter().any(|texel| texel[3] < 255);
    let alpha = Alpha {
        factor: factor.clamp(0.0, 1.0) as f32,
        image: image.filter(has_alpha).cloned(),
    };
    match material.alpha_mode.as_deref() {
        Some("MASK") => Opacity::Mask {
            alpha,
            cutoff: material.alpha_cutoff.unwrap_or(Opacity::CUTOFF),
        },
        Some("BLEND") if alpha.factor < 1.0 || alpha.image.is_some() => Opacity::Blend(alpha),
        _ => Opacity::Opaque,
    }
}

/// An image multiplied by a factor in linear light. The result is opaque: alpha belongs to the material, and
/// translucent texels may have any colour.
fn tint(image: &Texture, factor: [f64; 3]) -> Option<Texture> {
    let tables = srgb::tables();
    let levels = factor.map(|factor| {
        std::array::from_fn::<u8, 256, _>(|level| {
            let light = f64::from(tables.decode(level as u8)) * factor;
            tables.encode(light as f32)
        })
    });
    let [r, g, b] = &levels;
    let texels = image.texels().iter().map(|&[x, y, z, _]| {
        let at = usize::from;
        [r[at(x)], g[at(y)], b[at(z)], 255]
    });
    let tinted = Texture::new(image.width(), image.height(), texels.collect())?;
    Some(tinted.wrapped(image.wrap()))
}

/// The transform of a texture's coordinates (`KHR_texture_transform`), and the flip of v: glTF's origin is the
/// image's top left, a scene's is its bottom left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coordinates {
    offset: DVec2,
    /// Sine and cosine of the rotation.
    turn: (f64, f64),
    scale: DVec2,
}

impl Coordinates {
    /// No transform except the flip.
    pub(super) const PLAIN: Self = Self {
        offset: DVec2::ZERO,
        turn: (0.0, 1.0),
        scale: DVec2::ONE,
    };

    pub(super) fn new(info: &TextureInfo) -> Self {
        let Some(TextureTransform {
            offset,
            rotation,
            scale,
            ..
        }) = &info.extensions.transform
        else {
            return Self::PLAIN;
        };
        Self {
            offset: DVec2::from_array(*offset),
            turn: math::sin_cos(*rotation),
            scale: scale.map_or(DVec2::ONE, DVec2::from_array),
        }
    }

    /// The index of the coordinate set that a texture uses.
    pub(super) fn set(info: &TextureInfo) -> u32 {
        let moved = info.extensions.transform.as_ref();
        moved
            .and_then(|moved| moved.tex_coord)
            .unwrap_or(info.tex_coord)
    }

    pub(super) fn bits(&self) -> [u64; 6] {
        let Self {
            offset,
            turn: (sin, cos),
            scale,
        } = self;
        [offset.x, offset.y, *sin, *cos, scale.x, scale.y].map(f64::to_bits)
    }

    /// Scaled, rotated counter-clockwise as seen (v points down in glTF), translated, flipped.
    pub(super) fn apply(&self, [u, v]: [f64; 2]) -> Vec2 {
        let (sin, cos) = self.turn;
        let (u, v) = (u * self.scale.x, v * self.scale.y);
        let turned = DVec2::new(cos * u + sin * v, cos * v - sin * u) + self.offset;
        DVec2::new(turned.x, 1.0 - turned.y).as_vec2()
    }
}
