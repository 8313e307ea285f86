//! Reading the TIFF that [`tiff`](super::tiff) writes, by the `tiff` crate.

use super::buffers::{filled, reserved};
use super::image::DECODED_LIMIT;
use super::png::{MAX_EXPANSION, too_many};
use super::{ImageError, ImageFile, Picture, Recipe};
use ::tiff::decoder::{ChunkType, Decoder, Limits};
use ::tiff::tags::Tag;
use ::tiff::{ColorType, TiffError};
use std::io::{Cursor, Read, Seek};

/// The first bytes of the files that are written: little-endian, with offsets of 32 or 64 bits.
const SIGNATURES: [&[u8]; 2] = [b"II*\0", b"II+\0"];

/// Whether a file begins as a TIFF that is written here.
pub(super) fn is_tiff(begin: &[u8]) -> bool {
    SIGNATURES
        .iter()
        .any(|signature| begin.starts_with(signature))
}

/// Reads a TIFF from the top, some rows at a time.
pub(super) struct Reader<R: Read + Seek> {
    decoder: Decoder<R>,
    size: (u32, u32),
    recipe: Option<Recipe>,
    /// Columns and rows of a tile, or of a strip.
    tile: (u32, u32),
    channels: usize,
    /// The pixels of the tiles that were decoded last, side by side, row by row.
    decoded: Vec<[u8; 4]>,
    /// How many of them were returned.
    returned: usize,
    /// The row after the decoded ones.
    next: u32,
}

impl<R: Read + Seek> Reader<R> {
    /// Opens a file of `length` bytes.
    pub(super) fn open(read: R, length: u64) -> Result<Self, ImageError> {
        let mut limits = Limits::default();
        // By default tables of tiles have at most a megabyte; none is longer than the file.
        limits.ifd_value_size = usize::try_from(length).unwrap_or(usize::MAX);
        let mut decoder = Decoder::new(read).map_err(damaged)?.with_limits(limits);
        let size = decoder.dimensions().map_err(damaged)?;
        let channels = match decoder.colortype().map_err(damaged)? {
            ColorType::RGB(8) => 3,
            ColorType::RGBA(8) => 4,
            _ => {
                let expected = "expected 8-bit colour, with alpha or without".to_owned();
                return Err(ImageError::Decode(expected));
            }
        };
        let pixels = u64::from(size.0) * u64::from(size.1);
        let tile = decoder.chunk_dimensions();
        let decoded = u64::from(size.0) * u64::from(tile.1.min(size.1));
        // Checked before memory is allocated for them.
        if pixels > length.saturating_mul(MAX_EXPANSION) || decoded > DECODED_LIMIT {
            return Err(too_many());
        }
        if pixels == 0 || tile.0 == 0 || tile.1 == 0 {
            return Err(ImageError::Decode("it has no pixels".to_owned()));
        }
        check_ends(&mut decoder, length)?;
        let description = decoder.find_tag(Tag::ImageDescription).map_err(damaged)?;
        let text = description.map(|value| value.into_string());
        let recipe = text.transpose().map_err(damaged)?;
        Ok(Self {
            size,
            recipe: recipe.as_deref().map(str::parse).transpose()?,
            tile,
            channels,
            decoded: Vec::new(),
            returned: 0,
            next: 0,
            decoder,
        })
    }

    /// Columns and rows.
    pub(super) fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The picture's recipe, where the file stores it.
    pub(super) fn recipe(&self) -> Option<&Recipe> {
        self.recipe.as_ref()
    }

    /// The next rows; the file must have them.
    pub(super) fn rows(&mut self, rows: u32) -> Result<Picture, ImageError> {
        let mut left = self.size.0 as usize * rows as usize;
        let mut pixels = reserved(left)?;
        while left > 0 {
            if self.returned == self.decoded.len() {
                self.decode()?;
            }
            let rest = &self.decoded[self.returned..];
            let taken = left.min(rest.len());
            pixels.extend_from_slice(&rest[..taken]);
            self.returned += taken;
            left -= taken;
        }
        Ok(Picture {
            width: self.size.0,
            height: rows,
            pixels,
            layers: None,
        })
    }

    /// Decodes the next tiles that lie side by side.
    fn decode(&mut self) -> Result<(), ImageError> {
        let (columns, rows) = self.size;
        let height = self.tile.1.min(rows.saturating_sub(self.next));
        let count = columns as usize * height as usize;
        if count == 0 {
            return Err(ImageError::Decode(
                "it has fewer rows than it declares".to_owned(),
            ));
        }
        let across = columns.div_ceil(self.tile.0);
        let first = self.next / self.tile.1 * across;
        if self.decoded.len() != count {
            self.decoded = filled([u8::MAX; 4], count)?;
        }
        for tile in 0..across {
            let left = tile * self.tile.0;
            let width = self.tile.0.min(columns - left) as usize;
            let row = width * self.channels;
            let mut bytes = filled(0, row * height as usize)?;
            self.decoder
                .read_chunk_bytes(first + tile, &mut bytes)
                .map_err(damaged)?;
            let lines = self.decoded.chunks_exact_mut(columns as usize);
            for (line, bytes) in lines.zip(bytes.chunks_exact(row)) {
                let line = &mut line[left as usize..][..width];
                for (pixel, bytes) in line.iter_mut().zip(bytes.chunks_exact(self.channels)) {
                    pixel[..self.channels].copy_from_slice(bytes);
                }
            }
        }
        self.returned = 0;
        self.next += height;
        Ok(())
    }
}

/// Checks that all tiles end within a file of `length` bytes: the last rows of a tile may lie below the picture, and are
/// then not decoded.
fn check_ends<R: Read + Seek>(decoder: &mut Decoder<R>, length: u64) -> Result<(), ImageError> {
    let (offsets, lengths) = match decoder.get_chunk_type() {
        ChunkType::Tile => (Tag::TileOffsets, Tag::TileByteCounts),
        ChunkType::Strip => (Tag::StripOffsets, Tag::StripByteCounts),
    };
    let offsets = decoder.get_tag_u64_vec(offsets).map_err(damaged)?;
    let lengths = decoder.get_tag_u64_vec(lengths).map_err(damaged)?;
    let mut ends = offsets.iter().zip(lengths);
    if ends.any(|(&offset, bytes)| offset.saturating_add(bytes) > length) {
        return Err(ImageError::Decode("it ends early".to_owned()));
    }
    Ok(())
}

fn damaged(error: TiffError) -> ImageError {
    ImageError::Decode(error.to_string())
}

/// Decodes a TIFF that [`tiff`](super::tiff) wrote.
pub(super) fn decode(bytes: &[u8]) -> Result<ImageFile, ImageError> {
    let mut reader = Reader::open(Cursor::new(bytes), bytes.len() as u64)?;
    let (columns, rows) = reader.size();
    if u64::from(columns) * u64::from(rows) > DECODED_LIMIT {
        return Err(too_many());
    }
    let picture = reader.rows(rows)?;
    ImageFile::checked(picture, reader.recipe, None)
}
