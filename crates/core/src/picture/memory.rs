//! The memory that pictures and their files take.

use super::Format;

/// Bytes a pixel for 8-bit colours.
const PIXEL: u64 = 4;

/// Bytes a pixel for layers: colour 16, depth 4, numbers 8, normal 12, texture coordinates 8.
const LAYERS: u64 = 48;

/// The bytes that a picture of this size takes, with or without layers.
pub fn memory_of(columns: u32, rows: u32, layers: bool) -> u64 {
    let layers = if layers { LAYERS } else { 0 };
    u64::from(columns) * u64::from(rows) * (PIXEL + layers)
}

impl Format {
    /// An upper bound of the bytes that a picture of this size takes while it is rendered and encoded in this format:
    /// the picture, the encoder's copies, and the file itself, assumed to be as large as the uncompressed pixels.
    pub fn memory_for(self, columns: u32, rows: u32) -> u64 {
        let pixels = u64::from(columns) * u64::from(rows);
        let a_pixel = match self {
            // Without alpha: separate red, green and blue (3), the deflated bytes (3), and those in the file's chunks
            // (3). With alpha: no separate channels, 4 and 4.
            Self::Png => PIXEL + 9,
            // The file, and a band of it.
            Self::Ppm => PIXEL + 6,
            // The file in a buffer that doubles as it grows, and a band of it, with alpha.
            Self::Tiff => PIXEL + 12,
            // Separate red, green and blue, and the file.
            Self::Jpeg => PIXEL + 3 + 3,
            // Separate channels, and the file.
            Self::Exr => PIXEL + LAYERS + LAYERS + LAYERS,
        };
        pixels * a_pixel
    }

    /// An upper bound of the bytes that stitching takes: the fragments, the picture, and its encoding.
    pub fn memory_to_stitch(self, columns: u32, rows: u32, layers: bool) -> u64 {
        // The picture has its layers whether or not its file stores them.
        let more = match self {
            Self::Exr => 0,
            _ => memory_of(columns, rows, layers) - memory_of(columns, rows, false),
        };
        memory_of(columns, rows, layers) + more + self.memory_for(columns, rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Layers, Picture};

    #[test]
    fn memory_of_a_pixel_is_the_sum_of_its_values() {
        let Layers {
            color,
            depth,
            object,
            triangle,
            normal,
            uv,
        } = Layers::blank(1);
        let layers = size_of_val(&color[..])
            + size_of_val(&depth[..])
            + size_of_val(&object[..])
            + size_of_val(&triangle[..])
            + size_of_val(&normal[..])
            + size_of_val(&uv[..]);
        assert_eq!(layers as u64, LAYERS);
        let picture = Picture::blank(1, 1, false);
        assert_eq!(size_of_val(&picture.pixels[..]) as u64, PIXEL);
    }

    /// Each encoder's file of the noisiest picture is no larger than the bound.
    #[test]
    fn files_are_no_larger_than_their_bound() {
        let (columns, rows) = (256, 256);
        let mut picture = Picture::blank(columns, rows, true);
        for (i, pixel) in picture.pixels.iter_mut().enumerate() {
            let [a, b, c, _] = (i as u32)
                .wrapping_mul(0x9e37_79b9)
                .rotate_left(9)
                .to_le_bytes();
            *pixel = [a ^ c, b, c, 255];
        }
        // Headers, tables of offsets, checksums.
        let more = 8192;
        for (format, most) in [
            (Format::Png, 3),
            (Format::Ppm, 3),
            (Format::Jpeg, 3),
            (Format::Exr, LAYERS as usize),
        ] {
            let bytes = picture.encode(format).expect("encodes");
            let pixels = columns as usize * rows as usize;
            assert!(
                bytes.len() <= pixels * most + more,
                "{format:?}: {} bytes",
                bytes.len()
            );
        }
    }
}
