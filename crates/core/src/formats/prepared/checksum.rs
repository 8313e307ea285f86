//! The checksum of a prepared file: finds damage, not forgery.

use crate::digest::Digest;
use rayon::prelude::*;

/// Bytes that are digested by themselves, so that several threads may.
pub(super) const BLOCK: usize = 1 << 20;

/// Bytes of a checksum.
pub(super) const BYTES: usize = 16;

/// XXH3 of 128 bits over the same of each block of [`BLOCK`] bytes, in its canonical order of bytes: that of any other
/// content differs but for one in 2¹²⁸ by chance. Whoever wants to can make a file with a right checksum: what is read
/// is checked by itself.
pub(super) fn checksum(bytes: &[u8]) -> [u8; BYTES] {
    let blocks = bytes.par_chunks(BLOCK).map(of_block);
    of_blocks(blocks.collect::<Vec<_>>().as_flattened())
}

/// Of one block.
pub(super) fn of_block(block: &[u8]) -> [u8; BYTES] {
    Digest::of(block).to_bytes()
}

/// Of the checksums of all blocks.
pub(super) fn of_blocks(checksums: &[u8]) -> [u8; BYTES] {
    Digest::of(checksums).to_bytes()
}
