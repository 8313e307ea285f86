//! glTF files, and GLBs.

use super::placed::is_placed_soundly;
use super::reading::{IMAGE, Reading, read};

/// The name under which the bytes are read.
const NAME: &str = "mesh.gltf";

/// What must hold of a glTF file.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let read = |scene: &str| read_with(scene, bytes);
    match read(&format!("[[object]]\nmesh = \"{NAME}\"\n"))? {
        Ok(file) => is_placed_soundly(&file, read),
        Err(_) => Ok(()),
    }
}

/// Reads a scene; whatever buffer or image the file names is there.
fn read_with(scene: &str, bytes: &[u8]) -> Result<Reading, String> {
    let files = |name: &str| match name {
        NAME => Some(bytes.to_vec()),
        _ if name.ends_with(".ppm") => Some(IMAGE.into()),
        _ => Some((0..=255).collect()),
    };
    read(scene, &files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzz::reading::seed;

    /// A seed that is refused leads nowhere.
    #[test]
    fn seeds_are_good_files() {
        for (name, objects) in [
            ("square", 1),
            ("tree", 3),
            ("everything", 1),
            ("beside", 2),
            ("binary", 1),
        ] {
            let bytes = seed("gltf", name);
            let scene = format!("[[object]]\nmesh = \"{NAME}\"\n");
            let file = read_with(&scene, &bytes).expect("fit messages");
            let file = file.unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(file.scene.objects.len(), objects, "{name}");
        }
    }
}
