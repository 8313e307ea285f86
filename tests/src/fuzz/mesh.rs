//! What holds of every mesh that was read.

use super::picture::is_seen_soundly;
use super::reading::{Reading, read_mesh, with_windows_lines};
use raycast_core::formats::{MeshFormat, SceneFile, write_meshes};
use raycast_core::scene::{COORDINATE_LIMIT, Mesh, Scene};
use std::fmt::Write;

/// What must hold of a text file of one mesh, which `write` writes again.
///
/// # Errors
/// What does not.
pub fn check_text(name: &str, bytes: &[u8], write: fn(&Mesh) -> String) -> Result<(), String> {
    let reading = read_mesh(name, bytes)?;
    if let Some(windows) = with_windows_lines(bytes) {
        are_equal(&reading, &read_mesh(name, &windows)?)
            .map_err(|difference| format!("with Windows' lines {difference}"))?;
    }
    let Ok(file) = reading else {
        return Ok(());
    };
    let mesh = only_mesh(&file);
    is_sound(mesh)?;
    reads_again(mesh, name, write)?;
    is_seen_soundly(&file)
}

/// Whether the numbers of a mesh agree with one another, and what rays can hit is finite.
///
/// # Errors
/// The first thing that does not hold.
pub fn is_sound(mesh: &Mesh) -> Result<(), String> {
    let count = mesh.triangles().len();
    let kept = mesh.kept();
    if !kept.is_sorted_by(|a, b| a < b) || kept.last().is_some_and(|&last| last as usize >= count) {
        return Err(format!("numbers of {count} triangles: {kept:?}"));
    }
    let dropped = mesh.dropped();
    if kept.len() + dropped.total() as usize != count {
        return Err(format!("{} kept of {count}, {dropped:?}", kept.len()));
    }
    for &number in kept {
        let corners = mesh.corners(number);
        let is_near = corners.is_some_and(|corners| {
            corners.iter().all(|&corner| {
                let corner = mesh.offset() + corner.as_dvec3();
                // Single precision rounds by half a unit in its last place, at most.
                corner.is_finite() && corner.abs().max_element() <= COORDINATE_LIMIT * (1.0 + 6e-8)
            })
        });
        if !is_near {
            return Err(format!("triangle {number} is kept: {corners:?}"));
        }
    }
    for number in 0..count as u32 {
        let normals = mesh.corner_normals(number);
        if normals.is_some_and(|normals| normals.iter().any(|n| !n.is_normalized())) {
            return Err(format!("normals of triangle {number}: {normals:?}"));
        }
        let uvs = mesh.corner_uvs(number);
        if uvs.is_some_and(|uvs| uvs.iter().any(|uv| !uv.is_finite())) {
            return Err(format!("UV of triangle {number}: {uvs:?}"));
        }
    }
    Ok(())
}

/// Whether two readings are the same: the same mesh, bit for bit, or the same refusal.
///
/// # Errors
/// In what they differ.
pub fn are_equal(a: &Reading, b: &Reading) -> Result<(), String> {
    match (a, b) {
        (Ok(a), Ok(b)) => {
            if a.warnings != b.warnings {
                return Err(format!("warnings {:?} and {:?}", a.warnings, b.warnings));
            }
            meshes_are_equal(only_mesh(a), only_mesh(b))
        }
        (Err(a), Err(b)) if a == b => Ok(()),
        (Err(a), Err(b)) => Err(format!("refused as {a:?} and as {b:?}")),
        (Ok(_), Err(refusal)) | (Err(refusal), Ok(_)) => {
            Err(format!("read once, and refused once: {refusal}"))
        }
    }
}

fn meshes_are_equal(a: &Mesh, b: &Mesh) -> Result<(), String> {
    let bits = |mesh: &Mesh| -> Vec<[u32; 3]> {
        let positions = mesh.positions().iter();
        positions.map(|p| p.to_array().map(f32::to_bits)).collect()
    };
    let of_triangles = |mesh: &Mesh| -> String {
        (0..mesh.triangles().len() as u32)
            .map(|number| {
                let material = mesh.material(number);
                let normals = mesh.corner_normals(number);
                format!("{material:?} {normals:?} {:?}\n", mesh.corner_uvs(number))
            })
            .collect()
    };
    let agree = [
        ("offsets", a.offset() == b.offset()),
        ("positions", bits(a) == bits(b)),
        ("triangles", a.triangles() == b.triangles()),
        ("kept triangles", a.kept() == b.kept()),
        ("dropped triangles", a.dropped() == b.dropped()),
        ("materials", a.materials() == b.materials()),
        ("attributes", of_triangles(a) == of_triangles(b)),
    ];
    match agree.iter().find(|(_, agree)| !agree) {
        Some((what, _)) => Err(format!("the {what} differ")),
        None => Ok(()),
    }
}

/// Whether a mesh that is written by `write` as a file of this name reads again with the same
/// triangles kept, each with the same corners.
///
/// # Errors
/// In what it differs.
pub fn reads_again(mesh: &Mesh, name: &str, write: fn(&Mesh) -> String) -> Result<(), String> {
    if mesh.triangles().is_empty() {
        return Ok(());
    }
    let text = write(mesh);
    let again = read_mesh(name, text.as_bytes())?.map_err(|error| format!("not again: {error}"))?;
    has_same_triangles(mesh, only_mesh(&again))
}

fn has_same_triangles(mesh: &Mesh, again: &Mesh) -> Result<(), String> {
    if again.triangles().len() != mesh.triangles().len() {
        let (before, after) = (mesh.triangles().len(), again.triangles().len());
        return Err(format!("{after} of {before} triangles are read again"));
    }
    // What was written is rounded, so a mesh that is about as far from zero as it is long may get
    // another offset, and with it other roundings.
    if again.offset() != mesh.offset() {
        return Ok(());
    }
    let corners = |mesh: &Mesh, number| mesh.corners(number).map(|c| c.map(|c| c.to_array()));
    if again.kept() != mesh.kept() {
        return Err("other triangles are kept when it is read again".to_owned());
    }
    for &number in mesh.kept() {
        if corners(mesh, number) != corners(again, number) {
            let (a, b) = (corners(mesh, number), corners(again, number));
            return Err(format!("triangle {number} was {a:?} and is {b:?}"));
        }
    }
    Ok(())
}

/// The formats that the program writes and reads.
const WRITTEN: [(&str, MeshFormat); 6] = [
    ("again.obj", MeshFormat::Obj),
    ("again.ply", MeshFormat::Ply { ascii: false }),
    ("again.ply", MeshFormat::Ply { ascii: true }),
    ("again.stl", MeshFormat::Stl { ascii: false }),
    ("again.stl", MeshFormat::Stl { ascii: true }),
    ("again.txt", MeshFormat::TriangleText),
];

/// Whether a mesh that the program writes reads again with the same triangles kept, each with the same
/// corners, in every format whose numbers hold them.
///
/// # Errors
/// The format, and in what it differs.
pub fn converts(mesh: &Mesh) -> Result<(), String> {
    let scene = Scene::from(mesh.clone());
    for (name, format) in WRITTEN {
        let place = |fault| format!("as {format:?} {fault}");
        let mut bytes = Vec::new();
        let written = write_meshes(&scene, format, None, &mut bytes);
        let written = written.map_err(|error| place(format!("not written: {error}")))?;
        let again =
            read_mesh(name, &bytes)?.map_err(|error| place(format!("not again: {error}")))?;
        if written.moved == 0 {
            has_same_triangles(mesh, only_mesh(&again)).map_err(place)?;
        }
    }
    Ok(())
}

/// What must hold of a mesh file of this name; `is_text` says of which bytes the lines may end
/// otherwise.
///
/// # Errors
/// What does not.
pub fn check(name: &str, bytes: &[u8], is_text: fn(&[u8]) -> bool) -> Result<(), String> {
    let reading = read_mesh(name, bytes)?;
    if let Some(windows) = with_windows_lines(bytes)
        && is_text(bytes)
        && !bytes.contains(&b'\r')
    {
        // Messages tell bytes, which are others.
        match (&reading, &read_mesh(name, &windows)?) {
            (Ok(a), Ok(b)) => meshes_are_equal(only_mesh(a), only_mesh(b))
                .map_err(|difference| format!("with Windows' lines {difference}"))?,
            (Err(_), Err(_)) => {}
            (_, other) => return Err(format!("with Windows' lines {other:?}")),
        }
    }
    let Ok(file) = reading else {
        return Ok(());
    };
    let mesh = only_mesh(&file);
    is_sound(mesh)?;
    converts(mesh)?;
    is_seen_soundly(&file)
}

/// A mesh as an OBJ file, three vertices a triangle.
pub fn as_obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    for number in 0..mesh.triangles().len() as u32 {
        for [x, y, z] in corners_in_file(mesh, number) {
            // Writing to a string does not fail.
            let _ = writeln!(text, "v {x:?} {y:?} {z:?}");
        }
        text.push_str("f -3 -2 -1\n");
    }
    text
}

/// A mesh as triangle text.
pub fn as_triangle_text(mesh: &Mesh) -> String {
    let mut text = String::new();
    for number in 0..mesh.triangles().len() as u32 {
        let vertices =
            corners_in_file(mesh, number).map(|[x, y, z]| format!("({x:?},{y:?},{z:?})"));
        text.push_str(&vertices.join(";"));
        text.push('\n');
    }
    text
}

fn corners_in_file(mesh: &Mesh, number: u32) -> [[f64; 3]; 3] {
    let corners = mesh.corners(number).unwrap_or_default();
    corners.map(|corner| (mesh.offset() + corner.as_dvec3()).to_array())
}

/// The mesh of a scene of one object.
///
/// # Panics
/// A scene without objects.
pub fn only_mesh(file: &SceneFile) -> &Mesh {
    &file.scene.objects.first().expect("one object").mesh
}

#[cfg(test)]
mod tests {
    use super::super::reading::MESH;
    use super::*;

    fn reading(text: &str) -> Reading {
        read_mesh("a.obj", text.as_bytes()).expect("fit messages")
    }

    #[test]
    fn differences_are_found() {
        let good = reading(MESH);
        assert_eq!(are_equal(&good, &reading(MESH)), Ok(()));
        for (from, to) in [
            ("v 1 -1 0", "v 1 -1 -0"),
            ("vt 0 1", "vt 0 0.5"),
            ("vn 0 0 1", "vn 0 1 0"),
            ("usemtl b", "usemtl c"),
            ("f 1/1/1 3/3/2 4/4/1", "f 1/1/1 4/4/1 3/3/2"),
            ("f 1/1/1 3/3/2 4/4/1", "f 1/1/1 9/3/2 4/4/1"),
        ] {
            let other = reading(&MESH.replace(from, to));
            assert!(are_equal(&good, &other).is_err(), "{from} as {to}");
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let file =
            reading("v 1e7 0 0\nv 1e7 0.1 0\nv 1e7 0 nan\nv 10000001 0 0\nf 1 2 3\nf 1 2 4\n");
        let mesh = only_mesh(file.as_ref().expect("a good mesh"));
        assert_eq!(mesh.kept(), [1]);
        assert_eq!(is_sound(mesh), Ok(()));
        assert_eq!(reads_again(mesh, "b.obj", as_obj), Ok(()));
        assert_eq!(reads_again(mesh, "b.txt", as_triangle_text), Ok(()));
        assert!(reads_again(mesh, "b.obj", |mesh| as_obj(mesh).replace("0.1", "0.2")).is_err());
        assert!(reads_again(mesh, "b.obj", |mesh| as_obj(mesh) + "f 1 2 3\n").is_err());
    }
}
