//! Quoting arguments for a shell.

/// An argument, quoted for this system's shell: on Windows in double quotes, elsewhere as [`quoted_for_posix`].
pub(super) fn quoted(word: &str) -> String {
    match cfg!(windows) && !is_plain(word) {
        true => format!("\"{word}\""),
        false => quoted_for_posix(word),
    }
}

/// An argument, quoted for a POSIX shell: in single quotes, unless it needs none.
pub fn quoted_for_posix(word: &str) -> String {
    match is_plain(word) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

/// Whether an argument needs no quotes in any shell.
fn is_plain(word: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./:,=+@%".contains(c);
    !word.is_empty() && word.chars().all(is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_split_or_change_them() {
        for plain in ["/a/b-1.obj", "a-b_c.png", "--wireframe=1.5", "out-%05d.png"] {
            assert_eq!(quoted(plain), plain);
            assert_eq!(quoted_for_posix(plain), plain);
        }
        for (word, expected) in [
            ("a b", "'a b'"),
            ("it's $HOME", r"'it'\''s $HOME'"),
            ("#102030", "'#102030'"),
            ("", "''"),
        ] {
            assert_eq!(quoted_for_posix(word), expected);
            if !cfg!(windows) {
                assert_eq!(quoted(word), expected);
            }
        }
    }
}
