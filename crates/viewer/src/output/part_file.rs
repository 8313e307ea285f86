//! Part files: outputs under a temporary name until they are complete.

use super::file_identity::{is_same_file, parent_directory};
use raycast_core::digest::Digest;
use std::ffi::OsStr;
use std::fs::{self, File, Metadata, Permissions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

const PREFIX: &str = ".raycast-";
const SUFFIX: &str = ".part";
/// What follows a part file's name in the name of the part folder that it locks.
const FOLDER_SUFFIX: &str = "s";

/// The most part files of one process in one folder at a time.
const MAX_PART_FILES: u32 = 1 << 16;

/// The part files of this process, which a signal removes.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Locks the list of this process's part files. While it is locked none is created, renamed or removed.
pub(super) fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A locked part file; removed when dropped, unless [`PartFile::persist`] has renamed it.
#[derive(Debug)]
pub(super) struct PartFile {
    file: File,
    path: PathBuf,
    /// Whether it stays when dropped: it was renamed, or is kept for a later command.
    is_placed: bool,
}

impl PartFile {
    /// Opens the part file at `path` with its contents, or creates it; it stays until it is renamed, even if this
    /// command is interrupted. `is_private` is as in [`PartFile::create_in`].
    ///
    /// # Errors
    /// A file that cannot be opened, or that another command is writing.
    pub(super) fn keep_at(path: PathBuf, is_private: bool) -> io::Result<Self> {
        let file = open_resumable(&path, is_private)?;
        // A file system without locks shows no other writer.
        let is_held = matches!(file.try_lock(), Err(TryLockError::WouldBlock));
        if is_held || !is_same_file(&file, &path) {
            let reason = format!("another command is writing {}", path.display());
            return Err(io::Error::other(reason));
        }
        Ok(Self {
            file,
            path,
            is_placed: true,
        })
    }

    /// Creates an empty part file in `directory`. If `is_private` only its owner may read it; otherwise the umask
    /// decides.
    ///
    /// # Errors
    /// A directory that cannot be written.
    pub(super) fn create_in(directory: &Path, is_private: bool) -> io::Result<Self> {
        let mut options = File::options();
        options.read(true).write(true).create_new(true);
        #[cfg(unix)]
        {
            use std::os::unix::fs::OpenOptionsExt;
            options.mode(if is_private { 0o600 } else { 0o666 });
        }
        #[cfg(not(unix))]
        let _ = is_private;
        let process = std::process::id();
        let mut paths = unfinished();
        for number in 0..MAX_PART_FILES {
            let path = directory.join(part_name(process, number));
            if folder_of(&path).exists() {
                continue;
            }
            let file = match options.open(&path) {
                Ok(file) => file,
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                Err(error) => return Err(error),
            };
            // Before it is locked another process may consider it abandoned, lock it and remove it: then the next name
            // is tried.
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => continue,
                Ok(()) if !is_same_file(&file, &path) => continue,
                // A file system without locks: no process considers it abandoned there.
                Ok(()) | Err(TryLockError::Error(_)) => {}
            }
            paths.push(path.clone());
            return Ok(Self {
                file,
                path,
                is_placed: false,
            });
        }
        Err(io::Error::other("there are too many part files"))
    }

    /// Where the part folder is that this part file locks, if there is one. It exists only while this file does: it is
    /// created later, and renamed or removed earlier, so that whenever a process is killed a sweep finds both.
    pub(super) fn folder(&self) -> PathBuf {
        folder_of(&self.path)
    }

    /// The open file.
    pub(super) fn file(&mut self) -> &mut File {
        &mut self.file
    }

    /// Syncs the file to the disk and renames it, replacing an existing file.
    ///
    /// # Errors
    /// Those of the system. The existing file then stays, unless only syncing the folder failed.
    pub(super) fn persist(
        mut self,
        destination: &Path,
        permissions: Option<Permissions>,
    ) -> io::Result<()> {
        if let Some(permissions) = permissions {
            self.file.set_permissions(permissions)?;
        }
        self.file.flush()?;
        sync(&self.file)?;
        {
            let mut paths = unfinished();
            fs::rename(&self.path, destination)?;
            self.is_placed = true;
            paths.retain(|path| *path != self.path);
        }
        sync_directory(parent_directory(destination))
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        if !self.is_placed {
            let mut paths = unfinished();
            // A failure leaves it as a power cut would, for the next command to remove.
            let _ = fs::remove_file(&self.path);
            paths.retain(|path| *path != self.path);
        }
    }
}

/// Opens the file at `path` with its contents, or creates it. If `is_private` only its owner may read a new one.
///
/// # Errors
/// A file that cannot be opened; a link or a device, which no command leaves at such a name.
pub(super) fn open_resumable(path: &Path, is_private: bool) -> io::Result<File> {
    if fs::symlink_metadata(path).is_ok_and(|found| !found.is_file()) {
        let reason = format!("{} is no file", path.display());
        return Err(io::Error::other(reason));
    }
    let mut options = File::options();
    options.read(true).write(true).create(true).truncate(false);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.mode(if is_private { 0o600 } else { 0o666 });
    }
    #[cfg(not(unix))]
    let _ = is_private;
    options.open(path)
}

/// Removes the unlocked part files in `directory`: those of processes that were killed. What only resembles one, or
/// belongs to another user, stays.
pub(super) fn remove_abandoned(directory: &Path) {
    let Ok(entries) = fs::read_dir(directory) else {
        return;
    };
    for entry in entries.flatten() {
        if is_part_name(&entry.file_name()) {
            remove_if_abandoned(&entry.path());
        }
    }
}

/// Removes a part file, and before it the part folder that it locks, if it can be locked: its process has ended, or has
/// not locked it yet and will then create another.
fn remove_if_abandoned(path: &Path) {
    let Ok(found) = fs::symlink_metadata(path) else {
        return;
    };
    if !found.is_file() || !is_own(&found) {
        return;
    }
    let Ok(file) = File::options().read(true).write(true).open(path) else {
        return;
    };
    // Only the holder of the lock renames the file: what is at the path now stays.
    if file.try_lock().is_ok() && is_same_file(&file, path) && remove_folder(&folder_of(path)) {
        let _ = fs::remove_file(path);
    }
}

/// Removes this user's folder at `path`. Whether no folder is left there.
fn remove_folder(path: &Path) -> bool {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_dir() => is_own(&found) && fs::remove_dir_all(path).is_ok(),
        _ => true,
    }
}

/// Where the part folder is that the part file at `path` locks.
fn folder_of(path: &Path) -> PathBuf {
    let mut folder = path.as_os_str().to_owned();
    folder.push(FOLDER_SUFFIX);
    folder.into()
}

/// The name of a part file: its process, a number, and a checksum of both, which a file of somebody else has only if it
/// was made to look like one.
pub(super) fn part_name(process: u32, number: u32) -> String {
    let digest = Digest::of(format!("raycast part file {process} {number}").as_bytes());
    let check = u64::from_be_bytes(*digest.to_bytes().first_chunk().unwrap_or(&[0; 8]));
    format!("{PREFIX}{process}-{number}-{check:016x}{SUFFIX}")
}

/// Whether this is the name of a part folder.
pub(super) fn is_part_folder_name(name: &OsStr) -> bool {
    let name = name
        .to_str()
        .and_then(|name| name.strip_suffix(FOLDER_SUFFIX));
    name.is_some_and(|name| is_part_name(OsStr::new(name)))
}

/// Whether this is a name that [`PartFile::create_in`] gives.
pub(super) fn is_part_name(name: &OsStr) -> bool {
    let own = |name: &str| {
        let mut numbers = name.strip_prefix(PREFIX)?.split('-');
        let process = numbers.next()?.parse().ok()?;
        let number = numbers.next()?.parse().ok()?;
        Some(part_name(process, number))
    };
    name.to_str()
        .is_some_and(|name| own(name).is_some_and(|own| own == name))
}

/// Whether this user's processes made it.
#[cfg(unix)]
fn is_own(found: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    may_remove(rustix::process::geteuid().as_raw(), found.uid())
}

/// Whether a part file of `owner` may be one of `user`'s: the superuser gives a part file to the owner of the file that it
/// replaces.
#[cfg(unix)]
fn may_remove(user: u32, owner: u32) -> bool {
    user == 0 || user == owner
}

/// Other systems let nobody remove a file who may not write it.
#[cfg(not(unix))]
fn is_own(_: &Metadata) -> bool {
    true
}

/// Syncs a file to the disk; a file system that does not support this is not an error.
fn sync(file: &File) -> io::Result<()> {
    match file.sync_all() {
        Err(error) if !cannot_sync(&error) => Err(error),
        _ => Ok(()),
    }
}

/// Syncs a folder's entries to the disk. A folder without read permission cannot be synced.
#[cfg(unix)]
pub(super) fn sync_directory(directory: &Path) -> io::Result<()> {
    match File::open(directory) {
        Ok(directory) => sync(&directory),
        Err(_) => Ok(()),
    }
}

/// Other systems sync a name with its file.
#[cfg(not(unix))]
pub(super) fn sync_directory(_: &Path) -> io::Result<()> {
    Ok(())
}

fn cannot_sync(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(directory: &Path) -> usize {
        fs::read_dir(directory).map_or(0, Iterator::count)
    }

    #[test]
    fn only_names_that_are_given_are_taken_for_part_files() {
        for (process, number) in [(1, 0), (4_194_304, 12), (u32::MAX, MAX_PART_FILES - 1)] {
            let name = part_name(process, number);
            assert!(is_part_name(OsStr::new(&name)), "{name}");
            // Every other digit of the checksum, and every other process and number.
            for at in PREFIX.len()..name.len() - SUFFIX.len() {
                for with in "0123456789abcdef-".chars() {
                    let changed = format!("{}{with}{}", &name[..at], &name[at + 1..]);
                    assert!(
                        changed == name || !is_part_name(OsStr::new(&changed)),
                        "{changed}"
                    );
                }
            }
            for changed in [
                name[1..].to_owned(),
                format!("{name}.png"),
                name.replace(SUFFIX, ""),
                name.replacen('-', "-+", 2),
                name.replacen('-', "-0", 2),
            ] {
                assert!(!is_part_name(OsStr::new(&changed)), "{changed}");
            }
        }
        for bad in [
            ".raycast-1-0.part",
            ".raycast-1.part",
            ".raycast-notes.part",
            ".raycast--.part",
        ] {
            assert!(!is_part_name(OsStr::new(bad)), "{bad}");
        }
    }

    #[test]
    fn abandoned_files_are_removed_and_held_ones_are_not() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let held = PartFile::create_in(folder.path(), false).expect("a part file");
        let other = PartFile::create_in(folder.path(), true).expect("another");
        assert_ne!(held.path, other.path);
        for (process, number) in [(1, 0), (999_999_999, 7)] {
            let path = at(&part_name(process, number));
            fs::write(path, b"half").expect("a file of a process that is gone");
        }
        // Killed amid a folder: before it was begun, and before it was removed whole.
        fs::write(at(&part_name(2, 0)), b"").expect("a lock");
        let tiles = folder_of(&at(&part_name(2, 0))).join("0");
        fs::create_dir_all(&tiles).expect("a folder");
        fs::write(tiles.join("0_0.png"), b"half").expect("a tile");
        assert_eq!(count(folder.path()), 6);
        remove_abandoned(folder.path());
        assert_eq!(count(folder.path()), 2);
        assert!(held.path.is_file() && other.path.is_file());
        drop((held, other));
        assert_eq!(count(folder.path()), 0);
    }

    /// Somebody's own files and folders, however much their names resemble a part file's.
    #[test]
    fn a_sweep_removes_nothing_that_only_resembles_a_part_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let names = [
            ".raycast-1-0.part",
            ".raycast-999999999-7.part",
            ".raycast-1-0-0123456789abcdef.part",
            ".raycast-mine.part",
        ];
        for name in names {
            fs::write(at(name), b"somebody's own").expect("written");
        }
        for name in [".raycast-2-0.part", ".raycast-3-0.part"] {
            fs::create_dir(at(name)).expect("a folder");
        }
        fs::write(at(".raycast-3-0.part").join("notes"), b"somebody's own").expect("written");
        // Of the right names, but a folder, and without the file that locks it.
        fs::create_dir(at(&part_name(4, 0))).expect("a folder");
        fs::create_dir(folder_of(&at(&part_name(6, 0)))).expect("a folder");
        fs::write(
            folder_of(&at(&part_name(6, 0))).join("notes"),
            b"somebody's own",
        )
        .expect("written");
        #[cfg(unix)]
        std::os::unix::fs::symlink(".raycast-mine.part", at(&part_name(5, 0))).expect("a link");
        let before = count(folder.path());
        remove_abandoned(folder.path());
        assert_eq!(count(folder.path()), before);
        for name in names {
            assert_eq!(fs::read(at(name)).expect("it is there"), b"somebody's own");
        }
    }

    #[cfg(unix)]
    #[test]
    fn part_files_of_other_users_are_left_to_them() {
        assert!(may_remove(1000, 1000) && may_remove(0, 1000) && may_remove(0, 0));
        assert!(!may_remove(1000, 1001) && !may_remove(1000, 0));
    }

    #[test]
    fn what_is_put_in_its_place_is_no_longer_removed() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = folder.path().join("a");
        let mut part = PartFile::create_in(folder.path(), false).expect("a part file");
        part.file().write_all(b"all").expect("written");
        part.persist(&place, None).expect("renamed");
        remove_abandoned(folder.path());
        assert_eq!(fs::read(&place).expect("the file"), b"all");
        assert_eq!(count(folder.path()), 1);

        let part = PartFile::create_in(folder.path(), false).expect("a part file");
        assert!(part.persist(&folder.path().join("none/a"), None).is_err());
        assert_eq!(count(folder.path()), 1, "what cannot be put is removed");
    }

    /// Makers and sweepers in one folder: whoever has a part file, or a part folder, keeps it.
    #[test]
    fn a_sweep_takes_no_file_and_no_folder_from_its_maker() {
        let folder = tempfile::tempdir().expect("a folder");
        let is_done = std::sync::atomic::AtomicBool::new(false);
        let order = std::sync::atomic::Ordering::Relaxed;
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| {
                    while !is_done.load(order) {
                        remove_abandoned(folder.path());
                    }
                });
            }
            let makers: Vec<_> = (0..2)
                .map(|maker| {
                    let place = folder.path().join(format!("file {maker}"));
                    let folder = folder.path();
                    scope.spawn(move || {
                        for round in 0..50u32 {
                            let mut part = PartFile::create_in(folder, false).expect("a part file");
                            part.file()
                                .write_all(&round.to_le_bytes())
                                .expect("written");
                            part.persist(&place, None).expect("renamed");
                            let lock = PartFile::create_in(folder, false).expect("a part file");
                            fs::create_dir(lock.folder()).expect("a part folder");
                            let tile = lock.folder().join("tile");
                            fs::write(&tile, b"all").expect("it is still there");
                            assert_eq!(fs::read(&tile).expect("it still is"), b"all");
                            fs::remove_dir_all(lock.folder()).expect("nobody else removed it");
                        }
                    })
                })
                .collect();
            let made: Vec<_> = makers.into_iter().map(|maker| maker.join()).collect();
            is_done.store(true, order);
            assert!(made.iter().all(Result::is_ok), "a maker lost its file");
        });
        assert_eq!(count(folder.path()), 2);
    }
}
