//! Reads numbers, texts and lists of bytes that may be anything.

use super::super::error::{FormatError, quote};
use super::super::limits::{Budget, Share};
use rayon::prelude::*;
use std::path::Path;

/// Elements that are worth a task of their own.
const CHUNK: usize = 1 << 15;

/// Bytes on their way from a file. What they claim is counted before there is room for it.
pub(super) struct Decoder<'d> {
    path: &'d Path,
    /// Those that are left.
    rest: &'d [u8],
    /// How many there were, and how many stood before them in the file.
    length: usize,
    start: usize,
    share: Share<'d>,
    /// What is held so far.
    held: u64,
    budget: &'d Budget,
}

impl<'d> Decoder<'d> {
    /// Of bytes that begin at so many of a file.
    pub(super) fn new(
        path: &'d Path,
        bytes: &'d [u8],
        start: usize,
        budget: &'d Budget,
    ) -> Result<Self, FormatError> {
        Ok(Self {
            path,
            rest: bytes,
            length: bytes.len(),
            start,
            share: budget.share(path, "the prepared mesh", 0)?,
            held: 0,
            budget,
        })
    }

    pub(super) fn budget(&self) -> &'d Budget {
        self.budget
    }

    pub(super) fn path(&self) -> &'d Path {
        self.path
    }

    /// How much of the bytes was read, from 0 to 1.
    pub(super) fn done(&self) -> f32 {
        1.0 - self.rest.len() as f32 / self.length.max(1) as f32
    }

    /// The error that something else stands before this place than must.
    pub(super) fn unexpected(&self, expected: &str, found: impl std::fmt::Display) -> FormatError {
        let at = self.start + (self.length - self.rest.len());
        let expected = format!("{expected} before byte {at}");
        FormatError::unexpected(self.path, None, expected, found.to_string())
    }

    /// The error that what was read is not `what` it says.
    pub(super) fn refused(&self, what: &str, reason: &str) -> FormatError {
        let at = self.start + (self.length - self.rest.len());
        FormatError::refused(
            self.path,
            None,
            &format!("{what} before byte {at}: {reason}"),
        )
    }

    /// Counts bytes that are held from now on.
    pub(super) fn hold(&mut self, bytes: u64) -> Result<(), FormatError> {
        self.held = self.held.saturating_add(bytes);
        self.share.grow(self.path, "the prepared mesh", self.held)
    }

    /// Bytes as they are.
    pub(super) fn bytes(&mut self, what: &str, count: usize) -> Result<&'d [u8], FormatError> {
        match self.rest.split_at_checked(count) {
            Some((bytes, rest)) => {
                self.rest = rest;
                Ok(bytes)
            }
            None => {
                let found = format!("{} bytes to the end", self.rest.len());
                Err(self.unexpected(&format!("{count} bytes of {what}"), found))
            }
        }
    }

    fn chunk<const N: usize>(&mut self, what: &str) -> Result<[u8; N], FormatError> {
        let bytes = self.bytes(what, N)?;
        let mut chunk = [0; N];
        chunk.copy_from_slice(bytes);
        Ok(chunk)
    }

    pub(super) fn number(&mut self, what: &str) -> Result<u32, FormatError> {
        Ok(u32::from_le_bytes(self.chunk(what)?))
    }

    /// A number below a limit.
    pub(super) fn below(&mut self, what: &str, limit: usize) -> Result<usize, FormatError> {
        let number = self.number(what)? as usize;
        match number < limit {
            true => Ok(number),
            false => Err(self.unexpected(&format!("{what} below {limit}"), number)),
        }
    }

    pub(super) fn long(&mut self, what: &str) -> Result<u64, FormatError> {
        Ok(u64::from_le_bytes(self.chunk(what)?))
    }

    pub(super) fn flag(&mut self, what: &str) -> Result<bool, FormatError> {
        Ok(self.below(what, 2)? == 1)
    }

    /// A number that is not NaN.
    pub(super) fn single(&mut self, what: &str) -> Result<f32, FormatError> {
        let number = f32::from_bits(self.number(what)?);
        match number.is_nan() {
            false => Ok(number),
            true => Err(self.unexpected(what, number)),
        }
    }

    /// A number from 0 to 1.
    pub(super) fn portion(&mut self, what: &str) -> Result<f32, FormatError> {
        let number = self.single(what)?;
        match (0.0..=1.0).contains(&number) {
            true => Ok(number),
            false => Err(self.unexpected(&format!("{what} from 0 to 1"), number)),
        }
    }

    pub(super) fn double(&mut self, what: &str) -> Result<f64, FormatError> {
        Ok(f64::from_bits(self.long(what)?))
    }

    /// A number that is finite.
    pub(super) fn finite(&mut self, what: &str) -> Result<f64, FormatError> {
        let number = self.double(what)?;
        match number.is_finite() {
            true => Ok(number),
            false => Err(self.unexpected(what, number)),
        }
    }

    /// How many there are of something of which one has so many bytes at least.
    pub(super) fn count(&mut self, what: &str, least: usize) -> Result<usize, FormatError> {
        let count = self.number(what)? as usize;
        match count <= self.rest.len() / least {
            true => Ok(count),
            false => {
                let found = format!("{count} {what} in {} bytes", self.rest.len());
                Err(self.unexpected(&format!("{what} that are in the file"), found))
            }
        }
    }

    pub(super) fn text(&mut self, what: &str) -> Result<String, FormatError> {
        let count = self.count(what, 1)?;
        let bytes = self.bytes(what, count)?;
        self.hold(count as u64)?;
        match str::from_utf8(bytes) {
            Ok(text) => Ok(text.to_owned()),
            Err(_) => Err(self.unexpected(
                &format!("{what} in UTF-8"),
                quote(&String::from_utf8_lossy(bytes)),
            )),
        }
    }

    pub(super) fn option<T>(
        &mut self,
        what: &str,
        read: impl FnOnce(&mut Self) -> Result<T, FormatError>,
    ) -> Result<Option<T>, FormatError> {
        match self.flag(what)? {
            true => read(self).map(Some),
            false => Ok(None),
        }
    }

    /// Elements that are read one by one, each of so many bytes in the file at least.
    pub(super) fn each<T>(
        &mut self,
        what: &str,
        least: usize,
        mut read: impl FnMut(&mut Self) -> Result<T, FormatError>,
    ) -> Result<Vec<T>, FormatError> {
        let count = self.count(what, least)?;
        // Those of small files may be larger than what they are in the file.
        self.hold((count * size_of::<T>()) as u64)?;
        let mut all = Vec::with_capacity(count);
        for _ in 0..count {
            all.push(read(self)?);
        }
        Ok(all)
    }

    /// Elements of so many words each, behind their count.
    pub(super) fn list<T: Send, const N: usize>(
        &mut self,
        what: &str,
        element: impl Fn([u32; N]) -> T + Sync,
    ) -> Result<Vec<T>, FormatError> {
        let size = size_of::<[u32; N]>();
        let count = self.count(what, size)?;
        let bytes = self.bytes(what, count * size)?;
        self.hold((count * size_of::<T>()) as u64)?;
        let read = |bytes: &[u8]| {
            let mut words = [0; N];
            for (word, bytes) in words.iter_mut().zip(bytes.as_chunks().0) {
                *word = u32::from_le_bytes(*bytes);
            }
            element(words)
        };
        let elements = bytes.par_chunks_exact(size).with_min_len(CHUNK);
        Ok(elements.map(read).collect())
    }

    /// Checks that all was read; what it takes stays counted.
    pub(super) fn finish(self) -> Result<(), FormatError> {
        if !self.rest.is_empty() {
            return Err(self.unexpected("the end", format!("{} bytes more", self.rest.len())));
        }
        self.share.keep(self.held);
        Ok(())
    }
}
