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
    /// The system's refusal.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// More triangles than 32-bit numbers can name.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// No object.
    #[error("there is no mesh to prepare")]
    Nothing,
    /// What a scene file says, which a prepared file does not hold.
    #[error(
        "a prepared file holds meshes, and not a scene file's {what}: prepare the meshes that the scene file names, \
         and name the prepared ones in it"
    )]
    OfSceneFile {
        /// What the scene file says.
        what: String,
    },
}

/// Writes what was read from mesh files as a prepared file (`.raycast`), which [`read_scene`](crate::formats::read_scene)
/// reads at once: meshes as they are stored, with their materials, images and trees. `path` is where the bytes will be: an
/// object's image is remembered from there.
///
/// The tree over each mesh is built for it. Bytes depend on the meshes alone, and not on the number of threads.
///
/// # Errors
/// Those of `out`; what only scene files have: a camera, colours, places that are no matrix; nothing to write.
pub fn write_prepared(
    file: &SceneFile,
    path: &Path,
    out: &mut dyn Write,
) -> Result<(), PrepareError> {
    check(file)?;
    let contents = Contents::of(file, path);
    // The length stands before what it counts.
    let length = contents.write(0, &mut io::sink())?;
    contents.write(length, out)?;
    Ok(())
}

/// Checks that all there is can be held.
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
    match scene.objects.iter().find_map(of_scene_file) {
        Some(what) => refused(&what),
        None => Ok(()),
    }
}

/// What of an object only a scene file can have said.
fn of_scene_file(object: &Object) -> Option<String> {
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
        ("shape", shape.is_some()),
    ];
    let (what, _) = said.into_iter().find(|(_, is_said)| *is_said)?;
    Some(format!("{what} of the object {}", quote(name)))
}

/// What is written.
struct Contents<'c> {
    file: &'c SceneFile,
    notes: Vec<String>,
    textures: Textures<'c>,
    meshes: Vec<(&'c Arc<Mesh>, TreeTopology)>,
    objects: Vec<ObjectToWrite<'c>>,
}

impl<'c> Contents<'c> {
    fn of(file: &'c SceneFile, path: &Path) -> Self {
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
                    .for_each(|one| textures.add_of(one));
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

    /// Writes it as a file of so many bytes; how many there are.
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

/// Whether objects are mesh nodes. Of several each is one, so that a scene file can name it, as is one with a place:
/// a scene file that names a node says all of its place.
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
