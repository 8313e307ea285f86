//! Words and lines over a picture.

use super::canvas::Canvas;
use super::error::ChartError;
use super::output::{encode_png, register_font};
use super::style;
use image::RgbImage;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// Something to be drawn over a picture; places in pixels from its top left.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// Words that begin at a place, level with it.
    Words {
        /// What they say.
        text: String,
        /// Where they begin.
        at: (f64, f64),
        /// How high they are, in pixels.
        size: f64,
        /// sRGB.
        color: [u8; 3],
    },
    /// A filled rectangle.
    Patch {
        /// Its top left.
        low: (f64, f64),
        /// Its bottom right.
        high: (f64, f64),
        /// sRGB.
        color: [u8; 3],
    },
    /// Lines from point to point.
    Line {
        /// The points.
        points: Vec<(f64, f64)>,
        /// In pixels.
        width: f64,
        /// sRGB.
        color: [u8; 3],
    },
}

/// A PNG of a picture with notes over it, in their order.
///
/// # Errors
/// What plotters refuses.
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

/// sRGB of words that are to be read.
pub const TEXT: [u8; 3] = [style::TEXT.0, style::TEXT.1, style::TEXT.2];
/// sRGB of words that may be passed over.
pub const QUIET: [u8; 3] = [style::QUIET.0, style::QUIET.1, style::QUIET.2];
