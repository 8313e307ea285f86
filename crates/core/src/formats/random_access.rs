//! Files that are read a part at a time.

use std::io;

/// A file whose bytes are read from any offset on. Threads may read at once.
#[derive(Clone, Copy)]
pub(super) struct RandomAccess<'s> {
    /// Fills the whole slice from an offset on.
    pub(super) read_at: &'s (dyn Fn(u64, &mut [u8]) -> io::Result<()> + Sync),
    /// How many bytes there are.
    pub(super) length: u64,
}

impl RandomAccess<'_> {
    /// Fills the whole slice from an offset on.
    pub(super) fn read(&self, at: u64, to: &mut [u8]) -> io::Result<()> {
        (self.read_at)(at, to)
    }
}

/// Reads bytes in memory like a file.
pub(super) fn bytes_at(bytes: &[u8]) -> impl Fn(u64, &mut [u8]) -> io::Result<()> + Sync {
    |at, to| {
        let from = usize::try_from(at).ok().and_then(|at| bytes.get(at..));
        let from = from.and_then(|from| from.get(..to.len()));
        to.copy_from_slice(from.ok_or(io::ErrorKind::UnexpectedEof)?);
        Ok(())
    }
}
