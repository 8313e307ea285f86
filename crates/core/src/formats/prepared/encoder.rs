//! Writes numbers, strings and lists, followed by their checksum.

use super::checksum::{BLOCK, BYTES, block_checksum, file_checksum};
use std::io::{self, Write};

/// Buffers and hashes the bytes of a file.
pub(super) struct Encoder<'w> {
    out: &'w mut dyn Write,
    /// The current block, not yet full and not yet written.
    block: Vec<u8>,
    /// The hashes of the blocks written so far.
    checksums: Vec<u8>,
    length: u64,
}

impl<'w> Encoder<'w> {
    pub(super) fn new(out: &'w mut dyn Write) -> Self {
        Self {
            out,
            block: Vec::with_capacity(BLOCK),
            checksums: Vec::new(),
            length: 0,
        }
    }

    /// Raw bytes.
    pub(super) fn bytes(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        while !bytes.is_empty() {
            let room = BLOCK - self.block.len();
            let (now, later) = bytes.split_at(room.min(bytes.len()));
            self.block.extend_from_slice(now);
            if self.block.len() == BLOCK {
                self.flush()?;
            }
            bytes = later;
        }
        Ok(())
    }

    pub(super) fn number(&mut self, number: u32) -> io::Result<()> {
        self.bytes(&number.to_le_bytes())
    }

    pub(super) fn long(&mut self, number: u64) -> io::Result<()> {
        self.bytes(&number.to_le_bytes())
    }

    pub(super) fn single(&mut self, number: f32) -> io::Result<()> {
        self.number(number.to_bits())
    }

    pub(super) fn double(&mut self, number: f64) -> io::Result<()> {
        self.long(number.to_bits())
    }

    /// The number of elements of a list, before the elements.
    pub(super) fn count(&mut self, count: usize) -> io::Result<()> {
        let too_many =
            || io::Error::other(format!("{count} are more than a prepared mesh can hold"));
        self.number(u32::try_from(count).map_err(|_| too_many())?)
    }

    pub(super) fn text(&mut self, text: &str) -> io::Result<()> {
        self.count(text.len())?;
        self.bytes(text.as_bytes())
    }

    /// An option: 0, or 1 and the value.
    pub(super) fn option<T>(
        &mut self,
        value: Option<T>,
        write: impl FnOnce(&mut Self, T) -> io::Result<()>,
    ) -> io::Result<()> {
        match value {
            None => self.number(0),
            Some(value) => {
                self.number(1)?;
                write(self, value)
            }
        }
    }

    /// A list whose elements are `N` words each, preceded by its length.
    pub(super) fn list<T: Copy, const N: usize>(
        &mut self,
        elements: &[T],
        words: impl Fn(T) -> [u32; N],
    ) -> io::Result<()> {
        self.count(elements.len())?;
        let mut bytes = Vec::new();
        for some in elements.chunks(1 << 12) {
            bytes.clear();
            bytes.extend(
                some.iter()
                    .flat_map(|&element| words(element))
                    .flat_map(u32::to_le_bytes),
            );
            self.bytes(&bytes)?;
        }
        Ok(())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.checksums.extend(block_checksum(&self.block));
        self.length += self.block.len() as u64;
        self.out.write_all(&self.block)?;
        self.block.clear();
        Ok(())
    }

    /// Writes the checksum; returns the file's total number of bytes.
    pub(super) fn finish(&mut self) -> io::Result<u64> {
        if !self.block.is_empty() {
            self.flush()?;
        }
        self.out.write_all(&file_checksum(&self.checksums))?;
        Ok(self.length + BYTES as u64)
    }
}
