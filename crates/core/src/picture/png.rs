//! PNG, with what it was made of, and a fragment's place, in text chunks.

use super::buffers::{collected, filled, reserved};
use super::file::Tags;
use super::place::Place;
use super::{ImageError, ImageFile, Picture, Recipe};
use crate::camera::PIXEL_LIMIT;
use ::png::{BitDepth, ColorType, Compression, Decoder, Encoder, Limits, SrgbRenderingIntent};
use std::io::Cursor;

/// The text chunk that holds a fragment's place.
const FRAGMENT: &str = "raycast-fragment";

/// The text chunk that holds a picture's recipe.
const RECIPE: &str = "raycast-recipe";

/// No deflate stream expands to more than 1032 times its length (RFC 1951: 258 bytes of a match
/// take two bits at least).
pub(super) const MOST_EXPANSION: u64 = 1032;

/// The bytes of a PNG; opaque pictures are stored without alpha.
pub(super) fn encode(picture: &Picture, tags: Tags<'_>) -> Result<Vec<u8>, ImageError> {
    let failed = |error: ::png::EncodingError| ImageError::Encode(error.to_string());
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, picture.width, picture.height);
    let opaque = picture.pixels.iter().all(|pixel| pixel[3] == u8::MAX);
    encoder.set_color(if opaque {
        ColorType::Rgb
    } else {
        ColorType::Rgba
    });
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    let texts = [
        (RECIPE, tags.recipe.map(Recipe::to_string)),
        (FRAGMENT, tags.place.map(Place::to_string)),
    ];
    for (keyword, text) in texts {
        if let Some(text) = text {
            encoder
                .add_text_chunk(keyword.to_owned(), text)
                .map_err(failed)?;
        }
    }
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

/// What a PNG that [`encode`] made holds.
pub(super) fn decode(bytes: &[u8]) -> Result<ImageFile, ImageError> {
    let failed = |error: ::png::DecodingError| ImageError::Decode(error.to_string());
    let damaged = |reason: &str| ImageError::Decode(reason.to_owned());
    let mut decoder = Decoder::new_with_limits(
        Cursor::new(bytes),
        Limits {
            bytes: bytes.len() + (1 << 20),
        },
    );
    let info = decoder.read_header_info().map_err(failed)?;
    let pixels = u64::from(info.width) * u64::from(info.height);
    // Checked before anything is made to hold them.
    if pixels > PIXEL_LIMIT || pixels > bytes.len() as u64 * MOST_EXPANSION {
        return Err(damaged("it tells of more pixels than it can hold"));
    }
    let mut reader = decoder.read_info().map_err(failed)?;
    let (width, height) = (reader.info().width, reader.info().height);
    let channels = match reader.output_color_type() {
        (ColorType::Rgb, BitDepth::Eight) => 3,
        (ColorType::Rgba, BitDepth::Eight) => 4,
        _ => return Err(damaged("expected 8-bit colour, with alpha or without")),
    };
    let mut samples = filled(0, pixels as usize * channels)?;
    reader.next_frame(&mut samples).map_err(failed)?;
    reader.finish().map_err(failed)?;
    let texts = &reader.info().uncompressed_latin1_text;
    let text = |keyword| {
        let chunk = texts.iter().find(|chunk| chunk.keyword == keyword)?;
        Some(chunk.text.as_str())
    };
    let recipe: Option<Recipe> = text(RECIPE).map(str::parse).transpose()?;
    let place: Option<Place> = text(FRAGMENT).map(str::parse).transpose()?;
    let count = pixels as usize;
    let pixels = match channels {
        3 => {
            let rgb = samples.as_chunks().0.iter();
            collected(count, rgb.map(|&[r, g, b]| [r, g, b, u8::MAX]))?
        }
        _ => collected(count, samples.as_chunks().0.iter().copied())?,
    };
    let picture = Picture {
        width,
        height,
        pixels,
        layers: None,
    };
    ImageFile::checked(picture, recipe, place)
}

#[cfg(test)]
mod tests {
    use super::super::Format;
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
            assert_eq!((file.recipe, file.place), (None, None));
            assert_eq!(file.picture, picture);
            // The truth from another reader.
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
            let _ = decode(&damaged);
        }
        // A header that tells of 2^30 pixels is refused before they are made.
        let mut huge = bytes;
        huge[16..24].copy_from_slice(&[0, 0, 0x80, 0, 0, 0, 0x80, 0]);
        assert!(decode(&huge).is_err());
    }
}
