//! Writing a scene's meshes, in their places, in a format of meshes.

mod glb;
mod obj;
mod parts;
mod ply;
mod stl;
mod triangle_text;
mod written;

use crate::scene::Scene;
use parts::Parts;
use std::io::{self, Write};
use std::path::Path;
pub use written::{WriteError, Written};

/// A format that meshes are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// OBJ, its materials in a library beside it.
    Obj,
    /// PLY, little-endian or as text: one list of triangles.
    Ply {
        /// As text.
        ascii: bool,
    },
    /// STL, binary or as text: corners in single precision, and nothing else.
    Stl {
        /// As text.
        ascii: bool,
    },
    /// Binary glTF 2.0.
    Glb,
    /// The triangle text of the original RayCast: corners, and nothing else.
    TriangleText,
}

impl MeshFormat {
    /// The format that a file's name asks for, by its extension in any case; `ascii` asks for text
    /// where there is a choice. `None` for a name that asks for none.
    pub fn from_name(name: &str, ascii: bool) -> Option<Self> {
        let extension = Path::new(name).extension()?.to_str()?;
        Some(match extension.to_ascii_lowercase().as_str() {
            "obj" => Self::Obj,
            "ply" => Self::Ply { ascii },
            "stl" => Self::Stl { ascii },
            "glb" => Self::Glb,
            "txt" | "tri" => Self::TriangleText,
            _ => return None,
        })
    }
}

/// Writes the meshes of a scene, each in its place, object by object in their order. `library` is the
/// name by which an OBJ names the file of [`write_materials`]; without it an OBJ has no materials.
///
/// What is read from the file has the same triangles in the same order, with the same corners where
/// the format's numbers hold them: decimals of text are the shortest that are read as the same number.
///
/// # Errors
/// Those of `out`; a scene that cannot be placed; more than the format can hold.
pub fn write_meshes(
    scene: &Scene,
    format: MeshFormat,
    library: Option<&str>,
    out: &mut dyn Write,
) -> Result<Written, WriteError> {
    let parts = Parts::of(scene)?;
    let mut written = parts.written();
    match format {
        MeshFormat::Obj => obj::write(&parts, library, out, &mut written),
        MeshFormat::Ply { ascii } => ply::write(&parts, ascii, out, &mut written),
        MeshFormat::Stl { ascii } => stl::write(&parts, ascii, out, &mut written),
        MeshFormat::Glb => glb::write(&parts, out, &mut written),
        MeshFormat::TriangleText => triangle_text::write(&parts, out, &mut written),
    }?;
    let textures = scene
        .objects
        .iter()
        .filter(|object| object.texture.is_some())
        .count();
    if textures > 0 {
        written.lost.push(format!("textures of {textures} objects"));
    }
    let mut objects = scene.objects.iter();
    let has_scalars = objects.any(|object| !object.mesh.scalars().is_empty());
    if has_scalars && !matches!(format, MeshFormat::Ply { .. }) {
        written
            .lost
            .push("scalars of vertices and triangles".to_owned());
    }
    Ok(written)
}

/// Writes the material library (MTL) of what [`write_meshes`] writes as OBJ; whether there is any
/// material at all.
///
/// # Errors
/// Those of `out`.
pub fn write_materials(scene: &Scene, out: &mut dyn Write) -> io::Result<bool> {
    obj::write_library(scene, out)
}

#[cfg(test)]
mod tests;
