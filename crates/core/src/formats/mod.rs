//! Reading files: meshes, textures, scene files. The one place in the core that touches a disk.

mod error;
mod scene_file;

pub use error::{FormatError, Place};
pub use scene_file::{CameraFile, ImageFile, SceneFile, ShadingFile};

use crate::scene::{Mesh, Texture};
use std::path::Path;

/// A step of loading, for whoever shows progress: a share of the whole, 0 to 1.
pub type Progress<'a> = &'a (dyn Fn(f32) + Sync);

/// Reads a mesh file; its kind is known from the content where it can be, else from the extension.
///
/// # Errors
/// A file that cannot be read, or is not a mesh of a kind we know: with file, line and what was
/// expected.
pub fn read_mesh(_path: &Path, _progress: Progress<'_>) -> Result<Mesh, FormatError> {
    unimplemented!()
}

/// Reads an image file as a texture.
///
/// # Errors
/// A file that cannot be read or is not an image of a kind we know.
pub fn read_texture(_path: &Path) -> Result<Texture, FormatError> {
    unimplemented!()
}

/// Reads a scene file (`.raycast.toml`) and every mesh and texture that it names, or a mesh file as
/// a scene of one object named after the file.
///
/// # Errors
/// As [`read_mesh`]; a scene file that does not parse, with its line.
pub fn read_scene(_path: &Path, _progress: Progress<'_>) -> Result<SceneFile, FormatError> {
    unimplemented!()
}
