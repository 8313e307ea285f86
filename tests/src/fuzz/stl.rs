//! STL files.

use super::mesh;

/// What must hold of such a file.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    mesh::check("mesh.stl", bytes, |bytes| bytes.starts_with(b"solid"))
}
