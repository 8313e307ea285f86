//! A prepared file as a stream. Large slices are read directly into their destination; all bytes are hashed.

use super::checksum::{BLOCK, BYTES, block_checksum, file_checksum};
use crate::digest::Digester;
use crate::formats::random_access::RandomAccess;
use rayon::prelude::*;
use std::io;

/// The size of the read-ahead buffer for small fields; slices as large are read directly, whole blocks of them by
/// several threads. With a larger buffer, longer lists go through it, which costs one more copy on one thread; with a
/// smaller one there are more system calls.
const READ_AHEAD: usize = 1 << 16;

/// A stream over a file's bytes, without its checksum.
pub(super) struct Source<'s> {
    file: RandomAccess<'s>,
    /// The number of bytes.
    length: usize,
    /// The number of bytes taken.
    taken: usize,
    /// The read-ahead buffer, and how many of its bytes were taken.
    ahead: (Vec<u8>, usize),
    sums: Checksums,
}

impl<'s> Source<'s> {
    /// A stream over the first `length` bytes of a file.
    pub(super) fn new(file: RandomAccess<'s>, length: usize) -> Self {
        Self {
            file,
            length,
            taken: 0,
            ahead: (Vec::new(), 0),
            sums: Checksums::new(),
        }
    }

    /// The number of bytes.
    pub(super) fn length(&self) -> usize {
        self.length
    }

    /// The number of bytes taken.
    pub(super) fn taken(&self) -> usize {
        self.taken
    }

    /// The number of bytes left.
    pub(super) fn left(&self) -> usize {
        self.length - self.taken
    }

    /// Fills a slice, which must not be longer than the bytes left.
    pub(super) fn take(&mut self, mut to: &mut [u8]) -> io::Result<()> {
        while !to.is_empty() {
            let (ahead, used) = &mut self.ahead;
            if *used == ahead.len() {
                if to.len() >= READ_AHEAD {
                    return self.take_directly(to);
                }
                ahead.resize(READ_AHEAD.min(self.length - self.taken), 0);
                self.file.read(self.taken as u64, ahead)?;
                *used = 0;
            }
            let count = to.len().min(ahead.len() - *used);
            if count == 0 {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            let (first, rest) = to.split_at_mut(count);
            first.copy_from_slice(&ahead[*used..*used + count]);
            *used += count;
            self.taken += count;
            self.sums.add(first);
            to = rest;
        }
        Ok(())
    }

    /// Fills a slice without the buffer; several threads read and hash its whole blocks.
    fn take_directly(&mut self, to: &mut [u8]) -> io::Result<()> {
        let begun = self.taken % BLOCK;
        let first = if begun == 0 {
            0
        } else {
            to.len().min(BLOCK - begun)
        };
        let (first, rest) = to.split_at_mut(first);
        let (whole, last) = rest.split_at_mut(rest.len() / BLOCK * BLOCK);
        self.take_piece(first)?;
        let start = self.taken as u64;
        let file = self.file;
        let blocks = whole.par_chunks_mut(BLOCK).enumerate();
        let sums = blocks.map(|(number, block)| {
            file.read(start + (number * BLOCK) as u64, block)?;
            Ok(block_checksum(block))
        });
        let sums = sums.collect::<io::Result<Vec<_>>>()?;
        self.sums.finished.extend(sums.as_flattened());
        self.taken += whole.len();
        self.take_piece(last)
    }

    fn take_piece(&mut self, to: &mut [u8]) -> io::Result<()> {
        self.file.read(self.taken as u64, to)?;
        self.taken += to.len();
        self.sums.add(to);
        Ok(())
    }

    /// The checksum of all bytes; reads those not taken yet.
    pub(super) fn checksum(&mut self) -> io::Result<[u8; BYTES]> {
        let mut rest = Vec::new();
        while self.left() > 0 {
            rest.resize(self.left().min(16 * BLOCK), 0);
            self.take(&mut rest)?;
        }
        Ok(self.sums.finish())
    }
}

/// Hashes of a file's blocks.
struct Checksums {
    /// The hash of the current block, and how many of its bytes it has so far.
    begun: (Digester, usize),
    /// The hashes of the blocks before it.
    finished: Vec<u8>,
}

impl Checksums {
    fn new() -> Self {
        Self {
            begun: (Digester::new(), 0),
            finished: Vec::new(),
        }
    }

    /// Adds the next bytes.
    fn add(&mut self, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            let (digest, filled) = &mut self.begun;
            let (these, rest) = bytes.split_at(bytes.len().min(BLOCK - *filled));
            digest.bytes(these);
            *filled += these.len();
            if *filled == BLOCK {
                self.end_block();
            }
            bytes = rest;
        }
    }

    fn end_block(&mut self) {
        self.finished.extend(self.begun.0.finish().to_bytes());
        self.begun = (Digester::new(), 0);
    }

    fn finish(&mut self) -> [u8; BYTES] {
        if self.begun.1 > 0 {
            self.end_block();
        }
        file_checksum(&self.finished)
    }
}

#[cfg(test)]
mod tests {
    use super::super::checksum::checksum;
    use super::*;
    use crate::random::Random;

    /// Slices of any length, also across blocks, get the bytes in order, and the checksum covers all bytes.
    #[test]
    fn bytes_arrive_in_order_and_are_all_in_the_checksum() {
        let mut random = Random(97);
        for length in [0, 1, 100, READ_AHEAD, BLOCK - 1, BLOCK, 5 * BLOCK + 17] {
            let bytes: Vec<u8> = (0..length).map(|_| (random.unit() * 256.0) as u8).collect();
            let read_at = |at: u64, to: &mut [u8]| {
                to.copy_from_slice(&bytes[at as usize..at as usize + to.len()]);
                Ok(())
            };
            for share in [0.001, 0.3, 1.0] {
                let file = RandomAccess {
                    read_at: &read_at,
                    length: length as u64,
                };
                let mut source = Source::new(file, length);
                let mut taken = Vec::new();
                while taken.len() < length / 10 * 9 {
                    let most = (length as f64 * share) as usize + 2;
                    let count = ((random.unit() * most as f64) as usize).min(source.left());
                    let mut to = vec![0; count];
                    source.take(&mut to).expect("they are there");
                    taken.extend(to);
                    assert_eq!(source.taken(), taken.len());
                }
                assert!(taken == bytes[..taken.len()], "{length} {share}");
                let sum = source.checksum().expect("they are there");
                assert_eq!(sum, checksum(&bytes), "{length} {share}");
            }
        }
    }
}
