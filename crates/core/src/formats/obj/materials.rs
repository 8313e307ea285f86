//! The materials of an OBJ file: its libraries, their images, and which triangle has which.

use super::content::{NONE, ObjText};
use super::mtl::{self, MtlMaterial, Unused};
use crate::formats::error::FormatError;
use crate::formats::files::{Contents, Files, NamedBy, beside};
use crate::formats::limits::Budget;
use crate::formats::parsed::BLENDED;
use crate::formats::texture;
use crate::quote::{self, quote};
use crate::scene::{Alpha, Opacity, Texture};
use std::collections::HashMap;
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

/// The materials of the file's libraries; and the image, if those of all faces name the same one.
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
    let material = |name: u32| {
        let name = text.materials.get(name as usize)?;
        materials.get(*numbers.get(name.as_str())? as usize)
    };
    let unknown = (0..text.materials.len() as u32)
        .filter(|&name| material(name).is_none())
        .count();
    if !materials.is_empty() && unknown > 0 {
        warnings.push(format!(
            "{}: {unknown} materials are in none of its libraries",
            quote::path(path)
        ));
    }
    let used: Vec<usize> = (text.materials.iter())
        .filter_map(|name| numbers.get(name.as_str()).map(|&number| number as usize))
        .collect();
    let image = |name: u32| {
        let (material, library) = material(name)?;
        Some(beside(library, material.texture.as_deref()?))
    };
    let has_bare_start = text.material_runs.first().is_none_or(|run| run.0 > 0);
    let mut names: Vec<u32> = text.material_runs.iter().map(|run| run.1).collect();
    names.extend(has_bare_start.then_some(NONE));
    names.sort_unstable();
    names.dedup();
    let images: Vec<Option<PathBuf>> = names.into_iter().map(image).collect();
    let first = images.first().cloned().flatten();
    let texture = first.filter(|first| images.iter().all(|image| image.as_ref() == Some(first)));
    let mut others: Vec<&PathBuf> = images.iter().flatten().collect();
    others.sort_unstable();
    others.dedup();
    if texture.is_none() && !others.is_empty() {
        warnings.push(format!(
            "{}: an object has one texture, and not all its materials share an image; not shown: {}",
            quote::path(path),
            others.len()
        ));
    }
    read_opacity_images(path, &mut materials, &used, files, warnings);
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

/// Reads the opacity images of the used materials. A material whose library gives no other opacity becomes a mask;
/// otherwise the image's alpha is part of its blending.
fn read_opacity_images(
    path: &Path,
    materials: &mut Materials,
    used: &[usize],
    files: &dyn Files,
    warnings: &mut Vec<String>,
) {
    let mut images: HashMap<PathBuf, Option<Arc<Texture>>> = HashMap::new();
    for &number in used {
        let (material, library) = &mut materials[number];
        let Some(name) = &material.opacity else {
            continue;
        };
        let file = beside(library, name);
        let image = images.entry(file).or_insert_with_key(|file| {
            let read = files
                .read(file, NamedBy::Mesh(path), &|_| ())
                .and_then(|bytes| texture::decode(file, &bytes, files.budget()))
                .and_then(|image| alpha_image(file, image, files.budget()));
            match read {
                Ok(image) => Some(Arc::new(image)),
                Err(error) => {
                    let (path, name, why) = (quote::path(path), quote(name), error.reason());
                    warnings.push(format!(
                        "{path}: its opacity in {name} cannot be read: {why}"
                    ));
                    None
                }
            }
        });
        let Some(image) = image.clone() else { continue };
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
fn alpha_image(path: &Path, image: Texture, budget: &Budget) -> Result<Texture, FormatError> {
    let texels = image.texels();
    if texels.iter().any(|texel| texel[3] < u8::MAX) {
        return Ok(image);
    }
    let _copy = budget.share(path, "the image's opacity", size_of_val(texels) as u64)?;
    let texels = texels.iter().map(|&[grey, ..]| [grey; 4]).collect();
    Ok(Texture::new(image.width(), image.height(), texels).unwrap_or(image))
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
