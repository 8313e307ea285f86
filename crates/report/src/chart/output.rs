//! The font for plotters, and PNG encoding.

use super::error::ChartError;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use plotters::style::FontStyle;
use std::sync::OnceLock;

/// Encodes RGB pixels in row-major order as PNG.
pub(super) fn encode_png(
    pixels: &[u8],
    (width, height): (u32, u32),
) -> Result<Vec<u8>, ChartError> {
    let mut png = Vec::new();
    // Charts have few colours: best compression takes little time, and a third of the bytes.
    PngEncoder::new_with_quality(&mut png, CompressionType::Best, FilterType::Adaptive)
        .write_image(pixels, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| ChartError(error.to_string()))?;
    Ok(png)
}

/// Registers the embedded font with plotters, so that charts do not depend on installed fonts.
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
