//! OFF, with colours, normals and texture coordinates (Geomview's manual, "OFF Files", 1996).

use super::Progress;
use super::at_vertices::at_vertices;
use super::error::FormatError;
use super::face_colors;
use super::limits::Budget;
use super::parsed::Parsed;
use super::polygon::{self, Polygon};
use super::tokens::{Found, Tokens, parse};
use crate::quote;
use crate::scene::{Color, MeshData};
use glam::{DVec3, Vec2, Vec3};
use std::mem::size_of;
use std::path::Path;

/// What a vertex may have besides its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Normal,
    Color,
    Uv,
}

/// The first word of an OFF, which declares what vertices have: `[ST][C][N][4][n]OFF`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Keyword {
    /// In the order of the numbers, which is from the word's end to its start. Geomview's words have normals first;
    /// MeshLab writes `NCOFF`, with colours first.
    kinds: Vec<Kind>,
    /// Four coordinates a vertex, or a number of them that the file gives: not a three-dimensional space.
    other_space: bool,
}

impl Keyword {
    fn of(word: &[u8]) -> Option<Self> {
        let mut rest = word.strip_suffix(b"OFF")?;
        let mut keyword = Self::default();
        while let Some((last, before)) = rest.split_last() {
            rest = before;
            let kind = match last {
                b'N' => Kind::Normal,
                b'C' => Kind::Color,
                b'T' => {
                    rest = rest.strip_suffix(b"S")?;
                    Kind::Uv
                }
                b'4' | b'n' => {
                    keyword.other_space = true;
                    continue;
                }
                _ => return None,
            };
            if keyword.kinds.contains(&kind) {
                return None;
            }
            keyword.kinds.push(kind);
        }
        Some(keyword)
    }

    fn has(&self, kind: Kind) -> bool {
        self.kinds.contains(&kind)
    }
}

fn words(bytes: &[u8]) -> Tokens<'_> {
    Tokens::new(bytes, 0, Some(b'#'))
}

/// Whether these are the bytes of an OFF.
pub(super) fn is_off(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(4096)];
    words(head).next().and_then(Keyword::of).is_some()
}

/// Colours as the file has them, each with the first vertex or triangle that has it.
#[derive(Default)]
struct RawColors {
    colors: Vec<(u32, [f32; 3])>,
    /// The largest channel of all of them.
    largest: f32,
}

impl RawColors {
    fn add(&mut self, at: usize, channels: [f64; 3]) {
        let channels = channels.map(|channel| channel as f32);
        self.largest = channels.into_iter().fold(self.largest, f32::max);
        self.colors.push((at as u32, channels));
    }

    /// The colours as bytes. Some programs write 0 to 255, others 0 to 1: the latter if no channel of the file is
    /// above 1.
    fn bytes(&self) -> impl Iterator<Item = (u32, Color)> {
        let scale = if self.largest > 1.0 { 1.0 / 255.0 } else { 1.0 };
        self.colors.iter().map(move |(at, channels)| {
            let byte = |channel: f32| face_colors::byte(f64::from(channel) * scale);
            (*at, Color(channels.map(byte)))
        })
    }
}

/// Reads an OFF.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<Parsed, FormatError> {
    let mut words = words(bytes);
    let first = words.next().unwrap_or_default();
    let keyword = Keyword::of(first);
    let keyword = match keyword {
        Some(keyword) if keyword.other_space => {
            let expected = "an OFF of three dimensions";
            return Err(words.fault(path, expected, &Found::word(first)));
        }
        Some(keyword) => {
            let mut behind = words.clone();
            if behind.next_in_line() == Some(b"BINARY") {
                return Err(words.fault(
                    path,
                    "an OFF as text",
                    &Found::Word("a binary OFF, which is not read".to_owned()),
                ));
            }
            keyword
        }
        // The first word is optional; without it the file starts with the counts.
        None => {
            words = self::words(bytes);
            Keyword::default()
        }
    };
    let expected = "the counts of vertices and faces";
    let mut count = || -> Result<usize, FormatError> {
        let word = words.next();
        let count = word.and_then(|word| std::str::from_utf8(word).ok()?.parse().ok());
        count.ok_or_else(|| words.fault(path, expected, &Found::next(word)))
    };
    let (vertices, faces) = (count()?, count()?);
    // A digit and a separator: three in each vertex, one in each face.
    let least = vertices
        .saturating_mul(6)
        .saturating_add(faces.saturating_mul(2));
    let left = bytes.len() - words.at();
    if least > left + 1 {
        let expected = format!("{vertices} vertices and {faces} faces");
        let found = Found::Word(format!("{left} bytes for them: it is cut short"));
        return Err(words.fault(path, &expected, &found));
    }
    if vertices as u64 >= u64::from(u32::MAX) {
        let expected = format!("fewer than {} vertices", u32::MAX);
        return Err(words.fault(path, &expected, &Found::Word(vertices.to_string())));
    }
    // The number of edges, if the file has one.
    words.rest_of_line();
    let mut reader = Reader {
        path,
        budget,
        words,
        keyword,
        vertices,
        parsed: Parsed::default(),
        normals: Vec::new(),
        uvs: Vec::new(),
        polygons: Vec::new(),
        vertex_colors: RawColors::default(),
        triangle_colors: RawColors::default(),
        small: 0,
        color_numbers: 0,
        extra: 0,
    };
    reader.read_vertices(bytes.len(), progress)?;
    reader.read_faces(faces, bytes.len(), progress)?;
    reader.finish()
}

struct Reader<'a> {
    path: &'a Path,
    budget: &'a Budget,
    words: Tokens<'a>,
    keyword: Keyword,
    vertices: usize,
    parsed: Parsed,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    polygons: Vec<Polygon>,
    vertex_colors: RawColors,
    triangle_colors: RawColors,
    /// Faces of fewer than three corners.
    small: usize,
    /// Faces whose colour is an index into a list outside the file.
    color_numbers: usize,
    /// Vertices and faces with superfluous numbers.
    extra: usize,
}

impl Reader<'_> {
    #[cold]
    fn fault(&self, expected: &str, found: &Found) -> FormatError {
        self.words.fault(self.path, expected, found)
    }

    /// The numbers of the next line that has any.
    fn line(&mut self, numbers: &mut Vec<f64>, expected: &str) -> Result<(), FormatError> {
        numbers.clear();
        let mut word = self.words.next();
        if word.is_none() {
            return Err(self.fault(expected, &Found::End));
        }
        while let Some(found) = word {
            let number = parse(found);
            let number = number.ok_or_else(|| self.fault(expected, &Found::word(found)))?;
            numbers.push(number);
            word = self.words.next_in_line();
        }
        Ok(())
    }

    fn read_vertices(&mut self, length: usize, progress: Progress<'_>) -> Result<(), FormatError> {
        let count = self.vertices;
        let keyword = std::mem::take(&mut self.keyword);
        let of = |kind, number| if keyword.has(kind) { number } else { 0 };
        let vertex = size_of::<DVec3>()
            + of(Kind::Normal, size_of::<Vec3>())
            + of(Kind::Uv, size_of::<Vec2>())
            + of(
                Kind::Color,
                size_of::<(u32, [f32; 3])>() + size_of::<Option<Color>>(),
            );
        // Counted again as a mesh once all is read.
        drop(
            self.budget
                .share(self.path, "the mesh", (count * vertex) as u64)?,
        );
        self.parsed.mesh.positions.reserve_exact(count);
        let least = 3 + of(Kind::Normal, 3) + of(Kind::Color, 3) + of(Kind::Uv, 2);
        let expected = format!("{least} numbers of a vertex");
        let mut numbers = Vec::new();
        for index in 0..count {
            self.line(&mut numbers, &expected)?;
            if numbers.len() < least {
                let found = Found::Word(numbers.len().to_string());
                return Err(self.fault(&expected, &found));
            }
            let three = |at: usize| [numbers[at], numbers[at + 1], numbers[at + 2]];
            self.parsed.mesh.positions.push(DVec3::from_array(three(0)));
            let mut at = 3;
            for kind in &keyword.kinds {
                match kind {
                    Kind::Normal => {
                        let normal = DVec3::from_array(three(at)).normalize_or_zero();
                        self.normals.push(normal.as_vec3());
                        at += 3;
                    }
                    Kind::Color => {
                        self.vertex_colors.add(index, three(at));
                        // Colours may have an opacity.
                        at += if numbers.len() > least { 4 } else { 3 };
                    }
                    Kind::Uv => {
                        let uv = Vec2::new(numbers[at] as f32, numbers[at + 1] as f32);
                        self.uvs.push(uv);
                        at += 2;
                    }
                }
            }
            self.extra += usize::from(numbers.len() > at);
            if index % 16_384 == 0 {
                progress(0.9 * self.words.at() as f32 / length as f32);
            }
        }
        Ok(())
    }

    fn read_faces(
        &mut self,
        count: usize,
        length: usize,
        progress: Progress<'_>,
    ) -> Result<(), FormatError> {
        let mut share = self.budget.share(self.path, "the mesh", 0)?;
        let expected = "a face: its count of corners, and as many vertex indices";
        let (mut numbers, mut indices) = (Vec::new(), Vec::new());
        for face in 0..count {
            self.line(&mut numbers, expected)?;
            let (corners, rest) = numbers
                .split_first()
                .and_then(|(count, rest)| {
                    let corners = *count as usize;
                    (corners as f64 == *count).then_some(())?;
                    rest.split_at_checked(corners)
                })
                .ok_or_else(|| {
                    let found = Found::Word(format!("{} numbers", numbers.len()));
                    self.fault(expected, &found)
                })?;
            let index = |corner: f64| {
                let index = corner as usize;
                (index as f64 == corner && index < self.vertices).then_some(index as u32)
            };
            indices.clear();
            for &corner in corners {
                let index = index(corner).ok_or_else(|| {
                    let expected = format!("vertex indices from 0 to {}", self.vertices as i64 - 1);
                    self.fault(&expected, &Found::Word(corner.to_string()))
                })?;
                indices.push(index);
            }
            let mesh = &mut self.parsed.mesh;
            let first = mesh.triangles.len();
            if let [apex, mut last, ref rest @ ..] = indices[..] {
                for &corner in rest {
                    mesh.triangles.push([apex, last, corner]);
                    last = corner;
                }
            }
            let triangles = mesh.triangles.len() - first;
            let sum = mesh.triangles.len() as u64;
            if sum > self.budget.triangles_left() {
                self.budget.add_triangles(self.path, sum)?;
            }
            match triangles {
                0 => {
                    self.small += 1;
                    continue;
                }
                1 => {}
                _ => self.polygons.push(Polygon {
                    first: first as u32,
                    triangles: triangles as u32,
                }),
            }
            match *rest {
                [] => {}
                [_] => self.color_numbers += 1,
                [r, g, b] | [r, g, b, _] => self.triangle_colors.add(first, [r, g, b]),
                _ => self.extra += 1,
            }
            if face % 16_384 == 0 {
                let held = self.parsed.mesh.triangles.len() * size_of::<[u32; 3]>()
                    + self.polygons.len() * size_of::<Polygon>()
                    + self.triangle_colors.colors.len() * size_of::<(u32, [f32; 3])>();
                // A full list doubles, and the old one exists until the new one is filled.
                share.grow(self.path, "the mesh", 3 * held as u64)?;
                progress(0.9 * self.words.at() as f32 / length as f32);
            }
        }
        Ok(())
    }

    fn finish(self) -> Result<Parsed, FormatError> {
        let Self {
            path, mut parsed, ..
        } = self;
        let mesh: &mut MeshData = &mut parsed.mesh;
        if mesh.triangles.is_empty() {
            let found = match self.small {
                0 => "none".to_owned(),
                small => format!("{small} of fewer than three corners"),
            };
            return Err(FormatError::unexpected(path, None, "faces", found));
        }
        mesh.colors = self
            .vertex_colors
            .bytes()
            .map(|(_, color)| Some(color))
            .collect();
        if !self.triangle_colors.colors.is_empty() {
            // All triangles of a face have its colour.
            let mut colors = vec![None; mesh.triangles.len()];
            for (first, color) in self.triangle_colors.bytes() {
                colors[first as usize] = Some(color);
            }
            for polygon in &self.polygons {
                let first = polygon.first as usize;
                let color = colors[first];
                colors[first..first + polygon.triangles as usize].fill(color);
            }
            face_colors::set(mesh, colors);
        }
        let uncut = polygon::cut(mesh, &self.polygons);
        mesh.normals = at_vertices(self.normals, &mesh.triangles, |n| *n != Vec3::ZERO);
        mesh.uvs = at_vertices(self.uvs, &mesh.triangles, |uv| uv.is_finite());
        let quoted = quote::path(path);
        let counts = [
            (
                self.small,
                "faces of fewer than three corners, which are passed over",
            ),
            (
                self.extra,
                "vertices and faces with more numbers than there is a use for",
            ),
        ];
        for (count, what) in counts.into_iter().filter(|(count, _)| *count > 0) {
            parsed.warnings.push(format!("{quoted}: {what}: {count}"));
        }
        if self.color_numbers > 0 {
            let count = self.color_numbers;
            parsed
                .notes
                .push(format!("not used: numbers of colours of {count} faces"));
        }
        parsed.warnings.extend(uncut.warnings(path));
        Ok(parsed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Parsed, String> {
        let read = read(
            Path::new("a.off"),
            text.as_bytes(),
            &Budget::default(),
            &|_| (),
        );
        read.map_err(|error| error.to_string())
    }

    #[test]
    fn keywords() {
        for good in ["OFF", "COFF", "STCN4OFF", "NCOFF", "nOFF", "# a\n\n OFF"] {
            assert!(is_off(good.as_bytes()), "{good}");
        }
        for bad in ["", "off", "OFFF", "XOFF", "CCOFF", "v OFF"] {
            assert!(!is_off(bad.as_bytes()), "{bad}");
        }
    }

    #[test]
    fn counts_and_comments_stand_where_they_like() {
        let body = "0 0 0\n1 0 0 # one\n\n1 1 0\r\n0 1 0\n4 0 1 2 3\n2 0 1\n3 1 2 3\n";
        for head in [
            "OFF\n4 3 0\n",
            "OFF 4 3\n",
            "OFF # all\n# of it\n4\n3\n",
            "4 3 5\n",
        ] {
            let Parsed { mesh, warnings, .. } = parse(&format!("{head}{body}")).expect(head);
            assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [1, 2, 3]], "{head}");
            assert_eq!(mesh.positions[2], DVec3::new(1.0, 1.0, 0.0));
            let message = "a.off: faces of fewer than three corners, which are passed over: 1";
            assert_eq!(warnings, [message]);
        }
    }

    #[test]
    fn vertices_have_normals_colours_and_texture_coordinates() {
        let vertex = |x: u8, y: u8, color: &str| format!("{x} {y} 0 0 0 2 {color} {x} {y}\n");
        let file = |colors: [&str; 3]| {
            let [a, b, c] = colors;
            let vertices = vertex(0, 0, a) + &vertex(1, 0, b) + &vertex(0, 1, c);
            parse(&format!("STCNOFF\n3 1 0\n{vertices}3 0 1 2\n"))
                .expect("a good file")
                .mesh
        };
        let color = |r, g, b| Some(Color([r, g, b]));
        let mesh = file(["255 0 0 255", "0 128 0", "0 0 1 0"]);
        assert_eq!(
            mesh.colors,
            [color(255, 0, 0), color(0, 128, 0), color(0, 0, 1)]
        );
        assert_eq!(
            mesh.uvs.expect("uvs").values,
            [Vec2::ZERO, Vec2::X, Vec2::Y]
        );
        assert_eq!(mesh.normals.expect("normals").values, [Vec3::Z; 3]);
        let mesh = file(["1 0 0 1", "0 0.5 0", "0 0 1 0"]);
        assert_eq!(
            mesh.colors,
            [color(255, 0, 0), color(0, 128, 0), color(0, 0, 255)]
        );
    }

    #[test]
    fn vertex_values_follow_the_order_of_the_keyword() {
        let vertices = "0 0 0 1 0 0 1 0 3 0\n1 0 0 1 0 0 1 0 3 0\n0 1 0 1 0 0 1 0 3 0\n";
        let mesh = parse(&format!("NCOFF\n3 1 0\n{vertices}3 0 1 2\n")).expect("a good file");
        assert_eq!(mesh.mesh.colors[0], Some(Color([255, 0, 0])));
        assert_eq!(mesh.mesh.normals.expect("normals").values[0], Vec3::Y);
    }

    #[test]
    fn faces_have_colours() {
        let vertices = "OFF\n4 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
        let faces = |colors: [&str; 4]| {
            let [a, b, c, d] = colors;
            let text = format!("{vertices}4 0 1 2 3 {a}\n3 0 1 2 {b}\n3 0 1 3 {c}\n3 1 2 3 {d}\n");
            parse(&text).expect("a good file")
        };
        let parsed = faces(["255 0 0", "", "7", "0 0 255 9"]);
        let colors: Vec<_> = parsed.mesh.materials.iter().map(|m| m.color).collect();
        assert_eq!(colors, [Color([255, 0, 0]), Color([0, 0, 255])]);
        assert_eq!(
            parsed.mesh.material_of_triangle,
            [0, 0, u32::MAX, u32::MAX, 1]
        );
        assert_eq!(parsed.notes, ["not used: numbers of colours of 1 faces"]);
        let parsed = faces(["1.0 0.5 0", "1 2", "", ""]);
        assert_eq!(parsed.mesh.materials[0].color, Color([255, 128, 0]));
        let message = "a.off: vertices and faces with more numbers than there is a use for: 1";
        assert_eq!(parsed.warnings, [message]);
    }

    #[test]
    fn says_where_and_what() {
        let check = |text: &str, expected: &str| {
            assert_eq!(
                parse(text).expect_err("a bad file"),
                format!("a.off{expected}")
            );
        };
        let body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        check(
            "OFF BINARY\n1 2 3",
            ":1: expected an OFF as text, found a binary OFF, which is not read",
        );
        check(
            "4OFF\n1",
            ":1: expected an OFF of three dimensions, found \"4OFF\"",
        );
        check(
            "OFF\n3 x 0\n",
            ":2: expected the counts of vertices and faces, found \"x\"",
        );
        check(
            "OFF\n",
            ":1: expected the counts of vertices and faces, found the file's end: it is cut short",
        );
        check(
            &format!("OFF\n9999999 1 0\n{body}"),
            ":2: expected 9999999 vertices and 1 faces, found 29 bytes for them: it is cut short",
        );
        check(
            "OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n",
            ":4: expected 3 numbers of a vertex, found 2",
        );
        check(
            "OFF\n3 1 0\n0 0 0\n1 0 z\n0 1 0\n3 0 1 2\n",
            ":4: expected 3 numbers of a vertex, found \"z\"",
        );
        let face = "a face: its count of corners, and as many vertex indices";
        for (line, found) in [("3 0 1", "3 numbers"), ("-3 0 1 2", "4 numbers")] {
            check(
                &format!("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n{line}\n"),
                &format!(":6: expected {face}, found {found}"),
            );
        }
        check(
            &format!("OFF\n3 2 0\n{body}"),
            &format!(":6: expected {face}, found the file's end: it is cut short"),
        );
        for bad in ["3", "-1", "0.5"] {
            check(
                &format!("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 {bad}\n"),
                &format!(":6: expected vertex indices from 0 to 2, found {bad}"),
            );
        }
        check(
            "OFF\n1 1 0\n0 0 0\n1 0\n",
            ": expected faces, found 1 of fewer than three corners",
        );
        check("OFF\n1 0 0\n0 0 0\n", ": expected faces, found none");
    }
}
