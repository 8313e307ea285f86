//! Files and folders for tests of the program, and its arguments.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder that is gone when the test is.
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder for temporary files")
}

/// One of the demo's files.
pub fn asset(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../assets")
        .join(name);
    assert!(path.is_file(), "{} is missing", path.display());
    path
}

/// One of the documentation's pictures.
pub fn documented(name: &str) -> PathBuf {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    docs.join(name)
}

/// A folder with copies of some of the demo's files.
pub fn folder_with(names: &[&str]) -> TempDir {
    let folder = folder();
    for name in names {
        std::fs::copy(asset(name), folder.path().join(name)).expect("the folder can be written");
    }
    folder
}

/// What a file holds.
pub fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Writes a file in a folder; its path.
pub fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    path
}

/// A ray as `raycast cast` reads it: origin, t_min, direction, t_max.
pub type FileRay = [f32; 8];

/// Writes a file of rays.
pub fn write_rays(path: &Path, rays: &[FileRay]) {
    let bytes: Vec<u8> = rays
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    std::fs::write(path, bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
}

/// A named pipe in a folder; its path.
#[cfg(unix)]
pub fn pipe(folder: &Path) -> PathBuf {
    let pipe = folder.join("pipe");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(
        made.is_ok_and(|status| status.success()),
        "a pipe can be made"
    );
    pipe
}

/// The names in a folder, in order.
pub fn names(folder: &Path) -> Vec<OsString> {
    let entries = std::fs::read_dir(folder).expect("the folder can be listed");
    let mut names: Vec<_> = entries
        .map(|entry| entry.expect("the folder can be listed").file_name())
        .collect();
    names.sort();
    names
}

/// Arguments: words, and paths where they stand between them.
#[macro_export]
macro_rules! arguments {
    ($($argument:expr),* $(,)?) => {
        vec![$(std::ffi::OsString::from($argument)),*]
    };
}
