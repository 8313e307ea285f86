use super::journal::Journal;
use super::part_file::PartFile;
use crate::failure::Failure;
use std::fmt::Display;
use std::fs::{File, Permissions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A file under way: gone when dropped, unless [`Unfinished::finish`] puts it in its place.
#[derive(Debug)]
pub struct Unfinished {
    pub(super) sink: Sink,
    /// As it was named, for messages.
    pub(super) name: PathBuf,
    /// Where it is put.
    pub(super) path: PathBuf,
}

#[derive(Debug)]
pub(super) enum Sink {
    Part {
        part: PartFile,
        /// Those of the file that it replaces.
        permissions: Option<Permissions>,
    },
    Device(File),
}

impl Unfinished {
    /// Puts the file in its place, at once.
    ///
    /// # Errors
    /// A file that cannot be put there.
    pub fn finish(self) -> Result<(), Failure> {
        let Self { sink, name, path } = self;
        match sink {
            Sink::Part { part, permissions } => part
                .put(&path, permissions)
                .map_err(|error| cannot_write(&name, &error)),
            Sink::Device(_) => Ok(()),
        }
    }

    fn file(&mut self) -> &mut File {
        match &mut self.sink {
            Sink::Part { part, .. } => part.file(),
            Sink::Device(device) => device,
        }
    }

    /// Writes, as [`Write::write_all`]; tells which file cannot be written.
    ///
    /// # Errors
    /// A full disk.
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let written = self.file().write_all(bytes);
        written.map_err(|error| cannot_write(&self.name, &error))
    }

    /// Writes over what the file begins with.
    ///
    /// # Errors
    /// As [`Unfinished::append`]; a device that cannot go back.
    pub fn rewrite_head(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let file = self.file();
        let written = (file.seek(SeekFrom::Start(0))).and_then(|_| file.write_all(bytes));
        let written = written.and_then(|()| file.seek(SeekFrom::End(0)).map(drop));
        written.map_err(|error| cannot_write(&self.name, &error))
    }

    /// Notes in the file's journal what was written since it was last noted.
    ///
    /// # Errors
    /// As [`Unfinished::append`].
    pub fn note(&mut self, journal: &mut Journal) -> Result<(), Failure> {
        let noted = journal.note(self.file());
        noted.map_err(|error| cannot_write(&self.name, &error))
    }
}

impl Write for Unfinished {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file().flush()
    }
}

pub(super) fn cannot_write(name: &Path, reason: &dyn Display) -> Failure {
    Failure::could_not(format!("{}: cannot be written: {reason}", name.display()))
}
