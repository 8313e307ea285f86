//! Writing a prepared file.

use super::encoder::Encoder;
use super::header;
use super::material::Textures;
use super::object::{self, ObjectToWrite};
use super::{mesh, texture};
use crate::formats::files::relative;
use crate::formats::length_unit::LengthUnit;
use crate::formats::scene_file::SceneFile;
use crate::quote::{quote, shorten};
use crate::scene::{
    ColorRule, Mesh, Object, Scene, SceneError, Texture, TextureMapping, Transform, TreeTopology,
};
use glam::DAffine3;
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

/// Why a prepared file was not written.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    /// An error of the output.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// More triangles than 32-bit ids can tell apart.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// No object.
    #[error("there is no mesh to prepare")]
    Nothing,
    /// A setting of a scene file, which a prepared file cannot hold.
    #[error(
        "a prepared file holds meshes, and not a scene file's {what}: prepare the meshes that the scene file names, \
         and name the prepared ones in it"
    )]
    OfSceneFile {
        /// The setting.
        what: String,
    },
}

/// Writes the contents of mesh files as a prepared file (`.raycast`): meshes, materials, textures and BVHs as they
/// are in memory, so that [`read_scene`](crate::formats::read_scene) need not parse or build. `path` is where the
/// file will be; paths of the objects' textures are stored relative to it.
///
/// The BVH of each mesh is built here. The bytes depend only on the meshes, not on the number of threads.
///
/// # Errors
/// Those of `out`; settings that only scene files have (a camera, colours, a transform that is not a matrix); no
/// objects.
pub fn write_prepared(
    file: &SceneFile,
    path: &Path,
    out: &mut dyn Write,
) -> Result<(), PrepareError> {
    check(file)?;
    let contents = Contents::collect(file, path);
    // The header holds the file's length, so a first pass counts the bytes.
    let length = contents.write(0, &mut io::sink())?;
    contents.write(length, out)?;
    Ok(())
}

/// Checks that a prepared file can hold everything in `file`.
fn check(file: &SceneFile) -> Result<(), PrepareError> {
    let refused = |what: &str| {
        let what = what.to_owned();
        Err(PrepareError::OfSceneFile { what })
    };
    let SceneFile {
        kind: _,
        unit: _,
        scene,
        camera,
        animation,
        image,
        shading,
        clip,
        warnings: _,
        notes: _,
        opened: _,
    } = file;
    if camera.is_some() {
        return refused("camera");
    }
    if animation.is_some() {
        return refused("animation");
    }
    if *image != Default::default() {
        return refused("image settings");
    }
    if shading.is_some() {
        return refused("shading");
    }
    if !clip.all().is_empty() {
        return refused("clipping planes");
    }
    if scene.objects.is_empty() {
        return Err(PrepareError::Nothing);
    }
    match scene.objects.iter().find_map(scene_file_property) {
        Some(what) => refused(&what),
        None => Ok(()),
    }
}

/// The first property of an object that only a scene file can have set.
fn scene_file_property(object: &Object) -> Option<String> {
    let Object {
        name,
        mesh: _,
        transform,
        parent,
        color,
        texture,
        mapping,
        blend_by,
        source: _,
        up_axis: _,
        texture_source: _,
        node: _,
        visible,
        hidden_groups,
        shape,
    } = object;
    let is_matrix = Transform {
        matrix: DAffine3::IDENTITY,
        ..*transform
    } == Transform::IDENTITY;
    let is_cropped = |texture: &Arc<Texture>| texture.crop().is_some();
    let said = [
        ("place", !is_matrix),
        ("parent", parent.is_some()),
        ("color", *color != ColorRule::File),
        ("crop", texture.as_ref().is_some_and(is_cropped)),
        ("texture mapping", *mapping != TextureMapping::default()),
        ("blend-by", blend_by.is_some()),
        ("visible", !visible),
        ("hidden-groups", hidden_groups.is_some()),
        ("shape", shape.is_some()),
    ];
    let (what, _) = said.into_iter().find(|(_, is_said)| *is_said)?;
    Some(format!("{what} of the object {}", quote(name)))
}

/// Everything that is written, collected.
struct Contents<'c> {
    file: &'c SceneFile,
    notes: Vec<String>,
    textures: Textures<'c>,
    meshes: Vec<(&'c Arc<Mesh>, TreeTopology)>,
    objects: Vec<ObjectToWrite<'c>>,
}

impl<'c> Contents<'c> {
    fn collect(file: &'c SceneFile, path: &Path) -> Self {
        let all = &file.scene.objects;
        let mut textures = Textures::default();
        let mut meshes: Vec<&Arc<Mesh>> = Vec::new();
        let mut numbers: HashMap<*const Mesh, u32> = HashMap::new();
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut objects = Vec::with_capacity(all.len());
        for object in all {
            let next = meshes.len() as u32;
            let mesh = *numbers.entry(Arc::as_ptr(&object.mesh)).or_insert(next);
            if mesh == next {
                meshes.push(&object.mesh);
                object
                    .mesh
                    .materials()
                    .iter()
                    .for_each(|one| textures.add_all(one));
            }
            object.texture.iter().for_each(|one| textures.add(one));
            let source = object.texture_source.as_deref();
            objects.push(ObjectToWrite {
                name: &object.name,
                mesh,
                world_from_object: object.transform.matrix,
                texture: object.texture.as_ref(),
                texture_source: source.and_then(|source| relative(source, folder)),
            });
        }
        let trees = meshes.into_par_iter();
        let meshes = trees.map(|mesh| (mesh, TreeTopology::of(mesh))).collect();
        let mut notes = vec![format!("prepared from {}", sources(&file.scene))];
        notes.extend(file.notes.iter().cloned());
        Self {
            file,
            notes,
            textures,
            meshes,
            objects,
        }
    }

    /// Writes the file with `length` in its header; returns the number of bytes.
    fn write(&self, length: u64, out: &mut dyn Write) -> io::Result<u64> {
        let to = &mut Encoder::new(out);
        header::write(length, to)?;
        let unit = self.file.unit.and_then(|unit| {
            let all = LengthUnit::ALL.iter();
            all.zip(1..).find(|(one, _)| **one == unit)
        });
        to.number(unit.map_or(0, |(_, number)| number))?;
        for lines in [&self.file.warnings, &self.notes] {
            to.count(lines.len())?;
            lines.iter().try_for_each(|line| to.text(line))?;
        }
        to.count(self.textures.all.len())?;
        for one in &self.textures.all {
            texture::write(one, to)?;
        }
        to.count(self.meshes.len())?;
        for (one, tree) in &self.meshes {
            mesh::write(one, tree, &self.textures, to)?;
        }
        to.number(are_nodes(&self.file.scene.objects).into())?;
        to.count(self.objects.len())?;
        for one in &self.objects {
            object::write(one, &self.textures, to)?;
        }
        to.finish()
    }
}

/// Whether objects are mesh nodes. Several objects are, so that a scene file can name each. So is a single object
/// with a transform: a scene file that names a node sets its whole transform.
fn are_nodes(objects: &[Object]) -> bool {
    let is_node =
        |object: &Object| object.node.is_some() || object.transform.matrix != DAffine3::IDENTITY;
    objects.len() > 1 || objects.iter().any(is_node)
}

/// The names of the files that objects came from.
fn sources(scene: &Scene) -> String {
    let sources = scene
        .objects
        .iter()
        .filter_map(|object| object.source.as_deref()?.file_name());
    let names: BTreeSet<String> = sources
        .map(|name| shorten(&name.to_string_lossy()).replace(char::is_control, " "))
        .collect();
    match names.len() {
        0 => "no file".to_owned(),
        1..=4 => Vec::from_iter(names).join(", "),
        count => format!("{count} files"),
    }
}
