//! The triangle text of the original RayCast: `(x,y,z);(x,y,z);(x,y,z)`, a face a line.

use super::Progress;
use super::error::{FormatError, quote};
use super::kind::without_mark;
use crate::scene::MeshData;
use glam::DVec3;
use std::collections::HashMap;
use std::path::Path;

/// Reads triangle text: three or more vertices a line, polygons cut into fans. Space may stand
/// around every number and vertex; blank lines and lines that start with `#` are passed over.
/// Equal vertices become one.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    progress: Progress<'_>,
) -> Result<MeshData, FormatError> {
    let bytes = without_mark(bytes);
    let mut mesh = MeshData::default();
    let mut index_of: HashMap<[u64; 3], u32> = HashMap::new();
    let mut face = Vec::new();
    let mut done = 0;
    for (index, line) in bytes.split(|&b| b == b'\n').enumerate() {
        done += line.len() + 1;
        if index % 16_384 == 0 {
            progress(done as f32 / bytes.len().max(1) as f32);
        }
        let line = String::from_utf8_lossy(line);
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fault = |(expected, found): (&str, String)| {
            FormatError::unexpected(path, Some(index + 1), expected, found)
        };
        face.clear();
        read_face(line, &mut face).map_err(fault)?;
        let mut corners = face.iter().map(|&position| {
            // Adding zero makes one zero of the two.
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
    }
    if mesh.triangles.is_empty() {
        return Err(FormatError::unexpected(
            path,
            None,
            "faces (lines of `(x,y,z);(x,y,z);(x,y,z)`)",
            "none",
        ));
    }
    Ok(mesh)
}

/// Reads the vertices of one line; what was expected and what was found where it is not one.
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
        read(Path::new("a.txt"), text.as_bytes(), &|_| ()).map_err(|error| error.to_string())
    }

    #[test]
    fn reads_faces_and_shares_vertices() {
        let mesh = parse(
            "(0,0,0);(1,0,0);(0,1,0)\r\n\r\n ( 0.1 , -2.5e3 ,0) ; (1,0,0);(-0,0,0);(0,1,0);(7,7,7);\n",
        )
        .expect("good text");
        assert_eq!(mesh.triangles, [[0, 1, 2], [3, 1, 0], [3, 0, 2], [3, 2, 4]]);
        assert_eq!(mesh.positions[3], DVec3::new(0.1, -2500.0, 0.0));
        assert_eq!(mesh.positions.len(), 5);
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
            "# nothing",
            "a.txt: expected faces (lines of `(x,y,z);(x,y,z);(x,y,z)`), found none",
        );
    }
}
