//! Output files, checked before the work, and written atomically.

use super::file_identity::{Identity, parent_directory, resolve_links};
use super::journal::Journal;
use super::part_file::{PartFile, remove_abandoned};
use super::unfinished::{Sink, Unfinished, cannot_write};
use crate::failure::Failure;
use raycast_core::digest::Digest;
use std::fmt::Display;
use std::fs::{self, File, Metadata};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A checked path of an output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// The path as given, for messages.
    name: PathBuf,
    /// The path after following links.
    path: PathBuf,
    is_device: bool,
}

impl Output {
    /// An output at `name`: in a directory that exists, and none of `inputs` (nor of this command's other outputs, if
    /// they are among them). A link is followed to its end. Abandoned part files are removed from the directory.
    ///
    /// # Errors
    /// An input, as bad usage. A directory that is missing or cannot be written, a path that is a directory, a file
    /// that is not writable or that cannot be replaced.
    pub fn at(name: &Path, inputs: &[&Path]) -> Result<Self, Failure> {
        let cannot = |reason: &dyn Display| cannot_write(name, reason);
        let (path, is_device) = match fs::metadata(name) {
            Ok(found) if found.is_dir() => return Err(cannot(&"it is a directory")),
            // The end of the links is not used: a pipe's has no name.
            Ok(found) if !found.is_file() => (name.to_owned(), true),
            Ok(_) | Err(_) => (resolve_links(name).map_err(|error| cannot(&error))?, false),
        };
        let output = Self {
            name: name.to_owned(),
            path,
            is_device,
        };
        output.check_against(inputs.iter().copied())?;
        if name.file_name().is_none() || ends_as_folder(name) {
            return Err(cannot(&"it names no file"));
        }
        if !is_device {
            let directory = parent_directory(&output.path);
            if !directory.is_dir() {
                let reason = format!("there is no directory {}", directory.display());
                return Err(cannot(&reason));
            }
            remove_abandoned(directory);
            // Failing now is better than after the work.
            output.create()?;
        }
        Ok(output)
    }

    /// An output that accompanies this one and is named after it, as [`Output::at`]. It is replaced only if this one
    /// exists as well; otherwise it belongs to somebody else, and the command line does not mention it.
    ///
    /// # Errors
    /// As [`Output::at`]; a file that exists without this one.
    pub fn beside(&self, name: &Path, inputs: &[&Path]) -> Result<Self, Failure> {
        let output = Self::at(name, inputs)?;
        if output.is_taken() && !self.is_taken() {
            let own = self.name.display();
            return Err(cannot_write(
                name,
                &format!("it is there already, and {own}, which it would go with, is not"),
            ));
        }
        Ok(output)
    }

    /// Checks that the output is none of `inputs`, under any name. Devices may be both.
    ///
    /// # Errors
    /// The input that it is.
    pub fn check_against<P: AsRef<Path>>(
        &self,
        inputs: impl IntoIterator<Item = P>,
    ) -> Result<(), Failure> {
        let Some(place) = Identity::of(&self.path).filter(|_| !self.is_device) else {
            return Ok(());
        };
        for input in inputs {
            let input = input.as_ref();
            if Identity::of(input).as_ref() == Some(&place) {
                return Err(input_error(&self.name, input));
            }
        }
        Ok(())
    }

    /// Checks that none of many outputs is one of `inputs`, before the first is written.
    ///
    /// # Errors
    /// The first one that is.
    pub fn check_all(names: &[PathBuf], inputs: &[PathBuf]) -> Result<(), Failure> {
        let inputs: Vec<_> = inputs
            .iter()
            .filter_map(|input| Some((input, Identity::of(input)?)))
            .collect();
        for name in names {
            let place = Identity::of(name);
            if let Some((input, _)) = inputs.iter().find(|(_, id)| Some(id) == place.as_ref()) {
                return Err(input_error(name, input));
            }
        }
        Ok(())
    }

    /// Whether a file exists that would be replaced.
    pub fn is_taken(&self) -> bool {
        !self.is_device && self.path.exists()
    }

    /// Starts a part file beside the output.
    ///
    /// # Errors
    /// A directory that cannot be written, a file that is not writable or cannot be replaced.
    pub fn create(&self) -> Result<Unfinished, Failure> {
        let sink = if self.is_device {
            Sink::Device(self.open_existing()?)
        } else {
            let cannot = |error: io::Error| self.cannot(&error);
            let replaced = self.replaced()?;
            let mut part = PartFile::create_in(parent_directory(&self.path), replaced.is_some())
                .map_err(cannot)?;
            if let Some(replaced) = &replaced {
                copy_owner(replaced, part.file()).map_err(|reason| self.cannot(&reason))?;
            }
            Sink::Part {
                part,
                permissions: replaced.map(|replaced| replaced.permissions()),
            }
        };
        Ok(self.part_output(sink))
    }

    /// Starts a part file with a `head` and a journal, or resumes those of an earlier command for the file of this
    /// `key`. Both stay until the file is finished.
    ///
    /// # Errors
    /// As [`Output::create`]; another command that writes the same file; files of those names that none wrote.
    pub fn resume(&self, key: Digest, head: &[u8]) -> Result<(Unfinished, Journal), Failure> {
        let cannot = |error: io::Error| self.cannot(&error);
        if self.is_device {
            return Err(self.cannot(&"what is written to a device cannot be resumed"));
        }
        let replaced = self.replaced()?;
        let mut name = std::ffi::OsString::from(".");
        name.push(self.path.file_name().unwrap_or_default());
        let beside = |suffix: &str| {
            let mut name = name.clone();
            name.push(suffix);
            parent_directory(&self.path).join(name)
        };
        let mut part =
            PartFile::keep_at(beside(".raycast-part"), replaced.is_some()).map_err(cannot)?;
        let journal =
            Journal::open(beside(".raycast-journal"), key, head, part.file()).map_err(cannot)?;
        if let Some(replaced) = &replaced {
            copy_owner(replaced, part.file()).map_err(|reason| self.cannot(&reason))?;
        }
        let sink = Sink::Part {
            part,
            permissions: replaced.map(|replaced| replaced.permissions()),
        };
        Ok((self.part_output(sink), journal))
    }

    fn part_output(&self, sink: Sink) -> Unfinished {
        Unfinished {
            sink,
            name: self.name.clone(),
            path: self.path.clone(),
        }
    }

    /// Whether written bytes can be overwritten.
    pub fn can_seek(&self) -> bool {
        !self.is_device
    }

    /// Writes all of a file's bytes, ready to be finished.
    ///
    /// # Errors
    /// As [`Output::create`]; a full disk.
    pub fn write(&self, bytes: &[u8]) -> Result<Unfinished, Failure> {
        let mut file = self.create()?;
        file.write_all(bytes).map_err(|error| self.cannot(&error))?;
        Ok(file)
    }

    /// Truncates the file and opens it in place, so that it is visible while it grows.
    ///
    /// # Errors
    /// Those of the system.
    pub fn open_in_place(&self) -> Result<File, Failure> {
        if self.is_device {
            return self.open_existing();
        }
        File::create(&self.path).map_err(|error| self.cannot(&error))
    }

    /// The file that will be replaced, if there is one; it must be writable.
    fn replaced(&self) -> Result<Option<Metadata>, Failure> {
        match fs::metadata(&self.path) {
            Ok(found) => {
                self.open_existing()?;
                Ok(Some(found))
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(self.cannot(&error)),
        }
    }

    fn open_existing(&self) -> Result<File, Failure> {
        let opened = File::options().write(true).open(&self.path);
        opened.map_err(|error| self.cannot(&error))
    }

    fn cannot(&self, reason: &dyn Display) -> Failure {
        cannot_write(&self.name, reason)
    }
}

fn input_error(name: &Path, input: &Path) -> Failure {
    let is = if input == name {
        String::new()
    } else {
        format!("it is {}, and ", input.display())
    };
    let name = name.display();
    Failure::usage(format!(
        "{name}: cannot be written: {is}this command reads or writes that already"
    ))
}

/// Whether a path ends with a separator, as no file's does.
fn ends_as_folder(path: &Path) -> bool {
    let last = path.as_os_str().as_encoded_bytes().last();
    last.is_some_and(|&byte| std::path::is_separator(byte.into()))
}

/// Gives a new file the owner and group of the file that it replaces.
#[cfg(unix)]
fn copy_owner(replaced: &Metadata, new: &File) -> Result<(), String> {
    use std::os::unix::fs::{MetadataExt, fchown};
    let made = new.metadata().map_err(|error| error.to_string())?;
    let owner = (made.uid() != replaced.uid()).then_some(replaced.uid());
    let group = (made.gid() != replaced.gid()).then_some(replaced.gid());
    if owner.is_none() && group.is_none() {
        return Ok(());
    }
    fchown(new, owner, group).map_err(|error| {
        format!(
            "it belongs to user {} and group {}, to whom a new file cannot be given: {error}",
            replaced.uid(),
            replaced.gid()
        )
    })
}

#[cfg(not(unix))]
fn copy_owner(_: &Metadata, _: &File) -> Result<(), String> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::Permissions;

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

    fn write(path: &Path, bytes: &[u8]) {
        let output = Output::at(path, &[]).expect("a place");
        let file = output.write(bytes).expect("written");
        file.finish().expect("finished");
    }

    #[test]
    fn a_file_appears_when_it_is_finished() {
        let directory = tempfile::tempdir().expect("a directory");
        let path = directory.path().join("out.png");
        fs::write(&path, b"old").expect("the old file");
        let output = Output::at(&path, &[]).expect("a place");
        assert!(output.is_taken());
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
        assert!(!output.is_taken());
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
        let folder = directory.path().join("new.png/");
        assert!(matches!(
            Output::at(&folder, &[]),
            Err(Failure::CouldNot(_))
        ));
        assert_eq!(names(directory.path()), ["mesh.obj"]);
    }

    #[test]
    fn a_file_that_is_named_after_another_is_replaced_with_that_alone() {
        let directory = tempfile::tempdir().expect("a directory");
        let at = |name: &str| directory.path().join(name);
        let own = Output::at(&at("a"), &[]).expect("a place");
        assert!(own.beside(&at("a.b"), &[]).is_ok());
        fs::write(at("a.b"), b"somebody's own").expect("written");
        let refused = own.beside(&at("a.b"), &[]);
        assert!(refused.is_err_and(|error| error.to_string().contains("it is there already")));
        fs::write(at("a"), b"").expect("written");
        assert!(own.beside(&at("a.b"), &[]).is_ok());
    }

    #[test]
    fn two_outputs_are_not_one_file_even_before_it_is_there() {
        let directory = tempfile::tempdir().expect("a directory");
        let at = |name: &str| directory.path().join(name);
        let refused = Output::at(&at("./a"), &[&at("a")]);
        assert!(matches!(refused, Err(Failure::Usage(_))));
        assert!(Output::at(&at("b"), &[&at("a")]).is_ok());
    }

    #[cfg(unix)]
    mod unix {
        use super::*;
        use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};

        fn mode(path: &Path) -> u32 {
            fs::metadata(path).expect("a file").permissions().mode() & 0o7777
        }

        #[test]
        fn a_new_file_has_the_mode_of_any_new_file() {
            let directory = tempfile::tempdir().expect("a directory");
            let ours = directory.path().join("ours");
            let plain = directory.path().join("plain");
            write(&ours, b"");
            fs::write(&plain, b"").expect("written");
            assert_eq!(mode(&ours), mode(&plain));
        }

        #[test]
        fn a_replaced_file_keeps_its_mode() {
            let directory = tempfile::tempdir().expect("a directory");
            let path = directory.path().join("a");
            for kept in [0o600, 0o640, 0o755, 0o666] {
                fs::write(&path, b"old").expect("written");
                fs::set_permissions(&path, Permissions::from_mode(kept)).expect("set");
                write(&path, b"new");
                assert_eq!(mode(&path), kept, "{kept:o}");
            }
        }

        /// The superuser replaces it, and it stays read-only; others are refused.
        #[test]
        fn a_read_only_file_is_not_replaced_by_who_may_not_write_it() {
            let directory = tempfile::tempdir().expect("a directory");
            let path = directory.path().join("a");
            fs::write(&path, b"old").expect("written");
            fs::set_permissions(&path, Permissions::from_mode(0o444)).expect("set");
            let may_write = File::options().write(true).open(&path).is_ok();
            match Output::at(&path, &[]) {
                Ok(_) => {
                    assert!(may_write);
                    write(&path, b"new");
                    assert_eq!(mode(&path), 0o444);
                }
                Err(failure) => {
                    assert!(!may_write, "{failure}");
                    assert_eq!(fs::read(&path).expect("the old file"), b"old");
                }
            }
            assert_eq!(names(directory.path()), ["a"]);
        }

        /// The superuser, who may change owners, restores the owner.
        #[test]
        fn a_replaced_file_keeps_its_owner() {
            let directory = tempfile::tempdir().expect("a directory");
            let path = directory.path().join("a");
            fs::write(&path, b"old").expect("written");
            if std::os::unix::fs::chown(&path, Some(12_345), Some(54_321)).is_err() {
                return;
            }
            write(&path, b"new");
            let found = fs::metadata(&path).expect("a file");
            assert_eq!((found.uid(), found.gid()), (12_345, 54_321));
            assert_eq!(fs::read(&path).expect("the new file"), b"new");
        }

        #[test]
        fn links_stay_links_also_where_nothing_is_at_their_end() {
            let directory = tempfile::tempdir().expect("a directory");
            let at = |name: &str| directory.path().join(name);
            fs::create_dir(at("there")).expect("a directory");
            symlink("there/new", at("dangling")).expect("a link");
            for bytes in [&b"first"[..], b"second"] {
                write(&at("dangling"), bytes);
                assert_eq!(fs::read(at("there/new")).expect("the file"), bytes);
                assert!(at("dangling").is_symlink());
            }
            symlink("nowhere/new", at("lost")).expect("a link");
            assert!(Output::at(&at("lost"), &[]).is_err());
            symlink("circle", at("circle")).expect("a link");
            assert!(Output::at(&at("circle"), &[]).is_err());
            assert_eq!(names(&at("there")), ["new"]);
        }

        #[test]
        fn an_input_is_found_behind_links() {
            let directory = tempfile::tempdir().expect("a directory");
            let at = |name: &str| directory.path().join(name);
            fs::write(at("input"), b"in").expect("written");
            fs::hard_link(at("input"), at("hard")).expect("a hard link");
            symlink("input", at("soft")).expect("a link");
            for name in ["hard", "soft"] {
                let refused = Output::at(&at(name), &[&at("input")]);
                let Err(Failure::Usage(_)) = refused else {
                    panic!("{name}: {refused:?}");
                };
                let output = Output::at(&at(name), &[]).expect("a place");
                assert!(output.check_against([at("input")]).is_err(), "{name}");
                assert!(output.check_against([at("other")]).is_ok(), "{name}");
            }
        }

        #[test]
        fn a_device_is_written_where_it_is() {
            let null = Path::new("/dev/null");
            let output = Output::at(null, &[null]).expect("it may be read and written");
            assert!(!output.is_taken());
            let file = output.write(b"gone").expect("written");
            file.finish().expect("finished");
            let full = Path::new("/dev/full");
            if full.exists() {
                let output = Output::at(full, &[]).expect("a place");
                let failure = output.write(b"all").expect_err("it is full");
                assert!(
                    failure
                        .to_string()
                        .starts_with("/dev/full: cannot be written")
                );
            }
        }
    }
}
