//! Reading a prepared file.

use super::checksum::BYTES;
use super::decoder::Decoder;
use super::header::{self, HEADER_BYTES};
use super::object::{self, PreparedObject};
use super::source::Source;
use super::{mesh, texture};
use crate::formats::Progress;
use crate::formats::error::FormatError;
use crate::formats::length_unit::LengthUnit;
use crate::formats::limits::Budget;
use crate::formats::random_access::{RandomAccess, bytes_at};
use glam::DAffine3;
use std::io;
use std::path::Path;
use std::sync::Arc;

/// The contents of a prepared file.
pub(in crate::formats) struct Prepared {
    pub(in crate::formats) unit: Option<LengthUnit>,
    /// Whether each object is a mesh node that a scene file refers to by name.
    pub(in crate::formats) are_nodes: bool,
    pub(in crate::formats) objects: Vec<PreparedObject>,
    pub(in crate::formats) warnings: Vec<String>,
    pub(in crate::formats) notes: Vec<String>,
}

/// Decodes and checks a prepared file in memory.
pub(in crate::formats) fn read(
    path: &Path,
    bytes: &[u8],
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<Prepared, FormatError> {
    let from = RandomAccess {
        read_at: &bytes_at(bytes),
        length: bytes.len() as u64,
    };
    read_from(path, from, budget, progress)
}

/// Decodes and checks a prepared file.
pub(in crate::formats) fn read_from(
    path: &Path,
    file: RandomAccess<'_>,
    budget: &Budget,
    progress: Progress<'_>,
) -> Result<Prepared, FormatError> {
    let failed = |error| FormatError::io(path, error);
    let mut first = [0; HEADER_BYTES];
    let first = &mut first[..HEADER_BYTES.min(file.length as usize)];
    file.read(0, first).map_err(failed)?;
    header::check(path, first, file.length)?;
    let Some(end) = usize::try_from(file.length)
        .ok()
        .and_then(|all| all.checked_sub(BYTES))
    else {
        return Err(failed(io::ErrorKind::OutOfMemory.into()));
    };
    let mut source = Source::new(file, end);
    source.take(first).map_err(failed)?;
    let mut from = Decoder::new(path, source, budget)?;
    let prepared = contents(&mut from, progress);
    // A damaged file can fail to decode in any way: report the damage, not the decoding error that it caused.
    let mut stored = [0; BYTES];
    file.read(end as u64, &mut stored).map_err(failed)?;
    from.verify(stored)?;
    let prepared = prepared?;
    from.keep();
    Ok(prepared)
}

/// Decodes everything between header and checksum.
fn contents(from: &mut Decoder<'_>, progress: Progress<'_>) -> Result<Prepared, FormatError> {
    let unit = match from.below("a unit", 1 + LengthUnit::ALL.len())? {
        0 => None,
        number => Some(LengthUnit::ALL[number - 1]),
    };
    let lines = |what: &str, from: &mut Decoder<'_>| {
        from.each(what, 4, |from| {
            // Warnings and notes are shown as one line each: control characters in a forged file must not break it.
            Ok(from.text(what)?.replace(char::is_control, " "))
        })
    };
    let warnings = lines("warnings", from)?;
    let notes = lines("notes", from)?;
    let textures = from.each("textures", texture::MIN_BYTES, |from| {
        texture::read(from).map(Arc::new)
    })?;
    let meshes = from.each("meshes", mesh::MIN_BYTES, |from| {
        let mesh = mesh::read(&textures, from)?;
        progress(from.done());
        Ok(Arc::new(mesh))
    })?;
    let are_nodes = from.flag("whether objects are nodes")?;
    let objects = from.each("objects", object::MIN_BYTES, |from| {
        object::read(&meshes, &textures, from)
    })?;
    match &objects[..] {
        [] => return Err(from.unexpected("an object", "none")),
        _ if are_nodes => {}
        [one] if one.world_from_object == DAffine3::IDENTITY => {}
        _ => return Err(from.unexpected("nodes, or one object in its own place", "others")),
    }
    from.end()?;
    Ok(Prepared {
        unit,
        are_nodes,
        objects,
        warnings,
        notes,
    })
}
