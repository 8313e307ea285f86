//! PLY, ASCII and binary of both byte orders (Turk, "The PLY Polygon File Format", 1994).
//!
//! Vertices: `x y z`, normals `nx ny nz`, colours `red green blue`, texture coordinates `s t`, `u v` or `texture_u
//! texture_v`. Faces: the list `vertex_indices` or `vertex_index`, colours, and texture coordinates at corners as the
//! list `texcoord`. Triangle strips: the list `vertex_indices` of the element `tristrips`. Other numbers of vertices
//! and faces are scalars, which colours can show. Everything else is skipped, with a note.

mod faces;
mod header;
mod layout;
mod reader;
mod values;

use crate::formats::Progress;
use crate::formats::at_vertices::at_vertices;
use crate::formats::error::FormatError;
use crate::formats::face_colors;
use crate::formats::files::beside;
use crate::formats::limits::Budget;
use crate::formats::parsed::Parsed;
use crate::formats::polygon;
use crate::quote;
use crate::scene::{Attribute, MeshData};
use glam::Vec3;
pub(super) use header::is_ply;
use header::{Encoding, Header};
use layout::NONE;
use reader::{Reader, plain};
use std::path::Path;
use values::{Ascii, Binary, Values};

/// Reads a PLY.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<Parsed, FormatError> {
    let header = header::read(path, bytes)?;
    match header.encoding {
        Encoding::Ascii => body(
            path,
            &header,
            Ascii::new(bytes, header.body),
            budget,
            progress,
        ),
        Encoding::LittleEndian => {
            let values = Binary::<false>::new(bytes, header.body);
            body(path, &header, values, budget, progress)
        }
        Encoding::BigEndian => {
            let values = Binary::<true>::new(bytes, header.body);
            body(path, &header, values, budget, progress)
        }
    }
}

fn body<V: Values>(
    path: &Path,
    header: &Header,
    values: V,
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<Parsed, FormatError> {
    let encoding = match header.encoding {
        Encoding::Ascii => "ASCII",
        Encoding::LittleEndian => "binary, little-endian",
        Encoding::BigEndian => "binary, big-endian",
    };
    let named = |name: &str| header.elements.iter().find(|element| element.name == name);
    let vertices = named("vertex").map_or(0, |element| element.count);
    // Indices have 32 bits; one value means none.
    let Some(vertices) = u32::try_from(vertices).ok().filter(|count| *count < NONE) else {
        let found = format!("{vertices}");
        let expected = format!("fewer than {NONE} vertices");
        return Err(FormatError::unexpected(path, None, expected, found));
    };
    let mut reader = Reader {
        path,
        budget,
        values,
        vertices,
        mesh: MeshData::default(),
        normals: Vec::new(),
        uvs: Vec::new(),
        polygons: Vec::new(),
        corner_uvs: Vec::new(),
        uv_triangles: Vec::new(),
        face_colors: Vec::new(),
        face_scalars: Vec::new(),
        small: 0,
        notes: vec![encoding.to_owned()],
    };
    let count = header.elements.len().max(1) as f32;
    for (index, element) in header.elements.iter().enumerate() {
        let step = |share: f32| progress(0.9 * (index as f32 + share) / count);
        match element.name.as_str() {
            "vertex" => reader.vertices(element, &step)?,
            "face" => reader.faces(element, &step)?,
            "tristrips" => reader.strips(element)?,
            name => {
                reader.pass(element)?;
                let count = element.count;
                let name = plain(name);
                reader
                    .notes
                    .push(format!("not used: {count} of element {name}"));
            }
        }
        step(1.0);
    }
    let read = reader.parsed(header)?;
    progress(1.0);
    Ok(read)
}

impl<V: Values> Reader<'_, V> {
    /// The mesh of all elements.
    fn parsed(self, header: &Header) -> Result<Parsed, FormatError> {
        let left = self.values.left();
        let Self {
            path,
            vertices,
            mut mesh,
            normals,
            uvs,
            polygons,
            corner_uvs,
            uv_triangles,
            face_colors,
            face_scalars,
            small,
            notes,
            ..
        } = self;
        if mesh.triangles.is_empty() {
            let found = match (vertices, small) {
                (1.., 0) => format!("none: it has {vertices} points alone, which are not shown"),
                (_, 1..) => format!("{small} of fewer than three corners"),
                _ => "none".to_owned(),
            };
            return Err(FormatError::unexpected(path, None, "faces", found));
        }
        if !uv_triangles.is_empty() {
            mesh.uvs = Some(Attribute {
                values: corner_uvs,
                indices: Some(uv_triangles),
            });
        }
        if !face_colors.is_empty() {
            face_colors::set(&mut mesh, face_colors);
        }
        for mut scalar in face_scalars {
            scalar.values.resize(mesh.triangles.len(), f32::NAN);
            mesh.scalars.push(scalar);
        }
        let uncut = polygon::cut(&mut mesh, &polygons);
        mesh.normals = at_vertices(normals, &mesh.triangles, |normal| *normal != Vec3::ZERO);
        if mesh.uvs.is_none() {
            mesh.uvs = at_vertices(uvs, &mesh.triangles, |uv| uv.is_finite());
        }
        let mut parsed = Parsed {
            mesh,
            texture: header.texture.as_deref().map(|name| beside(path, name)),
            notes,
            ..Parsed::default()
        };
        let quoted = quote::path(path);
        let counts = [
            (
                header.odd_lines,
                "header lines that are not known, which are passed over",
            ),
            (
                small,
                "faces of fewer than three corners, which are passed over",
            ),
            (left, "bytes behind its last element, which are passed over"),
        ];
        for (count, what) in counts.into_iter().filter(|(count, _)| *count > 0) {
            parsed.warnings.push(format!("{quoted}: {what}: {count}"));
        }
        parsed.warnings.extend(uncut.warnings(path));
        Ok(parsed)
    }
}

#[cfg(test)]
mod tests;
