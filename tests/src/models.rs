//! Real meshes, where the machine has them.

#![allow(
    clippy::print_stdout,
    reason = "tests tell what they checked and what they skipped"
)]

use std::path::PathBuf;

/// The folder that `RAYCAST_MODELS` names; `None`, said aloud, where it is not set.
pub fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("RAYCAST_MODELS").map(PathBuf::from);
    match &folder {
        Some(folder) => assert!(
            folder.is_dir(),
            "RAYCAST_MODELS names {}, which is no folder",
            folder.display()
        ),
        None => println!("skipped: RAYCAST_MODELS is not set"),
    }
    folder
}

/// The meshes in that folder, in the order of their names; none where it is not set.
pub fn meshes() -> Vec<PathBuf> {
    let Some(folder) = folder() else {
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
        .expect("RAYCAST_MODELS can be listed")
        .map(|entry| entry.expect("RAYCAST_MODELS can be listed").path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "obj" || extension == "txt")
        })
        .collect();
    files.sort();
    assert!(!files.is_empty(), "no mesh in {}", folder.display());
    files
}

/// A file of that folder; `None` where `RAYCAST_MODELS` is not set.
pub fn file(name: &str) -> Option<PathBuf> {
    let path = folder()?.join(name);
    assert!(path.is_file(), "{} is missing", path.display());
    Some(path)
}
