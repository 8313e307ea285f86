use super::journal::Journal;
use super::part_file::PartFile;
use crate::failure::Failure;
use std::fmt::Display;
use std::fs::{File, Permissions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A file being written: removed when dropped, unless [`Unfinished::finish`] renames it.
#[derive(Debug)]
pub struct Unfinished {
    pub(super) sink: Sink,
    /// The path as given, for messages.
    pub(super) name: PathBuf,
    /// The final path.
    pub(super) path: PathBuf,
}

#[derive(Debug)]
pub(super) enum Sink {
    Part {
        part: PartFile,
        /// The permissions of the file that it replaces.
        permissions: Option<Permissions>,
    },
    Device(File),
}

impl Unfinished {
    /// Renames the part file to its final path, atomically.
    ///
    /// # Errors
    /// Those of the system.
    pub fn finish(self) -> Result<(), Failure> {
        let Self { sink, name, path } = self;
        match sink {
            Sink::Part { part, permissions } => part
                .persist(&path, permissions)
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

    /// As [`Write::write_all`]; the error names the file.
    ///
    /// # Errors
    /// A full disk.
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let written = self.file().write_all(bytes);
        written.map_err(|error| cannot_write(&self.name, &error))
    }

    /// Overwrites the start of the file.
    ///
    /// # Errors
    /// As [`Unfinished::append`]; a device that cannot seek.
    pub fn rewrite_head(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let file = self.file();
        let written = (file.seek(SeekFrom::Start(0))).and_then(|_| file.write_all(bytes));
        let written = written.and_then(|()| file.seek(SeekFrom::End(0)).map(drop));
        written.map_err(|error| cannot_write(&self.name, &error))
    }

    /// Stores the pieces written since the last call in the file's journal.
    ///
    /// # Errors
    /// As [`Unfinished::append`].
    pub fn store_journal(&mut self, journal: &mut Journal) -> Result<(), Failure> {
        let stored = journal.store(self.file());
        stored.map_err(|error| cannot_write(&self.name, &error))
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
