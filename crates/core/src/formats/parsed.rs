use crate::scene::MeshData;
use std::path::PathBuf;

/// What a reader makes of a mesh file.
#[derive(Debug, Default)]
pub(super) struct Parsed {
    pub(super) mesh: MeshData,
    /// The image that the file names for all of its surface.
    pub(super) texture: Option<PathBuf>,
    /// What was not as it should be, and did not matter enough to stop: a line each, with the file.
    pub(super) warnings: Vec<String>,
    /// What the file is, says of itself, and holds that is not used: a line each, without the file.
    pub(super) notes: Vec<String>,
}

/// The warning about blended materials.
pub(super) const BLENDED: &str =
    "blended materials, of which each layer covers by its alpha, with nothing refracted";
