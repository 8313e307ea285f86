use crate::quote;
pub(super) use crate::quote::{quote, shorten};
use std::path::{Path, PathBuf};

/// A position in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilePosition {
    /// The file.
    pub file: PathBuf,
    /// The line, from 1; `None` where the fault is not on one line.
    pub line: Option<usize>,
}

impl std::fmt::Display for FilePosition {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let file = quote::path(&self.file);
        match self.line {
            Some(line) => write!(f, "{file}:{line}"),
            None => write!(f, "{file}"),
        }
    }
}

/// Why a file was not read. Every message is one line: place, what was expected, what was found. It
/// shows at most 200 characters of what a file holds.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The file system's own refusal.
    #[error("{place}: {source}")]
    Io {
        /// Where.
        place: FilePosition,
        /// Why.
        source: std::io::Error,
    },
    /// Something other than what must stand there.
    #[error("{place}: expected {expected}, found {found}")]
    Unexpected {
        /// Where.
        place: FilePosition,
        /// What must stand there.
        expected: String,
        /// What does.
        found: String,
    },
    /// Something that cannot stand there, in the words of whatever refused it.
    #[error("{place}: {reason}")]
    Refused {
        /// Where.
        place: FilePosition,
        /// Why, in one line.
        reason: String,
    },
    /// More than the [`super::Limits`] of the reading allow.
    #[error("{place}: {what}; at most {most} are allowed (limit `{limit}`)")]
    TooMuch {
        /// Where.
        place: FilePosition,
        /// What there is too much of.
        what: String,
        /// The limit's name.
        limit: &'static str,
        /// How much it allows.
        most: u64,
    },
    /// More memory than there is: see [`super::Budget::within_memory`].
    #[error("{place}: {what}; {whose} leaves {leaves}")]
    NoMemory {
        /// Where.
        place: FilePosition,
        /// What there is no memory for.
        what: String,
        /// Who says how much there is.
        whose: String,
        /// How many bytes that is.
        leaves: u64,
    },
    /// The reading was cancelled by its caller.
    #[error("{place}: reading it was cancelled")]
    Cancelled {
        /// The file that was being read.
        place: FilePosition,
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

    /// What is wrong, without the place.
    pub(super) fn reason(&self) -> String {
        let (Self::Io { place, .. }
        | Self::Unexpected { place, .. }
        | Self::Refused { place, .. }
        | Self::TooMuch { place, .. }
        | Self::NoMemory { place, .. }
        | Self::Cancelled { place }) = self;
        let text = self.to_string();
        match text.strip_prefix(&format!("{place}: ")) {
            Some(reason) => reason.to_owned(),
            None => text,
        }
    }

    pub(super) fn cancelled(file: &Path) -> Self {
        Self::Cancelled {
            place: place(file, None),
        }
    }

    pub(super) fn too_much(file: &Path, what: String, limit: &'static str, most: u64) -> Self {
        Self::TooMuch {
            place: place(file, None),
            what,
            limit,
            most,
        }
    }
}

pub(super) fn place(file: &Path, line: Option<usize>) -> FilePosition {
    FilePosition {
        file: file.to_owned(),
        line,
    }
}
