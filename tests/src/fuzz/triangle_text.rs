//! The triangle text of the original RayCast.

use super::mesh::{are_equal, as_triangle_text, is_sound, only_mesh, reads_again};
use super::picture::is_seen_soundly;
use super::reading::{read_mesh, with_windows_lines};

/// The name under which the bytes are read.
const NAME: &str = "mesh.txt";

/// What must hold of triangle text.
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
    reads_again(mesh, NAME, as_triangle_text)?;
    is_seen_soundly(&file)
}
