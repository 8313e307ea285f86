//! Reads numbers, strings and lists from untrusted bytes.

use super::super::error::{FormatError, quote};
use super::super::limits::{Budget, Share};
use super::checksum::BYTES;
use super::source::Source;
use bytemuck::Pod;
use bytemuck::allocation::zeroed_vec;
use rayon::prelude::*;
use std::path::Path;

/// The least number of elements converted by one parallel task. With fewer, the cost of a task outweighs its work;
/// with more, short lists use fewer threads.
const CHUNK: usize = 1 << 15;

/// Decodes the bytes of a file. Memory for a claimed size is counted in the budget before it is allocated.
pub(super) struct Decoder<'d> {
    path: &'d Path,
    source: Source<'d>,
    share: Share<'d>,
    /// Bytes held so far.
    held: u64,
    budget: &'d Budget,
}

impl<'d> Decoder<'d> {
    /// A decoder of the remaining bytes of `source`.
    pub(super) fn new(
        path: &'d Path,
        source: Source<'d>,
        budget: &'d Budget,
    ) -> Result<Self, FormatError> {
        Ok(Self {
            path,
            source,
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

    /// The fraction of the bytes read, from 0 to 1.
    pub(super) fn done(&self) -> f32 {
        self.source.taken() as f32 / self.source.length().max(1) as f32
    }

    /// The error for unexpected content just before the current position.
    pub(super) fn unexpected(&self, expected: &str, found: impl std::fmt::Display) -> FormatError {
        let at = self.source.taken();
        let expected = format!("{expected} before byte {at}");
        FormatError::unexpected(self.path, None, expected, found.to_string())
    }

    /// The error for a value just before the current position that is not a valid `what`.
    pub(super) fn refused(&self, what: &str, reason: &str) -> FormatError {
        let at = self.source.taken();
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

    /// Checks the checksum of the whole file; bytes not decoded yet are read for it.
    pub(super) fn verify(&mut self, stored: [u8; BYTES]) -> Result<(), FormatError> {
        let sum = self.source.checksum();
        if sum.map_err(|error| FormatError::io(self.path, error))? == stored {
            return Ok(());
        }
        let found = "a file that was damaged: run `raycast prepare` again";
        let expected = "bytes with their checksum";
        Err(FormatError::unexpected(self.path, None, expected, found))
    }

    /// Reads raw bytes.
    fn fill(&mut self, what: &str, to: &mut [u8]) -> Result<(), FormatError> {
        if to.len() > self.source.left() {
            let found = format!("{} bytes to the end", self.source.left());
            return Err(self.unexpected(&format!("{} bytes of {what}", to.len()), found));
        }
        let taken = self.source.take(to);
        taken.map_err(|error| FormatError::io(self.path, error))
    }

    fn chunk<const N: usize>(&mut self, what: &str) -> Result<[u8; N], FormatError> {
        let mut chunk = [0; N];
        self.fill(what, &mut chunk)?;
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

    /// The length of a list whose elements take at least `least` bytes each. It is checked against the remaining
    /// bytes, so that a forged length cannot cause a large allocation.
    pub(super) fn count(&mut self, what: &str, least: usize) -> Result<usize, FormatError> {
        let count = self.number(what)? as usize;
        match count <= self.source.left() / least {
            true => Ok(count),
            false => {
                let found = format!("{count} {what} in {} bytes", self.source.left());
                Err(self.unexpected(&format!("{what} that are in the file"), found))
            }
        }
    }

    pub(super) fn text(&mut self, what: &str) -> Result<String, FormatError> {
        let count = self.count(what, 1)?;
        self.hold(count as u64)?;
        let mut bytes = vec![0; count];
        self.fill(what, &mut bytes)?;
        String::from_utf8(bytes).map_err(|error| {
            let found = quote(&String::from_utf8_lossy(error.as_bytes()));
            self.unexpected(&format!("{what} in UTF-8"), found)
        })
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

    /// A list whose elements are read one by one, each of at least `least` bytes in the file.
    pub(super) fn each<T>(
        &mut self,
        what: &str,
        least: usize,
        mut read: impl FnMut(&mut Self) -> Result<T, FormatError>,
    ) -> Result<Vec<T>, FormatError> {
        let count = self.count(what, least)?;
        // An element can be larger in memory than in the file.
        self.hold((count * size_of::<T>()) as u64)?;
        let mut all = Vec::with_capacity(count);
        for _ in 0..count {
            all.push(read(self)?);
        }
        Ok(all)
    }

    /// A list of plain words, preceded by its length, read without a copy.
    pub(super) fn words<T: Pod>(&mut self, what: &str) -> Result<Vec<T>, FormatError> {
        let count = self.count(what, size_of::<T>())?;
        self.hold((count * size_of::<T>()) as u64)?;
        // Large zeroed allocations come from the system untouched, so that reading into them is the first write.
        let mut all: Vec<T> = zeroed_vec(count);
        self.fill(what, bytemuck::cast_slice_mut(&mut all))?;
        if cfg!(target_endian = "big") {
            for word in bytemuck::cast_slice_mut::<T, u32>(&mut all) {
                *word = word.swap_bytes();
            }
        }
        Ok(all)
    }

    /// A list whose elements are `N` words each, preceded by its length.
    pub(super) fn list<T: Send, const N: usize>(
        &mut self,
        what: &str,
        element: impl Fn([u32; N]) -> T + Sync + Send,
    ) -> Result<Vec<T>, FormatError>
    where
        [u32; N]: Pod,
    {
        let words: Vec<[u32; N]> = self.words(what)?;
        self.hold((words.len() * size_of::<T>()) as u64)?;
        let words = words.par_iter().copied().with_min_len(CHUNK);
        Ok(words.map(element).collect())
    }

    /// Checks that no bytes are left.
    pub(super) fn end(&self) -> Result<(), FormatError> {
        match self.source.left() {
            0 => Ok(()),
            left => Err(self.unexpected("the end", format!("{left} bytes more"))),
        }
    }

    /// Leaves the bytes held counted in the budget.
    pub(super) fn keep(self) {
        self.share.keep(self.held);
    }
}
