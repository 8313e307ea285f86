//! Folders of many files that appear as one.

use super::file_identity::parent_directory;
use super::part_file::{PartFile, sync_directory, unfinished};
use crate::failure::Failure;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// A folder being written under a temporary name: removed when dropped, unless [`PartFolder::persist`] syncs it to the
/// disk and renames it.
#[derive(Debug)]
pub struct PartFolder {
    path: PathBuf,
    place: PathBuf,
    is_placed: bool,
    /// Beside it, so that nobody takes it for abandoned; removed after it.
    _lock: PartFile,
}

impl PartFolder {
    /// A new, empty folder that is to be put at `place`, where nothing is.
    ///
    /// # Errors
    /// Something that is there; a directory that cannot be written.
    pub fn create(place: &Path) -> Result<Self, Failure> {
        let cannot = |error: io::Error| cannot_make(place, &error);
        if fs::symlink_metadata(place).is_ok() {
            return Err(cannot(io::Error::other("it is there already")));
        }
        let lock = PartFile::create_in(parent_directory(place), false).map_err(cannot)?;
        let path = lock.folder();
        {
            let mut paths = unfinished();
            fs::create_dir(&path).map_err(cannot)?;
            // A signal removes it before its lock.
            paths.insert(0, path.clone());
        }
        Ok(Self {
            path,
            place: place.to_owned(),
            is_placed: false,
            _lock: lock,
        })
    }

    /// Where it is now.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Gives it its name.
    ///
    /// # Errors
    /// Something that is there by now.
    pub fn persist(mut self) -> Result<(), Failure> {
        sync_file_system(&self.path).map_err(|error| cannot_make(&self.place, &error))?;
        {
            let mut paths = unfinished();
            let put = fs::rename(&self.path, &self.place);
            put.map_err(|error| cannot_make(&self.place, &error))?;
            self.is_placed = true;
            paths.retain(|path| *path != self.path);
        }
        let synced = sync_directory(parent_directory(&self.place));
        synced.map_err(|error| cannot_make(&self.place, &error))
    }
}

fn cannot_make(place: &Path, error: &io::Error) -> Failure {
    Failure::could_not(format!("{}: cannot be made: {error}", place.display()))
}

/// Syncs a folder's file system to the disk: its files one by one would take minutes.
fn sync_file_system(folder: &Path) -> io::Result<()> {
    #[cfg(target_os = "linux")]
    rustix::fs::syncfs(File::open(folder)?)?;
    // The others on Unix know only all file systems.
    #[cfg(all(unix, not(target_os = "linux")))]
    rustix::fs::sync();
    let _ = folder;
    Ok(())
}

impl Drop for PartFolder {
    fn drop(&mut self) {
        if !self.is_placed {
            let mut paths = unfinished();
            // Nobody is there to be told; it is then as after a power cut.
            let _ = fs::remove_dir_all(&self.path);
            paths.retain(|path| *path != self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::part_file::remove_abandoned;
    use super::*;

    #[test]
    fn a_folder_appears_as_one_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = folder.path().join("tiles");
        let count = || fs::read_dir(folder.path()).map_or(0, Iterator::count);
        let made = PartFolder::create(&place).expect("a folder");
        fs::write(made.path().join("a"), b"1").expect("written");
        remove_abandoned(folder.path());
        assert!(count() == 2 && !place.exists(), "it and its lock");
        drop(made);
        assert_eq!(count(), 0);
        let made = PartFolder::create(&place).expect("a folder");
        fs::write(made.path().join("a"), b"1").expect("written");
        made.persist().expect("renamed");
        assert_eq!(fs::read_dir(&place).map_or(0, Iterator::count), 1);
        assert_eq!(count(), 1, "its lock is gone");
        assert!(PartFolder::create(&place).is_err());
        assert_eq!(count(), 1);
    }
}
