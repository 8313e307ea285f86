//! The parts of a 3MF file: a ZIP archive by the Open Packaging Conventions.

use crate::formats::error::{FormatError, quote, shorten};
use crate::formats::limits::{Budget, Share};
use std::collections::HashMap;
use std::io::{Cursor, Read};
use std::path::Path;
use zip::ZipArchive;

/// The part that states the types of the others.
const RELATIONSHIPS: &str = "_rels/.rels";

/// A lower bound of the memory that the ZIP library takes for each entry.
const ENTRY: u64 = 1024;

/// The parts of a 3MF file.
pub(super) struct Package<'b> {
    path: &'b Path,
    budget: &'b Budget,
    archive: ZipArchive<Cursor<&'b [u8]>>,
    /// Entries by name in lower case, since case is insignificant.
    numbers: HashMap<String, usize>,
    _share: Share<'b>,
}

/// A part's text, counted against the budget.
pub(super) struct Part<'b> {
    pub(super) name: String,
    pub(super) text: Vec<u8>,
    _share: Share<'b>,
}

/// A part's name, normalised for look-up.
fn key(name: &str) -> String {
    name.trim_start_matches('/').to_ascii_lowercase()
}

impl<'b> Package<'b> {
    pub(super) fn open(
        path: &'b Path,
        bytes: &'b [u8],
        budget: &'b Budget,
    ) -> Result<Self, FormatError> {
        // The number of entries, before the archive's directory is read.
        let entries = memchr::memmem::find_iter(bytes, b"PK\x01\x02").count() as u64;
        let share = budget.share(path, "the archive's directory", ENTRY * entries)?;
        let archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| {
            let reason = format!("its archive: {}", shorten(&error.to_string()));
            FormatError::refused(path, None, &reason)
        })?;
        let numbers = archive.file_names().enumerate();
        let numbers = numbers.filter_map(|(number, name)| Some((key(&name.ok()?), number)));
        Ok(Self {
            path,
            budget,
            numbers: numbers.collect(),
            archive,
            _share: share,
        })
    }

    /// An error in a part, with its line if it has one.
    pub(super) fn fault(&self, part: &str, line: Option<usize>, reason: &str) -> FormatError {
        let line = line.map_or_else(String::new, |line| format!(", line {line}"));
        // Messages of the XML library may contain names from the file.
        let shown = |c: char| if c.is_control() { '\u{fffd}' } else { c };
        let reason: String = reason.chars().map(shown).collect();
        let reason = format!("{}{line}: {reason}", quote(part));
        FormatError::refused(self.path, None, &reason)
    }

    /// A part's bytes: at most what its archive declares and what the budget has left.
    pub(super) fn part(&mut self, name: &str) -> Result<Part<'b>, FormatError> {
        let Some(&number) = self.numbers.get(&key(name)) else {
            return Err(self.fault(name, None, "there is no such part"));
        };
        let damaged = |error: &dyn std::fmt::Display| {
            let reason = format!("{}: {}", quote(name), shorten(&error.to_string()));
            FormatError::refused(self.path, None, &reason)
        };
        let mut file = self
            .archive
            .by_index(number)
            .map_err(|error| damaged(&error))?;
        let mut share = self.budget.share(self.path, "a part", 0)?;
        let mut text = Vec::new();
        /// Bytes decompressed at a time.
        const STEP: u64 = 1 << 20;
        loop {
            // A full buffer doubles, and the old one exists until the new one is filled.
            let most = 3 * (text.len() as u64 + STEP);
            share.grow(self.path, "a part", most)?;
            let read = (&mut file)
                .take(STEP)
                .read_to_end(&mut text)
                .map_err(|error| damaged(&error))?;
            if read == 0 {
                break;
            }
        }
        Ok(Part {
            name: name.trim_start_matches('/').to_owned(),
            text,
            _share: share,
        })
    }

    /// The name of the package's main model, by its relationship.
    pub(super) fn model(&mut self) -> Result<String, FormatError> {
        let part = self.part(RELATIONSHIPS)?;
        let mut reader = quick_xml::Reader::from_reader(&part.text[..]);
        loop {
            let event = reader.read_event();
            let line = line_at(&part.text, reader.buffer_position());
            match event {
                Err(error) => return Err(self.fault(&part.name, Some(line), &error.to_string())),
                Ok(quick_xml::events::Event::Eof) => break,
                Ok(quick_xml::events::Event::Start(tag) | quick_xml::events::Event::Empty(tag))
                    if tag.local_name().as_ref() == b"Relationship" =>
                {
                    let (mut kind, mut target) = (None, None);
                    for attribute in tag.attributes().with_checks(false).flatten() {
                        let value = attribute
                            .normalized_value(quick_xml::XmlVersion::Implicit1_0)
                            .ok()
                            .map(|value| value.into_owned());
                        match attribute.key.local_name().as_ref() {
                            b"Type" => kind = value,
                            b"Target" => target = value,
                            _ => {}
                        }
                    }
                    if let (Some(kind), Some(target)) = (kind, target)
                        && kind.ends_with("/3dmodel")
                    {
                        return Ok(target);
                    }
                }
                Ok(_) => {}
            }
        }
        Err(self.fault(
            &part.name,
            None,
            "expected the relationship of a 3D model, found none",
        ))
    }
}

/// The line, from 1, of a byte offset in a text.
pub(super) fn line_at(text: &[u8], at: u64) -> usize {
    let before = &text[..text.len().min(at as usize)];
    1 + memchr::memchr_iter(b'\n', before).count()
}
