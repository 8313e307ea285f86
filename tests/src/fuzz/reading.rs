//! Reading scenes from files in memory.

use raycast_core::formats::{SceneFile, read_scene_from};

/// What a reader makes of a file: a scene, or the message with which it refuses.
pub type Reading = Result<SceneFile, String>;

/// A small mesh with everything that an OBJ can have, for scenes to name.
pub const MESH: &str = "mtllib a.mtl\nusemtl a\nv -1 -1 0\nv 1 -1 0\nv 1 1 0.5\nv -1 1 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nvn 0 0.6 0.8\nf 1/1/1 2/2/1 3/3/2\n\
    usemtl b\nf 1/1/1 3/3/2 4/4/1\n";

/// Its materials.
pub const LIBRARY: &str = "newmtl a\nKd 1 0.5 0\nmap_Kd t.ppm\nnewmtl b\nKd 0 0.5 1\n";

/// A small image.
pub const IMAGE: &str = "P3\n2 2\n255\n255 0 0 0 255 0 0 0 255 250 250 10\n";

/// One of the files that a fuzzer starts with.
#[cfg(test)]
pub(super) fn seed(target: &str, name: &str) -> Vec<u8> {
    let seeds = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/seeds");
    crate::files::bytes(&seeds.join(target).join(name))
}

/// Reads a scene whose files are `files`, by name.
///
/// # Errors
/// A refusal, or a warning, that is not one printable line.
pub fn read(toml: &str, files: &dyn Fn(&str) -> Option<Vec<u8>>) -> Result<Reading, String> {
    let reading = read_scene_from(toml, files).map_err(|error| error.to_string());
    match &reading {
        Ok(file) => file.warnings.iter().try_for_each(|line| is_message(line))?,
        Err(message) => is_message(message)?,
    }
    Ok(reading)
}

/// Reads the bytes of a mesh file of this name, with [`LIBRARY`] and [`IMAGE`] for whatever library or
/// image it names.
///
/// # Errors
/// As [`read`].
pub fn read_mesh(name: &str, bytes: &[u8]) -> Result<Reading, String> {
    let files = |named: &str| {
        if named == name {
            Some(bytes.to_vec())
        } else if named.ends_with(".mtl") {
            Some(LIBRARY.into())
        } else {
            named.ends_with(".ppm").then(|| IMAGE.into())
        }
    };
    read(&format!("[[object]]\nmesh = \"{name}\"\n"), &files)
}

/// The same text as Windows ends its lines. `None` where that is no question: there are no lines, or
/// this is no text.
pub fn with_windows_lines(bytes: &[u8]) -> Option<Vec<u8>> {
    // In UTF-16 the byte may be half of any other character.
    let is_utf_16 = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    // A prepared mesh's signature has line ends, so that a transfer as text is found out.
    let is_prepared = bytes.starts_with(b"\x89RAYCAST");
    let is_packed = bytes.starts_with(b"\x1f\x8b") || bytes.starts_with(b"\x28\xb5\x2f\xfd");
    let is_text = !(is_utf_16 || is_prepared || is_packed);
    if !bytes.contains(&b'\n') || bytes.contains(&0) || !is_text {
        return None;
    }
    let mut windows = Vec::with_capacity(bytes.len() + bytes.len() / 8);
    for &byte in bytes {
        // A line that ends so already stays as it is: two returns would be two lines.
        if byte == b'\n' && windows.last() != Some(&b'\r') {
            windows.push(b'\r');
        }
        windows.push(byte);
    }
    Some(windows)
}

/// Whether a message is one line that a terminal can show: names and text from files come quoted.
///
/// # Errors
/// What it is instead.
pub fn is_message(message: &str) -> Result<(), String> {
    if message.trim().is_empty() || message.chars().any(char::is_control) {
        return Err(format!("a message that is not one line: {message:?}"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_scenes_name_can_be_read() {
        let file = read_mesh("a.obj", MESH.as_bytes())
            .expect("fit messages")
            .expect("a good mesh");
        let mesh = &file.scene.objects[0].mesh;
        assert_eq!(mesh.kept(), [0, 1]);
        assert!(mesh.has_normals() && mesh.has_uvs() && mesh.materials().len() == 2);
        assert_eq!(file.warnings, [""; 0]);
        let textured = (mesh.materials().iter()).filter(|material| material.texture.is_some());
        assert_eq!(textured.count(), 1);
    }

    #[test]
    fn messages_of_several_lines_are_faults() {
        assert_eq!(is_message("a.obj:1: expected"), Ok(()));
        for bad in ["", " ", "two\nlines", "a\u{1b}[2Jb"] {
            assert!(is_message(bad).is_err(), "{bad:?}");
        }
    }

    #[test]
    fn lines_end_as_on_windows() {
        let windows = Some(b"a\r\nb\r\n".to_vec());
        assert_eq!(with_windows_lines(b"a\nb\n"), windows);
        assert_eq!(with_windows_lines(b"a\r\nb\n"), windows);
        assert_eq!(with_windows_lines(b"a"), None);
    }
}
