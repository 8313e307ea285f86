use super::parts::{Part, Parts, Shortest, one_line};
use super::written::{WriteError, Written};
use glam::{DVec3, Vec3};
use std::io::{self, Write};

/// Writes STL: corners in single precision, and normals computed from them.
pub(super) fn write(
    parts: &Parts<'_>,
    ascii: bool,
    out: &mut dyn Write,
    written: &mut Written,
) -> Result<(), WriteError> {
    if ascii {
        for part in &parts.parts {
            solid(parts, part, out)?;
        }
    } else {
        binary(parts, out, written.triangles)?;
    }
    parts.count_moves(written, |_, position| position.as_vec3().as_dvec3());
    parts.record_lost_attributes(written);
    Ok(())
}

fn binary(parts: &Parts<'_>, out: &mut dyn Write, triangles: u64) -> Result<(), WriteError> {
    let count = u32::try_from(triangles).map_err(|_| WriteError::TooMany {
        what: format!("{triangles} triangles"),
        format: "STL",
    })?;
    // A binary header must not start with `solid`.
    let mut header = [0; 80];
    let name = b"Binary STL, written by RayCast";
    header[..name.len()].copy_from_slice(name);
    out.write_all(&header)?;
    out.write_all(&count.to_le_bytes())?;
    for part in &parts.parts {
        for triangle in part.triangles.iter() {
            let corners = part.corners(*triangle).map(DVec3::as_vec3);
            let mut facet = [0; 50];
            let vectors = [normal(corners)].into_iter().chain(corners);
            let numbers = vectors.flat_map(|vector| vector.to_array());
            for (place, number) in facet.as_chunks_mut::<4>().0.iter_mut().zip(numbers) {
                *place = number.to_le_bytes();
            }
            out.write_all(&facet)?;
        }
    }
    Ok(())
}

fn solid(parts: &Parts<'_>, part: &Part<'_>, out: &mut dyn Write) -> io::Result<()> {
    let name = one_line(part.name);
    writeln!(out, "solid {name}")?;
    for triangle in part.triangles.iter() {
        let corners = part.corners(*triangle).map(DVec3::as_vec3);
        let [x, y, z] = normal(corners).to_array().map(Shortest);
        writeln!(out, "facet normal {x} {y} {z}\nouter loop")?;
        for corner in corners {
            let numbers = corner.as_dvec3().to_array();
            let [x, y, z] = numbers.map(|number| parts.decimal(number));
            writeln!(out, "vertex {x} {y} {z}")?;
        }
        writeln!(out, "endloop\nendfacet")?;
    }
    writeln!(out, "endsolid {name}")
}

/// The normal of a triangle, of unit length; zero without area.
fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    let normal = (b - a).cross(c - a);
    // Scaled first, since squares of lengths may leave the range of doubles.
    (normal / normal.abs().max_element())
        .normalize_or_zero()
        .as_vec3()
}
