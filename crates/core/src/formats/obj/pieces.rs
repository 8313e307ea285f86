//! Parallel reading of a long OBJ file: in pieces that are then joined.

use super::content::{Counts, NONE, ObjText, is_beyond};
use super::reader::{INHERITED, RELATIVE, Reader};

use crate::formats::Progress;
use crate::formats::limits::Allowance;
use crate::formats::lines::without_mark;
use crate::formats::lines::{Lines, decode};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The least bytes of a piece. Handing a piece to a thread and joining it costs some microseconds, parsing so many
/// bytes a millisecond. With smaller pieces that overhead shows; with larger ones files of a few pieces leave threads
/// idle.
const PIECE: usize = 256 << 10;

/// Pieces a thread. With more than one, the last pieces balance the load; more than a few only add overhead.
const PIECES_A_THREAD: usize = 4;

/// Reads a file in parallel. `None` where it is short, contains any fault (a sequential reading then finds the first
/// one), or has a piece with both absolute and relative indices.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    allowance: &Allowance,
    progress: Progress<'_>,
) -> Option<ObjText> {
    let most = PIECES_A_THREAD * rayon::current_num_threads();
    read_in(
        path,
        bytes,
        allowance,
        progress,
        most.min(bytes.len() / PIECE),
    )
}

fn read_in(
    path: &Path,
    bytes: &[u8],
    allowance: &Allowance,
    progress: Progress<'_>,
    count: usize,
) -> Option<ObjText> {
    if count < 2 {
        return None;
    }
    let done = AtomicUsize::new(0);
    let pieces = cut(without_mark(bytes), count);
    let read: Option<Vec<Reader<'_>>> = pieces
        .par_iter()
        .map(|piece| {
            let text = decode(piece);
            let copied = match &text {
                Cow::Borrowed(_) => 0,
                Cow::Owned(text) => text.capacity(),
            };
            let mut reader = Reader::for_piece(path, allowance, copied);
            reader.lines(&text, &|_| ()).ok()?;
            let done = done.fetch_add(piece.len(), Ordering::Relaxed) + piece.len();
            progress(done as f32 / bytes.len() as f32);
            let is_plain = reader.first_fault.is_none() && reader.has_indices != [true; 2];
            is_plain.then_some(reader)
        })
        .collect();
    let (mut out, faces_with) = join(read?, allowance)?;
    if out.open_end.is_some() {
        // The line was counted from the start of the last piece.
        let lines_before: usize = pieces[..pieces.len() - 1]
            .par_iter()
            .map(|piece| Lines::new(&decode(piece)).count())
            .sum();
        out.open_end = out.open_end.map(|line| line + lines_before);
    }
    out.count_dangling(faces_with);
    Some(out)
}

/// Splits a text into at most `count` pieces of about the same length, after line feeds that end a line.
fn cut(bytes: &[u8], count: usize) -> Vec<&[u8]> {
    let mut pieces = Vec::with_capacity(count);
    let mut rest = bytes;
    for left in (2..=count).rev() {
        let mut end = rest.len() / left;
        while let Some(feed) = memchr::memchr(b'\n', &rest[end..]) {
            let line = rest[..end + feed].trim_ascii_end();
            end += feed + 1;
            // A line feed after a backslash does not end the line; before a non-ASCII byte there may be another line
            // separator.
            if line
                .last()
                .is_none_or(|&byte| byte.is_ascii() && byte != b'\\')
            {
                let piece;
                (piece, rest) = rest.split_at(end);
                pieces.push(piece);
                break;
            }
        }
    }
    pieces.push(rest);
    pieces
}

/// Joins pieces, and counts their faces with texture coordinates only, with normals only, and with both. `None` where
/// an index is out of range.
fn join(pieces: Vec<Reader<'_>>, allowance: &Allowance) -> Option<(ObjText, [usize; 3])> {
    let mut highest = [0; 3];
    let mut totals = [0; 3];
    let mut triangles = 0;
    for piece in &pieces {
        if (0..3).any(|kind| totals[kind] + piece.lowest[kind] < 0) {
            return None;
        }
        for kind in 0..3 {
            highest[kind] = highest[kind].max(piece.highest[kind]);
            totals[kind] += piece.totals()[kind];
        }
        triangles += piece.out.triangles.len();
    }
    let is_too_much = totals.iter().any(|&total| total >= RELATIVE);
    if is_beyond(highest, totals) || is_too_much || triangles as u64 > allowance.triangles() {
        return None;
    }
    let mut out = ObjText::default();
    out.positions.try_reserve_exact(totals[0] as usize).ok()?;
    out.uvs.try_reserve_exact(totals[1] as usize).ok()?;
    out.normals.try_reserve_exact(totals[2] as usize).ok()?;
    out.triangles.try_reserve_exact(triangles).ok()?;
    let mut faces_with = [0; 3];
    let mut names = HashMap::new();
    let mut material = NONE;
    for piece in pieces {
        for (sum, count) in faces_with.iter_mut().zip(piece.faces_with) {
            *sum += count;
        }
        material = append(&mut out, piece, &mut names, material);
    }
    Some((out, faces_with))
}

/// Appends a piece and empties it. `material` is the one before the piece; returns the one at its end.
fn append(
    out: &mut ObjText,
    mut piece: Reader<'_>,
    names: &mut HashMap<String, u32>,
    material: u32,
) -> u32 {
    let before: Counts = [
        out.positions.len() as i64,
        out.uvs.len() as i64,
        out.normals.len() as i64,
    ];
    let first = out.triangles.len();
    let is_relative = piece.has_indices[1];
    let last_material = piece.material;
    let mut piece = std::mem::take(&mut piece.out);
    if is_relative {
        // All are in range: `join` has checked the lowest, and relative indices refer backwards.
        let lists = [
            &mut piece.triangles,
            &mut piece.uv_triangles,
            &mut piece.normal_triangles,
        ];
        for (list, before) in lists.into_iter().zip(before) {
            for index in list.iter_mut().flatten() {
                if *index != NONE {
                    *index = (i64::from(*index) - RELATIVE + before) as u32;
                }
            }
        }
    }
    if !piece.colors.is_empty() {
        out.colors.resize(out.positions.len(), None);
        out.colors.append(&mut piece.colors);
    }
    out.positions.append(&mut piece.positions);
    out.uvs.append(&mut piece.uvs);
    out.normals.append(&mut piece.normals);
    let triangles = piece.triangles.len();
    out.triangles.append(&mut piece.triangles);
    for (all, list) in [
        (&mut out.uv_triangles, &mut piece.uv_triangles),
        (&mut out.normal_triangles, &mut piece.normal_triangles),
    ] {
        if !list.is_empty() {
            all.resize(first, [NONE; 3]);
            all.append(list);
        }
    }
    out.polygons
        .extend(piece.polygons.into_iter().map(|mut polygon| {
            polygon.first += first as u32;
            polygon
        }));
    out.libraries.append(&mut piece.libraries);
    let numbers: Vec<u32> = piece
        .materials
        .into_iter()
        .map(|name| {
            let next = names.len() as u32;
            *names.entry(name).or_insert_with_key(|name| {
                out.materials.push(name.clone());
                next
            })
        })
        .collect();
    let number = |local: u32| match local {
        NONE => NONE,
        INHERITED => material,
        local => numbers[local as usize],
    };
    for (start, local) in piece.material_runs {
        let number = number(local);
        if out.material_runs.last().map_or(NONE, |run| run.1) != number {
            out.material_runs.push((start + first as u32, number));
        }
    }
    out.groups.append(piece.groups, first, triangles);
    out.open_end = piece.open_end;
    out.oddities.add(piece.oddities);
    number(last_material)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::limits::{Budget, Limits};
    use crate::random::Random;

    fn below(random: &mut Random, count: usize) -> usize {
        (random.unit() * count as f64) as usize
    }

    fn in_pieces(source: &[u8], count: usize) -> Option<ObjText> {
        let path = Path::new("a.obj");
        read_in(path, source, &Budget::default().allowance(), &|_| (), count)
    }

    /// All contents of a file as text; `None` where it is refused.
    fn in_one(source: &[u8]) -> Option<String> {
        let path = Path::new("a.obj");
        let out = crate::formats::obj::text::read(path, source, &Budget::default(), &|_| ());
        out.ok().map(|out| format!("{out:?}"))
    }

    /// Random lines of an OBJ file with all its features, mostly valid.
    fn random_lines(random: &mut Random, is_relative: bool) -> Vec<u8> {
        let mut text = Vec::new();
        let mut totals = [3, 2, 2];
        text.extend_from_slice(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\nvn 1 0 0\n");
        for _ in 0..40 {
            let line = match below(random, 13) {
                0..3 => {
                    totals[0] += 1;
                    let more = ["", " 1", " 0 0.5 1", " 0 0 2", " 1 1 1 1"][below(random, 5)];
                    format!("v {} 1e-3 -2.5{more}", below(random, 100))
                }
                3 => {
                    totals[1] += 1;
                    format!("vt 0.{}", below(random, 10))
                }
                4 => {
                    totals[2] += 1;
                    format!("vn 0 {} 1", below(random, 10))
                }
                5..10 => {
                    let kinds = below(random, 4);
                    let mut face = "f".to_owned();
                    for _ in 0..3 + below(random, 3) {
                        let [v, vt, vn] = totals.map(|total| {
                            let index = 1 + below(random, total) as i64;
                            if is_relative { -index } else { index }
                        });
                        face.push_str(&match kinds {
                            0 => format!(" {v}"),
                            1 => format!(" {v}/{vt}"),
                            2 => format!(" {v}//{vn}"),
                            _ => format!(" {v}/{vt}/{vn}"),
                        });
                        if below(random, 20) == 0 {
                            face.push_str(" \\\n");
                        }
                    }
                    face
                }
                10 => format!("usemtl m{}", below(random, 4)),
                11 => {
                    let name = ["", " a", " b c", " d"][below(random, 4)];
                    ["g", "o"][below(random, 2)].to_owned() + name
                }
                _ => ["# a \\", "mtllib a.mtl", "o x", "", "s 1", "g \u{feff}"][below(random, 6)]
                    .to_owned(),
            };
            text.extend_from_slice(line.as_bytes());
            text.extend_from_slice([&b"\n"[..], b"\r\n", b"\n", b"\n\n"][below(random, 4)]);
        }
        if below(random, 2) == 0 {
            while text.last().is_some_and(u8::is_ascii_whitespace) {
                text.pop();
            }
        }
        text
    }

    #[test]
    fn reading_in_pieces_equals_reading_the_whole_file() {
        let random = &mut Random(16);
        let mut compared = [0; 2];
        for round in 0..2000 {
            let is_relative = round % 2 == 1;
            let mut source = random_lines(random, is_relative);
            if below(random, 4) == 0 {
                // Any byte may be changed.
                let at = below(random, source.len());
                source[at] = b"\n\\ 9-/\xe9#vf"[below(random, 10)];
            }
            let whole = in_one(&source);
            for count in 2..6 {
                if let Some(out) = in_pieces(&source, count) {
                    let source = String::from_utf8_lossy(&source);
                    assert_eq!(
                        Some(format!("{out:?}")),
                        whole,
                        "{count} pieces of {source}"
                    );
                    compared[usize::from(is_relative)] += 1;
                }
            }
        }
        assert!(compared.iter().all(|&count| count > 2000), "{compared:?}");
    }

    #[test]
    fn pieces_end_where_lines_do() {
        let check = |source: &str, count: usize, expected: &[&str]| {
            let pieces: Vec<_> = cut(source.as_bytes(), count)
                .into_iter()
                .map(String::from_utf8_lossy)
                .collect();
            assert_eq!(pieces, expected);
        };
        check("ab\ncd\nef\n", 3, &["ab\ncd\n", "ef\n", ""]);
        check("ab\\\ncd\nef", 3, &["ab\\\ncd\n", "ef"]);
        check("ab\\ \r\ncd\r\nef", 2, &["ab\\ \r\ncd\r\n", "ef"]);
        check("ab\rcd\ref", 3, &["ab\rcd\ref"]);
        check("abcdef\n", 3, &["abcdef\n", ""]);
    }

    #[test]
    fn all_pieces_together_are_within_the_limits() {
        let source = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\nf 1 2 3\nf 1 2 3\n";
        let within = |limits| {
            let allowance = Budget::new(limits).allowance();
            read_in(Path::new("a.obj"), source, &allowance, &|_| (), 2).is_some()
        };
        let limits = Limits::default();
        assert!(within(Limits {
            triangles: 4,
            ..limits
        }));
        assert!(!within(Limits {
            triangles: 3,
            ..limits
        }));
        // Three positions and four triangles, each three times.
        assert!(within(Limits {
            bytes: 360,
            ..limits
        }));
        assert!(!within(Limits {
            bytes: 359,
            ..limits
        }));
    }

    #[test]
    fn the_line_without_an_end_is_counted_from_the_first_piece() {
        let source = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1";
        let out = in_pieces(source, 3).expect("a good file");
        assert_eq!(out.open_end, Some(5));
    }
}
