use super::parts::{Parts, Shortest, one_line};
use super::written::{WriteError, Written};
use crate::scene::{Color, Scene};
use std::collections::HashMap;
use std::io::{self, Write};

/// Writes OBJ: an `o` for each object, colours after the vertices' coordinates, and materials by name.
pub(super) fn write(
    parts: &Parts<'_>,
    library: Option<&str>,
    out: &mut dyn Write,
    written: &mut Written,
) -> Result<(), WriteError> {
    let meshes = parts.parts.iter().map(|part| part.mesh);
    let names = Names::new(meshes.map(|mesh| mesh.materials()));
    let has_materials = names.are_any();
    let library = library.filter(|_| has_materials);
    match library {
        Some(library) => writeln!(out, "mtllib {}", one_line(library))?,
        None if has_materials => written.lost.push("materials".to_owned()),
        None => {}
    }
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
        for (index, &triangle) in part.triangles.iter().enumerate() {
            if library.is_some() {
                let material = materials.get(index).copied();
                let name = names.material_name(number, material);
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

/// Writes the library of the materials; returns whether there are any.
pub(super) fn write_library(scene: &Scene, out: &mut dyn Write) -> io::Result<bool> {
    let names = Names::new(scene.objects.iter().map(|object| object.mesh.materials()));
    for (name, Color(channels)) in &names.all {
        let [r, g, b] = channels.map(unit_channel);
        writeln!(out, "newmtl {name}\nKd {r} {g} {b}")?;
    }
    Ok(names.are_any())
}

/// A channel from 0 to 1, with enough digits to restore eight bits.
fn unit_channel(channel: u8) -> Shortest<f64> {
    Shortest((f64::from(channel) / 255.0 * 1e4).round() / 1e4)
}

/// The materials of all objects, with unique names.
struct Names {
    /// Each material once; the first is that of triangles without a material.
    all: Vec<(String, Color)>,
    /// For each object, the indices of its materials.
    of_objects: Vec<Vec<usize>>,
}

impl Names {
    fn new<'m>(objects: impl Iterator<Item = &'m [crate::scene::Material]>) -> Self {
        let mut all = vec![("none".to_owned(), Color::DEFAULT)];
        let mut known: HashMap<(String, Color), usize> = HashMap::from([(all[0].clone(), 0)]);
        let mut taken: HashMap<String, usize> = HashMap::from([(all[0].0.clone(), 1)]);
        let of_objects = objects
            .map(|materials| {
                let number = |material: &crate::scene::Material| {
                    let wanted = match one_line(&material.name) {
                        name if name.is_empty() => "unnamed".to_owned(),
                        name => name,
                    };
                    let key = (wanted.clone(), material.color);
                    if let Some(&number) = known.get(&key) {
                        return number;
                    }
                    let mut name = wanted.clone();
                    while taken.contains_key(&name) {
                        let count = taken.entry(wanted.clone()).or_default();
                        *count += 1;
                        name = format!("{wanted} {count}");
                    }
                    taken.insert(name.clone(), 1);
                    all.push((name, material.color));
                    known.insert(key, all.len() - 1);
                    all.len() - 1
                };
                materials.iter().map(number).collect()
            })
            .collect();
        Self { all, of_objects }
    }

    fn are_any(&self) -> bool {
        self.of_objects
            .iter()
            .any(|materials| !materials.is_empty())
    }

    /// The name of an object's material, or of no material.
    fn material_name(&self, object: usize, material: Option<u32>) -> &str {
        let materials = &self.of_objects[object];
        let number = material.and_then(|material| materials.get(material as usize));
        &self.all[number.copied().unwrap_or(0)].0
    }
}
