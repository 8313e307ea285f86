//! plotters' drawing area with a magnification. Coordinates and sizes are given before magnification.

use super::error::ChartError;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub(super) struct Canvas<'a, B: DrawingBackend> {
    pub(super) area: &'a DrawingArea<B, Shift>,
    pub(super) magnified: f64,
}

/// A point before magnification.
pub(super) type Point = (f64, f64);

impl<B: DrawingBackend> Canvas<'_, B> {
    fn at(&self, (x, y): Point) -> (i32, i32) {
        (
            (x * self.magnified).round() as i32,
            (y * self.magnified).round() as i32,
        )
    }

    fn width(&self, width: f64) -> u32 {
        (width * self.magnified).round().max(1.0) as u32
    }

    fn done<E: std::fmt::Display>(&self, result: Result<(), E>) -> Result<(), ChartError> {
        result.map_err(|error| ChartError(error.to_string()))
    }

    pub(super) fn fill(&self, low: Point, high: Point, color: RGBColor) -> Result<(), ChartError> {
        let rectangle = Rectangle::new([self.at(low), self.at(high)], color.filled());
        self.done(self.area.draw(&rectangle))
    }

    pub(super) fn line(
        &self,
        points: &[Point],
        width: f64,
        color: RGBAColor,
    ) -> Result<(), ChartError> {
        let points: Vec<_> = points.iter().map(|&point| self.at(point)).collect();
        let style = color.stroke_width(self.width(width));
        self.done(self.area.draw(&PathElement::new(points, style)))
    }

    /// A dashed polyline; the dash pattern continues across its points.
    pub(super) fn dashes(
        &self,
        points: &[Point],
        width: f64,
        color: RGBAColor,
    ) -> Result<(), ChartError> {
        const ON: f64 = 7.0;
        const OFF: f64 = 4.0;
        let mut along = 0.0;
        for pair in points.windows(2) {
            let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
            let length = (x1 - x0).hypot(y1 - y0);
            let point = |at: f64| {
                let share = if length > 0.0 { at / length } else { 0.0 };
                (x0 + (x1 - x0) * share, y0 + (y1 - y0) * share)
            };
            let mut at = 0.0;
            while at < length {
                let phase = (along + at) % (ON + OFF);
                let rest = if phase < ON {
                    ON - phase
                } else {
                    ON + OFF - phase
                };
                let end = (at + rest.max(0.01)).min(length);
                if phase < ON {
                    self.line(&[point(at), point(end)], width, color)?;
                }
                at = end;
            }
            along += length;
        }
        Ok(())
    }

    pub(super) fn dot(&self, at: Point, radius: f64, color: RGBColor) -> Result<(), ChartError> {
        let radius = (radius * self.magnified).round() as i32;
        self.done(
            self.area
                .draw(&Circle::new(self.at(at), radius, color.filled())),
        )
    }

    pub(super) fn halo(&self, at: Point, radius: f64, color: RGBAColor) -> Result<(), ChartError> {
        let radius = (radius * self.magnified).round() as i32;
        let circle = Circle::new(self.at(at), radius, color.filled());
        self.done(self.area.draw(&circle))
    }

    pub(super) fn polygon(&self, points: &[Point], color: RGBColor) -> Result<(), ChartError> {
        let points: Vec<_> = points.iter().map(|&point| self.at(point)).collect();
        self.done(self.area.draw(&Polygon::new(points, color.filled())))
    }

    pub(super) fn text(
        &self,
        text: &str,
        at: Point,
        size: f64,
        color: RGBColor,
        (across, along): (HPos, VPos),
    ) -> Result<(), ChartError> {
        let style = ("sans-serif", size * self.magnified)
            .into_font()
            .color(&color)
            .pos(Pos::new(across, along));
        self.done(
            self.area
                .draw(&Text::new(text.to_owned(), self.at(at), style)),
        )
    }

    /// Text rotated to read upwards, centred on a point.
    pub(super) fn text_upwards(
        &self,
        text: &str,
        at: Point,
        size: f64,
        color: RGBColor,
    ) -> Result<(), ChartError> {
        let style = ("sans-serif", size * self.magnified)
            .into_font()
            .transform(FontTransform::Rotate270)
            .color(&color)
            .pos(Pos::new(HPos::Center, VPos::Center));
        self.done(
            self.area
                .draw(&Text::new(text.to_owned(), self.at(at), style)),
        )
    }

    /// The width and height of a text.
    pub(super) fn measure(&self, text: &str, size: f64) -> Result<(f64, f64), ChartError> {
        let style = ("sans-serif", size * self.magnified)
            .into_font()
            .color(&BLACK);
        let (width, height) = self
            .area
            .estimate_text_size(text, &style)
            .map_err(|error| ChartError(error.to_string()))?;
        Ok((
            f64::from(width) / self.magnified,
            f64::from(height) / self.magnified,
        ))
    }
}
