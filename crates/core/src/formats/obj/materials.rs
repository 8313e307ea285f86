//! The materials of an OBJ file: its libraries, their images, and which triangle has which.

use super::content::{NONE, ObjText};
use super::images::Images;
use super::mtl::{self, MtlMaterial, Unused};
use crate::formats::error::FormatError;
use crate::formats::files::{Contents, Files, NamedBy, beside};
use crate::formats::parsed::BLENDED;
use crate::quote::{self, quote};
use crate::scene::Opacity;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

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
            if let Some(image) = &material.images.color {
                material.material.texture = images.read(library, image, "image");
            }
        }
    }
    for &number in &used {
        let (material, library) = &mut materials[number];
        images.read_opacity(library, material);
        images.read_reflectance(library, material);
    }
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
        let image = material.images.color.as_ref()?;
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

/// The names in a line of several, between spaces; one that a backslash precedes is part of a name.
fn names_in(line: &str) -> Vec<String> {
    let mut names = vec![String::new()];
    let mut letters = line.chars().peekable();
    while let Some(mut letter) = letters.next() {
        let is_between = letter.is_whitespace();
        if letter == '\\'
            && let Some(space) = letters.next_if(|next| next.is_whitespace())
        {
            letter = space;
        }
        match names.last_mut() {
            Some(name) if !is_between => name.push(letter),
            _ => names.push(String::new()),
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

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
        let names = names_in(line);
        let missing: Vec<_> = if names.iter().ne([line]) {
            let failures = names.into_iter().map(|name| {
                let error = add(&name).err();
                (name, error)
            });
            failures
                .filter_map(|(name, error)| Some((name, error?)))
                .collect()
        } else {
            vec![(line.clone(), error)]
        };
        for (name, error) in missing {
            let path = quote::path(path);
            let (name, why) = (quote(&name), error.reason());
            warnings.push(format!(
                "{path}: its materials in {name} cannot be read: {why}"
            ));
        }
    }
    found
}
