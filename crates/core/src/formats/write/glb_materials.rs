//! The materials of a GLB, and their images as PNG.

use super::written::WriteError;
use crate::scene::{Alpha, Color, Material, Object, Opacity, Reflectance, Texture, Wrap};
use crate::shade::srgb;
use crate::shade::srgb::linear;
use glam::Vec3;
use image::ExtendedColorType::{Rgb8, Rgba8};
use image::ImageEncoder;
use image::codecs::png::PngEncoder;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};
use std::io;
use std::sync::Arc;

/// The lists of a file that describe materials, so far.
#[derive(Default)]
pub(super) struct Materials {
    pub(super) materials: Vec<Value>,
    pub(super) textures: Vec<Value>,
    pub(super) samplers: Vec<Value>,
    /// PNG files, in the order of the file's images.
    pub(super) images: Vec<Vec<u8>>,
    known_textures: HashMap<ImageKey, usize>,
    known_samplers: HashMap<[u32; 2], usize>,
    /// What materials have and the file has not, and how many of them.
    lost: BTreeMap<&'static str, usize>,
}

/// Textures by their addresses: that of colours, that of alpha, and the colour under translucent texels.
type ImageKey = (Option<usize>, Option<usize>, Option<Color>);

/// The image of a material.
#[derive(Clone, Copy, Default)]
struct Image<'t> {
    color: Option<&'t Arc<Texture>>,
    /// The image whose fourth channel is the alpha.
    alpha: Option<&'t Arc<Texture>>,
    /// The colour under translucent texels, where `alpha` says nothing.
    under: Option<Color>,
}

impl Materials {
    /// Adds a material, or the look of triangles without one; returns its index. `has_uvs` says whether texture
    /// coordinates place its images.
    pub(super) fn add(
        &mut self,
        object: &Object,
        material: Option<&Material>,
        has_uvs: bool,
    ) -> Result<usize, WriteError> {
        if object.blend_by.is_some() {
            self.lose("weights of images");
        }
        let base = material.map_or(Color::DEFAULT, |material| material.color);
        let opacity = material.map_or(&Opacity::Opaque, |material| &material.opacity);
        let of_material = || material.and_then(|material| material.texture.as_ref());
        let color = object.texture.as_ref().or_else(of_material);
        let alpha = opacity.alpha().and_then(|alpha| alpha.image.as_ref());
        let image = self.image((color, alpha), base, has_uvs);
        let texture = self.texture(image)?;
        // glTF multiplies the image by the factor; here the image is the colour.
        let [r, g, b] = match image.color {
            Some(_) => [1.0; 3],
            None => linear(base).to_array(),
        };
        let is_masked = alpha.is_none() || image.alpha.is_some();
        let (mode, a) = match opacity {
            Opacity::Blend(Alpha { factor, .. }) => ("BLEND", *factor),
            Opacity::Mask { alpha, .. } if is_masked => ("MASK", alpha.factor),
            // A mask without its image would be all or nothing.
            Opacity::Opaque | Opacity::Mask { .. } => ("OPAQUE", 1.0),
        };
        let mut written = json!({
            "pbrMetallicRoughness": {
                "baseColorFactor": [r, g, b, a],
                "metallicFactor": 0.0,
            },
            "doubleSided": true,
        });
        if let Some(material) = material {
            written["name"] = material.name.as_str().into();
        }
        if mode != "OPAQUE" {
            written["alphaMode"] = mode.into();
        }
        if let ("MASK", Opacity::Mask { cutoff, .. }) = (mode, opacity) {
            written["alphaCutoff"] = (*cutoff).into();
        }
        if let Some(texture) = texture {
            written["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": texture });
        }
        if let Some(known) = material.and_then(|material| material.reflectance.as_deref()) {
            self.add_reflectance(&mut written, known, has_uvs)?;
        }
        self.materials.push(written);
        Ok(self.materials.len() - 1)
    }

    fn add_reflectance(
        &mut self,
        written: &mut Value,
        reflectance: &Reflectance,
        has_uvs: bool,
    ) -> Result<(), WriteError> {
        let pbr = &mut written["pbrMetallicRoughness"];
        pbr["metallicFactor"] = reflectance.metallic.into();
        pbr["roughnessFactor"] = reflectance.roughness.into();
        let image = self.image(
            (reflectance.texture.as_ref(), None),
            Color::DEFAULT,
            has_uvs,
        );
        if let Some(texture) = self.texture(image)? {
            pbr["metallicRoughnessTexture"] = json!({ "index": texture });
        }
        // glTF needs an extension for emission above 1.
        written["emissiveFactor"] = json!(reflectance.emission.map(|light| light.min(1.0)));
        let emission = reflectance.emission_texture.as_ref();
        let image = self.image((emission, None), Color::DEFAULT, has_uvs);
        if let Some(texture) = self.texture(image)? {
            written["emissiveTexture"] = json!({ "index": texture });
        }
        Ok(())
    }

    /// What the file can hold of a material's images.
    fn image<'t>(
        &mut self,
        (color, alpha): (Option<&'t Arc<Texture>>, Option<&'t Arc<Texture>>),
        base: Color,
        has_uvs: bool,
    ) -> Image<'t> {
        if color.is_none() && alpha.is_none() {
            return Image::default();
        }
        if !has_uvs {
            self.lose("images that are not placed by texture coordinates");
            return Image::default();
        }
        let fits = |alpha: &&Arc<Texture>| {
            color.is_none_or(|color| size(color) == size(alpha) && color.wrap() == alpha.wrap())
        };
        let fitting = alpha.filter(fits);
        if fitting.is_none() && alpha.is_some() {
            self.lose("images of opacity of another size than the color's");
        }
        let is_translucent = |color: &&Arc<Texture>| color.texels().iter().any(|t| t[3] < u8::MAX);
        Image {
            color,
            alpha: fitting,
            under: color.filter(is_translucent).map(|_| base),
        }
    }

    /// The index of the texture of an image.
    fn texture(&mut self, image: Image<'_>) -> Result<Option<usize>, WriteError> {
        let Some(either) = image.color.or(image.alpha) else {
            return Ok(None);
        };
        let address = |texture: &Arc<Texture>| Arc::as_ptr(texture) as usize;
        let key = (
            image.color.map(address),
            image.alpha.map(address),
            image.under,
        );
        if let Some(&known) = self.known_textures.get(&key) {
            return Ok(Some(known));
        }
        let sampler = self.sampler(either.wrap());
        self.images.push(image.encode(either)?);
        let source = self.images.len() - 1;
        self.textures
            .push(json!({ "source": source, "sampler": sampler }));
        let index = self.textures.len() - 1;
        self.known_textures.insert(key, index);
        Ok(Some(index))
    }

    /// The index of the sampler of a wrapping, by OpenGL's numbers.
    fn sampler(&mut self, wrap: [Wrap; 2]) -> usize {
        if wrap.iter().any(|wrap| matches!(wrap, Wrap::Border(_))) {
            self.lose("colors around images");
        }
        let numbers = wrap.map(|wrap| match wrap {
            Wrap::Repeat => 10497,
            Wrap::Mirror => 33648,
            Wrap::Clamp | Wrap::Border(_) => 33071,
        });
        *self.known_samplers.entry(numbers).or_insert_with(|| {
            let [s, t] = numbers;
            self.samplers.push(json!({ "wrapS": s, "wrapT": t }));
            self.samplers.len() - 1
        })
    }

    fn lose(&mut self, what: &'static str) {
        *self.lost.entry(what).or_default() += 1;
    }

    /// What the file has not, in words.
    pub(super) fn lost(&self) -> impl Iterator<Item = String> {
        let lost = self.lost.iter();
        lost.map(|(what, count)| format!("{what} ({count})"))
    }
}

impl Image<'_> {
    /// A PNG; `either` of its images has its size.
    fn encode(&self, either: &Texture) -> io::Result<Vec<u8>> {
        let tables = srgb::tables();
        let under = self.under.map_or(Vec3::ZERO, linear);
        let over_base = |[r, g, b, a]: [u8; 4]| {
            let [r, g, b] = [r, g, b].map(|channel| tables.decode(channel));
            let alpha = f32::from(a) / 255.0;
            let mixed = Vec3::new(r, g, b) * alpha + under * (1.0 - alpha);
            mixed.to_array().map(|channel| tables.encode(channel))
        };
        let color = |index: usize| match self.color.map(|color| color.texels()[index]) {
            None => [u8::MAX; 3],
            Some([r, g, b, u8::MAX]) => [r, g, b],
            Some(texel) => over_base(texel),
        };
        let indices = 0..either.texels().len();
        let (bytes, kind): (Vec<u8>, _) = match self.alpha {
            None => (indices.flat_map(color).collect(), Rgb8),
            Some(alpha) => {
                let texel = |index: usize| {
                    let [r, g, b] = color(index);
                    [r, g, b, alpha.texels()[index][3]]
                };
                (indices.flat_map(texel).collect(), Rgba8)
            }
        };
        let mut file = Vec::new();
        PngEncoder::new(&mut file)
            .write_image(&bytes, either.width(), either.height(), kind)
            .map_err(io::Error::other)?;
        Ok(file)
    }
}

fn size(texture: &Texture) -> (u32, u32) {
    (texture.width(), texture.height())
}
