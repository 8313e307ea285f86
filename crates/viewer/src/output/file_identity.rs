//! The identity of files, whatever their names.

use std::ffi::OsString;
use std::fs::{self, File, Metadata};
use std::io;
use std::path::{Path, PathBuf};

/// The longest chain of links that is followed, as on Linux.
const LINKS: usize = 40;

/// The identity of a file: all names of one file have the same.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Identity {
    /// Of an existing file.
    Present(FileId),
    /// Of a file that does not exist: its folder, and its name there.
    Absent(FileId, OsString),
}

/// Device and inode.
#[cfg(unix)]
type FileId = (u64, u64);

/// The canonical path, where a system offers nothing better.
#[cfg(not(unix))]
type FileId = PathBuf;

impl Identity {
    /// The identity of the file at `path`; `None` for an invalid path.
    pub(super) fn of(path: &Path) -> Option<Self> {
        if let Some(id) = file_id(path) {
            return Some(Self::Present(id));
        }
        let path = resolve_links(path).ok()?;
        let name = path.file_name()?.to_owned();
        Some(Self::Absent(file_id(parent_directory(&path))?, name))
    }
}

#[cfg(unix)]
fn file_id(path: &Path) -> Option<FileId> {
    fs::metadata(path).ok().map(|found| file_id_of(&found))
}

#[cfg(unix)]
fn file_id_of(found: &Metadata) -> FileId {
    use std::os::unix::fs::MetadataExt;
    (found.dev(), found.ino())
}

#[cfg(not(unix))]
fn file_id(path: &Path) -> Option<FileId> {
    fs::canonicalize(path).ok()
}

/// Whether `path` itself, not its link's target, is still the open `file`.
#[cfg(unix)]
pub(super) fn is_same_file(file: &File, path: &Path) -> bool {
    let id = |found: io::Result<Metadata>| found.ok().map(|found| file_id_of(&found));
    let open = id(file.metadata());
    open.is_some() && open == id(fs::symlink_metadata(path))
}

/// Whether there is a file at `path`: these systems reserve the name of an open file.
#[cfg(not(unix))]
pub(super) fn is_same_file(_: &File, path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|found: Metadata| found.is_file())
}

/// The end of a chain of links, whether a file exists there or not.
///
/// # Errors
/// An endless chain; links that cannot be read.
pub(super) fn resolve_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..LINKS {
        if !fs::symlink_metadata(&path).is_ok_and(|found| found.is_symlink()) {
            return Ok(path);
        }
        let target = fs::read_link(&path)?;
        path = parent_directory(&path).join(target);
    }
    Err(io::Error::other("it is a link that leads nowhere"))
}

/// The directory that a file is in.
pub(super) fn parent_directory(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn all_names_of_a_file_are_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        fs::write(at("file"), b"").expect("a file");
        fs::write(at("other"), b"").expect("a file");
        fs::create_dir(at("folder")).expect("a folder");
        fs::hard_link(at("file"), at("hard")).expect("a hard link");
        symlink("file", at("link")).expect("a link");
        symlink("link", at("link to a link")).expect("a link");
        symlink("new", at("dangling")).expect("a link");
        let same = |a: &str, b: &str| {
            let a = Identity::of(&at(a));
            a.is_some() && a == Identity::of(&at(b))
        };
        for name in ["hard", "link", "link to a link", "folder/../file", "./file"] {
            assert!(same("file", name), "{name}");
        }
        assert!(!same("file", "other"));
        assert!(same("new", "dangling") && same("new", "folder/../new"));
        assert!(!same("new", "file") && !same("new", "newer"));
        assert_eq!(Identity::of(&at("none/file")), None);
    }

    #[test]
    fn links_are_followed_to_their_end_or_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("folder")).expect("a folder");
        symlink("folder/second", at("first")).expect("a link");
        symlink("../end", at("folder/second")).expect("a link");
        let end = resolve_links(&at("first")).expect("an end");
        assert_eq!(end, at("folder/../end"));
        symlink("b", at("a")).expect("a link");
        symlink("a", at("b")).expect("a link");
        assert!(resolve_links(&at("a")).is_err());
    }

    #[test]
    fn a_name_that_was_given_to_another_file_is_not_the_open_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("file");
        let file = File::create(&path).expect("a file");
        assert!(is_same_file(&file, &path));
        fs::rename(&path, folder.path().join("elsewhere")).expect("renamed");
        assert!(!is_same_file(&file, &path));
        symlink("elsewhere", &path).expect("a link");
        assert!(!is_same_file(&file, &path), "a link to it is not itself");
    }
}
