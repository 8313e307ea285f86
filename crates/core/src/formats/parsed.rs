use crate::scene::MeshData;
use std::path::PathBuf;

/// The result of reading a mesh file.
#[derive(Debug, Default)]
pub(super) struct Parsed {
    pub(super) mesh: MeshData,
    /// The image that the file gives its whole surface.
    pub(super) texture: Option<PathBuf>,
    /// Faults too small to refuse the file: a line each, with the file.
    pub(super) warnings: Vec<String>,
    /// The file's metadata, and its contents that are not used: a line each, without the file.
    pub(super) notes: Vec<String>,
}

/// The warning about blended materials.
pub(super) const BLENDED: &str =
    "blended materials, of which each layer covers by its alpha, with nothing refracted";
