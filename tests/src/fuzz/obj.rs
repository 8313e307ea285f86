//! OBJ files.

use super::mesh::{are_equal, as_obj, is_sound, only_mesh, reads_again};
use super::picture::is_seen_soundly;
use super::reading::{read_mesh, with_windows_lines};

/// The name under which the bytes are read; written again they have another.
const NAME: &str = "mesh.obj";

/// What must hold of an OBJ file.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let reading = read_mesh(NAME, bytes)?;
    if let Some(windows) = with_windows_lines(bytes) {
        are_equal(&reading, &read_mesh(NAME, &windows)?)
            .map_err(|difference| format!("with Windows' lines {difference}"))?;
    }
    let Ok(file) = reading else {
        return Ok(());
    };
    let mesh = only_mesh(&file);
    is_sound(mesh)?;
    reads_again(mesh, NAME, as_obj)?;
    is_seen_soundly(&file)
}
