//! Stepping through the files of a folder.

use std::path::{Path, PathBuf};

/// The file that is `step` files after `path` in its folder, by name, among those with one of these `endings`; the
/// first follows the last.
///
/// # Errors
/// A folder that cannot be read, or has no other such file: one line.
pub(super) fn neighbor(path: &Path, step: i32, endings: &[&str]) -> Result<PathBuf, String> {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let folder = path.parent().unwrap_or(&path);
    let cannot = |error: std::io::Error| format!("{}: {error}", folder.display());
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .map_err(cannot)?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|file| *file == path || (has_ending(file, endings) && file.is_file()))
        .collect();
    files.sort_by_key(|file| sort_key(file));
    let here = files.iter().position(|file| *file == path);
    let count = files.len() as i64;
    let next = match here {
        _ if count == 0 => None,
        // The file was removed: the position where it would be.
        None => Some(files.partition_point(|file| sort_key(file) < sort_key(&path)) as i64),
        Some(_) if count == 1 => None,
        Some(here) => Some(here as i64 + i64::from(step)),
    };
    match next {
        Some(next) => Ok(files.swap_remove(next.rem_euclid(count) as usize)),
        None => Err(format!("{} has no other mesh or scene", folder.display())),
    }
}

/// Whether a file's name has one of these endings, in any case.
pub(super) fn has_ending(file: &Path, endings: &[&str]) -> bool {
    let ending = file.extension().map(|ending| ending.to_string_lossy());
    ending.is_some_and(|ending| endings.iter().any(|of| ending.eq_ignore_ascii_case(of)))
}

/// A key that sorts names without regard to case.
fn sort_key(file: &Path) -> (String, PathBuf) {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    (name.to_lowercase(), file.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goes_round_the_folder_by_name() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["b.obj", "A.obj", "c.OBJ", "notes.md", "d.png"] {
            std::fs::write(folder.path().join(name), "").expect("written");
        }
        let next = |name: &str, step| {
            let found = neighbor(&folder.path().join(name), step, &["obj"]).expect("a neighbour");
            found
                .file_name()
                .expect("a name")
                .to_string_lossy()
                .into_owned()
        };
        assert_eq!(next("A.obj", 1), "b.obj");
        assert_eq!(next("b.obj", 1), "c.OBJ");
        assert_eq!(next("c.OBJ", 1), "A.obj");
        assert_eq!(next("A.obj", -1), "c.OBJ");
        assert_eq!(next("bb.obj", 1), "c.OBJ", "a file that is gone");
        let alone = tempfile::tempdir().expect("a folder");
        let only = alone.path().join("only.obj");
        std::fs::write(&only, "").expect("written");
        assert!(neighbor(&only, 1, &["obj"]).is_err());
    }
}
