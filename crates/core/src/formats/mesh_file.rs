use super::error::FormatError;
use super::files::Files;
use super::kind::{MeshKind, mesh_kind};
use super::{Progress, obj, triangle_text};
use crate::scene::Mesh;
use std::path::{Path, PathBuf};

/// What a mesh file holds.
#[derive(Debug)]
pub(super) struct MeshFile {
    pub(super) mesh: Mesh,
    /// The image that its materials name for all of it.
    pub(super) texture: Option<PathBuf>,
    pub(super) warnings: Vec<String>,
}

/// Reads the bytes of a mesh file of any kind, and through `files` what it names.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    files: &dyn Files,
    progress: Progress<'_>,
) -> Result<MeshFile, FormatError> {
    let (data, texture, warnings) = match mesh_kind(path, bytes)? {
        MeshKind::Obj => {
            let obj = obj::read(path, bytes, files, progress)?;
            (obj.mesh, obj.texture, obj.warnings)
        }
        MeshKind::TriangleText => (
            triangle_text::read(path, bytes, progress)?,
            None,
            Vec::new(),
        ),
    };
    let mesh = Mesh::new(data);
    progress(1.0);
    Ok(MeshFile {
        mesh,
        texture,
        warnings,
    })
}

/// What an object is called that is named after its file.
pub(super) fn name(path: &Path) -> String {
    path.file_stem().map_or_else(
        || "object".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}
