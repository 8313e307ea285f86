//! A scene file's text, the line of each value, and the files that it names.

use super::Progress;
use super::error::FormatError;
use super::files::{Contents, Files, NamedBy, beside};
use glam::DVec3;
use std::path::Path;
use toml::Spanned;

/// The line, from 1, that holds the byte at `offset`.
pub(super) fn line_at(bytes: &[u8], offset: usize) -> usize {
    let before = &bytes[..offset.min(bytes.len())];
    1 + before.iter().filter(|&&b| b == b'\n').count()
}

/// The text of a scene file, and the store of the files that it names.
pub(super) struct Reader<'a> {
    pub(super) path: &'a Path,
    pub(super) text: &'a str,
    pub(super) files: &'a dyn Files,
}

impl Reader<'_> {
    pub(super) fn line<T>(&self, value: &Spanned<T>) -> Option<usize> {
        Some(line_at(self.text.as_bytes(), value.span().start))
    }

    pub(super) fn fault<T>(&self, value: &Spanned<T>, expected: &str, found: &str) -> FormatError {
        FormatError::unexpected(self.path, self.line(value), expected, found)
    }

    /// A number after its range check; an error names the line.
    pub(super) fn in_range<T, N>(
        &self,
        location: &Spanned<T>,
        number: Result<N, impl std::fmt::Display>,
    ) -> Result<N, FormatError> {
        number.map_err(|error| {
            FormatError::refused(self.path, self.line(location), &error.to_string())
        })
    }

    /// Three finite numbers.
    pub(super) fn vector(&self, value: &Spanned<[f64; 3]>) -> Result<DVec3, FormatError> {
        let vector = DVec3::from_array(*value.get_ref());
        if vector.is_finite() {
            Ok(vector)
        } else {
            Err(self.fault(value, "finite numbers", &format!("{:?}", value.get_ref())))
        }
    }

    /// The bytes of a file that the scene names.
    pub(super) fn bytes(
        &self,
        named: &Spanned<String>,
        path: &Path,
        progress: Progress<'_>,
    ) -> Result<Contents<'_>, FormatError> {
        let read = self.files.read(path, NamedBy::Scene, progress);
        read.map_err(|error| self.unreadable(named, error))
    }

    /// Checks that a file that the scene names can be opened.
    pub(super) fn check_file(&self, named: &Spanned<String>) -> Result<(), FormatError> {
        let path = beside(self.path, named.get_ref());
        let checked = self.files.check(&path, NamedBy::Scene);
        checked.map_err(|error| self.unreadable(named, error))
    }

    /// The error of a file that the scene names, with the line that names it.
    fn unreadable(&self, named: &Spanned<String>, error: FormatError) -> FormatError {
        let reason = match error {
            FormatError::Io { position, source } => format!("{position} cannot be read: {source}"),
            error => error.to_string(),
        };
        FormatError::refused(self.path, self.line(named), &reason)
    }
}
