//! The font that plotters draws with, and its pixels as PNG.

use super::error::ChartError;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use plotters::style::FontStyle;
use std::sync::OnceLock;

/// RGB pixels, row by row, as PNG.
pub(super) fn encode_png(
    pixels: &[u8],
    (width, height): (u32, u32),
) -> Result<Vec<u8>, ChartError> {
    let mut png = Vec::new();
    // Plots are few colours: the best compression takes little time, and a third of the bytes.
    PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive)
        .write_image(pixels, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| ChartError(error.to_string()))?;
    Ok(png)
}

/// Tells plotters the one font that it draws with: no fonts of the system are needed.
pub(super) fn register_font() -> Result<(), ChartError> {
    static DONE: OnceLock<bool> = OnceLock::new();
    let done = DONE.get_or_init(|| {
        let font = epaint_default_fonts::UBUNTU_LIGHT;
        plotters::style::register_font("sans-serif", FontStyle::Normal, font).is_ok()
    });
    if *done {
        Ok(())
    } else {
        Err(ChartError("the font cannot be read".to_owned()))
    }
}
