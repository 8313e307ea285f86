//! A part of a file that is written in bands.

use super::{ImageError, Picture};
use crate::camera::Rect;

/// The encoded part of a file that one band makes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Band {
    /// Bytes of the file; they follow those of the band above.
    pub bytes: Vec<u8>,
    /// What the file's head and tail need to know of the band.
    pub sizes: BandSizes,
}

/// What the head and the tail of a file need to know of a band.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BandSizes {
    /// The length of each of its parts (tiles, or blocks of rows), in order.
    pub parts: Vec<u32>,
    /// A checksum, in formats that have one over all bands: PNG's Adler-32; else 0.
    pub check: u32,
}

impl BandSizes {
    /// The band's length in bytes.
    pub fn bytes(&self) -> u64 {
        self.parts.iter().map(|&part| u64::from(part)).sum()
    }
}

/// A part's length as files store it.
pub(super) fn length(bytes: &[u8]) -> Result<u32, ImageError> {
    u32::try_from(bytes.len())
        .map_err(|_| ImageError::Encode("a part of it has more than 2^32 bytes".to_owned()))
}

/// The rows of a band, in a picture that may have more rows.
#[derive(Clone, Copy)]
pub(super) struct Source<'p> {
    pub(super) picture: &'p Picture,
    /// The band's rectangle in the whole picture.
    pub(super) rect: Rect,
    /// The row of the whole picture that `picture` starts with.
    pub(super) first: u32,
}

impl<'p> Source<'p> {
    /// The index in `picture`'s lists at which a row of the whole picture starts.
    pub(super) fn at(&self, y: u32) -> usize {
        (y - self.first) as usize * self.picture.width as usize
    }

    /// The pixels of the band's rows.
    pub(super) fn pixels(&self) -> &'p [[u8; 4]] {
        &self.picture.pixels[self.at(self.rect.y)..self.at(self.rect.bottom())]
    }

    /// The pixels of one row of the whole picture.
    pub(super) fn row(&self, y: u32) -> &'p [[u8; 4]] {
        &self.picture.pixels[self.at(y)..self.at(y + 1)]
    }
}
