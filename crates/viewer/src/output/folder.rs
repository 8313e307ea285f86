//! A folder of outputs, such as a report's.

use super::Output;
use super::part_file::{is_part_folder_name, is_part_name, remove_abandoned};
use crate::failure::Failure;
use std::fs;
use std::path::{Path, PathBuf};

/// A folder for a report: new, empty, one that contains a report already, or any with `force`.
///
/// Its files appear one by one, each complete; other files in it stay.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// The file that marks a report's folder.
    pub const MARKER: &str = ".raycast-report";

    /// Its text.
    pub const MARKER_TEXT: &str = "\
A report of `raycast report` lies in this folder. Another one may be written over it without being asked for twice.
";

    /// The folder at `path`, created if it does not exist. With `force` it may contain anything.
    ///
    /// # Errors
    /// A folder that cannot be created or read; without `force`, one that is neither empty nor a report's.
    pub fn at(path: &Path, force: bool) -> Result<Self, Failure> {
        let cannot = |what: &str, error: std::io::Error| {
            Failure::could_not(format!("{}: cannot be {what}: {error}", path.display()))
        };
        fs::create_dir_all(path).map_err(|error| cannot("made", error))?;
        remove_abandoned(path);
        let mut is_empty = true;
        for entry in fs::read_dir(path).map_err(|error| cannot("read", error))? {
            let name = entry.map_err(|error| cannot("read", error))?.file_name();
            is_empty &= is_part_name(&name) || is_part_folder_name(&name);
        }
        if is_empty || force || path.join(Self::MARKER).is_file() {
            return Ok(Self {
                path: path.to_owned(),
            });
        }
        Err(Failure::could_not(format!(
            "{}: is not empty and holds no report: give --force to write one into it",
            path.display()
        )))
    }

    /// The output for a file in it.
    ///
    /// # Errors
    /// As [`Output::at`].
    pub fn file(&self, name: &str, inputs: &[&Path]) -> Result<Output, Failure> {
        Output::at(&self.path.join(name), inputs)
    }
}

#[cfg(test)]
mod tests {
    use super::super::part_file::part_name;
    use super::*;

    #[test]
    fn a_folder_of_something_else_is_asked_for_twice() {
        let there = tempfile::tempdir().expect("a folder");
        let new = there.path().join("new/report");
        let folder = Folder::at(&new, false).expect("a new folder");
        assert!(Folder::at(&new, false).is_ok(), "it is empty");
        // Leftovers of a killed command do not count.
        fs::write(new.join(part_name(1, 0)), b"half").expect("written");
        assert!(Folder::at(&new, false).is_ok());
        assert_eq!(fs::read_dir(&new).map(Iterator::count).ok(), Some(0));
        fs::write(new.join(".raycast-1-0.part"), b"somebody's own").expect("written");
        assert!(Folder::at(&new, false).is_err());
        fs::remove_file(new.join(".raycast-1-0.part")).expect("it was left alone");

        fs::write(new.join("thesis.md"), b"years of work").expect("written");
        let message = Folder::at(&new, false)
            .expect_err("not a report's")
            .to_string();
        assert!(message.contains("--force"), "{message}");
        assert!(Folder::at(&new, true).is_ok());

        let marker = folder.file(Folder::MARKER, &[]).expect("a place");
        let written = marker.write(Folder::MARKER_TEXT.as_bytes());
        written.expect("written").finish().expect("finished");
        assert!(Folder::at(&new, false).is_ok(), "it holds a report");

        let file = there.path().join("file");
        fs::write(&file, b"").expect("written");
        assert!(Folder::at(&file, true).is_err());
    }
}
