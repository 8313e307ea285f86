//! Reading a prepared file.

use super::decoder::Decoder;
use super::header::{self, HEADER_BYTES};
use super::object::{self, PreparedObject};
use super::{mesh, texture};
use crate::formats::Progress;
use crate::formats::error::FormatError;
use crate::formats::length_unit::LengthUnit;
use crate::formats::limits::Budget;
use glam::DAffine3;
use std::path::Path;
use std::sync::Arc;

/// What a prepared file holds.
pub(in crate::formats) struct Prepared {
    pub(in crate::formats) unit: Option<LengthUnit>,
    /// Whether each object is a mesh node, by which a scene file names it.
    pub(in crate::formats) are_nodes: bool,
    pub(in crate::formats) objects: Vec<PreparedObject>,
    pub(in crate::formats) warnings: Vec<String>,
    pub(in crate::formats) notes: Vec<String>,
}

/// Reads and checks the bytes of a prepared file.
pub(in crate::formats) fn read(
    path: &Path,
    bytes: &[u8],
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<Prepared, FormatError> {
    let contents = header::check(path, bytes)?;
    progress(0.2);
    let mut from = Decoder::new(path, contents, HEADER_BYTES, budget)?;
    let unit = match from.below("a unit", 1 + LengthUnit::ALL.len())? {
        0 => None,
        number => Some(LengthUnit::ALL[number - 1]),
    };
    let lines = |what: &str, from: &mut Decoder<'_>| {
        from.each(what, 4, |from| {
            // One line each, whatever the file holds.
            Ok(from.text(what)?.replace(char::is_control, " "))
        })
    };
    let warnings = lines("warnings", &mut from)?;
    let notes = lines("notes", &mut from)?;
    let textures = from.each("textures", texture::LEAST, |from| {
        texture::read(from).map(Arc::new)
    })?;
    let meshes = from.each("meshes", mesh::LEAST, |from| {
        let mesh = mesh::read(&textures, from)?;
        progress(0.2 + 0.8 * from.done());
        Ok(Arc::new(mesh))
    })?;
    let are_nodes = from.flag("whether objects are nodes")?;
    let objects = from.each("objects", object::LEAST, |from| {
        object::read(&meshes, &textures, from)
    })?;
    match &objects[..] {
        [] => return Err(from.unexpected("an object", "none")),
        _ if are_nodes => {}
        [one] if one.world_from_object == DAffine3::IDENTITY => {}
        _ => return Err(from.unexpected("nodes, or one object in its own place", "others")),
    }
    from.finish()?;
    Ok(Prepared {
        unit,
        are_nodes,
        objects,
        warnings,
        notes,
    })
}
