//! The triangle text of the original RayCast: `(x,y,z);(x,y,z);(x,y,z)`, a face a line.

use super::Progress;
use super::error::{FormatError, quote};
use super::limits::Budget;
use super::lines::{Lines, text};
use super::polygon::{self, Polygon};
use crate::scene::MeshData;
use glam::DVec3;
use std::collections::HashMap;
use std::mem::size_of;
use std::path::Path;

/// Reads triangle text: three or more vertices a line. White space may surround every number and vertex; blank lines
/// and lines that start with `#` are skipped. Equal vertices become one. Also returns warnings.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<(MeshData, Vec<String>), FormatError> {
    // A vertex and its entry in the hash map, which is at least a third full; all doubled as lists grow.
    const VERTEX: usize = 3 * (size_of::<DVec3>() + 3 * size_of::<([u64; 3], u32)>());
    let text = text(bytes);
    let mut mesh = MeshData::default();
    let mut polygons = Vec::new();
    let mut index_of: HashMap<[u64; 3], u32> = HashMap::new();
    let mut face = Vec::new();
    let mut share = budget.share(path, "the mesh", 0)?;
    let mut lines = Lines::new(&text);
    while let Some(line) = lines.next() {
        if line.number % 16_384 == 0 {
            let held =
                VERTEX * mesh.positions.len() + 3 * size_of::<[u32; 3]>() * mesh.triangles.len();
            share.grow(path, "the mesh", held as u64)?;
            progress(0.9 * (1.0 - lines.left() as f32 / text.len().max(1) as f32));
        }
        let words = line.text.trim();
        if words.is_empty() || words.starts_with('#') {
            continue;
        }
        let fault = |(expected, found): (&str, String)| {
            FormatError::unexpected(path, Some(line.number), expected, found)
        };
        face.clear();
        read_face(words, &mut face).map_err(fault)?;
        if line.is_cut && words.ends_with(';') {
            let found = "the file's end: it is cut short".to_owned();
            return Err(fault(("a vertex behind `;`", found)));
        }
        let first = mesh.triangles.len();
        let triangles = face.len() - 2;
        let sum = first as u64 + triangles as u64;
        if sum > budget.triangles_left() {
            budget.add_triangles(path, sum)?;
        }
        let mut corners = face.iter().map(|&position| {
            // Adding zero makes minus zero positive.
            let key = (position + DVec3::ZERO).to_array().map(f64::to_bits);
            *index_of.entry(key).or_insert_with(|| {
                mesh.positions.push(position);
                (mesh.positions.len() - 1) as u32
            })
        });
        if let (Some(first), Some(mut last)) = (corners.next(), corners.next()) {
            for corner in corners {
                mesh.triangles.push([first, last, corner]);
                last = corner;
            }
        }
        if triangles > 1 {
            polygons.push(Polygon {
                first: first as u32,
                triangles: triangles as u32,
            });
        }
    }
    if mesh.triangles.is_empty() {
        return Err(FormatError::unexpected(
            path,
            None,
            "faces (lines of `(x,y,z);(x,y,z);(x,y,z)`)",
            "none",
        ));
    }
    let uncut = polygon::cut(&mut mesh, &polygons);
    Ok((mesh, uncut.warnings(path)))
}

/// Parses the vertices of one line; the error says what was expected and what was found.
fn read_face(line: &str, face: &mut Vec<DVec3>) -> Result<(), (&'static str, String)> {
    let mut rest = line;
    loop {
        let Some(inside) = rest.strip_prefix('(') else {
            return Err(("a vertex as (x,y,z)", quote(rest)));
        };
        let Some((numbers, after)) = inside.split_once(')') else {
            return Err(("`)` at the end of a vertex", quote(inside)));
        };
        let mut coordinates = [0.0; 3];
        let mut parts = numbers.split(',');
        for coordinate in &mut coordinates {
            let part = parts
                .next()
                .ok_or_else(|| ("three numbers in a vertex", quote(numbers)))?;
            *coordinate = part.trim().parse().map_err(|_| ("a number", quote(part)))?;
        }
        if parts.next().is_some() {
            return Err(("three numbers in a vertex", quote(numbers)));
        }
        face.push(DVec3::from_array(coordinates));
        rest = after.trim_start();
        match rest.strip_prefix(';') {
            Some(next) => rest = next.trim_start(),
            None if rest.is_empty() => {}
            None => return Err(("`;` between vertices", quote(rest))),
        }
        if rest.is_empty() {
            break;
        }
    }
    if face.len() < 3 {
        return Err(("three or more vertices", face.len().to_string()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<MeshData, String> {
        let budget = Budget::default();
        read(Path::new("a.txt"), text.as_bytes(), &budget, &|_| ())
            .map(|(mesh, _)| mesh)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn reads_faces_and_shares_vertices() {
        let mesh = parse(
            "(0,0,0);(1,0,0);(0,1,0)\r\n\r\n ( 0.1 , -2.5e3 ,0) ; (1,0,0);(0,1,0);(-0,0,0);\n",
        )
        .expect("good text");
        assert_eq!(mesh.triangles, [[0, 1, 2], [3, 1, 2], [3, 2, 0]]);
        assert_eq!(mesh.positions[3], DVec3::new(0.1, -2500.0, 0.0));
        assert_eq!(mesh.positions.len(), 4);
    }

    #[test]
    fn lines_end_as_they_like() {
        let mesh =
            parse("(0,0,0);(1,0,0);(0,1,0)\r(0,0,0);(5,0,0);(0,1,0);\r\n").expect("good text");
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 3, 2]]);
    }

    #[test]
    fn an_l_is_cut_into_ears() {
        let l = "(0,0,0);(2,0,0);(2,1,0);(1,1,0);(1,3,0);(0,3,0)\n";
        let mesh = parse(l).expect("good text");
        assert_eq!(mesh.triangles.len(), 4);
        let area: f64 = mesh
            .triangles
            .iter()
            .map(|triangle| {
                let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
                (b - a).cross(c - a).z / 2.0
            })
            .inspect(|area| assert!(*area > 0.0))
            .sum();
        assert_eq!(area, 4.0);
        let (_, warnings) = read(
            Path::new("a.txt"),
            b"(0,0,0);(2,2,0);(2,0,0);(0,2,0)\n",
            &Budget::default(),
            &|_| (),
        )
        .expect("good text");
        assert_eq!(
            warnings,
            ["a.txt: faces that cross or touch themselves, which are cut as fans: 1"]
        );
    }

    #[test]
    fn says_where_and_what() {
        let check = |text: &str, expected: &str| {
            assert_eq!(parse(text).expect_err("bad text"), expected);
        };
        let good = "(0,0,0);(1,0,0);(0,1,0)\n";
        check(
            &format!("{good}\n(0,0,0);(1,0,x);(0,1,0)"),
            "a.txt:3: expected a number, found \"x\"",
        );
        check(
            &format!("{good}(0,0,0);(1,0,0)"),
            "a.txt:2: expected three or more vertices, found 2",
        );
        check(
            &format!("{good}(0,0,0);(1,0"),
            "a.txt:2: expected `)` at the end of a vertex, found \"1,0\"",
        );
        check(
            &format!("{good}(0,0);(1,0,0);(0,1,0)"),
            "a.txt:2: expected three numbers in a vertex, found \"0,0\"",
        );
        check(
            &format!("{good}(0,0,0,0);(1,0,0);(0,1,0)"),
            "a.txt:2: expected three numbers in a vertex, found \"0,0,0,0\"",
        );
        check(
            "(0,0,0) (1,0,0);(0,1,0)",
            "a.txt:1: expected `;` between vertices, found \"(1,0,0);(0,1,0)\"",
        );
        check(
            &format!("{good}(0,0,0);(1,0,0);(0,1,0);"),
            "a.txt:2: expected a vertex behind `;`, found the file's end: it is cut short",
        );
        check(
            "# nothing",
            "a.txt: expected faces (lines of `(x,y,z);(x,y,z);(x,y,z)`), found none",
        );
    }
}
