//! OBJ files.

use super::mesh::{as_obj, check_text};

/// What must hold of an OBJ file.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    check_text("mesh.obj", bytes, as_obj)
}
