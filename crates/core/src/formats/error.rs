use std::path::{Path, PathBuf};

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: PathBuf,
    /// The line, from 1; `None` where the fault is not on one line.
    pub line: Option<usize>,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}", self.file.display()),
            None => write!(f, "{}", self.file.display()),
        }
    }
}

/// Why a file was not read. Every message is one line: place, what was expected, what was found.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The file system's own refusal.
    #[error("{place}: {source}")]
    Io {
        /// Where.
        place: Place,
        /// Why.
        source: std::io::Error,
    },
    /// Something other than what must stand there.
    #[error("{place}: expected {expected}, found {found}")]
    Unexpected {
        /// Where.
        place: Place,
        /// What must stand there.
        expected: String,
        /// What does.
        found: String,
    },
    /// Something that cannot stand there, in the words of whatever refused it.
    #[error("{place}: {reason}")]
    Refused {
        /// Where.
        place: Place,
        /// Why, in one line.
        reason: String,
    },
}

impl FormatError {
    pub(super) fn io(file: &Path, source: std::io::Error) -> Self {
        Self::Io {
            place: place(file, None),
            source,
        }
    }

    pub(super) fn unexpected(
        file: &Path,
        line: Option<usize>,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> Self {
        Self::Unexpected {
            place: place(file, line),
            expected: expected.into(),
            found: found.into(),
        }
    }

    /// `reason` may have several lines: they become one.
    pub(super) fn refused(file: &Path, line: Option<usize>, reason: &str) -> Self {
        let lines: Vec<_> = reason
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty())
            .collect();
        Self::Refused {
            place: place(file, line),
            reason: lines.join("; "),
        }
    }
}

fn place(file: &Path, line: Option<usize>) -> Place {
    Place {
        file: file.to_owned(),
        line,
    }
}

/// A file's own text as a message may show it: on one line, quoted, its length bounded.
pub(super) fn quote(text: &str) -> String {
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
