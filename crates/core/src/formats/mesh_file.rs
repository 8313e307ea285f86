use super::error::FormatError;
use super::files::{Files, beside};
use super::kind::{KindInPlace, MeshKind, mesh_kind};
use super::length_unit::LengthUnit;
use super::limits::Budget;
use super::parsed::Parsed;
use super::placed_meshes::PlacedMeshes;
use super::random_access::RandomAccess;
use super::scene_file::FileKind;
use super::unpack::{inner_name, unpack};
use super::{Progress, gltf, obj, off, ply, prepared, stl, threemf, triangle_text};
use crate::quote;
use crate::scene::{BENT, Mesh, MeshData, Object, Texture, Transform, UpAxis};
use glam::DAffine3;
use std::mem::size_of;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The most warnings of one file that are listed individually.
const WARNING_LIMIT: usize = 32;

/// The fraction of reading a compressed file that is decompression, for progress.
const UNPACKING_SHARE: f32 = 0.5;

/// The contents of a mesh file.
#[derive(Debug)]
pub(super) struct MeshFile {
    pub(super) kind: FileKind,
    /// The unit that the file states.
    pub(super) unit: Option<LengthUnit>,
    /// One or more objects, in the order of their numbers.
    pub(super) objects: Vec<MeshObject>,
    pub(super) warnings: Vec<String>,
    /// The file's metadata, and its contents that are not used.
    pub(super) notes: Vec<String>,
}

/// A mesh with the transform that its file gives it.
#[derive(Clone, Debug)]
pub(super) struct MeshObject {
    pub(super) name: String,
    /// Shared by all objects of the file that have the same mesh.
    pub(super) mesh: Arc<Mesh>,
    /// The index of its mesh node in the file; `None` in formats without nodes.
    pub(super) node: Option<u32>,
    pub(super) world_from_object: DAffine3,
    /// The axis that pointed up in the file; the mesh was rotated. Y where its transform was rotated instead.
    pub(super) up_axis: UpAxis,
    /// The image that its materials give the whole mesh.
    pub(super) texture: Option<MeshTexture>,
}

/// An image for the whole mesh.
#[derive(Clone, Debug)]
pub(super) enum MeshTexture {
    /// A file that is not read yet.
    Named(PathBuf),
    /// An image stored in the mesh's file, with the file that it came from.
    Held(Arc<Texture>, Option<PathBuf>),
}

impl MeshObject {
    /// The only object of a file, named after the file.
    fn whole(path: &Path, mesh: Arc<Mesh>, up_axis: UpAxis, texture: Option<PathBuf>) -> Self {
        let texture = texture.map(MeshTexture::Named);
        Self {
            name: name(path),
            mesh,
            node: None,
            world_from_object: DAffine3::IDENTITY,
            up_axis,
            texture,
        }
    }

    /// A mesh that came from no file.
    pub(super) fn from_mesh(name: &str, mesh: Arc<Mesh>) -> Self {
        Self {
            name: name.to_owned(),
            ..Self::whole(Path::new(""), mesh, UpAxis::Y, None)
        }
    }

    /// The object in a scene; its texture file is the caller's to read.
    pub(super) fn placed(&self, source: Option<PathBuf>) -> Object {
        Object {
            transform: Transform::from_matrix(self.world_from_object),
            source,
            up_axis: self.up_axis,
            node: self.node,
            ..Object::new(self.name.clone(), Arc::clone(&self.mesh))
        }
    }
}

/// Reads a mesh file of any format, and through `files` the files that it names; `up_axis` is the axis that points up
/// where the file does not say.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    files: &dyn Files,
    up_axis: UpAxis,
    progress: Progress<'_>,
) -> Result<MeshFile, FormatError> {
    let budget = files.budget();
    let unpacked = unpack(path, bytes, budget, &|share| {
        progress(share * UNPACKING_SHARE)
    })?;
    let (bytes, packing) = match &unpacked {
        Some((contents, packing)) => (&**contents, Some(*packing)),
        None => (bytes, None),
    };
    let start = if packing.is_some() {
        UNPACKING_SHARE
    } else {
        0.0
    };
    let progress: Progress<'_> = &|share| progress(start + share * (1.0 - start));
    let unpacked_from =
        packing.map(|packing| format!("unpacked from {packing}: {} bytes", bytes.len()));
    let (kind, parsed) = match mesh_kind(&inner_name(path), bytes)? {
        MeshKind::Gltf => {
            let placed = gltf::read(path, bytes, files, progress)?;
            drop(unpacked);
            let kind = FileKind::Gltf;
            return store_all(path, kind, placed, unpacked_from, budget, progress);
        }
        MeshKind::Threemf => {
            let mut placed = threemf::read(path, bytes, budget, progress)?;
            drop(unpacked);
            for node in &mut placed.nodes {
                node.world_from_object = up_axis.y_up() * node.world_from_object;
            }
            let kind = FileKind::Threemf;
            return store_all(path, kind, placed, unpacked_from, budget, progress);
        }
        MeshKind::Prepared => {
            let prepared = prepared::read(path, bytes, budget, progress)?;
            return Ok(prepared_objects(path, prepared, unpacked_from, files));
        }
        MeshKind::Obj => {
            let obj = obj::read(path, bytes, files, progress)?;
            let parsed = Parsed {
                mesh: obj.mesh,
                texture: obj.texture,
                warnings: obj.warnings,
                notes: obj.notes,
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
    drop(unpacked);
    let mut file = store_one(path, kind, parsed, files, up_axis)?;
    file.notes.splice(0..0, unpacked_from);
    progress(1.0);
    Ok(file)
}

/// Checks and stores the mesh of a file of one object, which says nothing of its axes.
fn store_one(
    path: &Path,
    kind: FileKind,
    parsed: Parsed,
    files: &dyn Files,
    up_axis: UpAxis,
) -> Result<MeshFile, FormatError> {
    let Parsed {
        mesh: mut data,
        texture,
        mut warnings,
        mut notes,
    } = parsed;
    if let Some(image) = &texture {
        // Named, even if it is not shown for want of texture coordinates.
        files.name(image);
    }
    up_axis.turn(&mut data);
    notes.push(format!(
        "units and up axis: not said; {up_axis} is taken to be up"
    ));
    let mesh = store(path, data, files.budget(), &mut warnings)?;
    limit_warnings(path, &mut warnings);
    Ok(MeshFile {
        kind,
        unit: None,
        objects: vec![MeshObject::whole(path, mesh, up_axis, texture)],
        warnings,
        notes,
    })
}

/// Reads a mesh file from where it is.
pub(super) fn read_in_place(
    path: &Path,
    kind: KindInPlace,
    file: RandomAccess<'_>,
    files: &dyn Files,
    progress: Progress<'_>,
) -> Result<MeshFile, FormatError> {
    let budget = files.budget();
    match kind {
        KindInPlace::Prepared => {
            let prepared = prepared::read_from(path, file, budget, progress)?;
            Ok(prepared_objects(path, prepared, None, files))
        }
        KindInPlace::Stl => {
            let parsed = stl::read_binary(path, file, budget, progress)?;
            store_one(path, FileKind::Stl, parsed, files, budget.limits().up_axis)
        }
    }
}

/// Checks and stores the meshes of a file of several objects.
fn store_all(
    path: &Path,
    kind: FileKind,
    placed: PlacedMeshes,
    unpacked_from: Option<String>,
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<MeshFile, FormatError> {
    let mut warnings = placed.warnings;
    let meshes: Vec<Arc<Mesh>> = placed
        .meshes
        .into_iter()
        .map(|data| store(path, data, budget, &mut warnings))
        .collect::<Result<_, _>>()?;
    let objects = placed
        .nodes
        .into_iter()
        .zip(0..)
        .map(|(node, number)| MeshObject {
            name: node.name,
            mesh: Arc::clone(&meshes[node.mesh]),
            node: Some(number),
            world_from_object: node.world_from_object,
            up_axis: UpAxis::Y,
            texture: None,
        });
    limit_warnings(path, &mut warnings);
    progress(1.0);
    let mut notes = placed.notes;
    notes.splice(0..0, unpacked_from);
    Ok(MeshFile {
        kind,
        unit: placed.unit,
        objects: objects.collect(),
        warnings,
        notes,
    })
}

/// The objects of a prepared file, whose meshes are stored already.
fn prepared_objects(
    path: &Path,
    prepared: prepared::Prepared,
    unpacked_from: Option<String>,
    files: &dyn Files,
) -> MeshFile {
    let numbered = prepared.objects.into_iter().zip(0..);
    let objects = numbered.map(|(object, number)| {
        let source = object.texture_source;
        let source = source.map(|source| files.source(&beside(path, &source)));
        MeshObject {
            name: object.name,
            mesh: object.mesh,
            node: prepared.are_nodes.then_some(number),
            world_from_object: object.world_from_object,
            up_axis: UpAxis::Y,
            texture: object.texture.map(|image| MeshTexture::Held(image, source)),
        }
    });
    let mut warnings = prepared.warnings;
    limit_warnings(path, &mut warnings);
    let mut notes = prepared.notes;
    notes.splice(0..0, unpacked_from);
    MeshFile {
        kind: FileKind::Prepared,
        unit: prepared.unit,
        objects: objects.collect(),
        warnings,
        notes,
    }
}

/// Checks and stores a mesh, counted against the budget.
pub(super) fn store(
    path: &Path,
    data: MeshData,
    budget: &Budget,
    warnings: &mut Vec<String>,
) -> Result<Arc<Mesh>, FormatError> {
    let kept = data.stored_bytes();
    let share = budget.share(path, "the mesh", data.bytes() + kept)?;
    let mesh = Mesh::new(data);
    share.keep(kept);
    warnings.extend(rounding_warning(path, &mesh));
    Ok(Arc::new(mesh))
}

/// Counts a scene's objects and all their triangles, those of a shared mesh each time.
pub(super) fn count_objects(
    path: &Path,
    objects: &[MeshObject],
    budget: &Budget,
) -> Result<(), FormatError> {
    // The object, its transform as a matrix, and its name; twice while they are made.
    let names: usize = objects.iter().map(|object| object.name.len()).sum();
    let bytes = 2 * (objects.len() * (size_of::<Object>() + size_of::<DAffine3>()) + names);
    let share = budget.share(path, "the list of objects", bytes as u64)?;
    share.keep(bytes as u64);
    for object in objects {
        budget.add_triangles(path, object.mesh.triangles().len() as u64)?;
    }
    Ok(())
}

/// Keeps the first warnings, and counts the rest.
pub(super) fn limit_warnings(path: &Path, warnings: &mut Vec<String>) {
    if warnings.len() > WARNING_LIMIT {
        let more = warnings.len() - WARNING_LIMIT;
        warnings.truncate(WARNING_LIMIT);
        warnings.push(format!("{}: {more} more warnings", quote::path(path)));
    }
}

/// A warning where rounding to single precision moved corners by more than a small fraction of an edge.
fn rounding_warning(path: &Path, mesh: &Mesh) -> Option<String> {
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

/// The name of an object that is named after its file.
pub(super) fn name(path: &Path) -> String {
    inner_name(path).file_stem().map_or_else(
        || "object".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}
