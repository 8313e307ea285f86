//! Reading an OBJ file's lines: in parallel where possible, else sequentially.

use super::content::{ObjText, is_beyond};
use super::pieces;
use super::reader::Reader;
use crate::formats::Progress;
use crate::formats::error::FormatError;
use crate::formats::limits::Budget;
use crate::formats::lines::text;
use std::borrow::Cow;
use std::path::Path;

/// Reads the lines of an OBJ file.
///
/// # Errors
/// The first bad line: too few words, a word that should be a number, a face with fewer than three corners, an index
/// out of the whole file's range. An exhausted budget.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<ObjText, FormatError> {
    if let Some(out) = pieces::read(path, bytes, &budget.allowance(), progress) {
        return Ok(out);
    }
    let text = text(bytes);
    let copied = match &text {
        Cow::Borrowed(_) => 0,
        Cow::Owned(text) => text.capacity(),
    };
    let allowance = budget.allowance();
    let mut reader = Reader::for_file(path, &allowance, copied);
    let stopped = reader.lines(&text, progress).err();
    let totals = reader.totals();
    if stopped.is_none() && is_beyond(reader.highest, totals) {
        // Only at the end is it known that an index is out of range. A second reading finds the first line with such
        // an index or another fault.
        let allowance = budget.allowance();
        let mut again = Reader::for_file(path, &allowance, copied);
        again.known_totals = Some(totals);
        again.lines(&text, &|_| ())?;
    }
    if let Some(fault) = reader.first_fault.take().or(stopped) {
        return Err(fault);
    }
    reader.out.count_dangling(reader.faces_with);
    Ok(reader.out)
}

#[cfg(test)]
mod tests {
    use super::super::reader::VERTEX;
    use super::*;
    use crate::scene::Color;
    use glam::{DVec3, Vec2};

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
    fn lines_that_are_no_faces_are_skipped() {
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
            let message = text(source).expect_err(source);
            let location = format!("a.obj:{line}: expected {expected}");
            assert!(message.starts_with(&location), "{source:?}: {message}");
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
        // A vertex's weight does not change its position.
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
            let message = within(3, faces).expect_err("too many");
            assert!(
                message.ends_with("at most 3 are allowed (limit `triangles`)"),
                "{message}"
            );
        }
        let budget = Budget::new(crate::formats::Limits {
            bytes: 1000,
            ..Default::default()
        });
        let source = "v 0 0 0\n".repeat(20) + "f 1 2 3\n";
        let message = read(Path::new("a.obj"), source.as_bytes(), &budget, &|_| ())
            .expect_err("too many bytes");
        assert!(message.to_string().contains("limit `bytes`"), "{message}");
    }
}
