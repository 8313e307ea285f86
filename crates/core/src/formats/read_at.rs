//! Files that are read a part at a time.

use std::io;

/// Fills the whole slice from an offset in a file. Threads may read at once.
pub(super) type ReadAt<'s> = &'s (dyn Fn(u64, &mut [u8]) -> io::Result<()> + Sync);

/// Reads bytes in memory like a file.
pub(super) fn bytes_at(bytes: &[u8]) -> impl Fn(u64, &mut [u8]) -> io::Result<()> + Sync {
    |at, to| {
        let from = usize::try_from(at).ok().and_then(|at| bytes.get(at..));
        let from = from.and_then(|from| from.get(..to.len()));
        to.copy_from_slice(from.ok_or(io::ErrorKind::UnexpectedEof)?);
        Ok(())
    }
}
