//! A part of a file that is written band by band.

use super::{ImageError, Picture};
use crate::camera::Rect;

/// A band's part of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Band {
    /// Its bytes, which follow those of the band above.
    pub bytes: Vec<u8>,
    /// What the file's head and tail need to know of it.
    pub sizes: BandSizes,
}

/// What the head and the tail of a file need to know of a band.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BandSizes {
    /// Bytes of each of its parts (tiles, blocks of rows), which follow one another.
    pub parts: Vec<u32>,
    /// A checksum where the kind of file has one over all bands: PNG's Adler-32; else 0.
    pub check: u32,
}

impl BandSizes {
    /// How many bytes the band has.
    pub fn bytes(&self) -> u64 {
        self.parts.iter().map(|&part| u64::from(part)).sum()
    }
}

/// A part's length as files hold it.
pub(super) fn length(bytes: &[u8]) -> Result<u32, ImageError> {
    u32::try_from(bytes.len())
        .map_err(|_| ImageError::Encode("a part of it has more than 2^32 bytes".to_owned()))
}

/// The rows of a band, in a picture that may have more.
#[derive(Clone, Copy)]
pub(super) struct Source<'p> {
    pub(super) picture: &'p Picture,
    /// The band's rectangle of the whole picture.
    pub(super) rect: Rect,
    /// The row of the whole picture with which `picture` begins.
    pub(super) first: u32,
}

impl<'p> Source<'p> {
    /// Where a row of the whole picture begins in `picture`'s lists.
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
