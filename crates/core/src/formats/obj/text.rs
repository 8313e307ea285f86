//! The lines of an OBJ file, read one after the other into what a mesh is made of.

use crate::formats::error::{FormatError, quote};
use crate::formats::limits::{Budget, Share};
use crate::formats::lines::{Line, Lines, text};
use crate::formats::polygon::Polygon;
use crate::scene::Color;
use glam::{DVec3, Vec2, Vec3};
use std::borrow::Cow;
use std::collections::HashMap;
use std::mem::size_of;
use std::path::Path;

/// No index: a corner without texture coordinates or normal.
pub(super) const NONE: u32 = u32::MAX;

/// What the lines of an OBJ file say, checked.
#[derive(Debug, Default)]
pub(super) struct ObjText {
    /// Every `v`, in the file's order.
    pub(super) positions: Vec<DVec3>,
    /// A colour a vertex, `None` where it has none; empty where none has.
    pub(super) colors: Vec<Option<Color>>,
    /// Every `vt`.
    pub(super) uvs: Vec<Vec2>,
    /// Every `vn`, of unit length; zero where it has no direction.
    pub(super) normals: Vec<Vec3>,
    /// The faces' triangles, in the file's order, as fans.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Texture coordinates at the corners of as many triangles, from the first on, as it takes to
    /// have all that are not [`NONE`]. Indices may be of none that is there.
    pub(super) uv_triangles: Vec<[u32; 3]>,
    /// Normals at corners, likewise.
    pub(super) normal_triangles: Vec<[u32; 3]>,
    /// The faces of more than three corners.
    pub(super) polygons: Vec<Polygon>,
    /// What stands behind `mtllib`, line by line.
    pub(super) libraries: Vec<String>,
    /// The names behind `usemtl`, each once.
    pub(super) materials: Vec<String>,
    /// From which triangle on there is another material, by index of its name; [`NONE`] for none.
    pub(super) material_runs: Vec<(u32, u32)>,
    /// The line of the last face, where the file ends in it with no line end behind.
    pub(super) open_end: Option<usize>,
    /// What is odd, and how often.
    pub(super) oddities: Oddities,
}

/// What is not as it should be and does not matter enough to stop, counted.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Oddities {
    /// Faces that name texture coordinates or normals of which the file has none at all.
    pub(super) dangling: usize,
    /// Vertices with a weight that is not 1.
    pub(super) weights: usize,
    /// Vertices with values behind the colour.
    pub(super) extra_values: usize,
    /// Vertices with a colour that is not from 0 to 1.
    pub(super) colors_out_of_range: usize,
}

/// Vertices, texture coordinates and normals: how many, or which.
type Counts = [i64; 3];

/// Reads the lines of an OBJ file.
///
/// # Errors
/// The first bad line: too few words or one that is no number, a face with fewer than three
/// corners, an index that the whole file has nothing for. More than the budget has left.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    budget: &Budget,
    progress: &dyn Fn(f32),
) -> Result<ObjText, FormatError> {
    let text = text(bytes);
    let copied = match &text {
        Cow::Borrowed(_) => 0,
        Cow::Owned(text) => text.capacity(),
    };
    let mut reader = Reader::new(path, budget, copied)?;
    let stopped = reader.lines(&text, progress).err();
    let totals = reader.totals();
    let is_short = (0..3).any(|kind| totals[kind] > 0 && reader.highest[kind] > totals[kind])
        || reader.highest[0] > totals[0];
    if stopped.is_none() && is_short {
        // That an index has nothing in the whole file is known at its end alone: which line was the
        // first with one, or with another fault, is worth a second reading.
        let mut again = Reader::new(path, budget, copied)?;
        again.known_totals = Some(totals);
        again.lines(&text, &|_| ())?;
    }
    if let Some(fault) = reader.first_fault.take().or(stopped) {
        return Err(fault);
    }
    reader.forgive_dangling();
    Ok(reader.out)
}

struct Reader<'a> {
    path: &'a Path,
    budget: &'a Budget,
    share: Share<'a>,
    /// Bytes of the text that are not the file's own.
    copied: usize,
    out: ObjText,
    /// The highest index of each that a face has asked for.
    highest: Counts,
    /// How many of each the file has, where that is known.
    known_totals: Option<Counts>,
    /// The first word that should be a number and is none. Reading goes on: an index above it may be
    /// of nothing, which the end tells.
    first_fault: Option<FormatError>,
    material: u32,
    material_numbers: HashMap<String, u32>,
    /// The corners of the face that is read: vertex, texture coordinates, normal.
    corners: Vec<[u32; 3]>,
    /// Faces that have texture coordinates alone, normals alone, both.
    faces_with: [usize; 3],
}

/// What a `v` line may hold, for messages.
const VERTEX: &str = "three numbers, a weight or three of a colour behind `v`";

impl<'a> Reader<'a> {
    fn new(path: &'a Path, budget: &'a Budget, copied: usize) -> Result<Self, FormatError> {
        Ok(Self {
            path,
            budget,
            share: budget.share(path, "the mesh", copied as u64)?,
            copied,
            out: ObjText::default(),
            highest: [0; 3],
            known_totals: None,
            first_fault: None,
            material: NONE,
            material_numbers: HashMap::new(),
            corners: Vec::new(),
            faces_with: [0; 3],
        })
    }

    fn lines(&mut self, text: &str, progress: &dyn Fn(f32)) -> Result<(), FormatError> {
        let mut lines = Lines::of(text);
        let mut joined = String::new();
        while let Some(line) = lines.next() {
            let is_joined = line.text.trim_end().ends_with('\\') && !line.is_cut;
            if !is_joined || line.text.trim_start().starts_with('#') {
                self.line(line)?;
            } else {
                // A backslash joins the next line to this one.
                joined.clear();
                let mut last = line;
                while let Some(start) = last.text.trim_end().strip_suffix('\\')
                    && !last.is_cut
                {
                    joined.push_str(start);
                    joined.push(' ');
                    match lines.next() {
                        Some(next) => last = next,
                        None => last.text = "",
                    }
                }
                joined.push_str(last.text);
                self.line(Line {
                    text: &joined,
                    number: line.number,
                    is_cut: last.is_cut,
                })?;
            }
            if line.number % 16_384 == 0 {
                self.count_bytes()?;
                progress(1.0 - lines.left() as f32 / text.len().max(1) as f32);
            }
        }
        self.count_bytes()
    }

    fn line(&mut self, line: Line<'_>) -> Result<(), FormatError> {
        let text = line.text.trim();
        let (keyword, rest) = match text.find(char::is_whitespace) {
            Some(end) => (&text[..end], &text[end..]),
            None => (text, ""),
        };
        // Names may hold a `#`; numbers do not.
        let values = || {
            let end = memchr::memchr(b'#', rest.as_bytes());
            Words::of(&rest[..end.unwrap_or(rest.len())])
        };
        match keyword {
            "v" => self.vertex(values(), &line)?,
            "vt" => {
                let mut values = values();
                let mut read = |is_needed: bool| match values.next() {
                    None if is_needed => None,
                    None => Some(0.0),
                    Some(word) => word.parse::<f64>().ok(),
                };
                let uv = read(true).zip(read(false));
                let uv = self.number(uv, "one or more numbers behind `vt`", &line)?;
                let (u, v) = uv.unwrap_or_default();
                self.out.uvs.push(Vec2::new(u as f32, v as f32));
            }
            "vn" => {
                let normal = three(&mut values());
                let normal = self.number(normal, "three numbers behind `vn`", &line)?;
                let normal = normal.unwrap_or_default().normalize_or_zero();
                self.out.normals.push(normal.as_vec3());
            }
            "f" => self.face(values(), &line)?,
            "mtllib" => self.out.libraries.push(rest.trim().to_owned()),
            "usemtl" => self.material = self.material_number(rest.trim()),
            _ => {}
        }
        Ok(())
    }

    /// Notes a line whose numbers are none as faulty; an error where it is known already that no
    /// other fault stands above it.
    fn number<T>(
        &mut self,
        value: Option<T>,
        expected: &str,
        line: &Line<'_>,
    ) -> Result<Option<T>, FormatError> {
        if value.is_none() && self.first_fault.is_none() {
            let fault = self.fault(line, expected, quote(line.text));
            if self.known_totals.is_some() {
                return Err(fault);
            }
            self.first_fault = Some(fault);
        }
        Ok(value)
    }

    #[cold]
    fn fault(&self, line: &Line<'_>, expected: &str, found: String) -> FormatError {
        FormatError::unexpected(self.path, Some(line.number), expected, found)
    }

    fn vertex(&mut self, mut values: Words<'_>, line: &Line<'_>) -> Result<(), FormatError> {
        let position = three(&mut values);
        let position = self.number(position, "three numbers behind `v`", line)?;
        self.out.positions.push(position.unwrap_or(DVec3::NAN));
        let mut more = [0.0; 3];
        let mut count = 0;
        for word in values {
            let value: Option<f64> = word.parse().ok();
            let value = self.number(value, VERTEX, line)?.unwrap_or_default();
            if let Some(place) = more.get_mut(count) {
                *place = value;
            }
            count += 1;
        }
        match count {
            0 => {}
            1 => self.out.oddities.weights += usize::from(more[0] != 1.0),
            2 => drop(self.number(None::<()>, VERTEX, line)?),
            _ => {
                self.out.oddities.extra_values += usize::from(count > 3);
                let is_color = more.iter().all(|value| (0.0..=1.0).contains(value));
                self.out.oddities.colors_out_of_range += usize::from(!is_color);
                let before = self.out.positions.len() - 1;
                self.out.colors.resize(before, None);
                let byte = |value: f64| (value * 255.0).round() as u8;
                let color = Color(more.map(byte));
                self.out.colors.push(Some(color));
            }
        }
        Ok(())
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

    /// How many of each there are so far.
    fn totals(&self) -> Counts {
        [
            self.out.positions.len() as i64,
            self.out.uvs.len() as i64,
            self.out.normals.len() as i64,
        ]
    }

    fn face(&mut self, words: Words<'_>, line: &Line<'_>) -> Result<(), FormatError> {
        self.corners.clear();
        let so_far = self.totals();
        let left = self.budget.triangles_left() - self.out.triangles.len() as u64;
        let mut with = [0; 3];
        for word in words {
            let mut parts = word.split('/');
            let mut corner = [NONE; 3];
            for kind in 0..3 {
                let part = parts.next().unwrap_or_default();
                if part.is_empty() && kind > 0 {
                    continue;
                }
                let Ok(index) = part.parse::<i64>() else {
                    let expected = "a corner as `v`, `v/vt`, `v//vn` or `v/vt/vn`";
                    return Err(self.fault(line, expected, quote(word)));
                };
                corner[kind] = self.index(kind, index, so_far[kind], line)?;
                with[kind] += 1;
            }
            if parts.next().is_some() {
                let expected = "a corner of at most three indices";
                return Err(self.fault(line, expected, quote(word)));
            }
            self.corners.push(corner);
            if self.corners.len() as u64 > left.saturating_add(2) {
                let more = self.budget.triangles_left() + 1;
                self.budget.add_triangles(self.path, more)?;
            }
        }
        let count = self.corners.len();
        if count < 3 {
            let expected = "three or more corners behind `f`";
            return Err(self.fault(line, expected, quote(line.text)));
        }
        if line.is_cut && with.iter().any(|&corners| corners % count != 0) {
            let expected = "corners all of one form (the file ends within a face)";
            return Err(self.fault(line, expected, quote(line.text)));
        }
        self.add_face([with[1] == count, with[2] == count]);
        self.out.open_end = line.is_cut.then_some(line.number);
        Ok(())
    }

    /// An index from 0; [`NONE`] for texture coordinates and normals of which there are none yet.
    fn index(
        &mut self,
        kind: usize,
        index: i64,
        so_far: i64,
        line: &Line<'_>,
    ) -> Result<u32, FormatError> {
        let total = self
            .known_totals
            .map_or(i64::MAX, |totals| match totals[kind] {
                0 if kind > 0 => i64::MAX,
                total => total,
            });
        let from_zero = match index {
            0 => None,
            // Relative to the end of what stands above.
            ..0 if index >= -so_far => Some(so_far + index),
            ..0 if kind > 0 && so_far == 0 => Some(i64::from(NONE)),
            _ => (1..=total).contains(&index).then(|| index - 1),
        };
        let Some(from_zero) = from_zero else {
            let name = ["vertex", "texture coordinate", "normal"][kind];
            let has = self.known_totals.map_or(so_far, |totals| totals[kind]);
            let expected = match index {
                ..0 => format!("a {name} index down to -{so_far}"),
                _ if self.known_totals.is_none() => format!("a {name} index from 1"),
                _ if has == 0 => "vertices in the file (lines of `v x y z`)".into(),
                _ => format!("a {name} index from 1 to {has}, as the file has"),
            };
            return Err(self.fault(line, &expected, index.to_string()));
        };
        self.highest[kind] = self.highest[kind].max(index);
        // More than there can be of anything is told at the end.
        Ok(u32::try_from(from_zero).unwrap_or(NONE))
    }

    /// Adds the corners as a fan.
    fn add_face(&mut self, has: [bool; 2]) {
        let out = &mut self.out;
        let first = out.triangles.len();
        let triangles = self.corners.len() - 2;
        let fan = |kind: usize| {
            let apex = self.corners[0][kind];
            let pairs = self.corners[1..].windows(2);
            pairs.map(move |pair| [apex, pair[0][kind], pair[1][kind]])
        };
        out.triangles.extend(fan(0));
        if triangles > 1 {
            out.polygons.push(Polygon {
                first: first as u32,
                triangles: triangles as u32,
            });
        }
        if has[0] {
            out.uv_triangles.resize(first, [NONE; 3]);
            out.uv_triangles.extend(fan(1));
        }
        if has[1] {
            out.normal_triangles.resize(first, [NONE; 3]);
            out.normal_triangles.extend(fan(2));
        }
        match has {
            [false, false] => {}
            [true, false] => self.faces_with[0] += 1,
            [false, true] => self.faces_with[1] += 1,
            [true, true] => self.faces_with[2] += 1,
        }
        let last = out.material_runs.last().map_or(NONE, |run| run.1);
        if last != self.material {
            out.material_runs.push((first as u32, self.material));
        }
    }

    /// Counts what is held against the budget: three times what it holds, since a list that is full
    /// doubles, and the old one stays until the new one is filled.
    fn count_bytes(&mut self) -> Result<(), FormatError> {
        let out = &self.out;
        let triangles = out.triangles.len() + out.uv_triangles.len() + out.normal_triangles.len();
        let bytes = out.positions.len() * size_of::<DVec3>()
            + out.colors.len() * size_of::<Option<Color>>()
            + out.uvs.len() * size_of::<Vec2>()
            + out.normals.len() * size_of::<Vec3>()
            + triangles * size_of::<[u32; 3]>()
            + out.polygons.len() * size_of::<Polygon>();
        let bytes = (self.copied + 3 * bytes) as u64;
        self.share.grow(self.path, "the mesh", bytes)
    }

    /// Faces that ask for texture coordinates or normals in a file that has none do without them.
    fn forgive_dangling(&mut self) {
        let [uvs, normals, both] = self.faces_with;
        let no_uvs = self.out.uvs.is_empty();
        let no_normals = self.out.normals.is_empty();
        self.out.oddities.dangling = if no_uvs { uvs } else { 0 }
            + if no_normals { normals } else { 0 }
            + if no_uvs || no_normals { both } else { 0 };
    }
}

/// Three numbers.
fn three(words: &mut Words<'_>) -> Option<DVec3> {
    let mut next = || words.next()?.parse().ok();
    Some(DVec3::new(next()?, next()?, next()?))
}

/// Words with white space between them: ASCII's, and Unicode's where there is any.
#[derive(Clone, Debug)]
struct Words<'t> {
    rest: &'t str,
}

impl<'t> Words<'t> {
    fn of(text: &'t str) -> Self {
        Self { rest: text }
    }
}

impl<'t> Iterator for Words<'t> {
    type Item = &'t str;

    fn next(&mut self) -> Option<&'t str> {
        let bytes = self.rest.as_bytes();
        let start = bytes.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length = bytes[start..]
            .iter()
            .position(|byte| byte.is_ascii_whitespace() || !byte.is_ascii());
        let end = length.map_or(bytes.len(), |length| start + length);
        if bytes.get(end).is_some_and(|byte| !byte.is_ascii()) {
            // Rare: by characters.
            let rest = self.rest.trim_start();
            let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
            let word;
            (word, self.rest) = rest.split_at(end);
            return (!word.is_empty()).then_some(word);
        }
        let word = &self.rest[start..end];
        self.rest = &self.rest[end..];
        Some(word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(source: &str) -> Result<ObjText, String> {
        read(
            Path::new("a.obj"),
            source.as_bytes(),
            &Budget::default(),
            &|_| (),
        )
        .map_err(|error| error.to_string())
    }

    #[test]
    fn passes_over_what_is_no_face() {
        let source = "# c:\\\no x\nv 0 0 0 # here\nv 1 0 0 0.5 0.5 0.5\r\nl 1 2 3\n\
            vt 0.5\nv 0 1 0\nf 1 \\\n2 \\\n3 # there\nv 2 2 2";
        let out = text(source).expect("a good file");
        assert_eq!(out.positions.len(), 4);
        assert_eq!(out.positions[1], DVec3::X);
        assert_eq!(out.uvs, [Vec2::new(0.5, 0.0)]);
        assert_eq!(out.triangles, [[0, 1, 2]]);
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
            (
                "v 0 0 0\r\rv 0 0\nv 0 0 0\r\n",
                3,
                "three numbers behind `v`",
            ),
            ("v 0 0 0\nv 0 0 0 x\n", 2, VERTEX),
            ("v 0 0 0\nv 0 0 0 1 2\n", 2, VERTEX),
            ("v 0 0 0\nv 0 0 0 1 1 x\n", 2, VERTEX),
            ("v 0 0 0\nv 0 0 0 1 1 1 x\n", 2, VERTEX),
            (
                "\nf 1 2 4294967297\nv 0 0 0\n",
                2,
                "a vertex index from 1 to 1",
            ),
        ] {
            let told = text(source).expect_err(source);
            let place = format!("a.obj:{line}: expected {expected}");
            assert!(told.starts_with(&place), "{source:?}: {told}");
        }
    }

    #[test]
    fn lines_end_as_they_like() {
        for source in [
            "v 0 0 0\rv 5 0 0\rv 0 1 0\rf 1 2 3\r",
            "v 0 0 0\rv 5 0 0\nv 0 1 0\r\nf 1 2 3\n",
            "v 0 0 0\r\nv 5 0 0\rv 0 1 0\nf 1 2 3",
        ] {
            let out = text(source).expect("a good file");
            assert_eq!(out.positions[1], DVec3::X * 5.0, "{source:?}");
            assert_eq!(out.triangles, [[0, 1, 2]]);
        }
    }

    #[test]
    fn values_behind_a_position_are_weights_or_colours() {
        let out = text(
            "v 0 0 0 2\nv 1 0 0 1\nv 0 1 0 1 0 0.5\nv 0 0 1 0 0 2\nv 1 1 1 0 0 0 1\nv 1 1 1\nf 1 2 3\n",
        )
        .expect("a good file");
        assert_eq!(out.positions[0], DVec3::ZERO);
        let color = |r, g, b| Some(Color([r, g, b]));
        assert_eq!(
            out.colors,
            [
                None,
                None,
                color(255, 0, 128),
                color(0, 0, 255),
                color(0, 0, 0)
            ]
        );
        assert_eq!(out.oddities.weights, 1);
        assert_eq!(out.oddities.colors_out_of_range, 1);
        assert_eq!(out.oddities.extra_values, 1);
        // The position stays what it is.
        let out = text("v 2 4 6 2\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("a good file");
        assert_eq!(out.positions[0], DVec3::new(2.0, 4.0, 6.0));
    }

    #[test]
    fn triangles_are_counted_before_they_are_there() {
        let within = |triangles: u64, faces: &str| {
            let budget = Budget::new(crate::formats::Limits {
                triangles,
                ..Default::default()
            });
            let source = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
            read(Path::new("a.obj"), source.as_bytes(), &budget, &|_| ())
                .map(|out| out.triangles.len())
                .map_err(|error| error.to_string())
        };
        assert_eq!(within(4, "f 1 2 3\nf 1 2 3 1 2\n"), Ok(4));
        for faces in ["f 1 2 3\nf 1 2 3 1 2\n", "f 1 2 3 1 2 3 1 2 3 1\n"] {
            let told = within(3, faces).expect_err("too many");
            assert!(
                told.ends_with("at most 3 are allowed (limit `triangles`)"),
                "{told}"
            );
        }
        let budget = Budget::new(crate::formats::Limits {
            bytes: 1000,
            ..Default::default()
        });
        let source = "v 0 0 0\n".repeat(20) + "f 1 2 3\n";
        let told = read(Path::new("a.obj"), source.as_bytes(), &budget, &|_| ())
            .expect_err("too many bytes");
        assert!(told.to_string().contains("limit `bytes`"), "{told}");
    }

    #[test]
    fn words_end_at_any_white_space() {
        let words: Vec<_> = Words::of(" a\tbc \u{a0}d\u{2003}é f\u{a0}").collect();
        assert_eq!(words, ["a", "bc", "d", "é", "f"]);
        assert_eq!(Words::of("\u{a0}").next(), None);
    }
}
