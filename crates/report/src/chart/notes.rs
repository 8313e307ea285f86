//! Text and lines over a picture.

use super::canvas::Canvas;
use super::error::ChartError;
use super::output::{encode_png, register_font};
use super::style;
use image::RgbImage;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// An annotation; positions are in pixels from the picture's top left corner.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// Text that starts at a point and is vertically centred on it.
    Words {
        /// The text.
        text: String,
        /// The middle of its left side.
        at: (f64, f64),
        /// Font size in pixels.
        size: f64,
        /// sRGB.
        color: [u8; 3],
    },
    /// A filled rectangle.
    Patch {
        /// The top left corner.
        low: (f64, f64),
        /// The bottom right corner.
        high: (f64, f64),
        /// sRGB.
        color: [u8; 3],
    },
    /// A polyline.
    Line {
        /// The points.
        points: Vec<(f64, f64)>,
        /// Width in pixels.
        width: f64,
        /// sRGB.
        color: [u8; 3],
    },
}

/// Encodes a picture with annotations, drawn in order, as PNG.
///
/// # Errors
/// An error of plotters.
pub fn annotated(picture: &RgbImage, notes: &[Note]) -> Result<Vec<u8>, ChartError> {
    register_font()?;
    let size = picture.dimensions();
    let mut pixels = picture.as_raw().clone();
    {
        let area = BitMapBackend::with_buffer(&mut pixels, size).into_drawing_area();
        let canvas = Canvas {
            area: &area,
            magnified: 1.0,
        };
        let ink = |[r, g, b]: [u8; 3]| RGBColor(r, g, b);
        for note in notes {
            match note {
                Note::Words {
                    text,
                    at,
                    size,
                    color,
                } => canvas.text(text, *at, *size, ink(*color), (HPos::Left, VPos::Center))?,
                Note::Patch { low, high, color } => canvas.fill(*low, *high, ink(*color))?,
                Note::Line {
                    points,
                    width,
                    color,
                } => canvas.line(points, *width, ink(*color).into())?,
            }
        }
        area.present()
            .map_err(|error| ChartError(error.to_string()))?;
    }
    encode_png(&pixels, size)
}

/// sRGB of important text.
pub const TEXT: [u8; 3] = [style::TEXT.0, style::TEXT.1, style::TEXT.2];
/// sRGB of secondary text.
pub const QUIET: [u8; 3] = [style::QUIET.0, style::QUIET.1, style::QUIET.2];
