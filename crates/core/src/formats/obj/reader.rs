//! Parsing the lines of an OBJ file, or of a piece of one.

use super::content::{Counts, NONE, ObjText};
use super::numbers::{integer, plain_vector, vector};
use super::words::{Words, split_keyword};
use crate::formats::error::{FormatError, quote};
use crate::formats::limits::Allowance;
use crate::formats::lines::{Line, Lines};
use crate::formats::polygon::Polygon;
use crate::formats::tokens::parse;
use crate::scene::Color;
use glam::{DVec3, Vec2, Vec3};
use std::collections::HashMap;
use std::mem::size_of;
use std::path::Path;

/// The material of a piece's faces before its first `usemtl`: that of the last face before the piece.
pub(super) const INHERITED: u32 = u32::MAX - 1;

/// Added to a piece's relative indices, which are relative to its start and may be negative.
pub(super) const RELATIVE: i64 = 1 << 31;

/// Parses lines into [`Reader::out`].
pub(super) struct Reader<'a> {
    path: &'a Path,
    allowance: &'a Allowance,
    /// Bytes counted against the allowance so far.
    counted: u64,
    /// Bytes of the text that are copies, not the file's own.
    copied: usize,
    pub(super) out: ObjText,
    /// The highest absolute index of each type that a face uses.
    pub(super) highest: Counts,
    /// The totals of the whole file, once they are known.
    pub(super) known_totals: Option<Counts>,
    /// The first word that should be a number and is none. Parsing continues, because an index before it may be out
    /// of range, which only the end shows.
    pub(super) first_fault: Option<FormatError>,
    /// Whether another reader parses the lines before the first one.
    is_piece: bool,
    /// Whether any index is absolute, and whether any is relative.
    pub(super) has_indices: [bool; 2],
    /// The lowest relative index of each type, relative to the piece's start.
    pub(super) lowest: Counts,
    /// The material of the next face: an index into the materials' names, [`NONE`] or [`INHERITED`].
    pub(super) material: u32,
    material_numbers: HashMap<String, u32>,
    /// The corners of the current face: vertex, texture coordinates, normal.
    corners: Vec<[u32; 3]>,
    /// The numbers of faces with texture coordinates only, with normals only, and with both.
    pub(super) faces_with: [usize; 3],
}

/// The contents of a `v` line, for messages.
pub(super) const VERTEX: &str = "three numbers, a weight or three of a colour behind `v`";

impl<'a> Reader<'a> {
    /// A reader of all lines of a file; `copied` bytes of their text are copies.
    pub(super) fn for_file(path: &'a Path, allowance: &'a Allowance, copied: usize) -> Self {
        Self {
            path,
            allowance,
            counted: 0,
            copied,
            out: ObjText::default(),
            highest: [0; 3],
            known_totals: None,
            first_fault: None,
            is_piece: false,
            has_indices: [false; 2],
            lowest: [0; 3],
            material: NONE,
            material_numbers: HashMap::new(),
            corners: Vec::new(),
            faces_with: [0; 3],
        }
    }

    /// A reader of a piece. Relative indices are stored relative to the piece's start, plus [`RELATIVE`].
    pub(super) fn for_piece(path: &'a Path, allowance: &'a Allowance, copied: usize) -> Self {
        Self {
            is_piece: true,
            material: INHERITED,
            ..Self::for_file(path, allowance, copied)
        }
    }

    /// Parses all lines of a text.
    ///
    /// # Errors
    /// The first invalid line, except one whose only fault is a word that should be a number
    /// ([`Reader::first_fault`]); more than the allowance.
    pub(super) fn lines(&mut self, text: &str, progress: &dyn Fn(f32)) -> Result<(), FormatError> {
        let mut lines = Lines::new(text);
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
        let (keyword, rest) = split_keyword(text);
        // Names may contain a `#`, numbers may not.
        let values = || {
            let end = memchr::memchr(b'#', rest.as_bytes());
            Words::new(&rest[..end.unwrap_or(rest.len())])
        };
        match keyword {
            "v" => self.vertex(values(), &line)?,
            "vt" => {
                let mut values = values();
                let mut read = |is_needed: bool| match values.next() {
                    None if is_needed => None,
                    None => Some(0.0),
                    Some(word) => parse(word.as_bytes()),
                };
                let uv = read(true).zip(read(false));
                let uv = self.number(uv, "one or more numbers behind `vt`", &line)?;
                let (u, v) = uv.unwrap_or_default();
                self.out.uvs.push(Vec2::new(u as f32, v as f32));
            }
            "vn" => {
                let mut values = values();
                let normal = self.vector(&mut values);
                let normal = self.number(normal, "three numbers behind `vn`", &line)?;
                let normal = normal.unwrap_or_default().normalize_or_zero();
                self.out.normals.push(normal.as_vec3());
            }
            "f" => self.face(values(), &line)?,
            "mtllib" => self.out.libraries.push(rest.trim().to_owned()),
            "g" | "o" => self.out.groups.begin(rest.trim()),
            "usemtl" => self.material = self.material_number(rest.trim()),
            _ => {}
        }
        Ok(())
    }

    /// Records a line with an invalid number; an error where it is already known that no other fault precedes it.
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
        let position = self.vector(&mut values);
        let position = self.number(position, "three numbers behind `v`", line)?;
        self.out.positions.push(position.unwrap_or(DVec3::NAN));
        let mut more = [0.0; 3];
        let mut count = 0;
        for word in values {
            let value = parse(word.as_bytes());
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

    /// Three numbers, as a vector.
    fn vector(&self, words: &mut Words<'_>) -> Option<DVec3> {
        let plain = match self.known_totals {
            None => plain_vector(words),
            Some(_) => None,
        };
        plain.or_else(|| vector(words))
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

    /// The totals so far.
    pub(super) fn totals(&self) -> Counts {
        [
            self.out.positions.len() as i64,
            self.out.uvs.len() as i64,
            self.out.normals.len() as i64,
        ]
    }

    fn face(&mut self, words: Words<'_>, line: &Line<'_>) -> Result<(), FormatError> {
        self.corners.clear();
        let so_far = self.totals();
        let most = self.allowance.triangles();
        let left = most.saturating_sub(self.out.triangles.len() as u64);
        let mut with = [0; 3];
        if self.known_totals.is_none() && self.plain_corners(words.rest().as_bytes(), left) {
            let has = |kind: usize| self.corners[0][kind] != NONE;
            self.has_indices[0] = true;
            self.add_face([has(1), has(2)]);
            self.out.open_end = line.is_cut.then_some(line.number);
            return Ok(());
        }
        self.corners.clear();
        for word in words {
            let mut corner = [NONE; 3];
            let mut rest = Some(word.as_bytes());
            for kind in 0..3 {
                let Some(indices) = rest else { break };
                let end = indices.iter().position(|&byte| byte == b'/');
                let part = &indices[..end.unwrap_or(indices.len())];
                rest = end.map(|end| &indices[end + 1..]);
                if part.is_empty() && kind > 0 {
                    continue;
                }
                let Some(index) = integer(part) else {
                    let expected = "a corner as `v`, `v/vt`, `v//vn` or `v/vt/vn`";
                    return Err(self.fault(line, expected, quote(word)));
                };
                corner[kind] = self.index(kind, index, so_far[kind], line)?;
                with[kind] += 1;
            }
            if rest.is_some() {
                let expected = "a corner of at most three indices";
                return Err(self.fault(line, expected, quote(word)));
            }
            self.corners.push(corner);
            if self.corners.len() as u64 > left.saturating_add(2) {
                return Err(self.allowance.too_many_triangles(self.path, most + 1));
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

    /// Parses corners in the most frequent form: three or more, separated by ASCII white space, with absolute indices
    /// of at most nine digits, all with texture coordinates and normals, or none. Returns whether they have that
    /// form; if not, nothing else has changed.
    fn plain_corners(&mut self, text: &[u8], left: u64) -> bool {
        const DIGITS: usize = 9;
        let mut highest = self.highest;
        let mut with = [0; 3];
        let mut at = 0;
        loop {
            while text.get(at).is_some_and(u8::is_ascii_whitespace) {
                at += 1;
            }
            if at == text.len() {
                break;
            }
            let mut corner = [NONE; 3];
            let mut kind = 0;
            loop {
                let start = at;
                let mut index = 0;
                while let Some(digit) = text.get(at).map(|byte| byte.wrapping_sub(b'0'))
                    && digit <= 9
                    && at - start < DIGITS
                {
                    index = index * 10 + u32::from(digit);
                    at += 1;
                }
                if index > 0 {
                    corner[kind] = index - 1;
                    highest[kind] = highest[kind].max(i64::from(index));
                    with[kind] += 1;
                } else if at > start || kind == 0 {
                    return false;
                }
                match text.get(at) {
                    Some(b'/') if kind < 2 => {
                        kind += 1;
                        at += 1;
                    }
                    Some(byte) if !byte.is_ascii_whitespace() => return false,
                    _ => break,
                }
            }
            self.corners.push(corner);
        }
        let count = self.corners.len();
        let is_plain = count >= 3
            && count as u64 <= left.saturating_add(2)
            && with.iter().all(|&corners| corners == 0 || corners == count);
        if is_plain {
            self.highest = highest;
        }
        is_plain
    }

    /// An index from 0; [`NONE`] for texture coordinates and normals if there are none so far.
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
            ..0 if self.is_piece => {
                let from_start = so_far + index.max(-RELATIVE);
                self.lowest[kind] = self.lowest[kind].min(from_start);
                Some((from_start + RELATIVE).max(0))
            }
            // Relative to the last one so far.
            ..0 if index >= -so_far => Some(so_far + index),
            ..0 if kind > 0 && so_far == 0 => Some(i64::from(NONE)),
            _ => (1..=total).contains(&index).then(|| index - 1),
        };
        let Some(from_zero) = from_zero else {
            let name = ["vertex", "texture coordinate", "normal"][kind];
            let has = self.known_totals.map_or(so_far, |totals| totals[kind]);
            let expected = match index {
                ..0 if so_far == 0 => "vertices before it (lines of `v x y z`)".into(),
                ..0 => format!("a {name} index down to -{so_far}"),
                _ if self.known_totals.is_none() => format!("a {name} index from 1"),
                _ if has == 0 => "vertices in the file (lines of `v x y z`)".into(),
                _ => format!("a {name} index from 1 to {has}, as the file has"),
            };
            return Err(self.fault(line, &expected, index.to_string()));
        };
        self.has_indices[usize::from(index < 0)] = true;
        self.highest[kind] = self.highest[kind].max(index);
        // An index beyond the range of u32 is reported at the end.
        Ok(u32::try_from(from_zero).unwrap_or(NONE))
    }

    /// Adds the corners as a fan.
    fn add_face(&mut self, has: [bool; 2]) {
        let out = &mut self.out;
        let first = out.triangles.len();
        out.groups.add_triangle(first);
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

    /// Counts memory against the allowance: three times the lists' contents, since a full list doubles, and the old
    /// one exists until the new one is filled.
    fn count_bytes(&mut self) -> Result<(), FormatError> {
        let out = &self.out;
        let triangles = out.triangles.len() + out.uv_triangles.len() + out.normal_triangles.len();
        let bytes = out.positions.len() * size_of::<DVec3>()
            + out.colors.len() * size_of::<Option<Color>>()
            + out.uvs.len() * size_of::<Vec2>()
            + out.normals.len() * size_of::<Vec3>()
            + triangles * size_of::<[u32; 3]>()
            + out.polygons.len() * size_of::<Polygon>()
            + out.groups.bytes();
        let bytes = (self.copied + 3 * bytes) as u64;
        let more = bytes.saturating_sub(self.counted);
        self.counted += more;
        self.allowance.hold(self.path, "the mesh", more)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line parsed by the fast path, if that applies, and by the general one.
    fn both_ways(line: &str) -> [Result<String, String>; 2] {
        [None, Some([1 << 40; 3])].map(|known_totals| {
            let allowance = crate::formats::limits::Budget::default().allowance();
            let mut reader = Reader::for_file(Path::new("a.obj"), &allowance, 0);
            reader.known_totals = known_totals;
            reader
                .lines(&format!("{line}\n"), &|_| ())
                .and_then(|()| reader.first_fault.take().map_or(Ok(()), Err))
                .map(|()| {
                    format!(
                        "{:?} {:?} {:?}",
                        reader.out, reader.highest, reader.faces_with
                    )
                })
                .map_err(|error| error.to_string())
        })
    }

    #[test]
    fn the_fast_path_parses_as_the_general_one() {
        let words = [
            "1",
            "23",
            "4/5",
            "6//7",
            "8/9/10",
            "11/",
            "12//",
            "0",
            "1/0",
            "-1",
            "+2",
            "1234567890",
            "999999999",
            "1/2/3/4",
            "/1",
            "//",
            "1x",
            "x",
            "é",
            "1\u{a0}2",
            "1e3",
            "-2.5e-3",
            "nan",
            "inf",
            "1e",
            ".5",
            "5.",
            "1_",
            "0x1",
            "",
            "\t",
            "\u{b}",
        ];
        let mut random = crate::random::Random(3);
        let mut word = || words[(random.unit() * words.len() as f64) as usize];
        for round in 0..20_000 {
            let keyword = ["f", "v", "vn"][round % 3];
            let line = match round % 5 {
                0 => format!("{keyword} {}", word()),
                1 => format!("{keyword} 1 2 {} 4", word()),
                2 => format!("{keyword} {} {} {} {}", word(), word(), word(), word()),
                3 => format!("{keyword}\t 1/2 {}  {} ", word(), word()),
                _ => format!("{keyword} 0.1 -7e2 {} {}", word(), word()),
            };
            let [short, long] = both_ways(&line);
            match (&short, &long) {
                // The error includes the totals where these are known.
                (Err(_), Err(_)) => {}
                _ => assert_eq!(short, long, "{line:?}"),
            }
        }
    }
}
