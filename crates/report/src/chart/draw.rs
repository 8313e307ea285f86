//! Draws a chart as SVG and PNG.

use super::canvas::Canvas;
use super::error::ChartError;
use super::frame::{Frame, Side};
use super::labels::{Area, OccupiedAreas};
use super::output::{encode_png, register_font};
use super::plot::Chart;
use super::series::Series;
use super::style::{self, SIZE};
use plotters::prelude::*;

/// Magnification of a PNG relative to its SVG, so that it is sharp on screens of high density.
const MAGNIFIED: u32 = 2;

/// Margins between the picture's edges and the plot's frame: left, top, right, bottom.
const MARGINS: (f64, f64, f64, f64) = (84.0, 92.0, 30.0, 70.0);

/// The greatest fraction of the frame's width for labels at the ends of lines.
const LABEL_SHARE: f64 = 0.24;

impl Chart {
    /// As SVG.
    ///
    /// # Errors
    /// An error of plotters.
    pub fn svg(&self) -> Result<String, ChartError> {
        register_font()?;
        let mut svg = String::new();
        {
            let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
            self.draw(&Canvas {
                area: &area,
                magnified: 1.0,
            })?;
            area.present()
                .map_err(|error| ChartError(error.to_string()))?;
        }
        Ok(svg)
    }

    /// As PNG.
    ///
    /// # Errors
    /// An error of plotters.
    pub fn png(&self) -> Result<Vec<u8>, ChartError> {
        register_font()?;
        let (width, height) = (SIZE.0 * MAGNIFIED, SIZE.1 * MAGNIFIED);
        let mut pixels = vec![255; (width * height * 3) as usize];
        {
            let backend = BitMapBackend::with_buffer(&mut pixels, (width, height));
            let area = backend.into_drawing_area();
            self.draw(&Canvas {
                area: &area,
                magnified: f64::from(MAGNIFIED),
            })?;
            area.present()
                .map_err(|error| ChartError(error.to_string()))?;
        }
        encode_png(&pixels, (width, height))
    }

    fn draw<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>) -> Result<(), ChartError> {
        let (width, height) = (f64::from(SIZE.0), f64::from(SIZE.1));
        let (left, top, right, bottom) = MARGINS;
        canvas.fill((0.0, 0.0), (width, height), WHITE)?;
        let is_lines = self
            .series
            .iter()
            .any(|series| series.is_line() && !series.label.is_empty());
        let label_room = if is_lines {
            (width - left - right) * LABEL_SHARE
        } else {
            0.0
        };
        let frame = Frame {
            chart: self,
            low: (left, top),
            high: (width - right - label_room, height - bottom),
        };
        frame.heading(canvas)?;
        frame.axes(canvas)?;
        let mut occupied = OccupiedAreas {
            bounds: Area {
                low: (left + 4.0, top + 2.0),
                high: (width - 8.0, height - bottom - 4.0),
            },
            areas: Vec::new(),
            line_points: Vec::new(),
        };
        frame.better(canvas)?;
        for series in &self.series {
            frame.series(canvas, series, &mut occupied)?;
        }
        let labelled = |series: &&Series| !series.label.is_empty();
        let is_at_zero = |series: &Series| {
            let mut points = series.points.iter();
            self.x.has_room_at_zero() && points.all(|point| point.0 <= 0.0)
        };
        let (mut lines, mut zeros, mut others) = (Vec::new(), Vec::new(), Vec::new());
        for series in self.series.iter().filter(labelled) {
            match series {
                line if line.is_line() => lines.push(line),
                zero if is_at_zero(zero) => zeros.push(zero),
                other => others.push(other),
            }
        }
        let bounds = occupied.bounds;
        frame.column(
            canvas,
            &lines,
            Side::Right(frame.high.0 + 16.0),
            &mut occupied,
        )?;
        let beside_zero = Side::Right(frame.x(self.x.position(0.0)) + 34.0);
        frame.column(canvas, &zeros, beside_zero, &mut occupied)?;
        if let Some(end) = self.x.zero_end() {
            occupied.bounds.low.0 = occupied.bounds.low.0.max(frame.x(end));
        }
        let (piles, alone) = frame.piles(others);
        for pile in piles {
            let xs = || pile.iter().map(|series| frame.end(series).0);
            let widths = pile
                .iter()
                .map(|series| canvas.measure(&series.label, style::LABEL));
            let widths = widths.collect::<Result<Vec<_>, _>>()?;
            let width = widths.into_iter().map(|size| size.0).fold(0.0, f64::max);
            let right = xs().fold(0.0, f64::max) + 26.0;
            let side = if right + width < bounds.high.0 {
                Side::Right(right)
            } else {
                Side::Left(xs().fold(f64::INFINITY, f64::min) - 26.0)
            };
            frame.column(canvas, &pile, side, &mut occupied)?;
        }
        for series in alone {
            frame.label(canvas, series, &mut occupied)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::{Axis, Better, Ink};

    #[test]
    fn charts_are_drawn_twice() {
        let chart = Chart {
            title: "A title".to_owned(),
            subtitle: "What it says".to_owned(),
            x: Axis::log("x", [1.0, 100.0]).with_zero("0 of 10"),
            y: Axis::linear("y", [3.0]),
            series: vec![
                Series::line("a line", vec![(1.0, 1.0), (100.0, 3.0)], Ink::Blue),
                Series::dot("a dot", (0.0, 2.0), Ink::Green),
            ],
            better: Better::HigherLeft,
        };
        let svg = chart.svg().expect("an SVG");
        for text in [
            "A title",
            "What it says",
            "a line",
            "a dot",
            "0 of 10",
            "better",
        ] {
            assert!(svg.contains(text), "{text}");
        }
        let png = chart.png().expect("a PNG");
        let picture = image::load_from_memory(&png).expect("a PNG").into_rgb8();
        assert_eq!(
            picture.dimensions(),
            (SIZE.0 * MAGNIFIED, SIZE.1 * MAGNIFIED)
        );
        assert!(picture.pixels().any(|pixel| pixel.0 == [0, 114, 178]));
    }
}
