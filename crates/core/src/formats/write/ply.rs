use super::parts::{JoinedMesh, Part, Parts, Shortest};
use super::written::{WriteError, Written};
use crate::quote;
use crate::scene::{Color, Mesh, Scalar, ScalarAt};
use glam::DVec3;
use std::io::{self, Write};

/// The properties of vertices and faces.
struct Columns {
    doubles: bool,
    normals: bool,
    uvs: bool,
    colors: bool,
    face_colors: bool,
    /// Names of the vertices' scalars, as the meshes have them.
    scalars: Vec<String>,
    /// Names of the faces' scalars.
    face_scalars: Vec<String>,
}

/// What a reader appends to the name of a face scalar if a vertex scalar has the same name.
const FACE_SUFFIX: &str = " of faces";

/// The names of all meshes' scalars of vertices or of triangles, each once.
fn names(parts: &Parts<'_>, at: ScalarAt) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let meshes = parts.parts.iter().map(|part| part.mesh);
    for scalar in meshes.flat_map(Mesh::scalars).filter(|s| s.at == at) {
        if !names.contains(&scalar.name) {
            names.push(scalar.name.clone());
        }
    }
    names
}

/// The values of a mesh's scalars of these names; an empty list for those that it lacks.
fn values<'m>(mesh: &'m Mesh, names: &[String], at: ScalarAt) -> Vec<&'m [f32]> {
    let is_it = |scalar: &&Scalar, name: &str| scalar.name == name && scalar.at == at;
    let of = |name: &String| mesh.scalars().iter().find(|scalar| is_it(scalar, name));
    let values = names.iter().map(of);
    values
        .map(|scalar| scalar.map_or(&[][..], |scalar| &scalar.values))
        .collect()
}

impl Columns {
    /// Drops the scalars whose names a PLY cannot represent, or uses for something else.
    fn drop_unnamable(&mut self, written: &mut Written) {
        let mut taken = vec!["x", "y", "z"];
        for (has, names) in [
            (self.normals, &["nx", "ny", "nz"][..]),
            (self.uvs, &["s", "t"]),
            (self.colors, &COLOR),
        ] {
            taken.extend(names.iter().copied().filter(|_| has));
        }
        let mut lose = |scalars: &mut Vec<String>, taken: &[&str]| {
            let mut seen: Vec<String> = Vec::new();
            scalars.retain(|name| {
                let property = property(name);
                let is_word =
                    !property.is_empty() && property.chars().all(|c| c.is_ascii_graphic());
                let is_free = !taken.contains(&property) && !seen.iter().any(|s| s == property);
                if is_word && is_free {
                    seen.push(property.to_owned());
                } else {
                    let name = quote::quote(name);
                    written.lost.push(format!(
                        "scalar {name}, whose name stands for something else"
                    ));
                }
                is_word && is_free
            });
        };
        lose(&mut self.scalars, &taken);
        let taken: &[&str] = if self.face_colors { &COLOR } else { &[] };
        lose(&mut self.face_scalars, taken);
    }
}

/// A scalar's name in the file.
fn property(name: &str) -> &str {
    name.strip_suffix(FACE_SUFFIX).unwrap_or(name)
}

const COLOR: [&str; 3] = ["red", "green", "blue"];

/// Writes PLY, little-endian or as text: one list of vertices and one of triangles. Coordinates are in double
/// precision where single precision cannot represent them all.
pub(super) fn write(
    parts: &Parts<'_>,
    ascii: bool,
    out: &mut dyn Write,
    written: &mut Written,
) -> Result<(), WriteError> {
    let join_attributes: Vec<JoinedMesh> = parts.parts.iter().map(Part::join_attributes).collect();
    let vertices: usize = join_attributes.iter().map(|part| part.vertices.len()).sum();
    if vertices >= i32::MAX as usize {
        return Err(WriteError::TooMany {
            what: format!("{vertices} vertices"),
            format: "PLY",
        });
    }
    written.vertices = vertices as u64;
    let colors: Vec<Option<Vec<Color>>> = parts.parts.iter().map(Part::vertex_colors).collect();
    let mut columns = Columns {
        doubles: !parts.is_single,
        normals: parts.has(|part| part.normals.is_some()),
        uvs: parts.has(|part| part.mesh.has_uvs()),
        // Only if all vertices have colours: PLY has no value for a missing one.
        colors: colors.iter().all(Option::is_some) && !colors.is_empty(),
        face_colors: parts.has(|part| !part.mesh.materials().is_empty()),
        scalars: names(parts, ScalarAt::Vertices),
        face_scalars: names(parts, ScalarAt::Triangles),
    };
    columns.drop_unnamable(written);
    if !columns.colors && parts.has(|part| !part.mesh.vertex_colors().is_empty()) {
        written
            .lost
            .push("colours of vertices, which not all have".to_owned());
    }
    header(&columns, ascii, vertices, written.triangles, out)?;
    let mut row = Row { ascii, out };
    for ((part, join_attributes), colors) in parts.parts.iter().zip(&join_attributes).zip(&colors) {
        let scalars = values(part.mesh, &columns.scalars, ScalarAt::Vertices);
        for &[position, normal, uv] in &join_attributes.vertices {
            for number in part.positions[position as usize].to_array() {
                if ascii {
                    write!(row.out, "{} ", parts.decimal(number))?;
                } else if columns.doubles {
                    row.out.write_all(&number.to_le_bytes())?;
                } else {
                    row.out.write_all(&(number as f32).to_le_bytes())?;
                }
            }
            if columns.normals {
                for number in part.normal(normal).to_array() {
                    row.single(number)?;
                }
            }
            if columns.uvs {
                for number in part.uv(uv).to_array() {
                    row.single(number)?;
                }
            }
            if let Some(colors) = colors.as_ref().filter(|_| columns.colors) {
                row.color(colors[position as usize])?;
            }
            row.scalars(&scalars, position as usize)?;
            row.end()?;
        }
    }
    let mut first = 0;
    for (part, join_attributes) in parts.parts.iter().zip(&join_attributes) {
        let scalars = values(part.mesh, &columns.face_scalars, ScalarAt::Triangles);
        for (number, triangle) in join_attributes.triangles.iter().enumerate() {
            row.number(3u8, &[3])?;
            for corner in triangle {
                let index = first + corner;
                row.number(index, &index.to_le_bytes())?;
            }
            if columns.face_colors {
                let material = part.mesh.material(number as u32);
                row.color(material.map_or(Color::DEFAULT, |material| material.color))?;
            }
            row.scalars(&scalars, number)?;
            row.end()?;
        }
        first += join_attributes.vertices.len() as u32;
    }
    if columns.doubles {
        parts.count_moves(written, |_, position| position);
    } else {
        parts.count_moves(written, |_, position: DVec3| position.as_vec3().as_dvec3());
    }
    if columns.face_colors {
        written.lost.push("names of materials".to_owned());
    }
    parts.record_lost_names(written);
    Ok(())
}

fn header(
    columns: &Columns,
    ascii: bool,
    vertices: usize,
    triangles: u64,
    out: &mut dyn Write,
) -> io::Result<()> {
    let format = if ascii {
        "ascii"
    } else {
        "binary_little_endian"
    };
    writeln!(out, "ply\nformat {format} 1.0\ncomment written by RayCast")?;
    writeln!(out, "element vertex {vertices}")?;
    let mut properties = |kind: &str, names: &[&str]| {
        names
            .iter()
            .try_for_each(|name| writeln!(out, "property {kind} {name}"))
    };
    let kind = if columns.doubles { "double" } else { "float" };
    properties(kind, &["x", "y", "z"])?;
    if columns.normals {
        properties("float", &["nx", "ny", "nz"])?;
    }
    if columns.uvs {
        properties("float", &["s", "t"])?;
    }
    if columns.colors {
        properties("uchar", &COLOR)?;
    }
    for name in &columns.scalars {
        properties("float", &[property(name)])?;
    }
    writeln!(
        out,
        "element face {triangles}\nproperty list uchar int vertex_indices"
    )?;
    if columns.face_colors {
        COLOR
            .iter()
            .try_for_each(|name| writeln!(out, "property uchar {name}"))?;
    }
    for name in &columns.face_scalars {
        writeln!(out, "property float {}", property(name))?;
    }
    writeln!(out, "end_header")
}

/// Writes numbers as text, a line an element, or in binary.
struct Row<'o> {
    ascii: bool,
    out: &'o mut dyn Write,
}

impl Row<'_> {
    fn number<T>(&mut self, number: T, bytes: &[u8]) -> io::Result<()>
    where
        T: Copy + Into<f64> + std::fmt::Display + std::fmt::LowerExp,
    {
        if self.ascii {
            write!(self.out, "{} ", Shortest(number))
        } else {
            self.out.write_all(bytes)
        }
    }

    fn single(&mut self, number: f32) -> io::Result<()> {
        self.number(number, &number.to_le_bytes())
    }

    fn color(&mut self, Color(channels): Color) -> io::Result<()> {
        channels
            .iter()
            .try_for_each(|channel| self.number(*channel, &[*channel]))
    }

    /// A missing value of a scalar is NaN.
    fn scalars(&mut self, scalars: &[&[f32]], index: usize) -> io::Result<()> {
        let mut values = scalars.iter().map(|values| values.get(index).copied());
        values.try_for_each(|value| self.single(value.unwrap_or(f32::NAN)))
    }

    fn end(&mut self) -> io::Result<()> {
        if self.ascii {
            writeln!(self.out)
        } else {
            Ok(())
        }
    }
}
