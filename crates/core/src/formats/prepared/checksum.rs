//! The checksum of a prepared file: XXH3 of 128 bits over the same of each block of [`BLOCK`] bytes, in its canonical order of
//! bytes. That of any other content differs but for one in 2¹²⁸ by chance. It finds damage, not forgery: whoever wants to can
//! make a file with a right checksum, and what is read is checked by itself.

use crate::digest::Digest;

/// Bytes that are digested by themselves, so that several threads may.
pub(super) const BLOCK: usize = 1 << 20;

/// Bytes of a checksum.
pub(super) const BYTES: usize = 16;

/// Of one block.
pub(super) fn of_block(block: &[u8]) -> [u8; BYTES] {
    Digest::of(block).to_bytes()
}

/// Of the checksums of all blocks.
pub(super) fn of_blocks(checksums: &[u8]) -> [u8; BYTES] {
    Digest::of(checksums).to_bytes()
}

/// Of all bytes of a file.
#[cfg(test)]
pub(super) fn checksum(bytes: &[u8]) -> [u8; BYTES] {
    let blocks: Vec<_> = bytes.chunks(BLOCK).map(of_block).collect();
    of_blocks(blocks.as_flattened())
}
