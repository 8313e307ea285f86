//! PNG, with recipe and a fragment's position in text chunks.

use super::buffers::reserved;
use super::file::Tags;
use super::fragment_position::FragmentPosition;
use super::image::DECODED_LIMIT;
use super::{ImageError, ImageFile, Picture, Recipe, xmp};
use ::png::{
    BitDepth, ColorType, Compression, DecodeOptions, Decoder, Encoder, Limits, SrgbRenderingIntent,
};
use std::io::{BufRead, Cursor, Seek};

/// The keyword of the text chunk with a fragment's position.
const FRAGMENT: &str = "raycast-fragment";

/// The keyword of the text chunk with a picture's recipe.
const RECIPE: &str = "raycast-recipe";

/// No deflate stream expands to more than 1032 times its length (RFC 1951: 258 bytes of a match
/// take two bits at least).
pub(super) const MAX_EXPANSION: u64 = 1032;

/// An encoder of pixels with or without alpha, and with a text chunk for each tag.
pub(super) fn encoder<'a>(
    bytes: &'a mut Vec<u8>,
    (columns, rows): (u32, u32),
    is_opaque: bool,
    tags: Tags<'_>,
) -> Result<Encoder<'a, &'a mut Vec<u8>>, ImageError> {
    let mut encoder = Encoder::new(bytes, columns, rows);
    encoder.set_color(if is_opaque {
        ColorType::Rgb
    } else {
        ColorType::Rgba
    });
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    if let (Some(recipe), None) = (tags.recipe, tags.position)
        && let Some(packet) = xmp::packet(recipe)
    {
        encoder
            .add_itxt_chunk(xmp::KEYWORD.to_owned(), packet)
            .map_err(failed)?;
    }
    let texts = [
        (RECIPE, tags.recipe.map(Recipe::to_string)),
        (FRAGMENT, tags.position.map(FragmentPosition::to_string)),
    ];
    for (keyword, text) in texts {
        if let Some(text) = text {
            encoder
                .add_text_chunk(keyword.to_owned(), text)
                .map_err(failed)?;
        }
    }
    Ok(encoder)
}

pub(super) fn failed(error: ::png::EncodingError) -> ImageError {
    ImageError::Encode(error.to_string())
}

/// The bytes of a PNG; opaque pictures are stored without alpha.
pub(super) fn encode(picture: &Picture, tags: Tags<'_>) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Vec::new();
    let opaque = picture.pixels.iter().all(|pixel| pixel[3] == u8::MAX);
    let encoder = encoder(&mut bytes, (picture.width, picture.height), opaque, tags)?;
    let mut writer = encoder.write_header().map_err(failed)?;
    if opaque {
        let mut rgb: Vec<u8> = reserved(picture.pixels.len() * 3)?;
        rgb.extend(picture.pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]));
        writer.write_image_data(&rgb).map_err(failed)?;
    } else {
        writer
            .write_image_data(picture.pixels.as_flattened())
            .map_err(failed)?;
    }
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

/// Reads a PNG from the top, some rows at a time.
pub(super) struct Reader<R: BufRead + Seek> {
    reader: ::png::Reader<R>,
    channels: usize,
}

impl<R: BufRead + Seek> Reader<R> {
    /// Opens a file of `length` bytes.
    pub(super) fn open(read: R, length: u64) -> Result<Self, ImageError> {
        let limits = Limits {
            bytes: usize::try_from(length)
                .unwrap_or(usize::MAX)
                .saturating_add(1 << 20),
        };
        // By default the decoder verifies neither the pixels' checksum nor those of text, and skips damaged text.
        let mut options = DecodeOptions::default();
        options.set_ignore_adler32(false);
        options.set_skip_ancillary_crc_failures(false);
        let mut decoder = Decoder::new_with_options(read, options);
        decoder.set_limits(limits);
        let info = decoder.read_header_info().map_err(damaged)?;
        let pixels = u64::from(info.width) * u64::from(info.height);
        // Checked before memory is allocated for them.
        if pixels > length.saturating_mul(MAX_EXPANSION) {
            return Err(too_many());
        }
        let reader = decoder.read_info().map_err(damaged)?;
        let channels = match reader.output_color_type() {
            (ColorType::Rgb, BitDepth::Eight) => 3,
            (ColorType::Rgba, BitDepth::Eight) => 4,
            _ => {
                let expected = "expected 8-bit colour, with alpha or without".to_owned();
                return Err(ImageError::Decode(expected));
            }
        };
        Ok(Self { reader, channels })
    }

    /// Columns and rows.
    pub(super) fn size(&self) -> (u32, u32) {
        (self.reader.info().width, self.reader.info().height)
    }

    /// The picture's recipe, where the file stores it.
    pub(super) fn recipe(&self) -> Result<Option<Recipe>, ImageError> {
        self.text(RECIPE).map(str::parse).transpose()
    }

    /// A fragment's position; `None` for a whole picture.
    pub(super) fn position(&self) -> Result<Option<FragmentPosition>, ImageError> {
        self.text(FRAGMENT).map(str::parse).transpose()
    }

    fn text(&self, keyword: &str) -> Option<&str> {
        let texts = &self.reader.info().uncompressed_latin1_text;
        let chunk = texts.iter().find(|chunk| chunk.keyword == keyword)?;
        Some(chunk.text.as_str())
    }

    /// The next rows; the file must have them.
    pub(super) fn rows(&mut self, rows: u32) -> Result<Picture, ImageError> {
        let (width, _) = self.size();
        let mut pixels = reserved(width as usize * rows as usize)?;
        let bytes = width as usize * self.channels;
        for _ in 0..rows {
            let row = self.reader.next_row().map_err(damaged)?;
            let row = row.filter(|row| row.data().len() == bytes).ok_or_else(|| {
                ImageError::Decode("it has fewer rows than it declares".to_owned())
            })?;
            match self.channels {
                3 => pixels
                    .extend((row.data().as_chunks().0.iter()).map(|&[r, g, b]| [r, g, b, u8::MAX])),
                _ => pixels.extend_from_slice(row.data().as_chunks().0),
            }
        }
        Ok(Picture {
            width,
            height: rows,
            pixels,
            layers: None,
        })
    }

    /// Reads the file to its end, so that its last checksum is verified.
    pub(super) fn finish(&mut self) -> Result<(), ImageError> {
        self.reader.finish().map_err(damaged)
    }
}

fn damaged(error: ::png::DecodingError) -> ImageError {
    ImageError::Decode(error.to_string())
}

/// The error for a header with more pixels than the file can hold.
pub(super) fn too_many() -> ImageError {
    ImageError::Decode("it declares more pixels than it can hold".to_owned())
}

/// Decodes a PNG that [`encode`] made.
pub(super) fn decode(bytes: &[u8]) -> Result<ImageFile, ImageError> {
    let mut reader = Reader::open(Cursor::new(bytes), bytes.len() as u64)?;
    let (columns, rows) = reader.size();
    if u64::from(columns) * u64::from(rows) > DECODED_LIMIT {
        return Err(too_many());
    }
    let picture = reader.rows(rows)?;
    reader.finish()?;
    ImageFile::checked(picture, reader.recipe()?, reader.position()?)
}

#[cfg(test)]
mod tests {
    use super::super::Format;
    use super::super::fragment::tests::with_checksums;
    use super::super::recipe::tests::sample_recipe;
    use super::*;

    fn noise(width: u32, height: u32, alpha: bool) -> Picture {
        let mut picture = Picture::blank(width, height, false);
        for (i, pixel) in picture.pixels.iter_mut().enumerate() {
            let [a, b, c, d] = (i as u32).wrapping_mul(0x9e37_79b9).to_le_bytes();
            *pixel = [a, b, c, if alpha { d } else { 255 }];
        }
        picture
    }

    #[test]
    fn comes_back_exactly() {
        for picture in [noise(37, 23, false), noise(37, 23, true), noise(1, 1, true)] {
            let bytes = picture.encode(Format::Png).expect("encodes");
            assert_eq!(bytes, picture.encode(Format::Png).expect("encodes"));
            let file = decode(&bytes).expect("decodes");
            assert_eq!((file.recipe, file.position), (None, None));
            assert_eq!(file.picture, picture);
            // The truth is another decoder.
            let other = image::load_from_memory(&bytes).expect("decodes").to_rgba8();
            assert_eq!(other.as_raw(), picture.pixels.as_flattened());
        }
    }

    #[test]
    fn damage_is_an_error() {
        let bytes = noise(9, 5, true).encode(Format::Png).expect("encodes");
        for length in 0..bytes.len() - 1 {
            assert!(decode(&bytes[..length]).is_err(), "cut to {length}");
        }
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0xff;
            assert!(decode(&damaged).is_err(), "{at}");
        }
        // Also where a recipe, or another text, is damaged: the picture must not lose it in silence.
        let picture = noise(9, 5, true);
        let recipe = sample_recipe(9, 5);
        let encoded = picture
            .encode_with(Format::Png, Some(&recipe))
            .expect("encodes");
        for bit in 0..8 * encoded.len() {
            let mut damaged = encoded.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(decode(&damaged).is_err(), "bit {bit}");
        }
        // The compressed pixels have a checksum of their own, whatever that of their chunk says.
        let begin = bytes.windows(4).position(|name| name == b"IDAT");
        let begin = begin.expect("pixels") + 4;
        for bit in 8 * begin..8 * (bytes.len() - 16) {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            let damaged = with_checksums(damaged).expect("no length was changed");
            let is_same = |file: ImageFile| file.picture == picture;
            assert!(decode(&damaged).map_or(true, is_same), "bit {bit}");
        }
        // A header that claims 2^30 pixels is refused before they are allocated.
        let mut huge = bytes;
        huge[16..24].copy_from_slice(&[0, 0, 0x80, 0, 0, 0, 0x80, 0]);
        assert!(decode(&huge).is_err());
    }
}
