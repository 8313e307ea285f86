//! Strict decoding of JPEG. The decoder fills missing data with grey, or decodes zeros; here a file that ends early,
//! claims more pixels than its bytes can hold, or whose coded data end early, is refused.
//!
//! Undetected: bytes missing within a scan that is followed by others, where the rest still is a sequence of valid
//! codes; and a progressive file that ends after a complete scan. JPEG has no checksum, so no decoder can tell these
//! from an intended picture.

use image::{DynamicImage, GrayAlphaImage, GrayImage, RgbImage, RgbaImage};
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// The structure of a JPEG file, by its markers (ITU-T T.81, "Digital compression and coding of continuous-tone still
/// images", 1992, annex B).
#[derive(Debug)]
pub(super) struct Outline {
    /// The offset of the end-of-image marker.
    end: usize,
    scans: usize,
    is_progressive: bool,
}

/// Follows the markers from the first to the end of the image, without decoding. `None` for a file that is no JPEG,
/// or has no known frame header; the decoder reports those.
///
/// # Errors
/// Why the file cannot hold the picture that it claims.
pub(super) fn outline(bytes: &[u8]) -> Result<Option<Outline>, String> {
    let cut = || "the image is damaged: the file ends before the image does".to_owned();
    let Some(mut rest) = bytes.strip_prefix(&[0xff, 0xd8]) else {
        return Ok(None);
    };
    let mut least_bits = None;
    let mut scan_bytes = 0;
    let mut outline = Outline {
        end: 0,
        scans: 0,
        is_progressive: false,
    };
    loop {
        let at = rest.iter().position(|&byte| byte == 0xff).ok_or_else(cut)?;
        rest = &rest[at + 1..];
        let (&marker, after) = rest.split_first().ok_or_else(cut)?;
        match marker {
            // Stuffing, fill bytes and restarts: within entropy-coded data, or before a marker.
            0x00 | 0x01 | 0xd0..=0xd8 => rest = after,
            0xff => {}
            END_OF_IMAGE => break,
            _ => {
                let &[high, low] = after.first_chunk().ok_or_else(cut)?;
                let length = usize::from(u16::from_be_bytes([high, low])).max(2);
                let (segment, behind) = after.split_at_checked(length).ok_or_else(cut)?;
                match marker {
                    // Baseline, extended and progressive frames with Huffman coding.
                    0xc0..=PROGRESSIVE => {
                        least_bits = least_bits.or(frame_bits(&segment[2..]));
                        outline.is_progressive |= marker == PROGRESSIVE;
                    }
                    START_OF_SCAN => {
                        scan_bytes = scan_bytes.max(behind.len());
                        outline.scans += 1;
                    }
                    _ => {}
                }
                rest = behind;
            }
        }
    }
    let Some((width, height, bits)) = least_bits else {
        return Ok(None);
    };
    if bits > scan_bytes as u64 * 8 {
        return Err(format!(
            "the image is damaged: it claims {width}x{height} pixels, more than its {} bytes can \
             hold",
            bytes.len()
        ));
    }
    // The marker has two bytes, of which the second was consumed.
    outline.end = bytes.len() - rest.len() - 1;
    Ok(Some(outline))
}

/// Sixteen one bits are no Huffman code (T.81, annex C: no code is all ones), and up to fifteen bits may belong to
/// the value before them. A decoder that needs more than the file's own data reads these stuffed bytes and reports an
/// error.
const ONES: [u8; 10] = [0xff, 0, 0xff, 0, 0xff, 0, 0xff, 0, 0xff, 0];

/// Decodes the picture.
///
/// # Errors
/// The decoder's errors; data that end before the picture does.
pub(super) fn decode(bytes: &[u8], outline: &Outline) -> Result<DynamicImage, DecodeErrors> {
    match decode_closed(bytes, outline, &ONES) {
        // After a progressive file's first scan the decoder expects the marker immediately: that scan is complete.
        Err(DecodeErrors::FormatStatic("Marker missing where expected"))
            if outline.is_progressive && outline.scans == 1 =>
        {
            decode_closed(bytes, outline, &[])
        }
        decoded => decoded,
    }
}

/// Decodes the picture with `more` data inserted before its end.
fn decode_closed(
    bytes: &[u8],
    outline: &Outline,
    more: &[u8],
) -> Result<DynamicImage, DecodeErrors> {
    let (data, end) = bytes.split_at(outline.end);
    let closed = [data, more, &end[..2]].concat();
    let options = DecoderOptions::default()
        .set_strict_mode(false)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(&closed[..]), options);
    // Bytes between headers are harmless; from here on damage is an error.
    decoder.decode_headers()?;
    let space = match decoder.input_colorspace() {
        Some(space @ (ColorSpace::Luma | ColorSpace::LumaA | ColorSpace::RGBA)) => space,
        _ => ColorSpace::RGB,
    };
    decoder.set_options(options.jpeg_set_out_colorspace(space).set_strict_mode(true));
    let pixels = decoder.decode()?;
    let (width, height) = decoder.dimensions().unwrap_or_default();
    let (width, height) = (width as u32, height as u32);
    let picture = match space {
        ColorSpace::Luma => GrayImage::from_raw(width, height, pixels).map(DynamicImage::from),
        ColorSpace::LumaA => {
            GrayAlphaImage::from_raw(width, height, pixels).map(DynamicImage::from)
        }
        ColorSpace::RGBA => RgbaImage::from_raw(width, height, pixels).map(DynamicImage::from),
        _ => RgbImage::from_raw(width, height, pixels).map(DynamicImage::from),
    };
    picture.ok_or(DecodeErrors::FormatStatic("too few pixels"))
}

const PROGRESSIVE: u8 = 0xc2;
const END_OF_IMAGE: u8 = 0xd9;
const START_OF_SCAN: u8 = 0xda;

/// Columns, rows, and the fewest bits that they take: each 8 × 8 block of each component has a DC coefficient of at
/// least one bit.
fn frame_bits(header: &[u8]) -> Option<(u16, u16, u64)> {
    let &[_precision, h1, h2, w1, w2, components] = header.first_chunk()?;
    let (height, width) = (u16::from_be_bytes([h1, h2]), u16::from_be_bytes([w1, w2]));
    let factors: Vec<(u64, u64)> = header[6..]
        .chunks_exact(3)
        .take(components.into())
        .map(|component| (u64::from(component[1] >> 4), u64::from(component[1] & 15)))
        .collect();
    let across = factors.iter().map(|(h, _)| *h).max().filter(|h| *h > 0)?;
    let down = factors.iter().map(|(_, v)| *v).max().filter(|v| *v > 0)?;
    let blocks = |side: u16, factor: u64, most: u64| {
        let samples = (u64::from(side) * factor).div_ceil(most);
        samples.div_ceil(8)
    };
    let bits = factors
        .iter()
        .map(|&(h, v)| blocks(width, h, across) * blocks(height, v, down))
        .sum();
    Some((width, height, bits))
}

#[cfg(test)]
mod tests {
    use super::*;
    use base64::prelude::{BASE64_STANDARD, Engine as _};

    /// 24 × 24 in grey, in six scans, of which the first has the DC coefficients; made by ImageMagick.
    const IN_SCANS: &str = "\
        /9j/4AAQSkZJRgABAQAAAQABAAD/2wBDACgcHiMeGSgjISMtKygwPGRBPDc3PHtYXUlkkYCZlo+AjIqgtObDoKra\
        rYqMyP/L2u71////m8H////6/+b9//j/wgALCAAYABgBAREA/8QAFgABAQEAAAAAAAAAAAAAAAAAAQAD/9oACAEB\
        AAAAAcBCi//EABQQAQAAAAAAAAAAAAAAAAAAADD/2gAIAQEAAQUCH//EABQQAQAAAAAAAAAAAAAAAAAAADD/2gAI\
        AQEABj8CH//EABkQAAMAAwAAAAAAAAAAAAAAAAABERAgIf/aAAgBAQABPyFMvS6N3FP/2gAIAQEAAAAQxf8A/8QA\
        GhAAAwEBAQEAAAAAAAAAAAAAABEhAWExQf/aAAgBAQABPxCHToJ9w8bNMoxIxymIf//Z";

    fn fault(bytes: &[u8]) -> Option<String> {
        outline(bytes).err()
    }

    fn jpeg(side: u32, grey: bool) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 50);
        let noise = |i: u32| (i.wrapping_mul(2_654_435_761) >> 24) as u8;
        let (count, kind) = if grey {
            (1, image::ExtendedColorType::L8)
        } else {
            (3, image::ExtendedColorType::Rgb8)
        };
        let pixels: Vec<u8> = (0..side * side * count).map(noise).collect();
        encoder
            .encode(&pixels, side, side, kind)
            .expect("an image can be encoded");
        bytes
    }

    fn decoded(bytes: &[u8]) -> Result<DynamicImage, String> {
        let outline = outline(bytes)?.expect("a JPEG");
        decode(bytes, &outline).map_err(|error| error.to_string())
    }

    /// `bytes` truncated at `at`, with an end-of-image marker.
    fn closed_at(bytes: &[u8], at: usize) -> Vec<u8> {
        [&bytes[..at], &[0xff, END_OF_IMAGE]].concat()
    }

    /// The start of each scan's data.
    fn scan_data(bytes: &[u8]) -> Vec<usize> {
        let is_scan = |&at: &usize| bytes[at..at + 2] == [0xff, START_OF_SCAN];
        let header = |at: usize| 2 + usize::from(bytes[at + 3]);
        (0..bytes.len() - 4)
            .filter(is_scan)
            .map(|at| at + header(at))
            .collect()
    }

    #[test]
    fn a_whole_file_is_decoded_as_by_the_decoder_alone() {
        let in_scans = BASE64_STANDARD.decode(IN_SCANS).expect("base 64");
        for bytes in [jpeg(40, false), jpeg(41, true), in_scans] {
            let alone = image::load_from_memory(&bytes).expect("an image");
            let with_more = [&bytes[..], b"a trailer"].concat();
            assert!(decoded(&bytes) == Ok(alone.clone()));
            assert!(decoded(&with_more) == Ok(alone));
        }
    }

    #[test]
    fn data_that_end_before_the_picture_does_are_an_error() {
        for grey in [false, true] {
            let whole = jpeg(40, grey);
            let end = whole.len() - 2;
            for at in scan_data(&whole)[0]..end {
                assert!(decoded(&closed_at(&whole, at)).is_err(), "{at} of {end}");
            }
        }
    }

    #[test]
    fn data_that_end_in_the_first_of_several_scans_are_an_error() {
        let whole = BASE64_STANDARD.decode(IN_SCANS).expect("base 64");
        let first = scan_data(&whole)[0];
        let length = whole[first..]
            .windows(2)
            .position(|pair| pair == [0xff, 0xc4]);
        let end = first + length.expect("tables of the second scan");
        for at in first..end {
            assert!(decoded(&closed_at(&whole, at)).is_err(), "{at} of {end}");
        }
        // A complete scan is a picture, although a coarse one.
        assert!(decoded(&closed_at(&whole, end)).is_ok());
    }

    #[test]
    fn a_cut_file_is_known_by_its_missing_end() {
        for grey in [false, true] {
            let whole = jpeg(40, grey);
            assert_eq!(fault(&whole), None);
            assert_eq!(fault(&[&whole[..], b"a trailer"].concat()), None);
            for end in 2..whole.len() {
                assert!(fault(&whole[..end]).is_some(), "{end} of {}", whole.len());
            }
        }
    }

    #[test]
    fn a_file_holds_no_more_pixels_than_it_has_bits_for() {
        for grey in [false, true] {
            let mut bytes = jpeg(16, grey);
            let frame = bytes
                .windows(2)
                .position(|pair| pair == [0xff, 0xc0])
                .expect("a frame");
            let side = 16_000u16.to_be_bytes();
            bytes[frame + 5..frame + 7].copy_from_slice(&side);
            bytes[frame + 7..frame + 9].copy_from_slice(&side);
            let message = fault(&bytes).expect("a fault");
            assert!(message.contains("claims 16000x16000 pixels"), "{message}");
        }
        // One grey block of a single colour is the smallest possible.
        let mut flat = Vec::new();
        image::codecs::jpeg::JpegEncoder::new_with_quality(&mut flat, 1)
            .encode(&[128; 256 * 256], 256, 256, image::ExtendedColorType::L8)
            .expect("an image can be encoded");
        assert_eq!(fault(&flat), None);
    }

    #[test]
    fn files_without_jpeg_markers_are_left_to_the_decoder() {
        assert_eq!(fault(b"\x89PNG"), None);
        assert_eq!(fault(b""), None);
        assert!(fault(b"\xff\xd8").is_some());
    }
}
