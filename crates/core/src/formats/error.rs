use crate::quote;
pub(super) use crate::quote::{quote, shorten};
use std::path::{Path, PathBuf};

/// A position in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilePosition {
    /// The file.
    pub file: PathBuf,
    /// The line, from 1; `None` if the error does not belong to one line.
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

/// Why a file was not read. Every message is one line: position, what was expected, what was found. It quotes at most
/// 200 characters of the file.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// An error of the file system.
    #[error("{position}: {source}")]
    Io {
        /// Where.
        position: FilePosition,
        /// Why.
        source: std::io::Error,
    },
    /// Content other than what the format requires.
    #[error("{position}: expected {expected}, found {found}")]
    Unexpected {
        /// Where.
        position: FilePosition,
        /// What the format requires.
        expected: String,
        /// What the file has.
        found: String,
    },
    /// Content that a decoder or parser rejects; the message is its own.
    #[error("{position}: {reason}")]
    Refused {
        /// Where.
        position: FilePosition,
        /// Why, in one line.
        reason: String,
    },
    /// The file exceeds one of the [`super::Limits`].
    #[error("{position}: {what}; at most {most} are allowed (limit `{limit}`)")]
    TooMuch {
        /// Where.
        position: FilePosition,
        /// What exceeds it.
        what: String,
        /// The name of the field of `Limits`.
        limit: &'static str,
        /// Its value.
        most: u64,
    },
    /// Not enough memory: see [`super::Budget::within_memory`].
    #[error("{position}: {what}; {whose} leaves {leaves}")]
    NoMemory {
        /// Where.
        position: FilePosition,
        /// What the memory was for.
        what: String,
        /// What bounds the memory: a process limit, the machine.
        whose: String,
        /// How many bytes were available.
        leaves: u64,
    },
    /// The caller cancelled reading.
    #[error("{position}: reading it was cancelled")]
    Cancelled {
        /// The file that was being read.
        position: FilePosition,
    },
}

impl FormatError {
    /// Whether a limit, memory or a caller ended the reading, and not the file.
    pub(super) fn is_of_budget(&self) -> bool {
        matches!(
            self,
            Self::TooMuch { .. } | Self::NoMemory { .. } | Self::Cancelled { .. }
        )
    }

    pub(super) fn io(file: &Path, source: std::io::Error) -> Self {
        Self::Io {
            position: position(file, None),
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
            position: position(file, line),
            expected: expected.into(),
            found: found.into(),
        }
    }

    /// The lines of `reason` are joined by "; ", so that the message is one line.
    pub(super) fn refused(file: &Path, line: Option<usize>, reason: &str) -> Self {
        let lines: Vec<_> = reason
            .lines()
            .map(str::trim)
            .filter(|line| !line.is_empty())
            .collect();
        Self::Refused {
            position: position(file, line),
            reason: lines.join("; "),
        }
    }

    /// The message without the position.
    pub(super) fn reason(&self) -> String {
        let (Self::Io { position, .. }
        | Self::Unexpected { position, .. }
        | Self::Refused { position, .. }
        | Self::TooMuch { position, .. }
        | Self::NoMemory { position, .. }
        | Self::Cancelled { position }) = self;
        let text = self.to_string();
        match text.strip_prefix(&format!("{position}: ")) {
            Some(reason) => reason.to_owned(),
            None => text,
        }
    }

    pub(super) fn cancelled(file: &Path) -> Self {
        Self::Cancelled {
            position: position(file, None),
        }
    }

    pub(super) fn too_much(file: &Path, what: String, limit: &'static str, most: u64) -> Self {
        Self::TooMuch {
            position: position(file, None),
            what,
            limit,
            most,
        }
    }
}

pub(super) fn position(file: &Path, line: Option<usize>) -> FilePosition {
    FilePosition {
        file: file.to_owned(),
        line,
    }
}
