//! An object: name, mesh, world from object (12 f64, column by column), texture (an option)
//! and the path to its file (an option).

use super::decoder::Decoder;
use super::encoder::Encoder;
use super::material::{Textures, read_texture};
use crate::formats::error::FormatError;
use crate::scene::{Mesh, Texture};
use glam::DAffine3;
use std::io;
use std::sync::Arc;

/// The least number of bytes of an object in the file.
pub(super) const MIN_BYTES: usize = 4 + 4 + 12 * 8 + 4 + 4;

/// A mesh and its transform.
pub(in crate::formats) struct PreparedObject {
    pub(in crate::formats) name: String,
    pub(in crate::formats) mesh: Arc<Mesh>,
    pub(in crate::formats) world_from_object: DAffine3,
    /// The texture that covers the whole object.
    pub(in crate::formats) texture: Option<Arc<Texture>>,
    /// The path of the texture's file relative to the prepared file, with `/` as the separator.
    pub(in crate::formats) texture_source: Option<String>,
}

/// What is written of an object; the mesh is an index into the list of meshes.
pub(super) struct ObjectToWrite<'o> {
    pub(super) name: &'o str,
    pub(super) mesh: u32,
    pub(super) world_from_object: DAffine3,
    pub(super) texture: Option<&'o Arc<Texture>>,
    pub(super) texture_source: Option<String>,
}

pub(super) fn write(
    object: &ObjectToWrite<'_>,
    textures: &Textures<'_>,
    to: &mut Encoder<'_>,
) -> io::Result<()> {
    to.text(object.name)?;
    to.number(object.mesh)?;
    let numbers = object.world_from_object.to_cols_array();
    numbers.into_iter().try_for_each(|x| to.double(x))?;
    textures.write(object.texture, to)?;
    to.option(object.texture_source.as_deref(), Encoder::text)
}

pub(super) fn read(
    meshes: &[Arc<Mesh>],
    textures: &[Arc<Texture>],
    from: &mut Decoder<'_>,
) -> Result<PreparedObject, FormatError> {
    let name = from.text("an object's name")?;
    let mesh = from.below("the number of a mesh", meshes.len())?;
    let mut numbers = [0.0; 12];
    for number in &mut numbers {
        *number = from.finite("a number of a matrix")?;
    }
    Ok(PreparedObject {
        name,
        mesh: Arc::clone(&meshes[mesh]),
        world_from_object: DAffine3::from_cols_array(&numbers),
        texture: read_texture(textures, from)?,
        texture_source: from.option("whether its image was a file", |from| {
            from.text("the path of an image")
        })?,
    })
}
