//! The names in a folder, for the path line.

use super::dialog::{DIALOG_ENDINGS, IMAGE_ENDINGS};
use super::neighbors::has_ending;
use crate::state::PromptKind;
use crate::state::listing::{Listing, path_of};
use std::path::MAIN_SEPARATOR;

/// The folders in a folder and its files of the kind that is asked for; none where it cannot be read.
pub(super) fn names(folder: String, kind: PromptKind) -> Listing {
    let endings = match kind {
        PromptKind::Open | PromptKind::Add => DIALOG_ENDINGS,
        PromptKind::Texture | PromptKind::TextureOf(_) => IMAGE_ENDINGS,
        // Any file can be replaced, and its name be a start.
        PromptKind::Picture
        | PromptKind::Scene
        | PromptKind::SceneCopy
        | PromptKind::Meshes
        | PromptKind::Measurements
        | PromptKind::Outline(_) => &[],
    };
    let path = match folder.is_empty() {
        true => ".".into(),
        false => path_of(&folder),
    };
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .filter_map(|entry| {
            let path = entry.path();
            // A path line has no way to write a name that is not Unicode.
            let name = entry.file_name().into_string().ok()?;
            match path.is_dir() {
                true => Some(format!("{name}{MAIN_SEPARATOR}")),
                false => (endings.is_empty() || has_ending(&path, endings)).then_some(name),
            }
        })
        .collect();
    names.sort_by_cached_key(|name| (name.to_lowercase(), name.clone()));
    Listing { folder, names }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_folders_and_files_of_the_kind_that_is_asked_for() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["b.obj", "A.PLY", "notes.md", "skin.png"] {
            std::fs::write(folder.path().join(name), "").expect("written");
        }
        std::fs::create_dir(folder.path().join("more")).expect("made");
        let typed = format!("{}{MAIN_SEPARATOR}", folder.path().display());
        let found = |kind| names(typed.clone(), kind);
        let more = format!("more{MAIN_SEPARATOR}");
        assert_eq!(found(PromptKind::Open).folder, typed);
        assert_eq!(found(PromptKind::Open).names, ["A.PLY", "b.obj", &more]);
        assert_eq!(found(PromptKind::Texture).names, [&*more, "skin.png"]);
        assert_eq!(found(PromptKind::Scene).names.len(), 5);
        let gone = names("no such folder/".to_owned(), PromptKind::Open);
        assert!(gone.names.is_empty());
    }
}
