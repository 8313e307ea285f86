//! Animated PNG (W3C, "PNG Specification (Third Edition)", 2025), by the `png` crate.

use super::png::failed;
use super::{ImageError, Picture};
use ::png::{BitDepth, ColorType, Compression, Encoder, SrgbRenderingIntent, Writer};
use std::io::Write;

/// A PNG whose pictures repeat in a loop; decoders without animation show the first.
pub struct AnimatedPng<W: Write> {
    writer: Writer<W>,
    size: (u32, u32),
    is_opaque: bool,
    /// Frames that are still missing.
    left: u32,
}

impl<W: Write> AnimatedPng<W> {
    /// An animation of `frames` pictures of one size, `rate` a second. `is_opaque` says whether every pixel of all of
    /// them covers what lies behind it.
    ///
    /// # Errors
    /// A size, count or rate of zero; a write error.
    pub fn new(
        to: W,
        size: (u32, u32),
        frames: u32,
        rate: u16,
        is_opaque: bool,
    ) -> Result<Self, ImageError> {
        let mut encoder = Encoder::new(to, size.0, size.1);
        encoder.set_color(if is_opaque {
            ColorType::Rgb
        } else {
            ColorType::Rgba
        });
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::Fast);
        encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
        encoder.set_animated(frames, 0).map_err(failed)?;
        encoder.set_frame_delay(1, rate.max(1)).map_err(failed)?;
        let writer = encoder.write_header().map_err(failed)?;
        Ok(Self {
            writer,
            size,
            is_opaque,
            left: frames,
        })
    }

    /// Adds the next picture.
    ///
    /// # Errors
    /// A picture of another size; one more than declared; a write error.
    pub fn add(&mut self, picture: &Picture) -> Result<(), ImageError> {
        picture.check()?;
        if (picture.width, picture.height) != self.size {
            return Err(ImageError::Encode("its frames differ in size".to_owned()));
        }
        self.left = (self.left.checked_sub(1))
            .ok_or_else(|| ImageError::Encode("it has more frames than it declares".to_owned()))?;
        if self.is_opaque {
            let mut rgb: Vec<u8> = super::buffers::reserved(picture.pixels.len() * 3)?;
            rgb.extend(picture.pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]));
            self.writer.write_image_data(&rgb).map_err(failed)
        } else {
            let rgba = picture.pixels.as_flattened();
            self.writer.write_image_data(rgba).map_err(failed)
        }
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Fewer pictures than declared; a write error.
    pub fn finish(self) -> Result<(), ImageError> {
        if self.left > 0 {
            return Err(ImageError::Encode(
                "it has fewer frames than it declares".to_owned(),
            ));
        }
        self.writer.finish().map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_frame_comes_back() {
        for is_opaque in [true, false] {
            let frame = |number: u8| {
                let mut picture = Picture::blank(5, 3, false);
                let alpha = if is_opaque { 255 } else { number };
                picture.pixels.fill([number, 7, 9, alpha]);
                picture
            };
            let mut bytes = Vec::new();
            let mut file = AnimatedPng::new(&mut bytes, (5, 3), 3, 25, is_opaque).expect("a file");
            for number in [10, 20, 30] {
                file.add(&frame(number)).expect("a frame");
            }
            assert!(file.add(&Picture::blank(5, 4, false)).is_err());
            file.finish().expect("all are there");
            let decoder = ::png::Decoder::new(std::io::Cursor::new(&bytes));
            let mut reader = decoder.read_info().expect("a PNG");
            let control = *reader.info().animation_control().expect("an animation");
            assert_eq!((control.num_frames, control.num_plays), (3, 0));
            for number in [10, 20, 30] {
                let mut row = vec![0; reader.output_buffer_size().expect("it is small")];
                reader.next_frame(&mut row).expect("a frame");
                assert_eq!(row[0], number);
            }
        }
    }

    #[test]
    fn a_file_that_lacks_frames_is_an_error() {
        let mut file = AnimatedPng::new(Vec::new(), (5, 3), 2, 25, true).expect("a file");
        file.add(&Picture::blank(5, 3, false)).expect("a frame");
        assert!(file.finish().is_err());
        assert!(AnimatedPng::new(Vec::new(), (5, 3), 0, 25, true).is_err());
    }
}
