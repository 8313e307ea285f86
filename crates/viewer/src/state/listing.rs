//! The names in the folder of the path that is being typed.

use std::path::PathBuf;

/// A folder's names, for a path line to suggest.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listing {
    /// The folder, as it is typed: the path up to its last separator; empty for the working folder.
    pub folder: String,
    /// Files and folders in it, sorted; a folder's name ends in a separator. None before they are read.
    pub names: Vec<String>,
}

impl Listing {
    /// The names that complete `word`, without regard to case. Nothing completes a name in the folder, so that it can be
    /// confirmed where longer ones begin with it; and a hidden name completes only what begins with its dot.
    pub fn completing(&self, word: &str) -> impl Iterator<Item = &String> {
        let start = word.to_lowercase();
        let is_complete = self.names.iter().any(|name| name == word);
        self.names.iter().filter(move |name| {
            let is_meant = !name.starts_with('.') || start.starts_with('.');
            !is_complete && is_meant && name.to_lowercase().starts_with(&start)
        })
    }
}

/// The folder of a path as it is typed, up to its last separator.
pub fn folder_of(text: &str) -> &str {
    let end = text.rfind(std::path::is_separator);
    end.map_or("", |at| &text[..=at])
}

/// The path that a text means: `~/` is the home folder.
pub fn path_of(text: &str) -> PathBuf {
    match text.strip_prefix("~/").zip(std::env::home_dir()) {
        Some((rest, home)) => home.join(rest),
        None => PathBuf::from(text),
    }
}

/// A path as messages name it: the window does not show which folder the program was started in.
pub fn in_working_folder(path: PathBuf) -> PathBuf {
    std::path::absolute(&path).unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_complete_what_is_typed_whatever_its_case() {
        let listing = Listing {
            folder: "models/".to_owned(),
            names: [
                ".cache/",
                "Bunny.obj",
                "bunnies/",
                "cube.ply",
                "cube.ply.gz",
            ]
            .map(str::to_owned)
            .to_vec(),
        };
        let found = |word| listing.completing(word).cloned().collect::<Vec<_>>();
        assert_eq!(found("bun"), ["Bunny.obj", "bunnies/"]);
        assert_eq!(found("Bunny.obj"), [""; 0], "it is typed in full");
        assert_eq!(found("cube.ply"), [""; 0], "it is a file");
        assert_eq!(found("cube.ply."), ["cube.ply.gz"]);
        assert_eq!(found("")[..2], ["Bunny.obj", "bunnies/"]);
        assert_eq!(found("."), [".cache/"]);
        assert_eq!(folder_of("models/bun"), "models/");
        assert_eq!((folder_of("bun"), folder_of("/")), ("", "/"));
    }
}
