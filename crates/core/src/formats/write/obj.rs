use super::mtl::{MaterialLibrary, unit_channel};
use super::parts::{Part, Parts, Shortest, one_line};
use super::written::{WriteError, Written};
use crate::scene::Color;
use std::io::Write;
use std::ops::Range;

/// Writes OBJ: an `o` for each object, a `g` where its triangles' groups change, colours after the vertices' coordinates, and materials by name.
pub(super) fn write(
    parts: &Parts<'_>,
    library: Option<(&str, &MaterialLibrary)>,
    out: &mut dyn Write,
    written: &mut Written,
) -> Result<(), WriteError> {
    let has_materials = parts.has(|part| !part.mesh.materials().is_empty());
    match library {
        Some((name, library)) if !library.is_empty() => {
            writeln!(out, "mtllib {}", one_line(name))?;
            written.lost.extend(library.lost.iter().cloned());
        }
        None if has_materials => written.lost.push("materials".to_owned()),
        _ => {}
    }
    let library = library.filter(|(_, library)| !library.is_empty());
    // The numbers of vertices, texture coordinates and normals written so far.
    let mut above = [0; 3];
    let mut last_material = None;
    for (number, part) in parts.parts.iter().enumerate() {
        writeln!(out, "o {}", one_line(part.name))?;
        let colors = part.mesh.vertex_colors();
        for (vertex, position) in part.positions.iter().enumerate() {
            let [x, y, z] = position.to_array().map(|number| parts.decimal(number));
            write!(out, "v {x} {y} {z}")?;
            if let Some(Some(Color(channels))) = colors.get(vertex) {
                let [r, g, b] = channels.map(unit_channel);
                write!(out, " {r} {g} {b}")?;
            }
            writeln!(out)?;
        }
        let uvs = part.mesh.uvs();
        for uv in uvs.iter().flat_map(|uvs| &uvs.values) {
            let [u, v] = uv.to_array().map(Shortest);
            writeln!(out, "vt {u} {v}")?;
        }
        let normals = part.normals.as_ref();
        for normal in normals.iter().flat_map(|normals| &normals.values) {
            let [x, y, z] = normal.to_array().map(Shortest);
            writeln!(out, "vn {x} {y} {z}")?;
        }
        let counts = [
            part.positions.len(),
            uvs.map_or(0, |uvs| uvs.values.len()),
            normals.map_or(0, |normals| normals.values.len()),
        ];
        let materials = part.mesh.material_of_triangle();
        let mut groups = group_lines(part).peekable();
        for (index, &triangle) in part.triangles.iter().enumerate() {
            if let Some((_, line)) = groups.next_if(|(first, _)| *first == index) {
                writeln!(out, "{line}")?;
            }
            if let Some((_, library)) = library {
                let material = materials.get(index).copied();
                let name = library.name(number, material);
                if last_material != Some(name) {
                    writeln!(out, "usemtl {name}")?;
                    last_material = Some(name);
                }
            }
            // The triangles that have the attribute at all three corners.
            let own = |indices: Option<&Vec<[u32; 3]>>, kind: usize| {
                let own = match indices {
                    Some(indices) => *indices.get(index)?,
                    None => triangle,
                };
                own.iter()
                    .all(|&i| (i as usize) < counts[kind])
                    .then_some(own)
            };
            let uv = uvs.and_then(|uvs| own(uvs.indices.as_ref(), 1));
            let normal = normals.and_then(|normals| own(normals.indices.as_ref(), 2));
            write!(out, "f")?;
            for corner in 0..3 {
                let index = |of: [u32; 3], kind: usize| above[kind] + of[corner] as usize + 1;
                write!(out, " {}", index(triangle, 0))?;
                match (uv, normal) {
                    (None, None) => {}
                    (Some(uv), None) => write!(out, "/{}", index(uv, 1))?,
                    (None, Some(normal)) => write!(out, "//{}", index(normal, 2))?,
                    (Some(uv), Some(normal)) => {
                        write!(out, "/{}/{}", index(uv, 1), index(normal, 2))?;
                    }
                }
            }
            writeln!(out)?;
        }
        for (above, count) in above.iter_mut().zip(counts) {
            *above += count;
        }
    }
    parts.count_moves(written, |_, position| position);
    Ok(())
}

/// The `g` lines of an object, each with the number of the triangle after it.
fn group_lines<'p>(part: &'p Part<'_>) -> impl Iterator<Item = (usize, String)> + 'p {
    let groups = part.mesh.groups();
    let ranges = groups.named_ranges(part.triangles.len());
    // Triangles above all groups are not in one of the object's name, which an `o` begins, too.
    let is_above = !groups.is_empty() && groups.of(0).is_none();
    let above = is_above.then_some((0..0, None));
    let ranges = above.into_iter().chain(ranges);
    ranges.map(|(range, name): (Range<usize>, _)| {
        let line = format!("g {}", name.map_or_else(String::new, one_line));
        (range.start, line.trim_end().to_owned())
    })
}
