//! JPEG, by the `image` crate.

use super::opaque::over_black;
use super::{ImageError, Picture, Recipe, xmp};
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;

/// JPEG quality, out of 100. At 92 the loss is invisible beside the original; higher values make much larger files,
/// lower ones show blocks at sharp edges.
const QUALITY: u8 = 92;

/// The most pixels a JPEG's side can have.
const SIDE_LIMIT: u32 = 65_535;

/// The start of an XMP segment ("XMP Specification Part 3", Adobe, 2020).
const XMP: &[u8] = b"http://ns.adobe.com/xap/1.0/\0";

/// Encodes a picture; a whole panorama gets the metadata that mark it for viewers.
pub(super) fn encode(picture: &Picture, recipe: Option<&Recipe>) -> Result<Vec<u8>, ImageError> {
    if picture.width.max(picture.height) > SIDE_LIMIT {
        return Err(ImageError::Encode(format!(
            "a JPEG has at most {SIDE_LIMIT} pixels a side"
        )));
    }
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, QUALITY)
        .encode(
            &over_black(&[], &picture.pixels)?,
            picture.width,
            picture.height,
            ExtendedColorType::Rgb8,
        )
        .map_err(|error| ImageError::Encode(error.to_string()))?;
    if let Some(packet) = recipe.and_then(xmp::packet) {
        insert_xmp(&mut bytes, packet.as_bytes());
    }
    Ok(bytes)
}

/// Inserts an XMP packet in an APP1 segment after the JFIF header, which must come first. Without such a header, or
/// if the packet is too long, the file stays unchanged.
fn insert_xmp(bytes: &mut Vec<u8>, packet: &[u8]) {
    // SOI, then APP0: its marker, and its length including the two bytes of the length.
    let Some(&[0xff, 0xd8, 0xff, 0xe0, high, low]) = bytes.first_chunk() else {
        return;
    };
    let at = 4 + usize::from(u16::from_be_bytes([high, low]));
    let Ok(length) = u16::try_from(2 + XMP.len() + packet.len()) else {
        return;
    };
    if at <= bytes.len() {
        let segment = [&[0xff, 0xe1], &length.to_be_bytes()[..], XMP, packet].concat();
        bytes.splice(at..at, segment);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Format, Picture};

    #[test]
    fn comes_back_nearly() {
        // JPEG is lossy: at this quality a smooth ramp is decoded to within a few levels.
        let mut picture = Picture::blank(64, 32, false);
        for (i, pixel) in picture.pixels.iter_mut().enumerate() {
            let (x, y) = (i as u32 % 64, i as u32 / 64);
            *pixel = [x as u8 * 4, 128, y as u8 * 8, 255];
        }
        let bytes = picture.encode(Format::Jpeg).expect("encodes");
        assert_eq!(bytes, picture.encode(Format::Jpeg).expect("encodes"));
        let back = image::load_from_memory_with_format(&bytes, image::ImageFormat::Jpeg)
            .expect("decodes")
            .to_rgb8();
        assert_eq!(back.dimensions(), (64, 32));
        for (found, made) in back.pixels().zip(&picture.pixels) {
            for (a, b) in found.0.iter().zip(made) {
                assert!(a.abs_diff(*b) <= 8, "{found:?} for {made:?}");
            }
        }
    }
}
