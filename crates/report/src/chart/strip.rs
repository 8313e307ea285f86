//! A contact sheet of captioned pictures.

use super::canvas::Canvas;
use super::error::ChartError;
use super::output::{encode_png, register_font};
use super::style;
use image::RgbImage;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Pixels between pictures, and below each for its caption.
const GAP: u32 = 14;
const WORDS: u32 = 34;

/// Arranges pictures of the same size in so many columns, with captions below, as one PNG.
///
/// # Errors
/// An error of plotters.
pub fn captioned(pictures: &[(String, RgbImage)], columns: usize) -> Result<Vec<u8>, ChartError> {
    register_font()?;
    let (width, height) = pictures
        .first()
        .map_or((1, 1), |(_, first)| first.dimensions());
    let rows = pictures.len().div_ceil(columns.max(1)) as u32;
    let place = |at: usize| {
        let (column, row) = ((at % columns) as u32, (at / columns) as u32);
        (GAP + column * (width + GAP), GAP + row * (height + WORDS))
    };
    let size = (
        GAP + columns as u32 * (width + GAP),
        GAP + rows * (height + WORDS),
    );
    let mut pixels = vec![255; (size.0 * size.1 * 3) as usize];
    {
        let area = BitMapBackend::with_buffer(&mut pixels, size).into_drawing_area();
        let canvas = Canvas {
            area: &area,
            magnified: 1.0,
        };
        for (at, (words, _)) in pictures.iter().enumerate() {
            let (x, y) = place(at);
            let middle = (
                f64::from(x) + f64::from(width) / 2.0,
                f64::from(y + height + 4),
            );
            canvas.text(words, middle, 20.0, style::TEXT, (HPos::Center, VPos::Top))?;
        }
        area.present()
            .map_err(|error| ChartError(error.to_string()))?;
    }
    for (at, (_, picture)) in pictures.iter().enumerate() {
        let (left, top) = place(at);
        for (x, y, pixel) in picture
            .enumerate_pixels()
            .filter(|(x, y, _)| *x < width && *y < height)
        {
            let first = (((top + y) * size.0 + left + x) * 3) as usize;
            pixels[first..first + 3].copy_from_slice(&pixel.0);
        }
    }
    encode_png(&pixels, size)
}
