//! Files that are written whole or not at all, and standard output.

use crate::failure::Failure;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// Files that are being written, for [`remove_unfinished_on_interrupt`].
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From now on Ctrl-C (or being told to end) removes files that are not finished, and exits with
/// 130.
pub fn remove_unfinished_on_interrupt() {
    let handler = || {
        // Held until the process is gone: no file is made, or finished, in between.
        let paths = unfinished();
        for path in paths.iter() {
            let _ = fs::remove_file(path);
        }
        std::process::exit(130);
    };
    // Refused only where a handler stands already; the files are then merely not tidied up.
    let _ = ctrlc::set_handler(handler);
}

/// A place to write to, checked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    path: PathBuf,
    is_device: bool,
}

impl Output {
    /// A file that can be made at `path`, in a directory that exists, and is none of `inputs` (nor
    /// of this command's other outputs, if they are among them). A link is followed to its end.
    ///
    /// # Errors
    /// A directory that is missing or cannot be written, a path that is a directory, an input.
    pub fn at(path: &Path, inputs: &[&Path]) -> Result<Self, Failure> {
        let cannot = |reason: &dyn std::fmt::Display| {
            Failure::could_not(format!("{}: cannot be written: {reason}", path.display()))
        };
        let mut output = Self {
            path: path.to_owned(),
            is_device: false,
        };
        if let Ok(found) = fs::metadata(path) {
            if found.is_dir() {
                return Err(cannot(&"it is a directory"));
            }
            output.path = fs::canonicalize(path).map_err(|error| cannot(&error))?;
            output.is_device = !found.is_file();
        }
        output.check_against(inputs.iter().copied())?;
        if path.file_name().is_none() {
            return Err(cannot(&"it names no file"));
        }
        if !output.is_device {
            let directory = directory_of(&output.path);
            if !directory.is_dir() {
                let reason = format!("there is no directory {}", directory.display());
                return Err(cannot(&reason));
            }
            // Better now than after the work.
            output.create()?;
        }
        Ok(output)
    }

    /// Checks that the place is none of `inputs`.
    ///
    /// # Errors
    /// The one that it is.
    pub fn check_against<'p>(
        &self,
        inputs: impl IntoIterator<Item = &'p Path>,
    ) -> Result<(), Failure> {
        let place = place_of(&self.path);
        match inputs
            .into_iter()
            .find(|input| place.is_some() && place_of(input) == place)
        {
            Some(input) => Err(Failure::usage(format!(
                "{}: cannot be written: this command reads or writes it already",
                input.display()
            ))),
            None => Ok(()),
        }
    }

    /// Begins to write, beside the place itself.
    ///
    /// # Errors
    /// A directory that cannot be written.
    pub fn create(&self) -> Result<Unfinished, Failure> {
        let cannot = |error: io::Error| {
            Failure::could_not(format!(
                "{}: cannot be written: {error}",
                self.path.display()
            ))
        };
        let sink = if self.is_device {
            let device = File::options().write(true).open(&self.path);
            Sink::Device(device.map_err(cannot)?)
        } else {
            let mut paths = unfinished();
            let file = new_file_in(directory_of(&self.path)).map_err(cannot)?;
            paths.push(file.path().to_owned());
            Sink::File(file)
        };
        Ok(Unfinished {
            sink: Some(sink),
            destination: self.path.clone(),
        })
    }

    /// Writes all of a file's bytes, ready to be finished.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, bytes: &[u8]) -> Result<Unfinished, Failure> {
        let mut file = self.create()?;
        match file.write_all(bytes) {
            Ok(()) => Ok(file),
            Err(error) => Err(Failure::could_not(format!(
                "{}: cannot be written: {error}",
                self.path.display()
            ))),
        }
    }
}

/// Writes to standard output. A reader that went away has seen enough: that is no failure.
///
/// # Errors
/// Anything else that keeps it from being written.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::could_not(
            format!("standard output could not be written: {error}"),
        )),
        _ => Ok(()),
    }
}

/// A file's one name, whether it is there already or not; `None` where it cannot be.
fn place_of(path: &Path) -> Option<PathBuf> {
    fs::canonicalize(path).ok().or_else(|| {
        let directory = fs::canonicalize(directory_of(path)).ok()?;
        Some(directory.join(path.file_name()?))
    })
}

/// The directory that a file is in.
fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    }
}

/// A new file that everybody whom the umask allows can read: temporary files alone are private.
fn new_file_in(directory: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".raycast-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(directory)
}

/// A file under way: gone when dropped, unless [`Unfinished::finish`] puts it in its place.
#[derive(Debug)]
pub struct Unfinished {
    sink: Option<Sink>,
    destination: PathBuf,
}

#[derive(Debug)]
enum Sink {
    File(NamedTempFile),
    Device(File),
}

impl Unfinished {
    /// Puts the file in its place, at once.
    ///
    /// # Errors
    /// A file that cannot be put there.
    pub fn finish(mut self) -> Result<(), Failure> {
        let mut paths = unfinished();
        match self.sink.take() {
            Some(Sink::File(file)) => {
                paths.retain(|path| path != file.path());
                file.persist(&self.destination).map_err(|error| {
                    Failure::could_not(format!(
                        "{}: cannot be written: {}",
                        self.destination.display(),
                        error.error
                    ))
                })?;
            }
            Some(Sink::Device(_)) | None => {}
        }
        Ok(())
    }
}

impl Write for Unfinished {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.sink {
            Some(Sink::File(file)) => file.write(bytes),
            Some(Sink::Device(device)) => device.write(bytes),
            None => Ok(0),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.sink {
            Some(Sink::File(file)) => file.flush(),
            Some(Sink::Device(device)) => device.flush(),
            None => Ok(()),
        }
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if let Some(Sink::File(file)) = self.sink.take() {
            let mut paths = unfinished();
            paths.retain(|path| path != file.path());
            // Dropped before the lock is: an interrupt finds no path of a file that is still there.
            drop(file);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(directory)
            .expect("a directory")
            .map(|entry| {
                entry
                    .expect("an entry")
                    .file_name()
                    .to_string_lossy()
                    .into_owned()
            })
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_appears_when_it_is_finished() {
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path().join("out.png");
        fs::write(&path, b"old").expect("the old file");
        let output = Output::at(&path, &[]).expect("a place");
        let file = output.write(b"new").expect("written");
        assert_eq!(fs::read(&path).expect("the old file"), b"old");
        file.finish().expect("finished");
        assert_eq!(fs::read(&path).expect("the new file"), b"new");
        assert_eq!(names(directory.path()), ["out.png"]);
    }

    #[test]
    fn a_file_that_is_not_finished_leaves_nothing() {
        let directory = tempfile::tempdir().expect("a directory");
        let output = Output::at(&directory.path().join("out.png"), &[]).expect("a place");
        let file = output.write(b"half").expect("written");
        assert_eq!(names(directory.path()).len(), 1);
        drop(file);
        assert!(names(directory.path()).is_empty());
    }

    #[test]
    fn refuses_inputs_and_places_that_are_not_there() {
        let directory = tempfile::tempdir().expect("a directory");
        let input = directory.path().join("mesh.obj");
        fs::write(&input, b"v 0 0 0").expect("an input");
        let roundabout = directory.path().join(".").join("mesh.obj");
        assert!(matches!(
            Output::at(&roundabout, &[&input]),
            Err(Failure::Usage(_))
        ));
        let nowhere = directory.path().join("missing").join("out.png");
        assert!(matches!(
            Output::at(&nowhere, &[]),
            Err(Failure::CouldNot(_))
        ));
        assert!(matches!(
            Output::at(directory.path(), &[]),
            Err(Failure::CouldNot(_))
        ));
        assert_eq!(names(directory.path()), ["mesh.obj"]);
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let directory = tempfile::tempdir().expect("a directory");
        let (ours, plain) = (
            directory.path().join("ours"),
            directory.path().join("plain"),
        );
        let output = Output::at(&ours, &[]).expect("a place");
        output
            .write(b"")
            .and_then(Unfinished::finish)
            .expect("written");
        fs::write(&plain, b"").expect("written");
        let mode = |path| fs::metadata(path).expect("a file").permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
