//! Prepared meshes, whose checksum and length are made right: a change to a file's bytes never leaves them so.

use super::placed::is_placed_soundly;
use super::reading::{Reading, read};
use raycast_core::digest::Digest;
use raycast_core::formats::{SceneFile, write_prepared};
use std::path::Path;

/// The name under which the bytes are read.
const NAME: &str = "mesh.raycast";

/// Where the length stands, and what is before the contents: magic, version, program.
const LENGTH: std::ops::Range<usize> = 36..44;

/// Bytes of the checksum behind all.
const CHECKSUM: usize = 16;

/// What must hold of a prepared mesh.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let bytes = signed(bytes);
    let files = |name: &str| (name == NAME).then(|| bytes.clone());
    let read = |scene: &str| -> Result<Reading, String> { read(scene, &files) };
    let Ok(file) = read(&format!("[[object]]\nmesh = \"{NAME}\"\n"))? else {
        return Ok(());
    };
    is_placed_soundly(&file, read)?;
    prepares_again(&file)
}

/// The file with length and checksum made right: of less than a block of a MiB, the digest of one digest.
fn signed(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    let length = bytes.len() as u64;
    if bytes.len() < LENGTH.end + CHECKSUM {
        return bytes;
    }
    bytes[LENGTH].copy_from_slice(&length.to_le_bytes());
    let end = bytes.len() - CHECKSUM;
    let sum = Digest::of(&Digest::of(&bytes[..end]).to_bytes());
    bytes[end..].copy_from_slice(&sum.to_bytes());
    bytes
}

/// Whether what was read is prepared and read again as the same.
fn prepares_again(file: &SceneFile) -> Result<(), String> {
    let mut bytes = Vec::new();
    write_prepared(file, Path::new(NAME), &mut bytes)
        .map_err(|error| format!("not prepared again: {error}"))?;
    let files = |name: &str| (name == NAME).then(|| bytes.clone());
    let again = read(&format!("[[object]]\nmesh = \"{NAME}\"\n"), &files)?
        .map_err(|error| format!("prepared again, it is refused: {error}"))?;
    if again.scene.content() != file.scene.content() {
        return Err("prepared again it is another scene".to_owned());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzz::reading::seed;

    /// A seed that is refused leads nowhere.
    #[test]
    fn seeds_are_good_files() {
        for (name, objects) in [
            ("everything", 1),
            ("objects", 4),
            ("scalars", 1),
            ("textured", 1),
        ] {
            let bytes = seed("prepared", name);
            assert_eq!(signed(&bytes), bytes, "{name}: what is right stays");
            let files = |_: &str| Some(bytes.clone());
            let file = read(&format!("[[object]]\nmesh = \"{NAME}\"\n"), &files);
            let file = file.expect("fit messages");
            let file = file.unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(file.scene.objects.len(), objects, "{name}");
        }
    }
}
