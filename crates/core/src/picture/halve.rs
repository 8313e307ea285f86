//! Halving a picture's sides.

use super::{ImageError, Picture};
use crate::shade::{encode_premultiplied, srgb};

impl Picture {
    /// The picture with one pixel for every 2 × 2 pixels (fewer at the end of an odd side): the mean of their linear
    /// light with premultiplied alpha. The result has no layers.
    ///
    /// # Errors
    /// A picture whose lists have wrong lengths; memory.
    pub fn halved(&self) -> Result<Self, ImageError> {
        self.check()?;
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut half = Self::try_blank(width, height, false)?;
        let tables = srgb::tables();
        for (row, pixels) in half.pixels.chunks_exact_mut(width as usize).enumerate() {
            let across = self.width as usize;
            let rows = self.pixels[2 * row * across..].chunks_exact(across).take(2);
            let rows: Vec<&[[u8; 4]]> = rows.collect();
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let of = rows.iter().flat_map(|row| row[2 * column..].iter().take(2));
                let (mut sum, mut count) = ([0.0f32; 4], 0.0);
                for &[r, g, b, a] in of {
                    let alpha = f32::from(a) / 255.0;
                    let light = [r, g, b].map(|byte| tables.decode(byte) * alpha);
                    sum = [
                        sum[0] + light[0],
                        sum[1] + light[1],
                        sum[2] + light[2],
                        sum[3] + alpha,
                    ];
                    count += 1.0;
                }
                *pixel = encode_premultiplied(sum.map(|channel| channel / count));
            }
        }
        Ok(half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_has_the_mean_of_the_light() {
        let mut picture = Picture::blank(3, 3, false);
        picture.pixels = vec![
            [255, 255, 255, 255],
            [0, 0, 0, 255],
            [9, 9, 9, 255],
            [0, 0, 0, 255],
            [255, 255, 255, 255],
            [9, 9, 9, 255],
            [1, 2, 3, 255],
            [1, 2, 3, 255],
            [7, 7, 7, 0],
        ];
        let half = picture.halved().expect("a half");
        assert_eq!((half.width, half.height), (2, 2));
        // Half of white's light is sRGB 188 by the standard's formula; a transparent pixel contributes no colour.
        let expected = [[188, 188, 188, 255], [9, 9, 9, 255], [1, 2, 3, 255], [0; 4]];
        assert_eq!(half.pixels, expected);
        let point = half
            .halved()
            .and_then(|half| half.halved())
            .expect("a half");
        assert_eq!((point.width, point.height), (1, 1));
    }
}
