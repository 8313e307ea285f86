//! The triangle text of the original RayCast.

use super::mesh::{as_triangle_text, check_text};

/// What must hold of triangle text.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    check_text("mesh.txt", bytes, as_triangle_text)
}
