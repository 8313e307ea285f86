//! Words of a file as a message may show them: on one line, their length bounded.

use std::path::Path;

/// The most characters of a file that a message shows.
const MOST: usize = 200;

/// A piece of a file, quoted; short, since messages show where it stands.
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

/// Another's message, which may hold as much of a file as it likes.
pub(crate) fn shorten(text: &str) -> String {
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// A path, which may have come from inside a file. One too long to show loses its middle.
pub(crate) fn path(path: &Path) -> String {
    let text = path.to_string_lossy();
    let mut shown = String::with_capacity(text.len().min(4 * MOST));
    let mut add = |part: &str| {
        for c in part.chars() {
            if c.is_control() {
                shown.extend(c.escape_debug());
            } else {
                shown.push(c);
            }
        }
    };
    match text.char_indices().nth(MOST) {
        None => add(&text),
        Some(_) => {
            let end = text.char_indices().nth(MOST / 2).map_or(0, |(at, _)| at);
            let tail = text.char_indices().nth_back(MOST / 2 - 1);
            add(&text[..end]);
            add("…");
            add(&text[tail.map_or(text.len(), |(at, _)| at)..]);
        }
    }
    shown
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
