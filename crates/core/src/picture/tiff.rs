//! TIFF (Adobe, "TIFF Revision 6.0", 1992), and BigTIFF where 32-bit offsets may not suffice: one image in tiles,
//! deflated with horizontal differencing.
//!
//! The container is written here because no crate writes tiles to a file that it did not start. The length of what
//! precedes the tiles (tags, and the tiles' offsets) follows from the picture's size and recipe only, so tiles are
//! written as they arrive.

use super::band::{Band, BandSizes, Source, length};
use super::{ImageError, Recipe};
use crate::camera::Rect;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;
use std::io::Write;

/// Pixels of a tile's side.
pub(super) const TILE: u32 = 256;

/// The largest bound of a file's bytes for 32-bit offsets: half of what they reach, so that an error in the bound
/// does not matter.
const CLASSIC: u64 = 1 << 31;

/// The number of tiles in a band's rectangle.
pub(super) fn tiles(rect: Rect) -> usize {
    rect.width.div_ceil(TILE) as usize * rect.height.div_ceil(TILE) as usize
}

/// A TIFF in tiles.
#[derive(Debug)]
pub(super) struct Banded {
    size: (u32, u32),
    /// Red, green and blue, and alpha if any pixel needs it.
    channels: u16,
    /// The recipe, as `ImageDescription`.
    description: Option<String>,
    is_big: bool,
}

impl Banded {
    pub(super) fn new(
        size: (u32, u32),
        is_opaque: bool,
        recipe: Option<&Recipe>,
    ) -> Result<Self, ImageError> {
        let channels = if is_opaque { 3 } else { 4 };
        let all = Rect {
            x: 0,
            y: 0,
            width: size.0,
            height: size.1,
        };
        // Incompressible data is stored in blocks of at most 64 KiB with 5 bytes each.
        let most = tiles(all) as u64 * u64::from(TILE * TILE * u32::from(channels) + 1024);
        Ok(Self {
            size,
            channels,
            description: recipe.map(Recipe::to_string),
            is_big: most > CLASSIC,
        })
    }

    /// Header and directory of a file of these tiles, in order; without tiles, a placeholder of the same length.
    pub(super) fn head(&self, lengths: &[u32]) -> Vec<u8> {
        let (columns, rows) = self.size;
        let all = Rect {
            x: 0,
            y: 0,
            width: columns,
            height: rows,
        };
        let count = tiles(all);
        let directory = |offsets: Vec<u64>| {
            let mut tags = vec![
                (256, Values::Long(vec![columns])),
                (257, Values::Long(vec![rows])),
                // Bits of each channel; deflate; red, green and blue.
                (258, Values::Short(vec![8; self.channels.into()])),
                (259, Values::Short(vec![8])),
                (262, Values::Short(vec![2])),
            ];
            if let Some(text) = &self.description {
                tags.push((270, Values::Text(text.clone())));
            }
            tags.extend([
                (277, Values::Short(vec![self.channels])),
                // Interleaved channels; horizontal differencing.
                (284, Values::Short(vec![1])),
                (317, Values::Short(vec![2])),
                (322, Values::Long(vec![TILE])),
                (323, Values::Long(vec![TILE])),
                (324, Values::Offset(offsets)),
                (
                    325,
                    Values::Long(
                        lengths
                            .iter()
                            .copied()
                            .chain([0])
                            .cycle()
                            .take(count)
                            .collect(),
                    ),
                ),
            ]);
            if self.channels == 4 {
                // Straight alpha.
                tags.push((338, Values::Short(vec![2])));
            }
            self.directory(&tags)
        };
        let mut next = directory(vec![0; count]).len() as u64;
        if lengths.is_empty() {
            return directory(vec![0; count]);
        }
        let mut offsets = Vec::with_capacity(count);
        for &length in lengths {
            offsets.push(next);
            next += u64::from(length);
        }
        directory(offsets)
    }

    /// The file's header, its one directory, and the values that do not fit into entries.
    fn directory(&self, tags: &[(u16, Values)]) -> Vec<u8> {
        let mut head = Vec::new();
        // Little-endian; the directory follows immediately.
        let (entry, room) = if self.is_big {
            head.extend(*b"II\x2b\0\x08\0\0\0");
            head.extend(16u64.to_le_bytes());
            head.extend((tags.len() as u64).to_le_bytes());
            (20, 8)
        } else {
            head.extend(*b"II\x2a\0");
            head.extend(8u32.to_le_bytes());
            head.extend((tags.len() as u16).to_le_bytes());
            (12, 4)
        };
        let number = |head: &mut Vec<u8>, number: u64| {
            // The number is below 2^32 in a classic file, so nothing is cut off.
            head.extend(&number.to_le_bytes()[..room]);
        };
        let end = head.len() + entry * tags.len() + room;
        let mut beyond = Vec::new();
        for (tag, values) in tags {
            let (kind, count, mut bytes) = values.bytes(self.is_big);
            head.extend(tag.to_le_bytes());
            head.extend(kind.to_le_bytes());
            number(&mut head, count as u64);
            if bytes.len() <= room {
                bytes.resize(room, 0);
                head.extend(bytes);
            } else {
                number(&mut head, (end + beyond.len()) as u64);
                beyond.extend(bytes);
                // Values start at even offsets.
                beyond.resize(beyond.len().next_multiple_of(2), 0);
            }
        }
        // No next directory.
        number(&mut head, 0);
        head.extend(beyond);
        head
    }

    /// The tiles of a band, row by row.
    pub(super) fn encode(&self, source: Source<'_>) -> Result<Band, ImageError> {
        let rect = source.rect;
        let across = rect.width.div_ceil(TILE);
        let tiles: Vec<Vec<u8>> = (0..tiles(rect) as u32)
            .into_par_iter()
            .map(|tile| {
                let (x, y) = (tile % across * TILE, rect.y + tile / across * TILE);
                self.tile(source, x, y)
            })
            .collect::<Result<_, _>>()?;
        let parts = tiles
            .iter()
            .map(|tile| length(tile))
            .collect::<Result<_, _>>()?;
        Ok(Band {
            bytes: tiles.concat(),
            sizes: BandSizes { parts, check: 0 },
        })
    }

    /// The tile at a column and row; zero beyond the picture.
    fn tile(&self, source: Source<'_>, x: u32, y: u32) -> Result<Vec<u8>, ImageError> {
        let failed = |error: std::io::Error| ImageError::Encode(error.to_string());
        let channels = usize::from(self.channels);
        let columns = x as usize..(x + TILE).min(source.rect.width) as usize;
        let mut deflate = ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
        let mut row = vec![0; TILE as usize * channels];
        for y in y..y + TILE {
            row.fill(0);
            if y < source.rect.bottom() {
                let mut left = [0u8; 4];
                let pixels = &source.row(y)[columns.clone()];
                for (to, pixel) in row.chunks_exact_mut(channels).zip(pixels) {
                    for (channel, to) in to.iter_mut().enumerate() {
                        *to = pixel[channel].wrapping_sub(left[channel]);
                    }
                    left = *pixel;
                }
                if columns.len() < TILE as usize {
                    // The difference back to zero.
                    let beyond = &mut row[columns.len() * channels..][..channels];
                    for (to, left) in beyond.iter_mut().zip(left) {
                        *to = 0u8.wrapping_sub(left);
                    }
                }
            }
            deflate.write_all(&row).map_err(failed)?;
        }
        deflate.finish().map_err(failed)
    }
}

/// The values of a tag.
enum Values {
    Short(Vec<u16>),
    Long(Vec<u32>),
    /// As wide as the file's offsets.
    Offset(Vec<u64>),
    Text(String),
}

impl Values {
    /// The type's number, the count, and the bytes.
    fn bytes(&self, is_big: bool) -> (u16, usize, Vec<u8>) {
        match self {
            Self::Short(values) => {
                let bytes = values.iter().flat_map(|value| value.to_le_bytes());
                (3, values.len(), bytes.collect())
            }
            Self::Long(values) => {
                let bytes = values.iter().flat_map(|value| value.to_le_bytes());
                (4, values.len(), bytes.collect())
            }
            Self::Offset(values) if is_big => {
                let bytes = values.iter().flat_map(|value| value.to_le_bytes());
                (16, values.len(), bytes.collect())
            }
            Self::Offset(values) => {
                let bytes = values
                    .iter()
                    .flat_map(|&value| (value as u32).to_le_bytes());
                (4, values.len(), bytes.collect())
            }
            Self::Text(text) => {
                let bytes = [text.as_bytes(), &[0]].concat();
                (2, bytes.len(), bytes)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::sample_picture;
    use super::super::recipe::tests::sample_recipe;
    use super::super::{Picture, tiff_read};
    use super::*;

    fn encoded(picture: &Picture, file: &Banded) -> Vec<u8> {
        let rect = Rect {
            x: 0,
            y: 0,
            width: picture.width,
            height: picture.height,
        };
        let source = Source {
            picture,
            rect,
            first: 0,
        };
        let band = file.encode(source).expect("encodes");
        [file.head(&band.sizes.parts), band.bytes].concat()
    }

    #[test]
    fn what_is_written_is_read_with_offsets_of_either_width() {
        let recipe = sample_recipe(40, 30);
        for (columns, rows) in [(1, 1), (256, 256), (257, 511), (700, 300)] {
            let translucent = sample_picture(columns, rows, false);
            let mut opaque = translucent.clone();
            opaque.pixels.iter_mut().for_each(|pixel| pixel[3] = 255);
            for picture in [translucent, opaque] {
                let is_opaque = picture.pixels.iter().all(|pixel| pixel[3] == 255);
                for is_big in [false, true] {
                    let file = Banded::new((columns, rows), is_opaque, Some(&recipe));
                    let file = Banded {
                        is_big,
                        ..file.expect("a file")
                    };
                    let bytes = encoded(&picture, &file);
                    assert_eq!(bytes[2], if is_big { 43 } else { 42 });
                    let read = tiff_read::decode(&bytes).expect("decodes");
                    assert!(read.picture == picture, "{columns} {rows} {is_big}");
                    assert_eq!(read.recipe.as_ref(), Some(&recipe));
                }
            }
        }
    }

    /// Whatever is read of a damaged file, it is no larger than the file can hold.
    #[test]
    fn a_damaged_file_is_an_error_or_a_picture() {
        let picture = sample_picture(300, 200, false);
        let file = Banded::new((300, 200), false, Some(&sample_recipe(40, 30))).expect("a file");
        let bytes = encoded(&picture, &file);
        for length in (0..bytes.len()).step_by(97) {
            assert!(
                tiff_read::decode(&bytes[..length]).is_err(),
                "cut to {length}"
            );
        }
        let head = file.head(&[]).len();
        let mut refused = 0;
        for at in 0..head {
            for bit in [0, 3, 7] {
                let mut bytes = bytes.clone();
                bytes[at] ^= 1 << bit;
                match tiff_read::decode(&bytes) {
                    Ok(file) => assert!(file.picture.pixels.len() <= bytes.len() * 1032),
                    Err(_) => refused += 1,
                }
            }
        }
        assert!(refused > head, "{refused} of {}", 3 * head);
    }
}
