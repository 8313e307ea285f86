use super::error::{FormatError, shorten};
use super::guard::guarded;
use super::jpeg;
use super::kind::foreign_kind;
use super::limits::Budget;
use crate::scene::Texture;
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use rayon::prelude::*;
use std::collections::HashMap;
use std::hash::Hash;
use std::io::Cursor;
use std::path::Path;

/// The most columns or rows of a texture. Graphics hardware has the same limit or half of it.
const SIDE_LIMIT: u32 = 32_768;

/// The most bytes that a decoder holds beside the picture: a row, colour profiles, texts. A packed profile may be a thousand
/// times as large as its file; one that is larger than this is passed over.
const PROFILE_LIMIT: u64 = 16 << 20;

/// An upper bound of the bytes a pixel that a JPEG decoder needs beside the picture: 16-bit coefficients of up to
/// four components, in files of several scans.
const JPEG_COEFFICIENTS: u64 = 8;

/// Decodes an image file: PNG, JPEG or PNM, recognised by its content.
///
/// Memory for pixels, and for every copy of them, is counted against the budget before it is allocated.
pub(super) fn decode(path: &Path, bytes: &[u8], budget: &Budget) -> Result<Texture, FormatError> {
    guarded(path, || decode_within(path, bytes, budget))?
}

/// Decodes image files in parallel, each under its key. There are none where the budget does not hold all of them
/// together: the caller decodes them one by one, so that it does not depend on the threads which of them is refused.
pub(super) fn decode_ahead<K: Copy + Eq + Hash + Send + Sync>(
    files: &[(K, &Path, &[u8])],
    budget: &Budget,
) -> HashMap<K, Result<Texture, FormatError>> {
    let decoded: Vec<_> = files
        .par_iter()
        .map(|(key, path, bytes)| (*key, decode(path, bytes, budget)))
        .collect();
    let is_refused = |found: &Result<Texture, FormatError>| {
        let error = found.as_ref().err();
        error.is_some_and(FormatError::is_of_budget)
    };
    if decoded.iter().any(|(_, found)| is_refused(found)) {
        for (_, texture) in decoded {
            budget.release(texture.map_or(0, |texture| bytes_of(&texture)));
        }
        return HashMap::new();
    }
    decoded.into_iter().collect()
}

/// The bytes of a texture that stay counted.
fn bytes_of(texture: &Texture) -> u64 {
    4 * u64::from(texture.width()) * u64::from(texture.height())
}

fn decode_within(path: &Path, bytes: &[u8], budget: &Budget) -> Result<Texture, FormatError> {
    let unknown = || {
        let found = match foreign_kind(bytes) {
            _ if bytes.is_empty() => "an empty file",
            Some(kind) => kind,
            None => "a file of another kind",
        };
        FormatError::unexpected(path, None, "an image (PNG, JPEG or PNM)", found)
    };
    let damaged = |error: &dyn std::error::Error| {
        let reason = format!("the image is damaged: {}", shorten(&error.to_string()));
        FormatError::refused(path, None, &reason)
    };
    let fault = |error: ImageError| match error {
        ImageError::Unsupported(_) => unknown(),
        error => damaged(&error),
    };
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| FormatError::io(path, error))?;
    let Some(format) = reader.format() else {
        return Err(unknown());
    };
    let mut limits = Limits::no_limits();
    // The limit of what the decoder allocates beside the picture: colour profiles, texts.
    limits.max_alloc = Some(budget.bytes_left().min(PROFILE_LIMIT));
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(fault)?;

    let (width, height) = decoder.dimensions();
    if width.max(height) > SIDE_LIMIT {
        let expected = format!("an image with sides of at most {SIDE_LIMIT} pixels");
        let found = format!("one of {width}x{height}");
        return Err(FormatError::unexpected(path, None, expected, found));
    }
    budget.check_pixels(path, width, height)?;
    let outline = match format {
        ImageFormat::Jpeg => {
            jpeg::outline(bytes).map_err(|reason| FormatError::refused(path, None, &reason))?
        }
        _ => None,
    };
    let pixels = u64::from(width) * u64::from(height);
    let texels = 4 * pixels;
    let decoded = decoder.total_bytes();
    let beside = match format {
        // The decoder also keeps a copy of the file.
        ImageFormat::Jpeg => JPEG_COEFFICIENTS * pixels + bytes.len() as u64,
        _ => 0,
    };
    // The picture in the file's format coexists first with the decoder's memory and then with the texels.
    let peak = decoded.saturating_add(beside.max(texels));
    let share = budget.share(path, "the image", peak)?;
    let picture = match outline {
        Some(outline) => jpeg::decode(bytes, &outline).map_err(|error| damaged(&error))?,
        None => DynamicImage::from_decoder(decoder).map_err(fault)?,
    };
    let pixels = picture.into_rgba8().into_raw();
    share.keep(texels);
    let texels = match bytemuck::try_cast_vec(pixels) {
        Ok(texels) => texels,
        // A buffer with spare capacity that is not a multiple of a texel must be copied.
        Err((_, pixels)) => bytemuck::cast_slice(&pixels).to_vec(),
    };
    Texture::new(width, height, texels)
        .ok_or_else(|| FormatError::unexpected(path, None, "an image with pixels", "none"))
}

#[cfg(test)]
mod tests {
    use super::super::limits;
    use super::*;

    fn read(name: &str, bytes: &[u8]) -> Result<Texture, FormatError> {
        decode(Path::new(name), bytes, &Budget::default())
    }

    #[test]
    fn reads_rows_from_the_top() {
        let texture = read("a.ppm", b"P3\n1 2\n255\n255 0 0\n0 128 255\n").expect("a good image");
        assert_eq!((texture.width(), texture.height()), (1, 2));
        assert_eq!(texture.texels(), [[255, 0, 0, 255], [0, 128, 255, 255]]);
    }

    #[test]
    fn files_that_are_no_image_are_refused() {
        let check = |bytes: &[u8], expected: &str| {
            let message = read("a.png", bytes).expect_err("no image").to_string();
            assert!(message.starts_with("a.png: "), "{message}");
            assert!(message.contains(expected), "{message}");
            assert_eq!(message.lines().count(), 1);
        };
        check(b"", "an empty file");
        check(b"v 0 0 0\n", "a file of another kind");
        check(b"ply\nformat ascii 1.0\n", "PLY");
        check(b"GIF89a", "GIF");
        check(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0", "damaged");
        check(b"P6\n30000 1\n255\n", "damaged");
        check(b"P6\n100000 1\n255\n", "at most 32768 pixels");
        check(b"P6\n32768 30000\n255\n", "(limit `pixels`)");
    }

    /// A PNG of one grey.
    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::One);
        let mut writer = encoder.write_header().expect("a header");
        let row = width.div_ceil(8) as usize;
        writer
            .write_image_data(&vec![0; row * height as usize])
            .expect("rows");
        writer.finish().expect("an end");
        bytes
    }

    #[test]
    fn pixels_are_counted_before_they_are_there() {
        let bytes = png(32_768, 32_768);
        assert!(bytes.len() < 2_000_000);
        let error = read("bomb.png", &bytes).expect_err("too many pixels");
        assert_eq!(
            error.to_string(),
            "bomb.png: an image of 32768x32768 has 1073741824 pixels; at most 268435456 are \
             allowed (limit `pixels`)"
        );
        // A grey byte and a texel a pixel.
        let within = |bytes: u64| {
            let limits = limits::Limits {
                bytes,
                ..limits::Limits::default()
            };
            decode(Path::new("a.png"), &png(100, 10), &Budget::new(limits))
        };
        assert!(within(5000).is_ok());
        let error = within(4999).expect_err("too many bytes").to_string();
        assert!(
            error.ends_with("at most 4999 are allowed (limit `bytes`)"),
            "{error}"
        );
    }

    #[test]
    fn half_an_image_is_an_error() {
        let whole = png(64, 64);
        assert!(read("a.png", &whole).is_ok());
        for end in [whole.len() / 2, whole.len() - 20] {
            let error = read("a.png", &whole[..end]).expect_err("half an image");
            assert!(error.to_string().contains("damaged"), "{error}");
        }
        let mut jpeg = Vec::new();
        image::codecs::jpeg::JpegEncoder::new(&mut jpeg)
            .encode(&[90; 3 * 64 * 64], 64, 64, image::ExtendedColorType::Rgb8)
            .expect("an image can be encoded");
        assert!(read("a.jpg", &jpeg).is_ok());
        let error = read("a.jpg", &jpeg[..jpeg.len() - 30]).expect_err("half an image");
        assert_eq!(
            error.to_string(),
            "a.jpg: the image is damaged: the file ends before the image does"
        );
        let closed = [&jpeg[..jpeg.len() - 30], &[0xff, 0xd9]].concat();
        let error = read("a.jpg", &closed).expect_err("half an image");
        assert!(error.to_string().contains("damaged"), "{error}");
    }

    #[test]
    fn images_decoded_together_are_those_decoded_alone_or_none() {
        let images = [
            png(30, 20),
            png(50, 40),
            b"P6 1 1 255 ".to_vec(),
            png(10, 10),
        ];
        let path = Path::new("a.png");
        let files: Vec<_> = (0..)
            .zip(&images)
            .map(|(n, bytes)| (n, path, &bytes[..]))
            .collect();
        let budget = Budget::default();
        let before = budget.bytes_left();
        let together = decode_ahead(&files, &budget);
        assert_eq!(together.len(), files.len());
        for (number, path, bytes) in &files {
            let alone = decode(path, bytes, &Budget::default());
            assert_eq!(format!("{:?}", together[number]), format!("{alone:?}"));
        }
        let good: Vec<&Texture> = together.values().flatten().collect();
        assert_eq!(good.len(), 3, "one is damaged");
        let held: u64 = good.into_iter().map(bytes_of).sum();
        assert_eq!(budget.bytes_left(), before - held);

        // There is room for each while it is decoded, and not for what stays of all.
        let budget = Budget::new(limits::Limits {
            bytes: held - 1,
            ..limits::Limits::default()
        });
        assert!(decode_ahead(&files, &budget).is_empty());
        assert_eq!(budget.bytes_left(), held - 1, "nothing stays counted");
    }
}
