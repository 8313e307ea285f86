//! Folders of many files that appear as one.

use super::file_identity::parent_directory;
use super::part_file::{LOCK, PartFile, sync_directory, unfinished};
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
    /// Held locked, so that nobody takes the folder for abandoned.
    lock: Option<File>,
}

impl PartFolder {
    /// A new, empty folder that is to be put at `place`, where nothing is.
    ///
    /// # Errors
    /// Something that is there; a directory that cannot be written.
    pub fn create(place: &Path) -> Result<Self, Failure> {
        let cannot = |error: io::Error| {
            Failure::could_not(format!("{}: cannot be made: {error}", place.display()))
        };
        if fs::symlink_metadata(place).is_ok() {
            return Err(cannot(io::Error::other("it is there already")));
        }
        let (path, lock) = PartFile::create_folder_in(parent_directory(place)).map_err(cannot)?;
        Ok(Self {
            path,
            place: place.to_owned(),
            lock: Some(lock),
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
        let cannot = |place: &Path, error: io::Error| {
            Failure::could_not(format!("{}: cannot be made: {error}", place.display()))
        };
        sync_file_system(&self.path).map_err(|error| cannot(&self.place, error))?;
        let mut paths = unfinished();
        let put = fs::remove_file(self.path.join(LOCK))
            .and_then(|()| fs::rename(&self.path, &self.place));
        put.map_err(|error| cannot(&self.place, error))?;
        self.lock = None;
        paths.retain(|path| *path != self.path);
        drop(paths);
        sync_directory(parent_directory(&self.place)).map_err(|error| cannot(&self.place, error))
    }
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
        if self.lock.is_some() {
            let mut paths = unfinished();
            // Nobody is there to be told; it is then as after a power cut.
            let _ = fs::remove_dir_all(&self.path);
            paths.retain(|path| *path != self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::part_file::{part_name, remove_abandoned};
    use super::*;

    #[test]
    fn a_folder_appears_as_one_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = folder.path().join("tiles");
        let count = || fs::read_dir(folder.path()).map_or(0, Iterator::count);
        let made = PartFolder::create(&place).expect("a folder");
        fs::write(made.path().join("a"), b"1").expect("written");
        remove_abandoned(folder.path());
        assert!(count() == 1 && !place.exists());
        drop(made);
        assert_eq!(count(), 0);
        let made = PartFolder::create(&place).expect("a folder");
        fs::write(made.path().join("a"), b"1").expect("written");
        made.persist().expect("renamed");
        assert_eq!(fs::read_dir(&place).map_or(0, Iterator::count), 1);
        assert!(PartFolder::create(&place).is_err());
        // Of a process that is gone.
        let abandoned = folder.path().join(part_name(1, 0));
        fs::create_dir(&abandoned).expect("a folder");
        remove_abandoned(folder.path());
        assert!(!abandoned.exists(), "it was killed before it was locked");
        fs::create_dir(&abandoned).expect("a folder");
        fs::write(abandoned.join(LOCK), b"").expect("written");
        fs::write(abandoned.join("tile"), b"half").expect("written");
        remove_abandoned(folder.path());
        assert!(!abandoned.exists());
    }
}
