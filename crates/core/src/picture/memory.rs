//! What pictures and their files take in memory, and buffers that may not be had.

use super::Format;

/// Memory that could not be had.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{bytes} bytes of memory for a picture could not be had")]
pub struct OutOfMemory {
    /// How many bytes were asked for at once.
    pub bytes: u64,
}

/// Bytes a pixel of a picture's 8-bit colours.
const PIXEL: u64 = 4;

/// Bytes a pixel of its layers: colour 16, depth 4, numbers 8, normal 12, texture coordinates 8.
const LAYERS: u64 = 48;

/// The bytes that a picture of so many pixels takes, with layers or without.
pub fn memory_of(columns: u32, rows: u32, layers: bool) -> u64 {
    let layers = if layers { LAYERS } else { 0 };
    u64::from(columns) * u64::from(rows) * (PIXEL + layers)
}

impl Format {
    /// The most bytes that a picture of so many pixels takes while it is made and encoded as a file of
    /// this kind: the picture, what the encoder copies, and the file itself, which is taken to be as
    /// large as its pixels are uncompressed. Most compress to less.
    pub fn memory_for(self, columns: u32, rows: u32) -> u64 {
        let pixels = u64::from(columns) * u64::from(rows);
        let a_pixel = match self {
            // Opaque: red, green and blue apart (3), deflated (3), and with the file's chunks about them
            // (3). With alpha: nothing apart, 4 and 4.
            Self::Png => PIXEL + 9,
            // The file alone.
            Self::Ppm => PIXEL + 3,
            // Red, green and blue apart, and the file.
            Self::Jpeg => PIXEL + 3 + 3,
            // Every channel apart, and the file.
            Self::Exr => PIXEL + LAYERS + LAYERS + LAYERS,
        };
        pixels * a_pixel
    }

    /// The most bytes that stitching fragments to a picture takes: theirs and its own, and its encoding.
    pub fn memory_to_stitch(self, columns: u32, rows: u32, layers: bool) -> u64 {
        // The picture's layers are there whether its file holds them or not.
        let more = match self {
            Self::Exr => 0,
            _ => memory_of(columns, rows, layers) - memory_of(columns, rows, false),
        };
        memory_of(columns, rows, layers) + more + self.memory_for(columns, rows)
    }
}

/// An empty list with room for so many.
pub(super) fn reserved<T>(count: usize) -> Result<Vec<T>, OutOfMemory> {
    let mut list = Vec::new();
    match list.try_reserve_exact(count) {
        Ok(()) => Ok(list),
        Err(_) => Err(OutOfMemory {
            bytes: count as u64 * size_of::<T>() as u64,
        }),
    }
}

/// So many of one value.
pub(super) fn filled<T: Clone>(value: T, count: usize) -> Result<Vec<T>, OutOfMemory> {
    // Asked for first, and given back: memory that the system hands out zeroed is not written to fill it
    // with zeros, and the list that is kept is made at once, where there was as much a moment before.
    drop(reserved::<T>(count)?);
    Ok(vec![value; count])
}

/// What an iterator gives, which is known to be so many.
pub(super) fn collected<T>(
    count: usize,
    values: impl IntoIterator<Item = T>,
) -> Result<Vec<T>, OutOfMemory> {
    let mut list = reserved(count)?;
    list.extend(values);
    Ok(list)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{Layers, Picture};

    #[test]
    fn a_pixel_takes_what_its_values_do() {
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

    /// Each encoder's file of the noisiest picture is no larger than it is reckoned at.
    #[test]
    fn files_are_no_larger_than_reckoned() {
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

    #[test]
    fn memory_that_is_not_there_is_an_error() {
        let too_many = usize::MAX / 64;
        let error = filled([0u32; 4], too_many).expect_err("there is no such machine");
        assert_eq!(error.bytes, too_many as u64 * 16);
        assert!(collected::<u64>(too_many, []).is_err());
        assert_eq!(filled(7u8, 3), Ok(vec![7; 3]));
    }
}
