//! PNG in bands, for pictures larger than memory.

use super::ImageError;
use super::band::{Band, BandSizes, Source, length};
use super::buffers::reserved;
use super::file::Tags;
use super::png::{encoder, failed};
use crate::camera::Rect;
use flate2::{Compress, FlushCompress};
use rayon::prelude::*;

/// A PNG in bands: one deflate stream that restarts, at a byte boundary, several times in each band, so that a band's
/// bytes follow from its own rows only (as in Adler's `pigz`, 2007).
#[derive(Debug)]
pub(super) struct Banded {
    head: Vec<u8>,
    is_opaque: bool,
    columns: u32,
}

/// Bytes of rows between restarts (at least one row). A restart forgets the preceding 32 KiB; with smaller values
/// that costs compression, with larger ones a band has too few parts for all threads.
const RESTART_BYTES: usize = 1 << 20;

impl Banded {
    pub(super) fn new(
        size: (u32, u32),
        is_opaque: bool,
        tags: Tags<'_>,
    ) -> Result<Self, ImageError> {
        let mut head = Vec::new();
        drop(
            encoder(&mut head, size, is_opaque, tags)?
                .write_header()
                .map_err(failed)?,
        );
        // The writer appended the end chunk when it was dropped.
        head.truncate(head.len() - END.len());
        // The header of a zlib stream (RFC 1950): deflate, a window of 32 KiB, the fastest compression.
        head.extend(chunk(*b"IDAT", &[0x78, 0x01]));
        Ok(Self {
            head,
            is_opaque,
            columns: size.0,
        })
    }

    pub(super) fn head(&self) -> Vec<u8> {
        self.head.clone()
    }

    /// The bytes of a row before compression, with the filter's number.
    fn row_bytes(&self) -> usize {
        1 + self.columns as usize * if self.is_opaque { 3 } else { 4 }
    }

    /// The bytes of a band before compression.
    pub(super) fn filtered_bytes(&self, rect: Rect) -> u64 {
        self.row_bytes() as u64 * u64::from(rect.height)
    }

    /// The chunk of a band's rows.
    pub(super) fn encode(&self, source: Source<'_>) -> Result<Band, ImageError> {
        let rows = (RESTART_BYTES / self.row_bytes()).max(1);
        let starts: Vec<u32> = (source.rect.y..source.rect.bottom())
            .step_by(rows)
            .collect();
        let pieces: Vec<(Vec<u8>, u32, u64)> = starts
            .into_par_iter()
            .map(|y| {
                let end = (y + rows as u32).min(source.rect.bottom());
                let filtered = self.filtered(source, y, end)?;
                let check = simd_adler32::adler32(&&filtered[..]);
                Ok((deflated(&filtered)?, check, filtered.len() as u64))
            })
            .collect::<Result<_, ImageError>>()?;
        let check = pieces.iter().fold(1, |sum, &(_, check, length)| {
            combined_adler32(sum, check, length)
        });
        let data: Vec<u8> = pieces.into_iter().flat_map(|(bytes, ..)| bytes).collect();
        let bytes = chunk(*b"IDAT", &data);
        let parts = vec![length(&bytes)?];
        Ok(Band {
            bytes,
            sizes: BandSizes { parts, check },
        })
    }

    /// Rows as differences: the first row from pixel to pixel (filter 1), the others from row to row (filter 2),
    /// which compresses gradient backgrounds best.
    fn filtered(&self, source: Source<'_>, y: u32, end: u32) -> Result<Vec<u8>, ImageError> {
        let channels = if self.is_opaque { 3 } else { 4 };
        let mut filtered = reserved(self.row_bytes() * (end - y) as usize)?;
        filtered.push(1);
        let mut left = [0u8; 4];
        for pixel in source.row(y) {
            let difference: [u8; 4] = std::array::from_fn(|i| pixel[i].wrapping_sub(left[i]));
            filtered.extend(&difference[..channels]);
            left = *pixel;
        }
        for y in y + 1..end {
            filtered.push(2);
            for (pixel, above) in source.row(y).iter().zip(source.row(y - 1)) {
                let difference: [u8; 4] = std::array::from_fn(|i| pixel[i].wrapping_sub(above[i]));
                filtered.extend(&difference[..channels]);
            }
        }
        Ok(filtered)
    }

    /// The end of the stream and of the file, from the checksum and the length of each band.
    pub(super) fn tail(
        &self,
        bands: impl Iterator<Item = (u32, u64)>,
    ) -> Result<Vec<u8>, ImageError> {
        let check = bands.fold(1, |sum, (check, length)| {
            combined_adler32(sum, check, length)
        });
        // A last, empty block of fixed codes.
        let mut end = vec![0x03, 0x00];
        end.extend(check.to_be_bytes());
        let mut tail = chunk(*b"IDAT", &end);
        tail.extend(END);
        Ok(tail)
    }
}

/// The chunk that ends a PNG.
const END: [u8; 12] = *b"\0\0\0\0IEND\xae\x42\x60\x82";

/// A chunk: length, name, data, and a checksum of name and data.
fn chunk(name: [u8; 4], data: &[u8]) -> Vec<u8> {
    let mut check = flate2::Crc::new();
    check.update(&name);
    check.update(data);
    let mut chunk = Vec::with_capacity(data.len() + 12);
    // A band has far fewer than 2^31 bytes.
    chunk.extend((data.len() as u32).to_be_bytes());
    chunk.extend(name);
    chunk.extend(data);
    chunk.extend(check.sum().to_be_bytes());
    chunk
}

/// Deflates bytes up to a byte boundary, without references to earlier bytes.
fn deflated(bytes: &[u8]) -> Result<Vec<u8>, ImageError> {
    let failed = |reason: String| ImageError::Encode(reason);
    let mut deflate = Compress::new(flate2::Compression::fast(), false);
    let mut out = Vec::with_capacity(bytes.len() / 8 + 64);
    loop {
        let done = deflate.total_in() as usize;
        deflate
            .compress_vec(&bytes[done..], &mut out, FlushCompress::Sync)
            .map_err(|error| failed(error.to_string()))?;
        // Room left in the buffer means that nothing waits to be flushed.
        if deflate.total_in() as usize == bytes.len() && out.len() < out.capacity() {
            return Ok(out);
        }
        out.try_reserve(out.len().max(1 << 12))
            .map_err(|error| failed(error.to_string()))?;
    }
}

/// The Adler-32 of two concatenated sequences, from their checksums and the second one's length (RFC 1950: a is one
/// plus the sum of all bytes, b is the sum of all values of a, both modulo 65521).
fn combined_adler32(first: u32, second: u32, length: u64) -> u32 {
    const MODULUS: u64 = 65_521;
    let parts = |check: u32| (u64::from(check & 0xffff), u64::from(check >> 16));
    let ((a, b), (c, d)) = (parts(first), parts(second));
    let low = (a + c + MODULUS - 1) % MODULUS;
    let high = (b + d + length % MODULUS * (a + MODULUS - 1)) % MODULUS;
    (high << 16 | low) as u32
}
