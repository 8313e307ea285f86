//! The checksum of a prepared file: XXH3-128 of the concatenated XXH3-128 hashes (in canonical byte order) of its
//! blocks of [`BLOCK`] bytes. Two different files agree by chance with probability 2⁻¹²⁸. It detects damage, not
//! forgery: anyone can make a file with a correct checksum, so the reader still checks everything that it decodes.

use crate::digest::Digest;

/// Bytes of a block. Blocks are hashed independently, so that several threads can share the work.
pub(super) const BLOCK: usize = 1 << 20;

/// Bytes of the checksum.
pub(super) const BYTES: usize = 16;

/// The hash of one block.
pub(super) fn block_checksum(block: &[u8]) -> [u8; BYTES] {
    Digest::of(block).to_bytes()
}

/// The hash of all blocks' hashes.
pub(super) fn file_checksum(checksums: &[u8]) -> [u8; BYTES] {
    Digest::of(checksums).to_bytes()
}

/// The checksum of a whole file in memory.
#[cfg(test)]
pub(super) fn checksum(bytes: &[u8]) -> [u8; BYTES] {
    let blocks: Vec<_> = bytes.chunks(BLOCK).map(block_checksum).collect();
    file_checksum(blocks.as_flattened())
}
