//! Quotes of file contents for messages: on one line, of bounded length.

use std::path::Path;

/// The most characters of a file that a message shows.
const MOST: usize = 200;

/// A piece of a file, quoted and shortened. The message gives its line, so the start is enough to recognise it.
pub(crate) fn quote(text: &str) -> String {
    const LIMIT: usize = 48;
    let text = text.trim();
    if text.is_empty() {
        return "nothing".to_owned();
    }
    match text.char_indices().nth(LIMIT) {
        Some((end, _)) => format!("{:?}…", &text[..end]),
        None => format!("{text:?}"),
    }
}

/// Another library's message, which may repeat any part of a file: shortened, and without control characters except
/// its line ends.
pub(crate) fn shorten(text: &str) -> String {
    let lines = |text: &str| -> String {
        let mut lines = text.split('\n').map(escape_controls);
        let first = lines.next().unwrap_or_default();
        lines.fold(first, |all, line| all + "\n" + &line)
    };
    match text.char_indices().nth(MOST) {
        Some((end, _)) => lines(&text[..end]) + "…",
        None => lines(text),
    }
}

/// A name from a file, as people are shown it: on one line, of at most 200 characters, its control characters escaped.
pub fn name(text: &str) -> String {
    shorten(text).replace('\n', "\\n")
}

/// The text with its control characters escaped, so that a terminal shows them and does not obey them.
fn escape_controls(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() {
            shown.extend(c.escape_debug());
        } else {
            shown.push(c);
        }
    }
    shown
}

/// A path, which may have come from inside a file. One too long to show loses its middle.
pub(crate) fn path(path: &Path) -> String {
    let text = path.to_string_lossy();
    match text.char_indices().nth(MOST) {
        None => escape_controls(&text),
        Some(_) => {
            let end = text.char_indices().nth(MOST / 2).map_or(0, |(at, _)| at);
            let tail = text.char_indices().nth_back(MOST / 2 - 1);
            let tail = &text[tail.map_or(text.len(), |(at, _)| at)..];
            escape_controls(&text[..end]) + "…" + &escape_controls(tail)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_words_are_cut() {
        let long = "é".repeat(1000);
        assert_eq!(quote(&long).chars().count(), 51);
        assert_eq!(shorten(&long).chars().count(), 201);
        assert_eq!(quote(" a\nb "), "\"a\\nb\"");
        assert_eq!(quote(" "), "nothing");
        assert_eq!(shorten("short"), "short");
        assert_eq!(shorten("or\u{1b}phic\nx"), "or\\u{1b}phic\nx");
        assert_eq!(name("or\u{1b}phic\nx"), "or\\u{1b}phic\\nx");
    }

    #[test]
    fn long_paths_keep_their_ends() {
        let long = format!("/start/{}/end.png", "é".repeat(1000));
        let shown = path(Path::new(&long));
        assert_eq!(shown.chars().count(), 201);
        assert!(shown.starts_with("/start/é") && shown.ends_with("é/end.png"));
        assert_eq!(path(Path::new("/a/b\nc")), "/a/b\\nc");
    }
}
