//! A material: name, colour, whether vertex colours take precedence over it, texture (an index), reflectance, opacity.

use super::decoder::Decoder;
use super::encoder::Encoder;
use super::texture::{color_from_word, word};
use crate::formats::error::FormatError;
use crate::scene::{Alpha, Material, Opacity, Reflectance, Texture};
use std::collections::HashMap;
use std::io;
use std::sync::Arc;

/// The least number of bytes of a material in the file.
pub(super) const MIN_BYTES: usize = 24;

/// Distinct textures, in order of first use.
#[derive(Default)]
pub(super) struct Textures<'t> {
    pub(super) all: Vec<&'t Arc<Texture>>,
    numbers: HashMap<*const Texture, u32>,
}

impl<'t> Textures<'t> {
    /// Adds the textures of a material.
    pub(super) fn add_all(&mut self, material: &'t Material) {
        let reflectance = material.reflectance.as_deref();
        let alpha = material.opacity.alpha();
        let all = [
            &material.texture,
            alpha.map_or(&None, |alpha| &alpha.image),
            reflectance.map_or(&None, |one| &one.texture),
            reflectance.map_or(&None, |one| &one.emission_texture),
        ];
        all.into_iter().flatten().for_each(|one| self.add(one));
    }

    pub(super) fn add(&mut self, texture: &'t Arc<Texture>) {
        let next = self.all.len() as u32;
        let number = self.numbers.entry(Arc::as_ptr(texture)).or_insert(next);
        if *number == next {
            self.all.push(texture);
        }
    }

    /// Writes the index of a texture that was added.
    pub(super) fn write(
        &self,
        texture: Option<&Arc<Texture>>,
        to: &mut Encoder<'_>,
    ) -> io::Result<()> {
        to.option(texture, |to, texture| {
            let number = self.numbers.get(&Arc::as_ptr(texture));
            to.number(number.copied().unwrap_or_default())
        })
    }
}

/// Reads the index of a texture.
pub(super) fn read_texture(
    textures: &[Arc<Texture>],
    from: &mut Decoder<'_>,
) -> Result<Option<Arc<Texture>>, FormatError> {
    from.option("whether there is a texture", |from| {
        let number = from.below("the number of a texture", textures.len())?;
        Ok(Arc::clone(&textures[number]))
    })
}

pub(super) fn write(
    material: &Material,
    textures: &Textures<'_>,
    to: &mut Encoder<'_>,
) -> io::Result<()> {
    // Destructured field by field, so that a new field of a material does not compile until it is handled here.
    let Material {
        name,
        color,
        texture,
        by_vertex,
        reflectance,
        opacity,
    } = material;
    to.text(name)?;
    to.number(word(*color))?;
    to.number((*by_vertex).into())?;
    textures.write(texture.as_ref(), to)?;
    to.option(reflectance.as_deref(), |to, reflectance| {
        let Reflectance {
            metallic,
            roughness,
            texture,
            emission,
            emission_texture,
            is_unlit,
        } = reflectance;
        to.single(*metallic)?;
        to.single(*roughness)?;
        textures.write(texture.as_ref(), to)?;
        emission.iter().try_for_each(|light| to.single(*light))?;
        textures.write(emission_texture.as_ref(), to)?;
        to.number((*is_unlit).into())
    })?;
    to.number(match opacity {
        Opacity::Opaque => 0,
        Opacity::Mask { .. } => 1,
        Opacity::Blend(_) => 2,
    })?;
    if let Some(Alpha { factor, image }) = opacity.alpha() {
        to.single(*factor)?;
        textures.write(image.as_ref(), to)?;
    }
    if let Opacity::Mask { cutoff, .. } = opacity {
        to.single(*cutoff)?;
    }
    Ok(())
}

pub(super) fn read(
    textures: &[Arc<Texture>],
    from: &mut Decoder<'_>,
) -> Result<Material, FormatError> {
    let name = from.text("a material's name")?;
    let color = color_from_word(from.number("a colour")?);
    let by_vertex = from.flag("whether vertices have its colours")?;
    let texture = read_texture(textures, from)?;
    let reflectance = from.option("whether there is a reflectance", |from| {
        Ok(Arc::new(Reflectance {
            metallic: from.portion("a metal's share")?,
            roughness: from.portion("a roughness")?,
            texture: read_texture(textures, from)?,
            emission: {
                let mut light = || {
                    let light = from.single("light")?;
                    match light >= 0.0 && light.is_finite() {
                        true => Ok(light),
                        false => Err(from.unexpected("light of zero or more", light)),
                    }
                };
                [light()?, light()?, light()?]
            },
            emission_texture: read_texture(textures, from)?,
            is_unlit: from.flag("whether it is unlit")?,
        }))
    })?;
    let kind = from.below("a kind of opacity", 3)?;
    let mut alpha = || {
        Ok(Alpha {
            factor: from.portion("an alpha")?,
            image: read_texture(textures, from)?,
        })
    };
    let opacity = match kind {
        0 => Opacity::Opaque,
        1 => Opacity::Mask {
            alpha: alpha()?,
            cutoff: from.single("a cutoff")?,
        },
        _ => Opacity::Blend(alpha()?),
    };
    Ok(Material {
        name,
        color,
        texture,
        by_vertex,
        reflectance,
        opacity,
    })
}
