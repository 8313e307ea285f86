use super::error::FormatError;
use super::lines::without_mark;
use super::{off, ply, prepared, stl};
use std::path::Path;

/// The format of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MeshKind {
    Obj,
    Gltf,
    Off,
    Ply,
    Prepared,
    Stl,
    Threemf,
    TriangleText,
}

/// The supported mesh formats, for messages.
const MESHES: &str = "a mesh (OBJ, glTF, PLY, STL, OFF, 3MF, triangle text, or prepared)";

/// The number of lines, not counting empty ones, that are searched for a word that identifies the format.
const LINES: usize = 200;

/// The first bytes of a GLB.
pub(super) const GLB_SIGNATURE: &[u8] = b"glTF";

/// Words that start a line of an OBJ file.
const OBJ_WORDS: [&str; 14] = [
    "v", "vt", "vn", "vp", "f", "l", "p", "o", "g", "s", "mtllib", "usemtl", "cstype", "mg",
];

/// Whether a file is a scene file: by its name, or by the version or table that it starts with.
pub(super) fn is_scene(path: &Path, bytes: &[u8]) -> bool {
    has_extension(path, "toml")
        || first_lines(bytes).next().is_some_and(|line| {
            let tables = ["[camera]", "[image]", "[shading]", "[[object]]"];
            let value = line.strip_prefix("version").map(str::trim_start);
            value.is_some_and(|value| value.starts_with('='))
                || tables.iter().any(|table| line.starts_with(table))
        })
}

/// Whether a file is the pointer that a clone without Git LFS has in place of a large file (Git LFS, docs/spec.md: less
/// than 1024 bytes, the version first).
pub(super) fn is_lfs_pointer(bytes: &[u8]) -> bool {
    bytes.len() < 1024 && bytes.starts_with(b"version https://git-lfs.github.com/spec/")
}

/// The format of a mesh file: from the content where possible, else from the extension.
///
/// # Errors
/// A file in no known mesh format; the message says what it looks like.
pub(super) fn mesh_kind(path: &Path, bytes: &[u8]) -> Result<MeshKind, FormatError> {
    let found = |what: &str| Err(FormatError::unexpected(path, None, MESHES, what));
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return found("an empty file");
    }
    if let Some(kind) = kind_by_content(bytes) {
        return Ok(kind);
    }
    if is_gltf(path, bytes) {
        return Ok(MeshKind::Gltf);
    }
    if is_threemf(path, bytes) {
        return Ok(MeshKind::Threemf);
    }
    if let Some(kind) = foreign_kind(bytes) {
        // A binary STL starts with anything, and a damaged one cannot be recognised by its length.
        if kind == BINARY && has_extension(path, "stl") {
            return Ok(MeshKind::Stl);
        }
        return found(kind);
    }
    if is_scene(path, bytes) {
        return found("a scene file");
    }
    for line in first_lines(bytes) {
        let word = line.split_whitespace().next().unwrap_or_default();
        if line.starts_with('(') {
            return Ok(MeshKind::TriangleText);
        }
        if OBJ_WORDS.contains(&word) {
            return Ok(MeshKind::Obj);
        }
    }
    if has_extension(path, "obj") {
        Ok(MeshKind::Obj)
    } else if has_extension(path, "stl") {
        Ok(MeshKind::Stl)
    } else if has_extension(path, "off") {
        Ok(MeshKind::Off)
    } else if has_extension(path, "txt") {
        Ok(MeshKind::TriangleText)
    } else {
        found("text of another kind")
    }
}

/// The kind of a mesh file that is read where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum KindInPlace {
    Prepared,
    /// A binary STL.
    Stl,
}

/// The first bytes of a file that tell a [`KindInPlace`].
pub(super) type Start = [u8; stl::HEADER];

/// The kind of a mesh file of which a part is needed at a time, by its first bytes and its length; `None` of any other.
pub(super) fn kind_in_place(path: &Path, start: &Start, length: u64) -> Option<KindInPlace> {
    if prepared::is_prepared(start) {
        Some(KindInPlace::Prepared)
    } else if ply::is_ply(start) || is_scene(path, start) {
        None
    } else {
        stl::is_binary_of(start, length).then_some(KindInPlace::Stl)
    }
}

/// Whether a file is a glTF: a GLB, or JSON with glTF's one required table.
fn is_gltf(path: &Path, bytes: &[u8]) -> bool {
    let text = without_mark(bytes).trim_ascii_start();
    bytes.starts_with(GLB_SIGNATURE)
        || (text.starts_with(b"{")
            && (has_extension(path, "gltf") || memchr::memmem::find(text, b"\"asset\"").is_some()))
}

/// Whether a file is a 3MF: a ZIP archive with a model part, whose name is not compressed.
fn is_threemf(path: &Path, bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
        && (has_extension(path, "3mf") || memchr::memmem::find(bytes, b".model").is_some())
}

/// The mesh format whose first bytes, or whose length, are unique.
fn kind_by_content(bytes: &[u8]) -> Option<MeshKind> {
    if prepared::is_prepared(bytes) {
        Some(MeshKind::Prepared)
    } else if ply::is_ply(bytes) {
        Some(MeshKind::Ply)
    } else if stl::is_binary(bytes) || stl::is_ascii(bytes) {
        Some(MeshKind::Stl)
    } else if off::is_off(bytes) {
        Some(MeshKind::Off)
    } else {
        None
    }
}

/// The description of an unknown binary file.
const BINARY: &str = "binary data";

/// What a file in no known mesh format looks like; `None` where nothing identifies it.
pub(super) fn foreign_kind(bytes: &[u8]) -> Option<&'static str> {
    const SIGNATURES: [(&[u8], &str); 15] = [
        (b"\x89PNG", "a PNG image"),
        (b"\xff\xd8\xff", "a JPEG image"),
        (b"\x76\x2f\x31\x01", "an OpenEXR image"),
        (b"GIF8", "a GIF image"),
        (b"II*\0", "a TIFF image"),
        (b"MM\0*", "a TIFF image"),
        (b"RIFF", "a RIFF file (WebP, perhaps)"),
        (GLB_SIGNATURE, "a GLB mesh"),
        (b"Kaydara FBX Binary", "an FBX file"),
        (b"BLENDER", "a Blender file"),
        (b"PK\x03\x04", "a ZIP archive"),
        (b"\x1f\x8b", "a gzip archive"),
        (b"%PDF", "a PDF document"),
        (b"\xff\xfe", "UTF-16 text"),
        (b"\xfe\xff", "UTF-16 text"),
    ];
    let head = &bytes[..bytes.len().min(4096)];
    if let Some((_, kind)) = SIGNATURES
        .iter()
        .find(|(signature, _)| head.starts_with(signature))
    {
        return Some(kind);
    }
    if let [b'P', b'1'..=b'6', space, ..] = head
        && space.is_ascii_whitespace()
    {
        return Some("a PNM image");
    }
    match kind_by_content(bytes) {
        Some(MeshKind::Prepared) => return Some("a prepared mesh"),
        Some(MeshKind::Ply) => return Some("a PLY mesh"),
        Some(MeshKind::Stl) => return Some("an STL mesh"),
        Some(MeshKind::Off) => return Some("an OFF mesh"),
        _ => {}
    }
    let text = String::from_utf8_lossy(head);
    let text = text.trim_start();
    if text.starts_with('<') {
        return Some("XML or HTML");
    }
    head.contains(&0).then_some(BINARY)
}

/// The first lines that are neither empty nor comments, trimmed.
fn first_lines(bytes: &[u8]) -> impl Iterator<Item = String> {
    without_mark(bytes)
        .split(|&b| b == b'\n' || b == b'\r')
        // Splitting at both bytes of Windows' line ends gives empty lines, which must not count.
        .filter(|line| !line.is_empty())
        .take(LINES)
        .map(|line| {
            String::from_utf8_lossy(&line[..line.len().min(256)])
                .trim()
                .to_owned()
        })
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
}

/// Whether a file's name has this extension, in any case.
fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension()
        .is_some_and(|found| found.eq_ignore_ascii_case(extension))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_that_are_read_in_place_are_told_by_their_start() {
        let file = |header: &[u8]| {
            let mut start = [0; stl::HEADER];
            start[..header.len()].copy_from_slice(header);
            start[80] = 2;
            start
        };
        let kind = |header: &[u8], length| kind_in_place(Path::new("a"), &file(header), length);
        assert_eq!(kind(b"solid", 184), Some(KindInPlace::Stl));
        assert_eq!(kind(b"\x1f\x8b", 184), Some(KindInPlace::Stl));
        assert_eq!(kind(b"solid", 185), None);
        assert_eq!(kind(b"ply\n", 184), None);
        assert_eq!(kind(b"version = 1\n", 184), None);
        assert_eq!(kind_in_place(Path::new("a.toml"), &file(b""), 184), None);
    }

    #[test]
    fn content_goes_before_extension() {
        let kind = |name: &str, text: &str| mesh_kind(Path::new(name), text.as_bytes()).ok();
        let (obj, text) = (Some(MeshKind::Obj), Some(MeshKind::TriangleText));
        assert_eq!(kind("a.txt", "# made by hand\r\n\r\nv 0 0 0\n"), obj);
        assert_eq!(kind("a.obj", "\n (0,0,0);(1,0,0);(0,1,0)"), text);
        assert_eq!(kind("a", "\u{feff}v 0 0 0"), obj);
        assert_eq!(kind("a.OBJ", "nothing of note"), obj);
        assert_eq!(kind("a.txt", "nothing of note"), text);
        assert_eq!(
            kind("a.obj", "ply\r\nformat ascii 1.0\n"),
            Some(MeshKind::Ply)
        );
        assert_eq!(kind("a", "# c\nCOFF\n"), Some(MeshKind::Off));
        assert_eq!(kind("a.off", "3 1 0\n"), Some(MeshKind::Off));
        let stl = Some(MeshKind::Stl);
        assert_eq!(kind("a", "solid cube\n facet normal 0 0 1\n"), stl);
        let binary = [&b"solid"[..], &[0; 75], &[1, 0, 0, 0], &[9; 50]].concat();
        assert_eq!(mesh_kind(Path::new("a.obj"), &binary).ok(), stl);
        let cut = &binary[..100];
        assert_eq!(mesh_kind(Path::new("a.stl"), cut).ok(), stl);
        assert!(mesh_kind(Path::new("a.obj"), cut).is_err());
        let gltf = Some(MeshKind::Gltf);
        assert_eq!(kind("a.obj", "glTF\u{2}\0\0\0"), gltf);
        assert_eq!(kind("a", " {\"x\": 1, \"asset\": {}}"), gltf);
        assert_eq!(kind("a.gltf", "{}"), gltf);
        assert_eq!(kind("a.json", "{}"), None);
        let archive = "PK\u{3}\u{4}";
        assert_eq!(kind("a.3mf", archive), Some(MeshKind::Threemf));
        assert_eq!(
            kind("a.zip", &format!("{archive}3D/x.model")),
            Some(MeshKind::Threemf)
        );
        assert_eq!(kind("a.zip", archive), None);
        assert_eq!(kind("a.md", "nothing of note"), None);
        // The same number of lines is searched for all line ends.
        for line in ["# c\n", "# c\r\n", "# c\r"] {
            let after = |lines| kind("a.obj", &(line.repeat(lines) + "(0,0,0);(1,0,0);(0,1,0)"));
            assert_eq!((after(LINES - 1), after(LINES)), (text, obj), "{line:?}");
        }
    }

    #[test]
    fn files_in_other_formats_are_named_in_the_error() {
        let check = |bytes: &[u8], expected: &str| {
            let error = mesh_kind(Path::new("a.obj"), bytes).expect_err("no mesh");
            let message = error.to_string();
            assert!(message.contains(expected), "{message}");
            assert!(message.starts_with("a.obj: expected a mesh"), "{message}");
        };
        check(b"", "an empty file");
        check(b" \r\n ", "an empty file");
        check(b"\x89PNG\r\n\x1a\n", "PNG");
        check(b"\xff\xd8\xff\xe0\x00\x10JFIF", "JPEG");
        check(b"\x76\x2f\x31\x01\x02", "OpenEXR");
        check(b"P6\n1 1\n255\n", "PNM");
        check(b"PK\x03\x04", "a ZIP archive");
        check(b"\x7fELF\x02\0", "binary data");
        check(b"[camera]\neye = [0, 0, 1]\n", "a scene file");
    }

    #[test]
    fn scenes_start_with_a_table_or_their_version() {
        let is = |text: &str| is_scene(Path::new("-"), text.as_bytes());
        assert!(is("# made by hand\nversion=1\n") && is("version = 1\n") && is("[[object]]\n"));
        assert!(!is("version https://git-lfs.github.com/spec/v1\n"));
        assert!(!is("versions = 1\n") && !is("version"));
    }
}
