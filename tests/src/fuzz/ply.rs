//! PLY files, packed ones too.

use super::mesh;

/// What must hold of such a file.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    mesh::check("mesh.ply", bytes, |bytes| {
        let header = &bytes[..bytes.len().min(40)];
        header.windows(12).any(|words| words == b"format ascii")
    })
}
