//! Writing a scene's meshes to a mesh file, transformed to world space.

mod glb;
mod glb_materials;
mod mtl;
mod obj;
mod parts;
mod ply;
mod stl;
mod triangle_text;
mod written;

use crate::scene::{Material, Object, Scene};
pub use mtl::MaterialLibrary;
use parts::Parts;
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;
pub use written::{WriteError, Written};

/// A mesh format that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// OBJ, with its materials in a library beside it.
    Obj,
    /// PLY, little-endian or as text, as one list of triangles.
    Ply {
        /// As text.
        ascii: bool,
    },
    /// STL, binary or as text: only corners, in single precision.
    Stl {
        /// As text.
        ascii: bool,
    },
    /// Binary glTF 2.0.
    Glb,
    /// The triangle text of the original RayCast: only corners.
    TriangleText,
}

impl MeshFormat {
    /// The format of a file name, by its extension in any case; `ascii` selects text where there is a choice. `None`
    /// for an unknown extension.
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

/// Writes the meshes of a scene's visible objects in world space, object by object in order; hidden objects, and the
/// triangles of hidden groups, are counted as lost. `library` is the name by which an OBJ refers to the file of a
/// [`MaterialLibrary`] of the same scene, and this; without it the OBJ has no materials.
///
/// A file that is read again has the same triangles in the same order, with the same corners where the format's
/// numbers can represent them; decimals of text are the shortest that read back as the same number.
///
/// # Errors
/// Those of `out`; invalid transforms or parents; more than the format can hold.
pub fn write_meshes(
    scene: &Scene,
    format: MeshFormat,
    library: Option<(&str, &MaterialLibrary)>,
    out: &mut dyn Write,
) -> Result<Written, WriteError> {
    let (shown, hidden) = without_hidden_groups(scene);
    let parts = Parts::new(&shown)?;
    let mut written = parts.written();
    if hidden > 0 {
        let lost = format!("triangles of hidden groups ({hidden})");
        written.lost.push(lost);
    }
    match format {
        MeshFormat::Obj => obj::write(&parts, library, out, &mut written),
        MeshFormat::Ply { ascii } => ply::write(&parts, ascii, out, &mut written),
        MeshFormat::Stl { ascii } => stl::write(&parts, ascii, out, &mut written),
        MeshFormat::Glb => glb::write(&parts, out, &mut written),
        MeshFormat::TriangleText => triangle_text::write(&parts, out, &mut written),
    }?;
    let parts = || parts.parts.iter();
    let textured = parts().filter(|part| has_image(part.object)).count();
    let has_images = match format {
        MeshFormat::Glb => true,
        MeshFormat::Obj => library.is_some(),
        _ => false,
    };
    if textured > 0 && !has_images {
        written.lost.push(format!("images of objects ({textured})"));
    }
    let has_groups = parts().any(|part| part.mesh.groups().names().len() > 1);
    if has_groups && !matches!(format, MeshFormat::Obj) {
        written.lost.push("groups of triangles".to_owned());
    }
    let has_scalars = parts().any(|part| !part.mesh.scalars().is_empty());
    if has_scalars && !matches!(format, MeshFormat::Ply { .. }) {
        written
            .lost
            .push("scalars of vertices and triangles".to_owned());
    }
    Ok(written)
}

/// The scene with meshes of the triangles alone that hidden groups leave; and how many triangles of visible objects are
/// not among these.
fn without_hidden_groups(scene: &Scene) -> (Cow<'_, Scene>, usize) {
    let mut shown = Cow::Borrowed(scene);
    let mut hidden = 0;
    for (number, object) in scene.objects.iter().enumerate() {
        if object.visible && object.hidden().is_some() {
            let mesh = object.mesh.subset(object.kept());
            hidden += object.mesh.triangles().len() - mesh.triangles().len();
            let shown = &mut shown.to_mut().objects[number];
            shown.hide_groups(BTreeSet::new());
            shown.mesh = Arc::new(mesh);
        }
    }
    (shown, hidden)
}

/// Whether any image is part of an object's look.
fn has_image(object: &Object) -> bool {
    let mut materials = object.mesh.materials().iter();
    let has_image = |material: &Material| {
        let alpha = material.opacity.alpha();
        let reflectance = material.reflectance.as_ref();
        material.texture.is_some()
            || alpha.is_some_and(|alpha| alpha.image.is_some())
            || reflectance.is_some_and(|reflectance| reflectance.has_textures())
    };
    object.texture.is_some() || materials.any(has_image)
}

#[cfg(test)]
mod material_tests;
#[cfg(test)]
mod tests;
