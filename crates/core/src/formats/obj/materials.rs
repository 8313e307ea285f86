//! The materials of an OBJ file: its libraries, their images, and which triangle has which.

use super::content::{NONE, ObjText};
use super::map_options::MtlImage;
use super::mtl::{self, MtlMaterial, Unused};
use crate::formats::error::FormatError;
use crate::formats::files::{Contents, Files, NamedBy, beside};
use crate::formats::limits::Budget;
use crate::formats::parsed::BLENDED;
use crate::formats::texture;
use crate::quote::{self, quote};
use crate::scene::{Alpha, Opacity, Texture, Wrap};
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The materials of a file's libraries, each with the path of its library.
pub(super) type Materials = Vec<(MtlMaterial, PathBuf)>;

/// A note about contents that are not shown, if there are any.
pub(super) fn notes(unused: &Unused) -> Vec<String> {
    let note = |(word, count): (&String, &usize)| format!("{} ({count} materials)", quote(word));
    let words: Vec<String> = unused.iter().map(note).collect();
    match words.is_empty() {
        true => Vec::new(),
        false => vec![format!("not used: {}", words.join(", "))],
    }
}

/// The index of each name. Of materials with the same name the last one counts.
pub(super) fn index_by_name(materials: &Materials) -> HashMap<&str, u32> {
    materials
        .iter()
        .zip(0..)
        .map(|((material, _), number)| (material.material.name.as_str(), number))
        .collect()
}

/// The materials of the file's libraries; and the image, if those of all faces name the same one. Otherwise each
/// material that a face has gets its own image.
pub(super) fn materials(
    path: &Path,
    text: &ObjText,
    files: &dyn Files,
    warnings: &mut Vec<String>,
    unused: &mut Unused,
) -> (Materials, Option<PathBuf>) {
    let mut materials = Materials::new();
    for (library, bytes) in libraries(path, &text.libraries, files, warnings) {
        for image in mtl::images(&bytes) {
            files.name(&beside(&library, &image));
        }
        let read = mtl::read(&library, &bytes, warnings, unused);
        materials.extend(read.into_iter().map(|material| (material, library.clone())));
    }
    let numbers = index_by_name(&materials);
    let number = |name: &String| numbers.get(name.as_str()).map(|&number| number as usize);
    let unknown = (text.materials.iter())
        .filter(|name| number(name).is_none())
        .count();
    if !materials.is_empty() && unknown > 0 {
        warnings.push(format!(
            "{}: {unknown} materials are in none of its libraries",
            quote::path(path)
        ));
    }
    let mut used: Vec<usize> = text.materials.iter().filter_map(number).collect();
    used.sort_unstable();
    used.dedup();
    let texture = common_image(text, &materials);
    let mut images = Images::new(path, files, warnings);
    images.decode_ahead(
        used.iter().map(|&number| &materials[number]),
        texture.is_none(),
    );
    if texture.is_none() {
        for &number in &used {
            let (material, library) = &mut materials[number];
            if let Some(image) = &material.texture {
                material.material.texture = images.read(library, image, "image");
            }
        }
    }
    read_opacity_images(&mut materials, &used, &mut images);
    let is_blended = |&&number: &&usize| {
        let opacity = &materials[number].0.material.opacity;
        matches!(opacity, Opacity::Blend(_))
    };
    let blended = used.iter().filter(is_blended).count();
    if blended > 0 {
        warnings.push(format!("{}: {BLENDED}: {blended}", quote::path(path)));
    }
    (materials, texture)
}

/// The image that the materials of all faces name; `None` where it is not to be repeated, which only a texture that is
/// read says.
fn common_image(text: &ObjText, materials: &Materials) -> Option<PathBuf> {
    let numbers = index_by_name(materials);
    let image = |name: u32| {
        let name = text.materials.get(name as usize)?;
        let (material, library) = materials.get(*numbers.get(name.as_str())? as usize)?;
        let image = material.texture.as_ref()?;
        (!image.options.clamps).then(|| beside(library, &image.name))
    };
    let (first_triangle, first) = *text.material_runs.first()?;
    let first = image(first).filter(|_| first_triangle == 0)?;
    let mut names: Vec<u32> = text.material_runs.iter().map(|run| run.1).collect();
    names.sort_unstable();
    names.dedup();
    let mut images = names.into_iter().map(image);
    images
        .all(|image| image.as_ref() == Some(&first))
        .then_some(first)
}

/// The images of a file's materials, each of which is read once.
struct Images<'f> {
    path: &'f Path,
    files: &'f dyn Files,
    warnings: &'f mut Vec<String>,
    /// `None` for one that cannot be read, of which a warning says why.
    /// With whether it is clamped.
    known: HashMap<(PathBuf, bool), Option<Arc<Texture>>>,
    /// Images that were read before they were asked for.
    ahead: HashMap<PathBuf, Result<Texture, FormatError>>,
}

impl<'f> Images<'f> {
    fn new(path: &'f Path, files: &'f dyn Files, warnings: &'f mut Vec<String>) -> Self {
        Self {
            path,
            files,
            warnings,
            known: HashMap::new(),
            ahead: HashMap::new(),
        }
    }

    /// Decodes the images of materials all at once: of opacity, and with `colors` of colour.
    fn decode_ahead<'m>(
        &mut self,
        materials: impl Iterator<Item = &'m (MtlMaterial, PathBuf)>,
        colors: bool,
    ) {
        let wanted: BTreeSet<PathBuf> = materials
            .flat_map(|(material, library)| {
                let color = material.texture.as_ref().filter(|_| colors);
                let images = color.into_iter().chain(&material.opacity);
                images.map(|image| beside(library, &image.name))
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
    fn read(&mut self, library: &Path, image: &MtlImage, what: &str) -> Option<Arc<Texture>> {
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
}

/// Reads the opacity images of the used materials. A material whose library gives no other opacity becomes a mask;
/// otherwise the image's alpha is part of its blending.
fn read_opacity_images(materials: &mut Materials, used: &[usize], images: &mut Images<'_>) {
    let mut known: HashMap<(PathBuf, bool), Option<Arc<Texture>>> = HashMap::new();
    for &number in used {
        let (material, library) = &mut materials[number];
        let Some(image) = &material.opacity else {
            continue;
        };
        let key = (beside(library, &image.name), image.options.clamps);
        let image = match known.get(&key) {
            Some(image) => image.clone(),
            None => {
                let alpha = images.read(library, image, "opacity").and_then(|texture| {
                    alpha_image(&key.0, texture, images.files.budget())
                        .map_err(|error| images.warn("opacity", &image.name, &error))
                        .ok()
                });
                known.insert(key, alpha.clone());
                alpha
            }
        };
        let Some(image) = image else { continue };
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
}

/// The alpha of an opacity image: its alpha channel if it has one, else its red channel, which is its grey.
fn alpha_image(
    path: &Path,
    image: Arc<Texture>,
    budget: &Budget,
) -> Result<Arc<Texture>, FormatError> {
    let texels = image.texels();
    if texels.iter().any(|texel| texel[3] < u8::MAX) {
        return Ok(image);
    }
    let bytes = size_of_val(texels) as u64;
    let share = budget.share(path, "the image's opacity", bytes)?;
    let texels = texels.iter().map(|&[grey, ..]| [grey; 4]).collect();
    let Some(opacity) = Texture::new(image.width(), image.height(), texels) else {
        return Ok(image);
    };
    share.keep(bytes);
    Ok(Arc::new(opacity.wrapped(image.wrap())))
}

/// The index of the material's name of every triangle.
pub(super) fn triangle_materials(text: &ObjText) -> Vec<u32> {
    let mut names = vec![NONE; text.triangles.len()];
    for (index, &(first, name)) in text.material_runs.iter().enumerate() {
        let next = text.material_runs.get(index + 1);
        let end = next.map_or(names.len(), |next| next.0 as usize);
        names[first as usize..end].fill(name);
    }
    names
}

/// The most material libraries that a mesh may name: each costs a file access.
const LIBRARY_LIMIT: usize = 1000;

/// The bytes of the libraries after `mtllib`: each line is one name, which may contain spaces, or several names.
fn libraries<'f>(
    path: &Path,
    lines: &[String],
    files: &'f dyn Files,
    warnings: &mut Vec<String>,
) -> Vec<(PathBuf, Contents<'f>)> {
    let mut found: Vec<(PathBuf, Contents<'f>)> = Vec::new();
    let mut tried = 0;
    let mut add = |name: &str| -> Result<(), FormatError> {
        tried += 1;
        if tried > LIBRARY_LIMIT {
            let reason = format!("a mesh has at most {LIBRARY_LIMIT} material libraries");
            return Err(FormatError::refused(path, None, &reason));
        }
        let library = beside(path, name);
        if found.iter().all(|(known, _)| *known != library) {
            files.name(&library);
            let bytes = files.read(&library, NamedBy::Mesh(path), &|_| ())?;
            found.push((library, bytes));
        }
        Ok(())
    };
    for line in lines {
        let Err(error) = add(line) else { continue };
        let names: Vec<_> = line.split_whitespace().collect();
        let missing: Vec<_> = if names.len() > 1 {
            let failures = names.into_iter().map(|name| (name, add(name).err()));
            failures
                .filter_map(|(name, error)| Some((name, error?)))
                .collect()
        } else {
            vec![(line.as_str(), error)]
        };
        for (name, error) in missing {
            let path = quote::path(path);
            let (name, why) = (quote(name), error.reason());
            warnings.push(format!(
                "{path}: its materials in {name} cannot be read: {why}"
            ));
        }
    }
    found
}
