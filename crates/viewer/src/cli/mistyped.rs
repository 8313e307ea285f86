//! A first argument that is neither a command nor a file: probably a mistyped command.

use super::Cli;
use crate::failure::Failure;
use clap::CommandFactory;
use std::ffi::OsStr;
use std::path::Path;

/// The failure of a first argument that looks like a command (letters and hyphens) but is none, and is no file either.
/// Without this check it would be taken for a file to open, and its options would be refused as those of the window.
/// `None` for anything else.
pub fn mistyped(word: &OsStr) -> Option<Failure> {
    let exists = Path::new(word).exists();
    let word = word.to_str()?;
    let is_like_a_command = word.starts_with(char::is_alphabetic)
        && word.chars().all(|c| c.is_alphabetic() || c == '-');
    if exists || !is_like_a_command {
        return None;
    }
    let mut cli = Cli::command();
    // Adds `help`.
    cli.build();
    let commands: Vec<_> = cli.get_subcommands().map(|c| c.get_name()).collect();
    if commands.contains(&word) {
        return None;
    }
    let nearest = nearest(&word.to_lowercase(), &commands);
    let hint = nearest.map_or(String::new(), |name| format!("; did you mean `{name}`?"));
    Some(Failure::usage(format!(
        "{word}: there is no such command and no such file{hint} (see `raycast --help`)"
    )))
}

/// The name nearest to `word` by the Damerau-Levenshtein distance; `None` if that is more than a third of the longer
/// one's letters, rounded up.
fn nearest<'a>(word: &str, names: &[&'a str]) -> Option<&'a str> {
    names
        .iter()
        .map(|&name| (strsim::damerau_levenshtein(word, name), name))
        .min()
        .filter(|&(slips, name)| slips <= word.len().max(name.len()).div_ceil(3))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(word: &str) -> Option<String> {
        mistyped(OsStr::new(word)).map(|failure| failure.to_string())
    }

    #[test]
    fn a_mistyped_command_gives_the_one_that_was_meant() {
        for (word, meant) in [
            ("reder", "render"),
            ("Render", "render"),
            ("redner", "render"),
            ("rendering", "render"),
            ("inof", "info"),
            ("verfiy", "verify"),
            ("stich", "stitch"),
            ("cst", "cast"),
            ("hlep", "help"),
            ("veiw", "view"),
            ("textur-map", "texture-map"),
            ("texturemap", "texture-map"),
        ] {
            let message = message(word).unwrap_or_else(|| panic!("{word} is no command"));
            assert!(
                message.contains(&format!("did you mean `{meant}`?")),
                "{message}"
            );
            assert!(message.starts_with(&format!("{word}: ")), "{message}");
        }
        let far = message("bunny").expect("no command, no file");
        assert!(!far.contains("did you mean"), "{far}");
    }

    #[test]
    fn commands_options_and_files_are_let_through() {
        for word in [
            "render", "view", "help", "--help", "-V", "", "none.obj", "a/b", "src",
        ] {
            assert_eq!(message(word), None, "{word}");
        }
    }
}
