//! STL, ASCII and binary (3D Systems, "StereoLithography Interface Specification", 1988).

use super::Progress;
use super::error::{FormatError, quote};
use super::face_colors;
use super::group_statements::GroupStatements;
use super::limits::Budget;
use super::parsed::Parsed;
use super::polygon::{self, Polygon};
use super::random_access::{RandomAccess, bytes_at};
use super::tokens::{Found, Tokens};
use super::weld::{Vertices, weld};
use crate::quote;
use crate::scene::{Color, MeshData};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::mem::size_of;
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// The length of a binary file's header: 80 arbitrary bytes, and a count.
pub(super) const HEADER: usize = 84;

/// The length of a binary facet: a normal and three corners of three floats each, and two arbitrary bytes.
const FACET: usize = 50;

type Facet = [u8; FACET];

/// Whether these are the bytes of a binary STL: its count agrees with its length. A binary file may start like an
/// ASCII one; the text of an ASCII file at the count's offset would mean billions of facets.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    let header = bytes.first_chunk::<HEADER>();
    header.is_some_and(|header| is_binary_of(header, bytes.len() as u64))
}

/// [`is_binary`] for a file of so many bytes that begins with these.
pub(super) fn is_binary_of(header: &[u8; HEADER], length: u64) -> bool {
    length == length_of(count(header))
}

/// Whether these are the bytes of an ASCII STL.
pub(super) fn is_ascii(bytes: &[u8]) -> bool {
    let head = bytes[..bytes.len().min(4096)].trim_ascii_start();
    let mut words = Tokens::new(head, 0, None);
    let first = words.next().unwrap_or_default();
    first.eq_ignore_ascii_case(b"solid") && {
        words.rest_of_line();
        words.next().is_some_and(|word| {
            word.eq_ignore_ascii_case(b"facet") || word.eq_ignore_ascii_case(b"endsolid")
        })
    }
}

fn count(header: &[u8; HEADER]) -> u32 {
    let [.., a, b, c, d] = *header;
    u32::from_le_bytes([a, b, c, d])
}

fn length_of(count: u32) -> u64 {
    HEADER as u64 + FACET as u64 * u64::from(count)
}

/// Reads an STL. Corners at one position become one vertex, and normals are computed from the corners.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<Parsed, FormatError> {
    if !is_binary(bytes) && is_ascii(bytes) {
        ascii(path, bytes, budget, progress)
    } else {
        let from = RandomAccess {
            read_at: &bytes_at(bytes),
            length: bytes.len() as u64,
        };
        read_binary(path, from, budget, progress)
    }
}

fn no_triangles(path: &Path) -> FormatError {
    FormatError::unexpected(path, None, "facets", "none")
}

/// Reads a binary STL, a part at a time: new memory for all of them would take longer than to decode
/// them.
pub(super) fn read_binary(
    path: &Path,
    file: RandomAccess<'_>,
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<Parsed, FormatError> {
    let length = file.length;
    if length < HEADER as u64 {
        let expected = format!("the {HEADER} bytes that a binary STL begins with");
        let found = format!("{length}: it is cut short");
        return Err(FormatError::unexpected(path, None, expected, found));
    }
    let mut header = [0; HEADER];
    file.read(0, &mut header)
        .map_err(|error| FormatError::io(path, error))?;
    let count = count(&header);
    let Some(left) = length.checked_sub(length_of(count)) else {
        let bytes = length_of(count);
        let whole = (length - HEADER as u64) / FACET as u64;
        let expected = format!("{count} facets, as the count at byte 80 says: {bytes} bytes");
        let found = format!("{whole} whole ones in {length} bytes: it is cut short");
        return Err(FormatError::unexpected(path, None, expected, found));
    };
    if count == 0 {
        return Err(no_triangles(path));
    }
    if u64::from(count) > budget.triangles_left() {
        budget.add_triangles(path, count.into())?;
    }
    let mut parsed = Parsed::default();
    parsed.notes.push("binary".to_owned());
    let name = header[..80].split(|&byte| byte == 0).next();
    let name = name.unwrap_or_default().trim_ascii();
    if !name.is_empty() {
        let name = quote(&String::from_utf8_lossy(name));
        parsed.notes.push(format!("header: {name}"));
    }
    if left > 0 {
        let path = quote::path(path);
        parsed.warnings.push(format!(
            "{path}: {left} bytes behind the last of its {count} facets, which are passed over"
        ));
    }

    let facets = Facets {
        path,
        file,
        budget,
        count: count as usize,
    };
    // The number of vertices of a closed mesh. More are counted once they exist, and are limited by the file's
    // length.
    let of = |vertices: usize| {
        let vertex = size_of::<DVec3>() + 3 * size_of::<u32>();
        (facets.count * size_of::<[u32; 3]>() + vertices * vertex) as u64
    };
    let mut share = budget.share(path, "the mesh", of(facets.count / 2))?;
    let (done, has_attributes) = (AtomicUsize::new(0), AtomicBool::new(false));
    let reader = || {
        let mut bytes = Vec::new();
        let has_attributes = &has_attributes;
        move |range: Range<usize>, to: &mut Vec<DVec3>| {
            let facets = facets.read(range, &mut bytes)?;
            to.extend(facets.iter().flat_map(corners));
            if facets.iter().fold(0, |any, facet| any | attribute(facet)) != 0 {
                has_attributes.store(true, Ordering::Relaxed);
            }
            Ok(())
        }
    };
    let (positions, triangles) = weld(facets.count, &reader, &|more| {
        let done = done.fetch_add(more, Ordering::Relaxed) + more;
        progress(0.9 * done as f32 / facets.count as f32);
    })?;
    let held = of(positions.len());
    share.grow(path, "the mesh", held)?;
    parsed.mesh = MeshData {
        positions,
        triangles,
        ..MeshData::default()
    };
    if has_attributes.into_inner() {
        share.grow(path, "the mesh", held + 2 * u64::from(count))?;
        color(&header, &facets.attributes()?, &mut parsed);
    }
    progress(1.0);
    Ok(parsed)
}

/// The facets of a binary file.
#[derive(Clone, Copy)]
struct Facets<'f> {
    path: &'f Path,
    file: RandomAccess<'f>,
    budget: &'f Budget,
    count: usize,
}

impl Facets<'_> {
    /// Reads some of them into a buffer.
    fn read<'b>(
        &self,
        range: Range<usize>,
        bytes: &'b mut Vec<u8>,
    ) -> Result<&'b [Facet], FormatError> {
        self.budget.check_cancelled(self.path)?;
        bytes.resize(range.len() * FACET, 0);
        let read = self.file.read((HEADER + range.start * FACET) as u64, bytes);
        read.map_err(|error| FormatError::io(self.path, error))?;
        Ok(bytes.as_chunks().0)
    }

    /// The last two bytes of all.
    fn attributes(&self) -> Result<Vec<u16>, FormatError> {
        const STEP: usize = 1 << 14;
        let mut attributes = vec![0; self.count];
        let steps = attributes.par_chunks_mut(STEP).enumerate();
        steps.try_for_each_init(Vec::new, |bytes, (step, attributes)| {
            let first = step * STEP;
            let facets = self.read(first..first + attributes.len(), bytes)?;
            for (to, facet) in attributes.iter_mut().zip(facets) {
                *to = attribute(facet);
            }
            Ok(())
        })?;
        Ok(attributes)
    }
}

fn corners(facet: &Facet) -> [DVec3; 3] {
    let (floats, _) = facet.as_chunks::<4>();
    let float = |index: usize| f32::from_le_bytes(floats[index]);
    // After the normal.
    [3, 6, 9].map(|first| Vec3::new(float(first), float(first + 1), float(first + 2)).as_dvec3())
}

fn attribute(facet: &Facet) -> u16 {
    u16::from_le_bytes([facet[48], facet[49]])
}

/// Gives the mesh the colours in its facets' last two bytes, by the conventions of two programs: five bits a channel,
/// and one that says whether there is a colour.
fn color(header: &[u8; HEADER], attributes: &[u16], parsed: &mut Parsed) {
    const VALID: u16 = 1 << 15;
    let five = |bits: u16| {
        let bits = (bits & 31) as u8;
        bits << 3 | bits >> 2
    };
    let bits = attributes.iter().copied();
    if let Some(at) = memchr::memmem::find(&header[..80 - 4], b"COLOR=") {
        // Magics: red in the lowest bits; the flag means that the facet has the object's colour.
        let object = match header.get(at + 6..at + 9) {
            Some(&[r, g, b]) => Color([r, g, b]),
            _ => Color::DEFAULT,
        };
        let colors = bits.map(|bits| {
            Some(match bits & VALID {
                0 => Color([five(bits), five(bits >> 5), five(bits >> 10)]),
                _ => object,
            })
        });
        face_colors::set(&mut parsed.mesh, colors);
        parsed
            .notes
            .push("colours of facets as Magics writes them".to_owned());
    } else if bits.clone().all(|bits| bits == 0 || bits & VALID != 0) {
        // VisCAM and SolidView: blue in the lowest bits; the flag means that the facet has a colour of its own.
        let colors = bits.map(|bits| {
            let color = Color([five(bits >> 10), five(bits >> 5), five(bits)]);
            (bits & VALID != 0).then_some(color)
        });
        face_colors::set(&mut parsed.mesh, colors);
        parsed
            .notes
            .push("colours of facets as VisCAM writes them".to_owned());
    } else {
        let count = bits.filter(|bits| *bits != 0).count();
        parsed
            .notes
            .push(format!("not used: attribute bytes of {count} facets"));
    }
}

/// The mesh of an ASCII file as it is read.
struct AsciiMesh<'a> {
    path: &'a Path,
    budget: &'a Budget,
    vertices: Vertices,
    triangles: Vec<[u32; 3]>,
    polygons: Vec<Polygon>,
    /// The corners of the facet that is read.
    facet: Vec<u32>,
    /// The solids.
    groups: GroupStatements,
}

impl AsciiMesh<'_> {
    /// Ends a facet, of three corners or more. False for fewer.
    fn end_facet(&mut self) -> Result<bool, FormatError> {
        let [first, second, ref rest @ ..] = self.facet[..] else {
            return Ok(false);
        };
        if rest.is_empty() {
            return Ok(false);
        }
        let sum = (self.triangles.len() + rest.len()) as u64;
        if sum > self.budget.triangles_left() {
            self.budget.add_triangles(self.path, sum)?;
        }
        if rest.len() > 1 {
            self.polygons.push(Polygon {
                first: self.triangles.len() as u32,
                triangles: rest.len() as u32,
            });
        }
        let mut last = second;
        for &next in rest {
            self.triangles.push([first, last, next]);
            last = next;
        }
        Ok(true)
    }

    /// The bytes that are held. A full list doubles, and the old one exists until the new one is filled.
    fn held(&self) -> u64 {
        let vertices = self.vertices.len() * (size_of::<DVec3>() + 3 * size_of::<u32>());
        let triangles = self.triangles.len() * size_of::<[u32; 3]>();
        (3 * (vertices + triangles) + 4 * self.facet.len() + self.groups.bytes()) as u64
    }
}

fn ascii(
    path: &Path,
    bytes: &[u8],
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<Parsed, FormatError> {
    let mut words = Tokens::new(bytes, 0, None);
    let mut share = budget.share(path, "the mesh", 0)?;
    let mut mesh = AsciiMesh {
        path,
        budget,
        vertices: Vertices::with_capacity(0),
        triangles: Vec::new(),
        polygons: Vec::new(),
        facet: Vec::new(),
        groups: GroupStatements::default(),
    };
    let (mut in_solid, mut in_facet) = (false, false);
    let mut solids = 0;
    while let Some(word) = words.next() {
        let is = |expected: &str| word.eq_ignore_ascii_case(expected.as_bytes());
        let fault =
            |words: &Tokens<'_>, expected| Err(words.fault(path, expected, &Found::word(word)));
        if in_facet {
            if is("vertex") {
                let position = words
                    .point()
                    .map_err(|found| words.fault(path, "three numbers behind `vertex`", &found))?;
                mesh.facet.push(mesh.vertices.number(position));
            } else if is("endfacet") {
                in_facet = false;
                if !mesh.end_facet()? {
                    return fault(&words, "three vertices in a facet");
                }
                if mesh.triangles.len().is_multiple_of(16_384) {
                    progress(0.9 * words.at() as f32 / bytes.len() as f32);
                }
            } else if !(is("outer") || is("loop") || is("endloop")) {
                return fault(&words, "`vertex`, `endloop` or `endfacet`");
            }
            let corners = mesh.facet.len();
            if corners < 2 || corners.is_multiple_of(16_384) {
                share.grow(path, "the mesh", mesh.held())?;
            }
        } else if is("facet") && in_solid {
            in_facet = true;
            mesh.facet.clear();
            mesh.groups.add_triangle(mesh.triangles.len());
            // Skips the normal, which is computed from the corners.
            words.rest_of_line();
        } else if is("endsolid") && in_solid {
            in_solid = false;
            words.rest_of_line();
        } else if is("solid") && !in_solid {
            in_solid = true;
            solids += 1;
            let name = String::from_utf8_lossy(words.rest_of_line());
            mesh.groups.begin(&name);
        } else if in_solid {
            return fault(&words, "`facet` or `endsolid`");
        } else {
            return fault(&words, "`solid`");
        }
    }
    if in_facet {
        return Err(words.fault(path, "`endfacet`", &Found::End));
    }
    if mesh.triangles.is_empty() {
        return Err(no_triangles(path));
    }
    Ok(parsed_ascii(mesh, solids, in_solid))
}

/// What was read of an ASCII file of so many solids; `is_cut_short` where the last one has no end.
fn parsed_ascii(mesh: AsciiMesh<'_>, solids: usize, is_cut_short: bool) -> Parsed {
    let mut parsed = Parsed::default();
    parsed.notes.push("ASCII".to_owned());
    if solids > 1 {
        let note = format!("solids: {solids}, which are groups of one object");
        parsed.notes.push(note);
    }
    let path = mesh.path;
    if is_cut_short {
        parsed.warnings.push(format!(
            "{}: its last solid has no `endsolid`: is it cut short?",
            quote::path(path)
        ));
    }
    parsed.mesh.positions = mesh.vertices.into_positions();
    parsed.mesh.groups = mesh.groups.groups(mesh.triangles.len());
    parsed.mesh.triangles = mesh.triangles;
    let uncut = polygon::cut(&mut parsed.mesh, &mesh.polygons);
    parsed.warnings.extend(uncut.warnings(path));
    parsed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::read_mesh;
    use crate::random::Random;
    use crate::scene::{Mesh, Object, Scene};
    use std::sync::Arc;

    fn parse(bytes: &[u8]) -> Result<Parsed, String> {
        read(Path::new("a.stl"), bytes, &Budget::default(), &|_| ())
            .map_err(|error| error.to_string())
    }

    fn facet(corners: [[f32; 3]; 3], attribute: u16) -> Vec<u8> {
        let normal = [9.0f32; 3];
        let floats = normal.iter().chain(corners.as_flattened());
        let mut bytes: Vec<u8> = floats.flat_map(|float| float.to_le_bytes()).collect();
        bytes.extend(attribute.to_le_bytes());
        bytes
    }

    fn file(header: &str, facets: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = header.as_bytes().to_vec();
        bytes.resize(80, 0);
        bytes.extend((facets.len() as u32).to_le_bytes());
        bytes.extend(facets.concat());
        bytes
    }

    const A: [[f32; 3]; 3] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
    const B: [[f32; 3]; 3] = [[-0., 0., -0.], [0., 1., 0.], [0., 0., 2.]];

    #[test]
    fn binary_corners_are_welded() {
        for header in ["solid of a kind", ""] {
            let bytes = file(header, &[facet(A, 0), facet(B, 0)]);
            assert!(is_binary(&bytes));
            let parsed = parse(&bytes).expect("a good file");
            assert_eq!(parsed.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
            assert_eq!(parsed.mesh.positions[3], DVec3::new(0.0, 0.0, 2.0));
            assert!(parsed.mesh.materials.is_empty());
            assert_eq!(parsed.warnings, [""; 0]);
        }
    }

    /// Of more facets than are read at once, one of which has a colour.
    #[test]
    fn a_file_is_read_in_place_as_in_memory() {
        let mut random = Random(31);
        let mut coordinate = || (random.unit() * 30.0).floor() as f32;
        let mut corner = || [coordinate(), coordinate(), coordinate()];
        let facets: Vec<Vec<u8>> = (0..40_000)
            .map(|index| {
                let color = if index == 33_333 { 0x8000 | 31 } else { 0 };
                facet([corner(), corner(), corner()], color)
            })
            .collect();
        let bytes = file("", &facets);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.stl");
        std::fs::write(&path, &bytes).expect("a file");
        let in_place = read_mesh(&path, &|_| ()).expect("a good file");
        let Parsed { mesh, .. } = parse(&bytes).expect("a good file");
        let colored = mesh.material_of_triangle.iter().filter(|&&of| {
            let material = mesh.materials.get(of as usize);
            material.is_some_and(|material| material.color == Color([0, 0, 255]))
        });
        assert_eq!(colored.count(), 1);
        let content = |mesh| {
            let object = Object::new("a", Arc::new(mesh));
            Scene {
                objects: vec![object],
            }
            .content()
        };
        assert_eq!(content(in_place), content(Mesh::new(mesh)));
        // A file that is cut after it was looked at.
        let cut = &bytes[..bytes.len() - 1];
        let from = RandomAccess {
            read_at: &bytes_at(cut),
            length: bytes.len() as u64,
        };
        let refused = read_binary(&path, from, &Budget::default(), &|_| ());
        assert!(refused.is_err());
    }

    #[test]
    fn colors_follow_the_conventions_of_two_programs() {
        let red = 31 | 8 << 5;
        let colors = |header: &str, attributes: [u16; 2]| {
            let bytes = file(header, &[facet(A, attributes[0]), facet(B, attributes[1])]);
            let Parsed { mesh, notes, .. } = parse(&bytes).expect("a good file");
            let color = |&material: &u32| mesh.materials.get(material as usize).map(|m| m.color);
            let colors: Vec<_> = mesh.material_of_triangle.iter().map(color).collect();
            (colors, notes.last().cloned().unwrap_or_default())
        };
        let (found, note) = colors("COLOR=\u{1}\u{2}\u{3}\u{4}", [red, 0x8000]);
        assert_eq!(found, [Some(Color([255, 66, 0])), Some(Color([1, 2, 3]))]);
        assert!(note.contains("Magics"), "{note}");
        let (found, note) = colors("", [0x8000 | red, 0]);
        assert_eq!(found, [Some(Color([0, 66, 255])), None]);
        assert!(note.contains("VisCAM"), "{note}");
        let (found, note) = colors("", [7, 0]);
        assert_eq!(found, []);
        assert_eq!(note, "not used: attribute bytes of 1 facets");
    }

    #[test]
    fn several_solids_make_one_object() {
        let text = "solid a b\r\nFACET normal nan nan nan\nouter loop\nvertex 0 0 0\n\
            vertex 1 0 0\nvertex 0 1 0\nendloop endfacet endsolid a b\nsolid\nendsolid\n\
            solid c\n facet normal 0 0 1\n outer loop\n vertex -0 0.0 0\n vertex 0 1 0\n\
            vertex 0 1 1e0\n vertex 0 0 1\n endloop\n endfacet\n";
        let parsed = parse(text.as_bytes()).expect("a good file");
        assert_eq!(parsed.mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        let groups = &parsed.mesh.groups;
        assert_eq!(groups.names(), ["a b", "c"]);
        assert_eq!(
            [0, 1, 2].map(|at| groups.of(at)),
            [Some("a b"), Some("c"), Some("c")]
        );
        assert_eq!(
            parsed.notes,
            ["ASCII", "solids: 3, which are groups of one object"]
        );
        let message = "a.stl: its last solid has no `endsolid`: is it cut short?";
        assert_eq!(parsed.warnings, [message]);
    }

    #[test]
    fn says_where_and_what() {
        let check = |bytes: &[u8], expected: &str| {
            assert_eq!(parse(bytes).expect_err("a bad file"), expected);
        };
        let whole = file("", &[facet(A, 0), facet(B, 0)]);
        check(
            &whole[..whole.len() - 1],
            "a.stl: expected 2 facets, as the count at byte 80 says: 184 bytes, found 1 whole ones \
             in 183 bytes: it is cut short",
        );
        check(
            &whole[..83],
            "a.stl: expected the 84 bytes that a binary STL begins with, found 83: it is cut short",
        );
        check(&file("", &[]), "a.stl: expected facets, found none");
        check(
            b"solid a\nendsolid a\n",
            "a.stl: expected facets, found none",
        );
        let longer = [&whole[..], b"abc"].concat();
        let message = "a.stl: 3 bytes behind the last of its 2 facets, which are passed over";
        assert_eq!(parse(&longer).expect("a good file").warnings, [message]);
        let start = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
        let with = |rest: &str| format!("{start}{rest}").into_bytes();
        check(
            &with("vertex 0 x 0"),
            "a.stl:6: expected three numbers behind `vertex`, found \"x\"",
        );
        check(
            &with("vertex 0 1"),
            "a.stl:6: expected three numbers behind `vertex`, found the file's end: it is cut short",
        );
        check(
            &with("endloop\nendfacet"),
            "a.stl:7: expected three vertices in a facet, found \"endfacet\"",
        );
        check(
            &with("vertex 0 1 0\nendloop\n\n"),
            "a.stl:7: expected `endfacet`, found the file's end: it is cut short",
        );
        check(
            &with("facet"),
            "a.stl:6: expected `vertex`, `endloop` or `endfacet`, found \"facet\"",
        );
        check(
            b"solid a\nendsolid\nfacet",
            "a.stl:3: expected `solid`, found \"facet\"",
        );
    }

    #[test]
    fn triangles_are_counted_before_they_are_there() {
        let budget = Budget::new(super::super::Limits {
            triangles: 1,
            ..Default::default()
        });
        let bytes = file("", &[facet(A, 0), facet(B, 0)]);
        let message = read(Path::new("a.stl"), &bytes, &budget, &|_| ()).expect_err("too many");
        assert!(
            message.to_string().contains("limit `triangles`"),
            "{message}"
        );
    }
}
