use super::Progress;
use super::error::{FormatError, quote};
use super::files::{Files, beside};
use super::mtl::{self, MtlMaterial};
use super::obj_text::{self, Face, ObjText};
use crate::scene::{Attribute, MeshData};
use glam::{DVec3, Vec2, Vec3};
use std::collections::HashMap;
use std::io::{self, BufRead, Read};
use std::path::{Path, PathBuf};
use tobj::LoadError;

/// What an OBJ file holds.
#[derive(Debug)]
pub(super) struct Obj {
    pub(super) mesh: MeshData,
    /// The one image that the materials of all its faces name.
    pub(super) texture: Option<PathBuf>,
    /// What was not as it should be, and did not matter enough to stop.
    pub(super) warnings: Vec<String>,
}

/// Reads an OBJ file, and through `files` its material libraries.
///
/// Triangles are in the file's order of faces, polygons cut into fans; groups and materials do not
/// change that. Positions keep their own indices.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    files: &dyn Files,
    progress: Progress<'_>,
) -> Result<Obj, FormatError> {
    let obj_text = obj_text::read(path, bytes, &|share| progress(share * 0.4))?;
    let mut lines = Lines {
        rest: obj_text.text.as_bytes(),
        length: obj_text.text.len(),
        line: 0,
        progress: &|share| progress(0.4 + share * 0.5),
    };
    let options = tobj::LoadOptions {
        triangulate: true,
        single_index: false,
        ignore_points: true,
        ignore_lines: true,
    };
    // The text names no library: materials are this module's own affair.
    let no_library = |_: &Path| Err(LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut lines, &options, no_library)
        .map_err(|error| line_error(path, &obj_text.text, lines.line, error))?;
    if obj_text.faces.is_empty() {
        return Err(FormatError::unexpected(
            path,
            None,
            "faces (lines of `f v v v`)",
            "none",
        ));
    }

    let mut mesh = MeshData::default();
    for model in models {
        let raw = model.mesh;
        let shift = mesh.positions.len() as u32;
        mesh.positions
            .extend(raw.positions.chunks_exact(3).map(DVec3::from_slice));
        mesh.triangles
            .extend(triples(&raw.indices).map(|triangle| triangle.map(|i| i + shift)));
        let single = |value: f64| value as f32;
        let uvs = raw.texcoords.chunks_exact(2);
        let uvs = uvs.map(|uv| Vec2::new(single(uv[0]), single(uv[1])));
        mesh.uvs = attribute(
            uvs.collect(),
            &raw.texcoord_indices,
            &obj_text.faces,
            |face| face.has_uvs,
            |uv| uv.is_finite(),
        );
        let normals = raw.normals.chunks_exact(3);
        let normals = normals.map(|n| DVec3::from_slice(n).normalize_or_zero().as_vec3());
        mesh.normals = attribute(
            normals.collect(),
            &raw.normal_indices,
            &obj_text.faces,
            |face| face.has_normals,
            |normal| *normal != Vec3::ZERO,
        );
    }
    let expected: usize = obj_text
        .faces
        .iter()
        .map(|face| face.triangles as usize)
        .sum();
    if mesh.triangles.len() != expected || expected > u32::MAX as usize {
        return Err(FormatError::unexpected(
            path,
            None,
            format!("{expected} triangles, at most {}", u32::MAX),
            mesh.triangles.len().to_string(),
        ));
    }
    let mut warnings = Vec::new();
    warnings.extend(loose_vertices(path, &obj_text, mesh.positions.len())?);
    if obj_text.dangling > 0 {
        warnings.push(format!(
            "{}: {} faces name texture coordinates or normals that the file does not have",
            path.display(),
            obj_text.dangling
        ));
    }
    let texture = add_materials(path, &obj_text, files, &mut mesh, &mut warnings);
    progress(1.0);
    Ok(Obj {
        mesh,
        texture,
        warnings,
    })
}

/// A warning where many vertices are in no face (`used` are): the file may have lost its end.
///
/// # Errors
/// The same where the file ends in a face with no newline behind it too: then it has.
fn loose_vertices(
    path: &Path,
    obj_text: &ObjText,
    used: usize,
) -> Result<Option<String>, FormatError> {
    // Whole files have loose vertices too, the Stanford bunny 3 in 100; but hardly 5.
    const FEWEST: usize = 16;
    let loose = obj_text.vertices.saturating_sub(used);
    if loose < FEWEST || loose * 20 < obj_text.vertices {
        return Ok(None);
    }
    let what = format!("{loose} of {} vertices are in no face", obj_text.vertices);
    if obj_text.open_end.is_some() {
        let found = format!("the file's end, and {what}: it is cut short");
        let expected = "a newline behind the last face";
        return Err(FormatError::unexpected(
            path,
            obj_text.open_end,
            expected,
            found,
        ));
    }
    Ok(Some(format!(
        "{}: {what}: is it cut short?",
        path.display()
    )))
}

/// Gives every triangle its material; the image that all of them name.
fn add_materials(
    path: &Path,
    obj_text: &ObjText,
    files: &dyn Files,
    mesh: &mut MeshData,
    warnings: &mut Vec<String>,
) -> Option<PathBuf> {
    let mut materials: Vec<(MtlMaterial, PathBuf)> = Vec::new();
    for (library, bytes) in libraries(path, &obj_text.libraries, files, warnings) {
        let read = mtl::read(&library, &bytes, warnings);
        materials.extend(read.into_iter().map(|material| (material, library.clone())));
    }
    // Of materials with one name the last one counts.
    let number_of: HashMap<&str, u32> = materials
        .iter()
        .zip(0..)
        .map(|((material, _), number)| (material.material.name.as_str(), number))
        .collect();
    let numbers: Vec<Option<u32>> = obj_text
        .materials
        .iter()
        .map(|name| number_of.get(name.as_str()).copied())
        .collect();
    let number_of_face = |face: &Face| *numbers.get(face.material as usize)?;
    if !materials.is_empty() {
        let unknown = numbers.iter().filter(|number| number.is_none()).count();
        if unknown > 0 {
            warnings.push(format!(
                "{}: {unknown} materials are in none of its libraries",
                path.display()
            ));
        }
        mesh.material_of_triangle = obj_text
            .faces
            .iter()
            .flat_map(|face| {
                let number = number_of_face(face).unwrap_or(u32::MAX);
                std::iter::repeat_n(number, face.triangles as usize)
            })
            .collect();
    }
    let image_of_face = |face: &Face| {
        let (material, library) = materials.get(number_of_face(face)? as usize)?;
        Some(beside(library, material.texture.as_deref()?))
    };
    // Faces of one material follow one another mostly: look at each material once.
    let mut used: Vec<&Face> = obj_text.faces.iter().collect();
    used.dedup_by_key(|face| face.material);
    let mut images = used.into_iter().map(image_of_face);
    let first = images.next().flatten();
    let texture = first.filter(|first| images.all(|image| image.as_ref() == Some(first)));
    mesh.materials = materials
        .into_iter()
        .map(|(material, _)| material.material)
        .collect();
    texture
}

/// The bytes of the libraries behind `mtllib`: each line is one name, which may hold spaces, or
/// several.
fn libraries(
    path: &Path,
    lines: &[String],
    files: &dyn Files,
    warnings: &mut Vec<String>,
) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found: Vec<(PathBuf, Vec<u8>)> = Vec::new();
    let mut add = |name: &str| -> io::Result<()> {
        let library = beside(path, name);
        if found.iter().all(|(known, _)| *known != library) {
            let bytes = files.read(&library, &|_| ())?;
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
            warnings.push(format!(
                "{}: its materials in {} cannot be read: {error}",
                path.display(),
                quote(name)
            ));
        }
    }
    found
}

/// Values at corners. A triangle of a face that has none, or with a value that is not good, has
/// no indices; `None` where that is every triangle.
fn attribute<T>(
    values: Vec<T>,
    indices: &[u32],
    faces: &[Face],
    has: impl Fn(&Face) -> bool,
    is_good: impl Fn(&T) -> bool,
) -> Option<Attribute<T>> {
    let whole = faces
        .iter()
        .flat_map(|face| std::iter::repeat_n(has(face), face.triangles as usize));
    let mut any = false;
    let indices = triples(indices)
        .zip(whole)
        .map(|(triangle, whole)| {
            let good = whole
                && triangle
                    .iter()
                    .all(|&i| values.get(i as usize).is_some_and(&is_good));
            any |= good;
            if good { triangle } else { [u32::MAX; 3] }
        })
        .collect();
    any.then_some(Attribute {
        values,
        indices: Some(indices),
    })
}

fn triples(indices: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]])
}

/// What `tobj` did not like, with the line at which it stopped.
fn line_error(path: &Path, text: &str, line: usize, error: LoadError) -> FormatError {
    let expected = match error {
        LoadError::PositionParseError => "three numbers behind `v`",
        LoadError::ScalingByZeroError => "a weight other than zero behind a vertex",
        LoadError::ColorParseError => "three numbers, a weight or three of a colour behind `v`",
        LoadError::TexcoordParseError => "numbers behind `vt`",
        LoadError::NormalParseError => "three numbers behind `vn`",
        LoadError::FaceParseError => "corners as `v`, `v/vt`, `v//vn` or `v/vt/vn`",
        error => return FormatError::refused(path, None, &error.to_string()),
    };
    let found = text.lines().nth(line.saturating_sub(1)).unwrap_or_default();
    FormatError::unexpected(path, Some(line), expected, quote(found))
}

/// Text that hands out a line at a time and counts them.
struct Lines<'a> {
    rest: &'a [u8],
    length: usize,
    /// Lines handed out.
    line: usize,
    progress: &'a dyn Fn(f32),
}

impl Read for Lines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        let newline = self.rest.iter().position(|&b| b == b'\n');
        Ok(&self.rest[..newline.map_or(self.rest.len(), |index| index + 1)])
    }

    fn consume(&mut self, count: usize) {
        let (taken, rest) = self.rest.split_at(count.min(self.rest.len()));
        self.rest = rest;
        self.line += usize::from(taken.ends_with(b"\n"));
        if self.line.is_multiple_of(16_384) {
            (self.progress)(1.0 - rest.len() as f32 / self.length.max(1) as f32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::files::Held;
    use super::*;
    use crate::scene::Color;

    const LIBRARY: &str =
        "newmtl red\nKd 1 0 0\nmap_Kd skin.png\nnewmtl blue\nKd 0 0 1\nmap_Kd skin.png\n";

    fn parse_bytes(bytes: &[u8]) -> Result<Obj, FormatError> {
        let files = Held::new(&|name| (name == "parts/a.mtl").then(|| LIBRARY.into()));
        read(Path::new("parts/a.obj"), bytes, &files, &|_| ())
    }

    fn parse(text: &str) -> Obj {
        parse_bytes(text.as_bytes()).expect("a good file")
    }

    fn error(text: &str) -> String {
        let message = parse_bytes(text.as_bytes())
            .expect_err("a bad file")
            .to_string();
        assert_eq!(message.lines().count(), 1, "{message}");
        message.replace("parts/", "")
    }

    #[test]
    fn triangles_are_in_the_order_of_faces() {
        let obj = parse(
            "mtllib a.mtl\no one\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n\
             usemtl blue\nf 1 2 3 4 5\no two\nusemtl red\nf -1 -2 -3\nusemtl blue\nf 1 2 3 4\n",
        );
        let corners: Vec<_> = (obj.mesh.triangles.iter())
            .map(|t| t.map(|i| obj.mesh.positions[i as usize].to_array()))
            .collect();
        let [a, b, c, d, e] = [
            [0., 0., 0.],
            [1., 0., 0.],
            [1., 1., 0.],
            [0., 1., 0.],
            [0., 0., 1.],
        ];
        assert_eq!(
            corners,
            [
                [a, b, c],
                [a, c, d],
                [a, d, e],
                [e, d, c],
                [a, b, c],
                [a, c, d]
            ]
        );
        assert_eq!(obj.mesh.positions.len(), 5);
        assert_eq!(obj.mesh.material_of_triangle, [1, 1, 1, 0, 1, 1]);
        assert_eq!(obj.mesh.materials[1].color, Color([0, 0, 255]));
        assert_eq!(obj.texture.as_deref(), Some(Path::new("parts/skin.png")));
        assert!(obj.warnings.is_empty(), "{:?}", obj.warnings);
    }

    #[test]
    fn attributes_have_indices_of_their_own() {
        let obj = parse(
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0.25 1\nvt nan 0\nvn 0 0 2\nvn 0 0 0\n\
             f 1 2 3\nf 1/3/1 2/2/1 3/1/1\nf 1/1/1 2/4/2 3/1/1\nf 1//1 2//1 3//1\n",
        );
        let uvs = obj.mesh.uvs.expect("texture coordinates");
        let normals = obj.mesh.normals.expect("normals");
        let shared = [7; 3];
        assert_eq!(uvs.corners(0, shared), None);
        assert_eq!(
            uvs.corners(1, shared),
            Some([Vec2::new(0.25, 1.0), Vec2::new(1.0, 0.0), Vec2::ZERO])
        );
        assert_eq!(uvs.corners(2, shared), None, "one is not a number");
        assert_eq!(normals.corners(0, shared), None);
        assert_eq!(normals.corners(1, shared), Some([Vec3::Z; 3]));
        assert_eq!(normals.corners(2, shared), None, "one has no direction");
        assert_eq!(normals.corners(3, shared), Some([Vec3::Z; 3]));
    }

    #[test]
    fn reads_double_precision_and_odd_bytes() {
        let obj = parse_bytes(
            b"\xef\xbb\xbf# caf\xe9\r\ng t\xeate\r\nv 0.1 1e7 -3 1.0\nv 1 0 0 9 9 9\nv 0 1 0\nf 1// 2// 3//",
        )
        .expect("a good file");
        assert_eq!(obj.mesh.positions[0], DVec3::new(0.1, 1e7, -3.0));
        assert_eq!(obj.mesh.triangles, [[0, 1, 2]]);
    }

    #[test]
    fn goes_without_what_is_missing() {
        let obj =
            parse("mtllib no.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1 2/2/2 3/3/3\n");
        assert!(obj.mesh.materials.is_empty() && obj.mesh.uvs.is_none());
        assert_eq!(obj.warnings.len(), 2, "{:?}", obj.warnings);
        assert!(obj.warnings[1].contains("\"no.mtl\""), "{:?}", obj.warnings);
    }

    #[test]
    fn says_where_and_what() {
        let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        let check = |tail: &str, expected: &str| {
            assert_eq!(error(&format!("{vertices}{tail}")), expected);
        };
        check("", "a.obj: expected faces (lines of `f v v v`), found none");
        check(
            "f 1 2 3\n\nf 1 2 4\nf 1 2 9\n",
            "a.obj:6: expected a vertex index from 1 to 3, as the file has, found 4",
        );
        check(
            "f 1 2 0\n",
            "a.obj:4: expected a vertex index from 1, found 0",
        );
        check(
            "f 1 2 -4\n",
            "a.obj:4: expected a vertex index down to -3, found -4",
        );
        check(
            "vt 0 0\nf 1/1 2/1 3/2\n",
            "a.obj:5: expected a texture coordinate index from 1 to 1, as the file has, found 2",
        );
        check(
            "f 1 2",
            "a.obj:4: expected three or more corners behind `f`, found \"f 1 2\"",
        );
        check(
            "f 1 2 3\nv 1 2\n",
            "a.obj:5: expected three numbers behind `v`, found \"v 1 2\"",
        );
        check(
            "f 1 2 3\nv 1 2 x\n",
            "a.obj:5: expected three numbers behind `v`, found \"v 1 2 x\"",
        );
        check(
            "f 1 2 3\nv 1 2 3 0\n",
            "a.obj:5: expected a weight other than zero behind a vertex, found \"v 1 2 3 0\"",
        );
        check(
            "f 1 2 3x\n",
            "a.obj:4: expected a corner as `v`, `v/vt`, `v//vn` or `v/vt/vn`, found \"3x\"",
        );
        check(
            "f 1/1/1/1 2 3\n",
            "a.obj:4: expected a corner of at most three indices, found \"1/1/1/1\"",
        );
        assert_eq!(
            error("f 1 2 3\n"),
            "a.obj:1: expected vertices in the file (lines of `v x y z`), found 1"
        );
    }

    #[test]
    fn a_cut_file_is_an_error_or_whole_faces() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 3//1 2//1 1//1";
        // Where the cut may not show: a face is whole, or ends in another number that is one too.
        for end in 0..text.len() {
            match parse_bytes(&text.as_bytes()[..end]) {
                Ok(obj) => {
                    let faces = text[..end].matches('f').count();
                    let last = text[..end].rsplit('\n').next().unwrap_or_default();
                    let whole = last.is_empty() || last.split_whitespace().count() == 4;
                    assert!(whole, "{last:?}");
                    assert_eq!(obj.mesh.triangles.len(), faces);
                }
                Err(error) => assert_eq!(error.to_string().lines().count(), 1),
            }
        }
    }

    #[test]
    fn a_file_that_lost_faces_is_not_read_in_silence() {
        let mut text: String = (0..100).map(|i| format!("v {i} 0 {}\n", i * i)).collect();
        for i in 1..=98 {
            text.push_str(&format!("f {i} {} {}\n", i + 1, i + 2));
        }
        assert!(parse(&text).warnings.is_empty());
        assert!(parse(text.trim_end()).warnings.is_empty());
        let at_line_end = &text[..text.find("f 60 ").expect("a face")];
        assert_eq!(
            parse(at_line_end).warnings,
            ["parts/a.obj: 39 of 100 vertices are in no face: is it cut short?"]
        );
        assert_eq!(
            error(at_line_end.trim_end()),
            "a.obj:159: expected a newline behind the last face, found the file's end, and 39 of \
             100 vertices are in no face: it is cut short"
        );
    }

    /// No input may bring a panic, here or in `tobj`, or an index that the mesh does not have.
    #[test]
    fn damaged_files_never_panic() {
        let good = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0 1\nv 0 1 0 1 0 0\nvt 0 0\nvt 1 0\nvn 0 0 1\n\
            usemtl red\nf 1/1/1 2/2/1 3/1/1\nusemtl blue\nf -3//-1 -2//1 -1//1 1//1\nl 1 2 3\n\
            g a\no b\nf 1/2 2/1 \\\n3/1\n";
        let pieces: [&[u8]; 16] = [
            b"9223372036854775807",
            b"-9223372036854775808",
            b"4611686018427387905",
            b"18446744073709551615",
            b"/",
            b"//",
            b"-",
            b"0",
            b"\n",
            b"\\",
            b" ",
            b"nan",
            b"1e999",
            b"\xff",
            b"\xc2\xa0",
            b"f ",
        ];
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        let mut random = |below: usize| {
            // Xorshift (Marsaglia, "Xorshift RNGs", 2003).
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 33) as usize % below
        };
        let mut read_well = 0;
        for _ in 0..20_000 {
            let mut bytes = good.to_vec();
            for _ in 0..1 + random(4) {
                let start = random(bytes.len() + 1);
                let end = (start + random(4)).min(bytes.len());
                let piece = pieces[random(pieces.len())];
                bytes.splice(start..end, piece.iter().copied());
            }
            if let Ok(obj) = parse_bytes(&bytes) {
                read_well += 1;
                let count = obj.mesh.positions.len() as u32;
                assert!(obj.mesh.triangles.iter().flatten().all(|&i| i < count));
            }
        }
        assert!((1000..19_000).contains(&read_well), "{read_well}");
    }
}
