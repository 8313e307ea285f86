//! OFF, with colours, normals and texture coordinates (Geomview's manual, "OFF Files", 1996).

mod keyword;
mod raw_colors;
#[cfg(test)]
mod tests;

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
use keyword::{Keyword, VertexAttribute};
use raw_colors::RawColors;
use std::mem::size_of;
use std::path::Path;

fn tokens(bytes: &[u8]) -> Tokens<'_> {
    Tokens::new(bytes, 0, Some(b'#'))
}

/// Whether these are the bytes of an OFF.
pub(super) fn is_off(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(4096)];
    tokens(head).next().and_then(Keyword::parse).is_some()
}

/// Reads an OFF.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<Parsed, FormatError> {
    let mut tokens = tokens(bytes);
    let first = tokens.next().unwrap_or_default();
    let keyword = Keyword::parse(first);
    let keyword = match keyword {
        Some(keyword) if keyword.other_space => {
            let expected = "an OFF of three dimensions";
            return Err(tokens.fault(path, expected, &Found::word(first)));
        }
        Some(keyword) => {
            let mut behind = tokens.clone();
            if behind.next_in_line() == Some(b"BINARY") {
                return Err(tokens.fault(
                    path,
                    "an OFF as text",
                    &Found::Word("a binary OFF, which is not read".to_owned()),
                ));
            }
            keyword
        }
        // The first word is optional; without it the file starts with the counts.
        None => {
            tokens = self::tokens(bytes);
            Keyword::default()
        }
    };
    let expected = "the counts of vertices and faces";
    let mut count = || -> Result<usize, FormatError> {
        let word = tokens.next();
        let count = word.and_then(|word| std::str::from_utf8(word).ok()?.parse().ok());
        count.ok_or_else(|| tokens.fault(path, expected, &Found::next(word)))
    };
    let (vertices, faces) = (count()?, count()?);
    // A digit and a separator: three in each vertex, one in each face.
    let least = vertices
        .saturating_mul(6)
        .saturating_add(faces.saturating_mul(2));
    let left = bytes.len() - tokens.at();
    if least > left + 1 {
        let expected = format!("{vertices} vertices and {faces} faces");
        let found = Found::Word(format!("{left} bytes for them: it is cut short"));
        return Err(tokens.fault(path, &expected, &found));
    }
    if vertices as u64 >= u64::from(u32::MAX) {
        let expected = format!("fewer than {} vertices", u32::MAX);
        return Err(tokens.fault(path, &expected, &Found::Word(vertices.to_string())));
    }
    // The number of edges, if the file has one.
    tokens.rest_of_line();
    let mut reader = Reader {
        path,
        budget,
        tokens,
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
    tokens: Tokens<'a>,
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
        self.tokens.fault(self.path, expected, found)
    }

    /// The numbers of the next line that has any.
    fn line(&mut self, numbers: &mut Vec<f64>, expected: &str) -> Result<(), FormatError> {
        numbers.clear();
        self.append_line(numbers, expected)
    }

    /// As [`Self::line`], but appends to `numbers`.
    fn append_line(&mut self, numbers: &mut Vec<f64>, expected: &str) -> Result<(), FormatError> {
        let mut word = self.tokens.next();
        if word.is_none() {
            return Err(self.fault(expected, &Found::End));
        }
        while let Some(found) = word {
            let number = parse(found);
            let number = number.ok_or_else(|| self.fault(expected, &Found::word(found)))?;
            numbers.push(number);
            word = self.tokens.next_in_line();
        }
        Ok(())
    }

    fn read_vertices(&mut self, length: usize, progress: Progress<'_>) -> Result<(), FormatError> {
        let count = self.vertices;
        let keyword = std::mem::take(&mut self.keyword);
        let if_present = |attribute, number| if keyword.has(attribute) { number } else { 0 };
        let vertex = size_of::<DVec3>()
            + if_present(VertexAttribute::Normal, size_of::<Vec3>())
            + if_present(VertexAttribute::Uv, size_of::<Vec2>())
            + if_present(
                VertexAttribute::Color,
                size_of::<(u32, [f32; 3])>() + size_of::<Option<Color>>(),
            );
        // Counted again as a mesh once all is read.
        drop(
            self.budget
                .share(self.path, "the mesh", (count * vertex) as u64)?,
        );
        self.parsed.mesh.positions.reserve_exact(count);
        let least = 3
            + if_present(VertexAttribute::Normal, 3)
            + if_present(VertexAttribute::Color, 3)
            + if_present(VertexAttribute::Uv, 2);
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
            for attribute in &keyword.attributes {
                match attribute {
                    VertexAttribute::Normal => {
                        let normal = DVec3::from_array(three(at)).normalize_or_zero();
                        self.normals.push(normal.as_vec3());
                        at += 3;
                    }
                    VertexAttribute::Color => {
                        self.vertex_colors.add(index, three(at));
                        // Colours may have an opacity.
                        at += if numbers.len() > least { 4 } else { 3 };
                    }
                    VertexAttribute::Uv => {
                        let uv = Vec2::new(numbers[at] as f32, numbers[at + 1] as f32);
                        self.uvs.push(uv);
                        at += 2;
                    }
                }
            }
            self.extra += usize::from(numbers.len() > at);
            if index % 16_384 == 0 {
                progress(0.9 * self.tokens.at() as f32 / length as f32);
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
            self.complete_face(&mut numbers, expected);
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
                progress(0.9 * self.tokens.at() as f32 / length as f32);
            }
        }
        Ok(())
    }

    /// Adds the indices of a face that follow in further lines, where all are of vertices and the last line ends with the
    /// face: some programs break lines anywhere. Anywhere else the line is wrong, and stays as it is.
    fn complete_face(&mut self, numbers: &mut Vec<f64>, expected: &str) {
        let corners = numbers.first().map_or(0, |&count| count as usize);
        if numbers.len() > corners || corners > self.vertices {
            return;
        }
        let (after_line, length) = (self.tokens.clone(), numbers.len());
        while numbers.len() <= corners && self.append_line(numbers, expected).is_ok() {}
        let vertices = 0.0..self.vertices as f64;
        let is_face = numbers.len() == corners + 1
            && numbers[1..].iter().all(|index| vertices.contains(index));
        if !is_face {
            self.tokens = after_line;
            numbers.truncate(length);
        }
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
