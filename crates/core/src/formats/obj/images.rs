//! The images of an OBJ file's materials.

use super::map_options::{Channel, MtlImage};
use super::mtl::MtlMaterial;
use crate::formats::error::FormatError;
use crate::formats::files::{Contents, Files, NamedBy, beside};
use crate::formats::limits::Budget;
use crate::formats::texture;
use crate::quote::{self, quote};
use crate::scene::{Alpha, Opacity, Reflectance, Texture, Wrap};
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The images of a file's materials, each of which is read once.
pub(super) struct Images<'f> {
    path: &'f Path,
    files: &'f dyn Files,
    warnings: &'f mut Vec<String>,
    /// By file, and whether it is clamped; `None` for one that cannot be read, of which a warning says why.
    known: HashMap<(PathBuf, bool), Option<Arc<Texture>>>,
    /// Images that were read before they were asked for.
    ahead: HashMap<PathBuf, Result<Texture, FormatError>>,
    /// The alphas of opacity images, by the same key as `known` and their channel.
    alphas: HashMap<(PathBuf, bool, Option<Channel>), Option<Arc<Texture>>>,
    /// The images made of one of roughness and one of metal.
    reflectances: HashMap<[Option<ScalarKey>; 2], Option<Arc<Texture>>>,
}

impl<'f> Images<'f> {
    pub(super) fn new(path: &'f Path, files: &'f dyn Files, warnings: &'f mut Vec<String>) -> Self {
        Self {
            path,
            files,
            warnings,
            known: HashMap::new(),
            ahead: HashMap::new(),
            alphas: HashMap::new(),
            reflectances: HashMap::new(),
        }
    }

    /// Decodes the images of materials all at once; those of colour with `colors` only.
    pub(super) fn decode_ahead<'m>(
        &mut self,
        materials: impl Iterator<Item = &'m (MtlMaterial, PathBuf)>,
        colors: bool,
    ) {
        let wanted: BTreeSet<PathBuf> = materials
            .flat_map(|(material, library)| {
                let all = material.images.by_keyword().into_iter();
                let all = all.skip(usize::from(!colors));
                all.filter_map(|(_, image)| Some(beside(library, &image?.name)))
            })
            .collect();
        if wanted.len() < 2 {
            return;
        }
        let mut found = Vec::new();
        for path in &wanted {
            match self.bytes(path) {
                Ok(bytes) => found.push((path.as_path(), bytes)),
                Err(error) if error.is_of_budget() => return,
                Err(error) => {
                    self.ahead.insert(path.clone(), Err(error));
                }
            }
        }
        let files = found.iter().map(|(path, bytes)| (*path, *path, &**bytes));
        let files: Vec<_> = files.collect();
        let decoded = texture::decode_ahead(&files, self.files.budget());
        let decoded = decoded.into_iter();
        (self.ahead).extend(decoded.map(|(path, read)| (path.to_owned(), read)));
    }

    fn bytes(&self, path: &Path) -> Result<Contents<'f>, FormatError> {
        self.files.read(path, NamedBy::Mesh(self.path), &|_| ())
    }

    /// An image of a library; `what` it is to it is for the warning.
    pub(super) fn read(
        &mut self,
        library: &Path,
        image: &MtlImage,
        what: &str,
    ) -> Option<Arc<Texture>> {
        let key = (beside(library, &image.name), image.options.clamps);
        if let Some(known) = self.known.get(&key) {
            return known.clone();
        }
        let file = &key.0;
        let read = match self.ahead.remove(file) {
            Some(read) => read,
            None => self
                .bytes(file)
                .and_then(|bytes| texture::decode(file, &bytes, self.files.budget())),
        };
        let texture = match read {
            Ok(texture) if image.options.clamps => Some(texture.wrapped([Wrap::Clamp; 2])),
            Ok(texture) => Some(texture),
            Err(error) => {
                self.warn(what, &image.name, &error);
                None
            }
        };
        let texture = texture.map(Arc::new);
        self.known.insert(key, texture.clone());
        texture
    }

    fn warn(&mut self, what: &str, name: &str, error: &FormatError) {
        let (path, name, why) = (quote::path(self.path), quote(name), error.reason());
        (self.warnings).push(format!(
            "{path}: its {what} in {name} cannot be read: {why}"
        ));
    }

    /// Reads a material's opacity image. Where the library gives no other opacity it becomes a mask; otherwise the image's
    /// alpha is part of its blending.
    pub(super) fn read_opacity(&mut self, library: &Path, material: &mut MtlMaterial) {
        let Some(image) = &material.images.opacity else {
            return;
        };
        let (clamps, channel) = (image.options.clamps, image.options.channel);
        let key = (beside(library, &image.name), clamps, channel);
        let image = match self.alphas.get(&key) {
            Some(image) => image.clone(),
            None => {
                let alpha = self.read(library, image, "opacity").and_then(|texture| {
                    alpha_image(&key.0, (texture, channel), self.files.budget())
                        .map_err(|error| self.warn("opacity", &image.name, &error))
                        .ok()
                });
                self.alphas.insert(key, alpha.clone());
                alpha
            }
        };
        let Some(image) = image else { return };
        material.material.opacity = match &material.material.opacity {
            Opacity::Blend(alpha) => Opacity::Blend(Alpha {
                image: Some(image),
                ..alpha.clone()
            }),
            Opacity::Opaque | Opacity::Mask { .. } => Opacity::Mask {
                alpha: Alpha {
                    factor: 1.0,
                    image: Some(image),
                },
                cutoff: Opacity::CUTOFF,
            },
        };
    }

    /// Reads a material's images of roughness, metal and emission. The former two replace the library's numbers, which
    /// exporters write beside them; emission is multiplied by its colour, unless that is black or missing.
    pub(super) fn read_reflectance(&mut self, library: &Path, material: &mut MtlMaterial) {
        let images = &material.images;
        let reflectance = material.material.reflectance.as_ref();
        let Some(reflectance) = reflectance.filter(|_| images.reflect()) else {
            return;
        };
        let mut found = Reflectance::clone(reflectance);
        let mut read = |image: &Option<MtlImage>, what| {
            (image.as_ref()).and_then(|image| self.read(library, image, what))
        };
        if let Some(emission) = read(&images.emission, "emission") {
            found.emission_texture = Some(emission);
            if found.emission == [0.0; 3] {
                found.emission = [1.0; 3];
            }
        }
        let mut read_scalar = |image: &Option<MtlImage>, what| {
            let channel = image.as_ref()?.options.channel;
            Some((read(image, what)?, channel.unwrap_or(Channel::Red)))
        };
        let shares = [
            read_scalar(&images.roughness, "roughness"),
            read_scalar(&images.metallic, "metal"),
        ];
        if let Some(texture) = self.reflectance_image(&shares) {
            found.texture = Some(texture);
            let [roughness, metallic] = shares.map(|share| share.is_some());
            if roughness {
                found.roughness = 1.0;
            }
            if metallic {
                found.metallic = 1.0;
            }
        }
        material.material.reflectance = Some(Arc::new(found));
    }

    /// One image of images of roughness and metal. `None` without either, or where it would exceed the budget, of which a
    /// warning says so.
    fn reflectance_image(&mut self, shares: &[Option<Scalar>; 2]) -> Option<Arc<Texture>> {
        if shares.iter().all(Option::is_none) {
            return None;
        }
        let key_of = |(texture, channel): &Scalar| (Arc::as_ptr(texture) as usize, *channel);
        let key = shares.each_ref().map(|share| share.as_ref().map(key_of));
        if let Some(known) = self.reflectances.get(&key) {
            return known.clone();
        }
        let texture = reflectance_image(self.path, shares, self.files.budget());
        let texture = texture.unwrap_or_else(|error| {
            let (path, why) = (quote::path(self.path), error.reason());
            (self.warnings).push(format!(
                "{path}: its roughness and metal cannot be read: {why}"
            ));
            None
        });
        let texture = texture.map(Arc::new);
        self.reflectances.insert(key, texture.clone());
        texture
    }
}

/// An image and the channel of it that a scalar is read from.
type Scalar = (Arc<Texture>, Channel);

/// The image's address in [`Images::known`] and the channel.
type ScalarKey = (usize, Channel);

/// The alpha of an opacity image: the channel that is named, else its alpha channel if it has one, else its red
/// channel, which is its grey.
fn alpha_image(
    path: &Path,
    (image, channel): (Arc<Texture>, Option<Channel>),
    budget: &Budget,
) -> Result<Arc<Texture>, FormatError> {
    let texels = image.texels();
    let channel = channel.unwrap_or_else(|| {
        let has_alpha = texels.iter().any(|texel| texel[3] < u8::MAX);
        match has_alpha {
            true => Channel::Alpha,
            false => Channel::Red,
        }
    });
    if channel == Channel::Alpha {
        return Ok(image);
    }
    let bytes = size_of_val(texels) as u64;
    let share = budget.share(path, "the image's opacity", bytes)?;
    let texels = texels.iter().map(|&texel| [channel.of(texel); 4]).collect();
    let Some(opacity) = Texture::new(image.width(), image.height(), texels) else {
        return Ok(image);
    };
    share.keep(bytes);
    Ok(Arc::new(opacity.wrapped(image.wrap())))
}

/// An image with roughness in green and metal in blue, as [`Reflectance`] has it, of a channel of each of two: where
/// none is named the red one, which is the grey. It is as large as the larger one; what is missing is full.
fn reflectance_image(
    path: &Path,
    shares: &[Option<Scalar>; 2],
    budget: &Budget,
) -> Result<Option<Texture>, FormatError> {
    let given = || shares.iter().flatten().map(|(image, _)| image);
    let width = given().map(|share| share.width()).max().unwrap_or(1);
    let height = given().map(|share| share.height()).max().unwrap_or(1);
    let bytes = 4 * u64::from(width) * u64::from(height);
    let counted = budget.share(path, "images of roughness and metal", bytes)?;
    // At once, as it is counted: collecting would grow by doubling.
    let mut texels = Vec::with_capacity(width as usize * height as usize);
    texels.extend((0..height).flat_map(|y| {
        (0..width).map(move |x| {
            let [roughness, metallic] = shares.each_ref().map(|share| {
                share.as_ref().map_or(u8::MAX, |(share, channel)| {
                    let at = |at: u32, own: u32, all: u32| {
                        (u64::from(at) * u64::from(own) / u64::from(all)) as usize
                    };
                    let column = at(x, share.width(), width);
                    let row = at(y, share.height(), height);
                    channel.of(share.texels()[row * share.width() as usize + column])
                })
            });
            [0, roughness, metallic, u8::MAX]
        })
    }));
    let texture = Texture::new(width, height, texels);
    counted.keep(bytes);
    let wrap = given()
        .next()
        .map_or([Wrap::Repeat; 2], |share| share.wrap());
    Ok(texture.map(|texture| texture.wrapped(wrap)))
}
