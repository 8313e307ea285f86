//! An OBJ file made ready for `tobj`, which knows no line numbers, takes polylines for faces, stops
//! at comments behind numbers, and may panic on absurd indices.

use super::error::{FormatError, quote};
use super::kind::without_mark;
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

/// No material.
pub(super) const NO_MATERIAL: u32 = u32::MAX;

/// What an `f` line makes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// How many triangles its fan has.
    pub(super) triangles: u32,
    /// Index of its material's name, or [`NO_MATERIAL`].
    pub(super) material: u32,
    /// Whether every corner has texture coordinates.
    pub(super) has_uvs: bool,
    /// Whether every corner has a normal.
    pub(super) has_normals: bool,
}

/// The lines that `tobj` gets, and what it is not asked about.
#[derive(Debug, Default)]
pub(super) struct ObjText {
    /// Vertices, texture coordinates, normals and faces, checked; every other line is empty, so
    /// that line numbers are the file's.
    pub(super) text: String,
    /// The faces, in the file's order.
    pub(super) faces: Vec<Face>,
    /// What stands behind `mtllib`, line by line.
    pub(super) libraries: Vec<String>,
    /// The names behind `usemtl`, each once.
    pub(super) materials: Vec<String>,
    /// How many `v` lines there are.
    pub(super) vertices: usize,
    /// The line of the last face, where the file ends in it with no newline behind.
    pub(super) open_end: Option<usize>,
    /// Faces whose texture coordinates or normals the file does not have at all.
    pub(super) dangling: usize,
}

/// Vertices, texture coordinates and normals: how many, or which.
type Counts = [i64; 3];

/// Reads the lines of an OBJ file.
///
/// # Errors
/// The first bad line: one with too few words, a face with fewer than three corners, an index that the whole file
/// has nothing for.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    progress: &dyn Fn(f32),
) -> Result<ObjText, FormatError> {
    let bytes = without_mark(bytes);
    let mut reader = Reader {
        path,
        out: ObjText::default(),
        seen: [0; 3],
        highest: [0; 3],
        totals: None,
        checks_numbers: false,
        material: NO_MATERIAL,
        material_numbers: HashMap::new(),
    };
    reader.out.text.reserve(bytes.len());
    let fault = reader.lines(bytes, progress).err();
    let totals = reader.seen;
    reader.out.dangling = reader.forgive_dangling(totals);
    let is_short = (0..3).any(|kind| totals[kind] > 0 && reader.highest[kind] > totals[kind])
        || reader.highest[0] > totals[0];
    // Which line was the first bad one is worth a second reading only when it is known that there is
    // one.
    if fault.is_some() || is_short {
        reader.totals = fault.is_none().then_some(totals);
        reader.checks_numbers = true;
        reader.seen = [0; 3];
        reader.out = ObjText::default();
        reader.material_numbers.clear();
        reader.lines(bytes, &|_| ())?;
    }
    if let Some(fault) = fault {
        return Err(fault);
    }
    reader.out.vertices = totals[0] as usize;
    Ok(reader.out)
}

struct Reader<'a> {
    path: &'a Path,
    out: ObjText,
    /// How many of each there are so far.
    seen: Counts,
    /// The highest index of each that a face has asked for.
    highest: Counts,
    /// How many of each the file has, once that is known.
    totals: Option<Counts>,
    /// Whether what should be numbers is held against that here, before `tobj` does it.
    checks_numbers: bool,
    material: u32,
    material_numbers: HashMap<String, u32>,
}

impl Reader<'_> {
    fn lines(&mut self, bytes: &[u8], progress: &dyn Fn(f32)) -> Result<(), FormatError> {
        let mut joined = String::new();
        let mut continued = 0;
        let mut done = 0;
        let newline = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
        for (index, line) in bytes.split(|&b| b == newline).enumerate() {
            done += line.len() + 1;
            if index % 16_384 == 0 {
                progress(done as f32 / bytes.len().max(1) as f32);
            }
            let text = String::from_utf8_lossy(line);
            let is_comment = joined.is_empty() && text.trim_start().starts_with('#');
            if let Some(start) = text.trim_end().strip_suffix('\\')
                && !is_comment
                && done < bytes.len()
            {
                joined.push_str(start);
                joined.push(' ');
                continued += 1;
                continue;
            }
            let text = if joined.is_empty() {
                text
            } else {
                joined.push_str(&text);
                Cow::Owned(std::mem::take(&mut joined))
            };
            let is_cut = done > bytes.len();
            self.line(&text, index + 1 - continued, is_cut)?;
            // As many lines out as came in.
            self.out
                .text
                .extend(std::iter::repeat_n('\n', continued + 1));
            continued = 0;
        }
        Ok(())
    }

    /// `is_cut`: the file ends in the line, with no newline behind it.
    fn line(&mut self, line: &str, number: usize, is_cut: bool) -> Result<(), FormatError> {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        // Names may hold a `#`; numbers do not.
        let values = || {
            rest.split('#')
                .next()
                .unwrap_or_default()
                .split_whitespace()
        };
        let is_number = |value: &str| value.parse::<f64>().is_ok();
        let least = |count: usize, expected: &str| {
            let are_numbers = || !self.checks_numbers || values().take(count).all(is_number);
            if values().count() < count || !are_numbers() {
                return Err(FormatError::unexpected(
                    self.path,
                    Some(number),
                    expected,
                    quote(line),
                ));
            }
            Ok(())
        };
        match keyword {
            "v" => {
                least(3, "three numbers behind `v`")?;
                self.seen[0] += 1;
                // Behind six are colours, which a mesh does not keep.
                let count = values().count();
                self.push("v", values().take(if count >= 6 { 3 } else { count }));
            }
            "vt" => {
                least(1, "one or more numbers behind `vt`")?;
                self.seen[1] += 1;
                self.push("vt", values().chain(["0"]).take(2));
            }
            "vn" => {
                least(3, "three numbers behind `vn`")?;
                self.seen[2] += 1;
                self.push("vn", values().take(3));
            }
            "f" => {
                let face = self.face(values(), line, number, is_cut)?;
                self.out.faces.push(face);
                self.out.open_end = is_cut.then_some(number);
                self.push("f", values());
            }
            "mtllib" => self.out.libraries.push(rest.trim().to_owned()),
            "usemtl" => self.material = self.material_number(rest.trim()),
            _ => {}
        }
        Ok(())
    }

    fn push<'t>(&mut self, keyword: &str, values: impl Iterator<Item = &'t str>) {
        self.out.text.push_str(keyword);
        for value in values {
            self.out.text.push(' ');
            self.out.text.push_str(value);
        }
    }

    fn material_number(&mut self, name: &str) -> u32 {
        if let Some(&number) = self.material_numbers.get(name) {
            return number;
        }
        let number = self.material_numbers.len() as u32;
        self.material_numbers.insert(name.to_owned(), number);
        self.out.materials.push(name.to_owned());
        number
    }

    fn face<'t>(
        &mut self,
        corners: impl Iterator<Item = &'t str>,
        line: &str,
        number: usize,
        is_cut: bool,
    ) -> Result<Face, FormatError> {
        let fault = |expected: String, found: String| {
            Err(FormatError::unexpected(
                self.path,
                Some(number),
                expected,
                found,
            ))
        };
        let mut count = 0;
        let mut with = [0; 3];
        for corner in corners {
            count += 1;
            let mut parts = corner.split('/');
            for kind in 0..3 {
                let part = parts.next().unwrap_or_default();
                if part.is_empty() && kind > 0 {
                    continue;
                }
                let Ok(index) = part.parse::<i64>() else {
                    return fault(
                        "a corner as `v`, `v/vt`, `v//vn` or `v/vt/vn`".into(),
                        quote(corner),
                    );
                };
                let name = ["vertex", "texture coordinate", "normal"][kind];
                let total = self.totals.map_or(i64::MAX, |totals| match totals[kind] {
                    0 if kind > 0 => i64::MAX,
                    total => total,
                });
                let so_far = self.seen[kind];
                let exists = match index {
                    0 => false,
                    // Relative to the end of what stands above.
                    ..0 => index >= -so_far || (kind > 0 && so_far == 0),
                    _ => index <= total,
                };
                if !exists {
                    let has = self.totals.map_or(so_far, |totals| totals[kind]);
                    let expected = match index {
                        ..0 => format!("a {name} index down to -{so_far}"),
                        _ if self.totals.is_none() => format!("a {name} index from 1"),
                        _ if has == 0 => "vertices in the file (lines of `v x y z`)".into(),
                        _ => format!("a {name} index from 1 to {has}, as the file has"),
                    };
                    return fault(expected, index.to_string());
                }
                self.highest[kind] = self.highest[kind].max(index);
                with[kind] += 1;
            }
            if parts.next().is_some() {
                return fault("a corner of at most three indices".into(), quote(corner));
            }
        }
        if count < 3 {
            return fault("three or more corners behind `f`".into(), quote(line));
        }
        let mixed = with.iter().any(|&corners| corners % count != 0);
        if is_cut && mixed {
            return fault(
                "corners all of one form (the file ends within a face)".into(),
                quote(line),
            );
        }
        Ok(Face {
            triangles: count - 2,
            material: self.material,
            has_uvs: with[1] == count,
            has_normals: with[2] == count,
        })
    }

    /// Faces that ask for texture coordinates or normals in a file that has none do without them;
    /// returns how many there are.
    fn forgive_dangling(&mut self, totals: Counts) -> usize {
        let mut forgiven = 0;
        for face in &mut self.out.faces {
            let uvs = face.has_uvs && totals[1] == 0;
            let normals = face.has_normals && totals[2] == 0;
            face.has_uvs &= !uvs;
            face.has_normals &= !normals;
            forgiven += usize::from(uvs || normals);
        }
        forgiven
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(source: &str) -> Result<ObjText, String> {
        read(Path::new("a.obj"), source.as_bytes(), &|_| ()).map_err(|error| error.to_string())
    }

    #[test]
    fn keeps_line_numbers() {
        let source = "# c:\\\no x\nv 0 0 0 # here\nv 1 0 0 0.5 0.5 0.5\r\nl 1 2 3\n\
            vt 0.5\nv 0 1 0\nf 1 \\\n2 \\\n3 # there\nv 2 2 2";
        let out = text(source).expect("a good file");
        assert_eq!(
            out.text,
            "\n\nv 0 0 0\nv 1 0 0\n\nvt 0.5 0\nv 0 1 0\nf 1 2 3\n\n\nv 2 2 2\n"
        );
        assert_eq!(out.faces.len(), 1);
    }

    #[test]
    fn the_first_bad_line_is_named() {
        for (source, line, expected) in [
            ("v 0 0 0\nv 1 x 3\nf 1 2 3\n", 2, "three numbers behind `v`"),
            (
                "v 0 0 0\nv 1 x 3\nv 0 1 0\nf -1 -2 -4\n",
                2,
                "three numbers behind `v`",
            ),
            (
                "v 0 0 0\nvn 0 ? 1\nf 1 2 3\n",
                2,
                "three numbers behind `vn`",
            ),
            (
                "v 0 0 0\nvt up\nv 1\n",
                2,
                "one or more numbers behind `vt`",
            ),
            (
                "v 0 0 0\nf 1 2 3\nv 1 x 3\n",
                2,
                "a vertex index from 1 to 2",
            ),
            (
                "v nan inf 1e9\nv 1 1 1\nf 1 2 3\n",
                3,
                "a vertex index from 1 to 2",
            ),
        ] {
            let told = text(source).expect_err(source);
            let place = format!("a.obj:{line}: expected {expected}");
            assert!(told.starts_with(&place), "{source:?}: {told}");
        }
    }

    #[test]
    fn old_macintosh_lines() {
        let out = text("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r").expect("a good file");
        assert_eq!(out.text, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n\n");
    }
}
