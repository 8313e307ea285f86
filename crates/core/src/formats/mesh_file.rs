use super::error::FormatError;
use super::files::Files;
use super::kind::{MeshKind, mesh_kind};
use super::parsed::Parsed;
use super::scene_file::FileKind;
use super::unpack::{inner_name, unpack};
use super::{Progress, obj, off, ply, stl, triangle_text};
use crate::quote;
use crate::scene::{BENT, Mesh, UpAxis};
use std::path::{Path, PathBuf};

/// The most warnings of one file that are told one by one.
const WARNING_LIMIT: usize = 32;

/// How much of reading a compressed file's bytes is unpacking them.
const UNPACKING: f32 = 0.5;

/// What a mesh file holds.
#[derive(Debug)]
pub(super) struct MeshFile {
    pub(super) kind: FileKind,
    pub(super) mesh: Mesh,
    /// The image that its materials name for all of it.
    pub(super) texture: Option<PathBuf>,
    pub(super) warnings: Vec<String>,
    /// What [`Parsed::notes`] says.
    pub(super) notes: Vec<String>,
}

/// Reads the bytes of a mesh file of any kind, and through `files` what it names; `up_axis` is what
/// is up where the file does not say.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    files: &dyn Files,
    up_axis: UpAxis,
    progress: Progress<'_>,
) -> Result<MeshFile, FormatError> {
    let budget = files.budget();
    let unpacked = unpack(path, bytes, budget, &|share| progress(share * UNPACKING))?;
    let (bytes, packing) = match &unpacked {
        Some((contents, packing)) => (&**contents, Some(*packing)),
        None => (bytes, None),
    };
    let start = if packing.is_some() { UNPACKING } else { 0.0 };
    let progress: Progress<'_> = &|share| progress(start + share * (1.0 - start));
    let (kind, parsed) = match mesh_kind(&inner_name(path), bytes)? {
        MeshKind::Obj => {
            let obj = obj::read(path, bytes, files, progress)?;
            let parsed = Parsed {
                mesh: obj.mesh,
                texture: obj.texture,
                warnings: obj.warnings,
                notes: Vec::new(),
            };
            (FileKind::Obj, parsed)
        }
        MeshKind::Off => (FileKind::Off, off::read(path, bytes, budget, progress)?),
        MeshKind::Ply => (FileKind::Ply, ply::read(path, bytes, budget, progress)?),
        MeshKind::Stl => (FileKind::Stl, stl::read(path, bytes, budget, progress)?),
        MeshKind::TriangleText => {
            let (mesh, warnings) = triangle_text::read(path, bytes, budget, progress)?;
            let parsed = Parsed {
                mesh,
                warnings,
                ..Parsed::default()
            };
            (FileKind::TriangleText, parsed)
        }
    };
    let Parsed {
        mesh: mut data,
        texture,
        mut warnings,
        mut notes,
    } = parsed;
    if let Some(packing) = packing {
        notes.insert(0, format!("unpacked from {packing}: {} bytes", bytes.len()));
    }
    drop(unpacked);
    up_axis.turn(&mut data);
    notes.push(format!(
        "units and up axis: not said; {up_axis} is taken to be up"
    ));
    let kept = data.stored_bytes();
    let share = budget.share(path, "the mesh", data.bytes() + kept)?;
    let mesh = Mesh::new(data);
    share.keep(kept);
    warnings.extend(rounding(path, &mesh));
    limit_warnings(path, &mut warnings);
    progress(1.0);
    Ok(MeshFile {
        kind,
        mesh,
        texture,
        warnings,
        notes,
    })
}

/// Keeps the first warnings, and counts the rest.
pub(super) fn limit_warnings(path: &Path, warnings: &mut Vec<String>) {
    if warnings.len() > WARNING_LIMIT {
        let more = warnings.len() - WARNING_LIMIT;
        warnings.truncate(WARNING_LIMIT);
        warnings.push(format!("{}: {more} more warnings", quote::path(path)));
    }
}

/// A warning where single precision moved corners by more than a small part of an edge.
fn rounding(path: &Path, mesh: &Mesh) -> Option<String> {
    let rounding = mesh.rounding();
    (rounding.bent > 0).then(|| {
        format!(
            "{}: triangles of which rounding to single precision moves a corner by more than {} % of \
             an edge, at most by {:.3} %: {}",
            quote::path(path),
            BENT * 100.0,
            rounding.share_of_edge * 100.0,
            rounding.bent,
        )
    })
}

/// What an object is called that is named after its file.
pub(super) fn name(path: &Path) -> String {
    inner_name(path).file_stem().map_or_else(
        || "object".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}
