use super::error::FormatError;
use super::kind::foreign_kind;
use crate::scene::Texture;
use image::{ImageError, ImageReader, Limits};
use std::io::Cursor;
use std::path::Path;

/// The most columns or rows of a texture.
const SIDE_LIMIT: u32 = 32_768;

/// The most bytes that decoding a texture may take.
const MEMORY_LIMIT: u64 = 1 << 30;

/// Decodes an image file: PNG, JPEG or PNM, known by its content.
pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<Texture, FormatError> {
    let unknown = || {
        let found = match foreign_kind(bytes) {
            _ if bytes.is_empty() => "an empty file",
            Some(kind) => kind,
            None => "a file of another kind",
        };
        FormatError::unexpected(path, None, "an image (PNG, JPEG or PNM)", found)
    };
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| FormatError::io(path, error))?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(SIDE_LIMIT);
    limits.max_image_height = Some(SIDE_LIMIT);
    limits.max_alloc = Some(MEMORY_LIMIT);
    reader.limits(limits);
    if reader.format().is_none() {
        return Err(unknown());
    }
    let decoded = reader.decode().map_err(|error| match error {
        ImageError::Unsupported(_) => unknown(),
        error => FormatError::refused(path, None, &format!("the image is damaged: {error}")),
    })?;
    let pixels = decoded.into_rgba8();
    let (width, height) = pixels.dimensions();
    let texels = pixels.pixels().map(|pixel| pixel.0).collect();
    Texture::new(width, height, texels)
        .ok_or_else(|| FormatError::unexpected(path, None, "an image with pixels", "none"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_rows_from_the_top() {
        let texture = decode(Path::new("a.ppm"), b"P3\n1 2\n255\n255 0 0\n0 128 255\n")
            .expect("a good image");
        assert_eq!((texture.width(), texture.height()), (1, 2));
        assert_eq!(texture.texels(), [[255, 0, 0, 255], [0, 128, 255, 255]]);
    }

    #[test]
    fn refuses_what_is_no_image() {
        let check = |bytes: &[u8], expected: &str| {
            let message = decode(Path::new("a.png"), bytes)
                .expect_err("no image")
                .to_string();
            assert!(message.starts_with("a.png: "), "{message}");
            assert!(message.contains(expected), "{message}");
            assert_eq!(message.lines().count(), 1);
        };
        check(b"", "an empty file");
        check(b"v 0 0 0\n", "a file of another kind");
        check(b"ply\nformat ascii 1.0\n", "PLY");
        check(b"GIF89a", "GIF");
        check(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0", "damaged");
        check(b"P6\n100000 1\n255\n", "damaged");
    }
}
