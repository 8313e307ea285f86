mod content;
mod images;
mod map_options;
mod materials;
mod mtl;
mod numbers;
mod pieces;
mod reader;
#[cfg(test)]
mod tests;
mod text;
mod words;

use crate::formats::Progress;
use crate::formats::error::FormatError;
use crate::formats::files::Files;
use crate::formats::polygon;
use crate::quote;
use crate::scene::{Attribute, Diagonals, MeshData};
use content::{NONE, ObjText, Oddities};
use glam::Vec3;
use materials::{index_by_name, materials, notes, triangle_materials};
use mtl::Unused;
use std::path::{Path, PathBuf};

/// An OBJ file.
#[derive(Debug)]
pub(super) struct Obj {
    pub(super) mesh: MeshData,
    /// The image, if the materials of all faces name the same one.
    pub(super) texture: Option<PathBuf>,
    /// Contents of its material libraries that are not shown.
    pub(super) notes: Vec<String>,
    /// Faults that are too small to refuse the file.
    pub(super) warnings: Vec<String>,
}

/// Reads an OBJ file, and through `files` its material libraries.
///
/// Triangles are in the file's order of faces, regardless of groups and materials. Positions are those of the file,
/// including unused ones, and keep their indices.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    files: &dyn Files,
    progress: Progress<'_>,
) -> Result<Obj, FormatError> {
    let mut text = text::read(path, bytes, files.budget(), &|share| progress(share * 0.9))?;
    if text.triangles.is_empty() {
        return Err(FormatError::unexpected(
            path,
            None,
            "faces (lines of `f v v v`)",
            "none",
        ));
    }
    let mut warnings = Vec::new();
    warnings.extend(check_unused_vertices(path, &text)?);
    warnings.extend(oddity_warnings(path, &text.oddities));
    let mut unused = Unused::new();
    let (materials, texture) = materials(path, &text, files, &mut warnings, &mut unused);
    let material_of_triangle = if materials.is_empty() {
        Vec::new()
    } else {
        triangle_materials(&text)
    };
    let groups = std::mem::take(&mut text.groups).groups(text.triangles.len());
    let mut mesh = MeshData {
        uvs: attribute(
            std::mem::take(&mut text.uvs),
            std::mem::take(&mut text.uv_triangles),
            text.triangles.len(),
            |uv| uv.is_finite(),
        ),
        normals: attribute(
            std::mem::take(&mut text.normals),
            std::mem::take(&mut text.normal_triangles),
            text.triangles.len(),
            |normal| *normal != Vec3::ZERO,
        ),
        positions: text.positions,
        triangles: text.triangles,
        colors: text.colors,
        material_of_triangle,
        materials: Vec::new(),
        scalars: Vec::new(),
        diagonals: Diagonals::default(),
        groups,
    };
    progress(0.95);
    let uncut = polygon::cut(&mut mesh, &text.polygons);
    warnings.extend(uncut.warnings(path));
    let numbers = index_by_name(&materials);
    let named: Vec<u32> = text
        .materials
        .iter()
        .map(|name| numbers.get(name.as_str()).copied().unwrap_or(NONE))
        .collect();
    for material in &mut mesh.material_of_triangle {
        *material = named.get(*material as usize).copied().unwrap_or(NONE);
    }
    let options: Vec<_> = (materials.iter())
        .map(|(material, _)| material.images.options())
        .collect();
    map_options::move_coordinates(path, &mut mesh, &options, files.budget())?;
    mesh.materials = materials
        .into_iter()
        .map(|(material, _)| material.material)
        .collect();
    progress(1.0);
    Ok(Obj {
        mesh,
        texture,
        notes: notes(&unused),
        warnings,
    })
}

/// A warning where many vertices are in no face: the file may be truncated.
///
/// # Errors
/// The same, where the file also ends in a face without a line end: then it is truncated.
fn check_unused_vertices(path: &Path, text: &ObjText) -> Result<Option<String>, FormatError> {
    // Complete files have unused vertices, too: the Stanford bunny 3 in 100; but hardly 5.
    const MIN_UNUSED: usize = 16;
    let vertices = text.positions.len();
    let mut is_used = vec![false; vertices];
    for &vertex in text.triangles.iter().flatten() {
        if let Some(is_used) = is_used.get_mut(vertex as usize) {
            *is_used = true;
        }
    }
    let loose = is_used.iter().filter(|is_used| !**is_used).count();
    if loose < MIN_UNUSED || loose * 20 < vertices {
        return Ok(None);
    }
    let what = format!("{loose} of {vertices} vertices are in no face");
    if text.open_end.is_some() {
        let found = format!("the file's end, and {what}: it is cut short");
        let expected = "a newline behind the last face";
        return Err(FormatError::unexpected(
            path,
            text.open_end,
            expected,
            found,
        ));
    }
    let path = quote::path(path);
    Ok(Some(format!("{path}: {what}: is it cut short?")))
}

/// A warning for each type of oddity in the file.
fn oddity_warnings(path: &Path, oddities: &Oddities) -> Vec<String> {
    let Oddities {
        dangling,
        weights,
        extra_values,
        colors_out_of_range,
    } = *oddities;
    let counts = [
        (
            dangling,
            "faces that name texture coordinates or normals of which the file has none",
        ),
        (
            weights,
            "vertices with a fourth value that is not 1, in OBJ a weight for rational curves and \
             surfaces alone, which is passed over",
        ),
        (
            extra_values,
            "vertices with values behind their colour, which are passed over",
        ),
        (
            colors_out_of_range,
            "vertices with a colour that is not from 0 to 1, which is clamped",
        ),
    ];
    let path = quote::path(path);
    let odd = counts.iter().filter(|(count, _)| *count > 0);
    odd.map(|(count, what)| format!("{path}: {what}: {count}"))
        .collect()
}

/// Values at corners. A triangle without values, or with an invalid one, has no indices; `None` where that is every
/// triangle.
fn attribute<T>(
    values: Vec<T>,
    mut indices: Vec<[u32; 3]>,
    triangles: usize,
    is_good: impl Fn(&T) -> bool,
) -> Option<Attribute<T>> {
    let mut any = false;
    for triangle in &mut indices {
        let is_good = |&i: &u32| values.get(i as usize).is_some_and(&is_good);
        if triangle.iter().all(is_good) {
            any = true;
        } else {
            *triangle = [NONE; 3];
        }
    }
    any.then(|| {
        indices.resize(triangles, [NONE; 3]);
        Attribute {
            values,
            indices: Some(indices),
        }
    })
}
