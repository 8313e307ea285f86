//! From a chart to SVG and PNG.

use super::canvas::{Canvas, Point};
use super::labels::{Area, Taken};
use super::style::{self, SIZE};
use super::{Better, Chart, Form, Series};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use std::sync::OnceLock;

/// Why a chart cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a plot cannot be drawn: {0}")]
pub struct ChartError(pub(super) String);

/// How much larger a PNG is than its SVG, along each side: sharp on any screen.
const MAGNIFIED: u32 = 2;

/// The plot's frame, from the picture's edges: left, top, right, bottom.
const MARGINS: (f64, f64, f64, f64) = (84.0, 92.0, 30.0, 70.0);

/// What labels at the ends of lines may take of the frame's width.
const LABEL_SHARE: f64 = 0.24;

impl Chart {
    /// As SVG.
    ///
    /// # Errors
    /// What plotters refuses.
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
    /// What plotters refuses.
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
        let mut taken = Taken {
            bounds: Area {
                low: (left + 4.0, top + 2.0),
                high: (width - 8.0, height - bottom - 4.0),
            },
            areas: Vec::new(),
            line_points: Vec::new(),
        };
        frame.better(canvas)?;
        for series in &self.series {
            frame.series(canvas, series, &mut taken)?;
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
        let bounds = taken.bounds;
        frame.column(canvas, &lines, Side::Right(frame.high.0 + 16.0), &mut taken)?;
        let beside_zero = Side::Right(frame.x(self.x.place(0.0)) + 34.0);
        frame.column(canvas, &zeros, beside_zero, &mut taken)?;
        if let Some(end) = self.x.zero_end() {
            taken.bounds.low.0 = taken.bounds.low.0.max(frame.x(end));
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
            frame.column(canvas, &pile, side, &mut taken)?;
        }
        for series in alone {
            frame.label(canvas, series, &mut taken)?;
        }
        Ok(())
    }
}

impl Series {
    fn is_line(&self) -> bool {
        matches!(self.form, Form::Line | Form::Dashes)
    }
}

/// Which way names go from a line.
#[derive(Clone, Copy)]
enum Side {
    /// To the right of it.
    Right(f64),
    /// To the left.
    Left(f64),
}

/// The rectangle that points lie in.
struct Frame<'a> {
    chart: &'a Chart,
    low: Point,
    high: Point,
}

impl Frame<'_> {
    fn x(&self, place: f64) -> f64 {
        self.low.0 + (self.high.0 - self.low.0) * place
    }

    fn y(&self, place: f64) -> f64 {
        self.high.1 - (self.high.1 - self.low.1) * place
    }

    fn at(&self, (x, y): (f64, f64)) -> Point {
        let within = |place: f64| place.clamp(0.0, 1.0);
        (
            self.x(within(self.chart.x.place(x))),
            self.y(within(self.chart.y.place(y))),
        )
    }

    fn heading<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>) -> Result<(), ChartError> {
        let Chart {
            title, subtitle, ..
        } = self.chart;
        let anchor = (HPos::Left, VPos::Top);
        canvas.text(title, (24.0, 18.0), style::TITLE, style::TEXT, anchor)?;
        canvas.text(
            subtitle,
            (24.0, 50.0),
            style::SUBTITLE,
            style::QUIET,
            anchor,
        )
    }

    fn axes<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>) -> Result<(), ChartError> {
        let Chart { x, y, .. } = self.chart;
        let ((left, top), (right, bottom)) = (self.low, self.high);
        if let Some(zero) = &x.zero {
            let (end, text) = (zero.share, &zero.text);
            canvas.fill((left, top), (self.x(end), bottom), style::ZERO)?;
            let middle = (left + self.x(end)) * 0.5;
            let anchor = (HPos::Center, VPos::Top);
            canvas.text(
                text,
                (middle, bottom + 8.0),
                style::TICK,
                style::TEXT,
                anchor,
            )?;
        }
        if let Some(zero) = &y.zero {
            let (end, text) = (zero.share, &zero.text);
            canvas.fill((left, self.y(end)), (right, bottom), style::ZERO)?;
            let middle = (bottom + self.y(end)) * 0.5;
            let anchor = (HPos::Right, VPos::Center);
            canvas.text(text, (left - 8.0, middle), style::TICK, style::TEXT, anchor)?;
        }
        for named in [false, true] {
            let color = if named {
                style::GRID
            } else {
                style::FAINT_GRID
            };
            let shown = |text: &String| text.is_empty() != named;
            for (at, text) in x.ticks().iter().filter(|(_, text)| shown(text)) {
                let at = self.x(x.place(*at));
                canvas.line(&[(at, top), (at, bottom)], 1.0, color.to_rgba())?;
                let anchor = (HPos::Center, VPos::Top);
                canvas.text(text, (at, bottom + 8.0), style::TICK, style::TEXT, anchor)?;
            }
            for (at, text) in y.ticks().iter().filter(|(_, text)| shown(text)) {
                let at = self.y(y.place(*at));
                canvas.line(&[(left, at), (right, at)], 1.0, color.to_rgba())?;
                let anchor = (HPos::Right, VPos::Center);
                canvas.text(text, (left - 8.0, at), style::TICK, style::TEXT, anchor)?;
            }
        }
        let corner = [(left, top), (left, bottom), (right, bottom)];
        canvas.line(&corner, 1.3, style::AXIS.to_rgba())?;
        let anchor = (HPos::Center, VPos::Bottom);
        let middle = ((left + right) * 0.5, f64::from(SIZE.1) - 12.0);
        canvas.text(&x.label, middle, style::AXIS_LABEL, style::TEXT, anchor)?;
        let middle = (20.0, (top + bottom) * 0.5);
        canvas.text_upwards(&y.label, middle, style::AXIS_LABEL, style::TEXT)
    }

    /// An arrow above the frame, the way things are better.
    fn better<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>) -> Result<(), ChartError> {
        const SIDE: f64 = 9.0;
        let (dx, dy) = match self.chart.better {
            Better::Higher => (0.0, -1.0),
            Better::Lower => (0.0, 1.0),
            Better::HigherLeft => (-0.8, -0.8),
            Better::LowerLeft => (-0.8, 0.8),
        };
        let middle = (self.low.0 + SIDE, self.low.1 - 14.0);
        let along = |share: f64| (middle.0 + dx * SIDE * share, middle.1 + dy * SIDE * share);
        let color = RGBColor(46, 125, 70);
        let neck = along(0.0);
        canvas.line(&[along(-1.0), neck], 2.4, color.to_rgba())?;
        let wing = |side: f64| (neck.0 - dy * 5.0 * side, neck.1 + dx * 5.0 * side);
        canvas.polygon(&[along(1.0), wing(1.0), wing(-1.0)], color)?;
        let at = (middle.0 + SIDE + 5.0, middle.1);
        canvas.text(
            "better",
            at,
            style::LABEL,
            color,
            (HPos::Left, VPos::Center),
        )
    }

    /// The names of lines or dots, one below the other, each as near to its line's end as the others
    /// let it.
    fn column<B: DrawingBackend>(
        &self,
        canvas: &Canvas<'_, B>,
        series: &[&Series],
        side: Side,
        taken: &mut Taken,
    ) -> Result<(), ChartError> {
        const APART: f64 = 17.5;
        let mut names: Vec<(Point, &Series)> = series
            .iter()
            .map(|&series| (self.end(series), series))
            .collect();
        names.sort_by(|(a, _), (b, _)| a.1.total_cmp(&b.1));
        let ends: Vec<f64> = names.iter().map(|((_, y), _)| *y).collect();
        let places = spread_out(&ends, APART, (self.low.1, self.high.1));
        for ((end, series), place) in names.into_iter().zip(places) {
            let color = series.ink.color();
            let (width, _) = canvas.measure(&series.label, style::LABEL)?;
            let (x, low) = match side {
                Side::Right(x) => (x, x + 3.0),
                Side::Left(x) => (x, x - 3.0 - width),
            };
            canvas.line(&[end, (x, place)], 1.0, color.mix(0.5))?;
            let anchor = (HPos::Left, VPos::Center);
            canvas.text(&series.label, (low, place), style::LABEL, color, anchor)?;
            taken.areas.push(Area {
                low: (low, place - APART * 0.5),
                high: (low + width, place + APART * 0.5),
            });
        }
        Ok(())
    }

    /// Where a series ends.
    fn end(&self, series: &Series) -> Point {
        let last = series.points.last().copied();
        last.map_or(self.high, |point| self.at(point))
    }

    /// Dots that stand one above the other, three or more, and all others.
    fn piles<'s>(&self, dots: Vec<&'s Series>) -> (Vec<Vec<&'s Series>>, Vec<&'s Series>) {
        const NEAR: f64 = 9.0;
        let mut sorted = dots;
        sorted.sort_by(|a, b| self.end(a).0.total_cmp(&self.end(b).0));
        let near = |a: &&Series, b: &&Series| self.end(b).0 - self.end(a).0 < NEAR;
        let (mut piles, mut alone) = (Vec::new(), Vec::new());
        for pile in sorted.chunk_by(near) {
            if pile.len() > 2 {
                piles.push(pile.to_vec());
            } else {
                alone.extend_from_slice(pile);
            }
        }
        (piles, alone)
    }

    fn series<B: DrawingBackend>(
        &self,
        canvas: &Canvas<'_, B>,
        series: &Series,
        taken: &mut Taken,
    ) -> Result<(), ChartError> {
        let color = series.ink.color();
        let points: Vec<Point> = series.points.iter().map(|&point| self.at(point)).collect();
        match series.form {
            Form::Dots => {}
            Form::Line => canvas.line(&points, 2.2, color.to_rgba())?,
            Form::Dashes => canvas.dashes(&points, 2.0, color.to_rgba())?,
            Form::Front => {
                let mut steps: Vec<Point> = Vec::new();
                for &(x, y) in &points {
                    if let Some(&(_, level)) = steps.last() {
                        steps.push((x, level));
                    }
                    steps.push((x, y));
                }
                taken.line_points.extend(along(&steps));
                match steps[..] {
                    [alone] => canvas.halo(alone, 10.0, color.mix(0.22))?,
                    _ => canvas.line(&steps, 7.0, color.mix(0.22))?,
                }
                return Ok(());
            }
        }
        if series.form != Form::Dots {
            taken.line_points.extend(along(&points));
        }
        for &point in &points {
            let is_open = series.form == Form::Dashes;
            canvas.dot(point, style::DOT + if is_open { -0.5 } else { 0.0 }, color)?;
            if is_open {
                canvas.dot(point, style::DOT - 2.0, WHITE)?;
            }
            taken.areas.push(Area::around(point, style::DOT));
        }
        Ok(())
    }

    fn label<B: DrawingBackend>(
        &self,
        canvas: &Canvas<'_, B>,
        series: &Series,
        taken: &mut Taken,
    ) -> Result<(), ChartError> {
        let (width, height) = canvas.measure(&series.label, style::LABEL)?;
        let points: Vec<Point> = series.points.iter().rev().map(|&p| self.at(p)).collect();
        if points.is_empty() {
            return Ok(());
        }
        let (area, point) = taken.place((width + 4.0, height.max(15.0)), &points);
        let color = series.ink.color();
        let near = area.nearest_to(point);
        if (near.0 - point.0).hypot(near.1 - point.1) > 13.0 {
            canvas.line(&[point, near], 1.0, color.mix(0.55))?;
        }
        let at = (area.low.0 + 2.0, (area.low.1 + area.high.1) * 0.5);
        let anchor = (HPos::Left, VPos::Center);
        canvas.text(&series.label, at, style::LABEL, color, anchor)
    }
}

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

/// Ascending numbers moved as little as leaves them `apart` and, if there is room, within `limits`.
fn spread_out(numbers: &[f64], apart: f64, (low, high): (f64, f64)) -> Vec<f64> {
    // Groups of neighbours that touch, each around the mean of what it moved: (sum, count).
    let mut groups: Vec<(f64, usize)> = Vec::new();
    let extent = |(sum, count): (f64, usize)| {
        let half = apart * count as f64 / 2.0;
        let middle = (sum / count as f64).clamp((low + half).min(high - half), high - half);
        (middle - half, middle + half)
    };
    for &number in numbers {
        groups.push((number, 1));
        while let [.., before, last] = groups[..]
            && extent(before).1 > extent(last).0
        {
            groups.truncate(groups.len() - 2);
            groups.push((before.0 + last.0, before.1 + last.1));
        }
    }
    let places = |group: (f64, usize)| {
        let begin = extent(group).0;
        (0..group.1).map(move |at| begin + apart * (at as f64 + 0.5))
    };
    groups.into_iter().flat_map(places).collect()
}

/// Points a few pixels apart along a line.
fn along(points: &[Point]) -> Vec<Point> {
    let mut all = Vec::new();
    for pair in points.windows(2) {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        let count = ((x1 - x0).hypot(y1 - y0) / 6.0).ceil().max(1.0);
        for step in 0..count as u32 {
            let share = f64::from(step) / count;
            all.push((x0 + (x1 - x0) * share, y0 + (y1 - y0) * share));
        }
    }
    all
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::{Axis, Ink};

    #[test]
    fn names_of_lines_do_not_touch() {
        let spread = spread_out(&[10.0, 11.0, 12.0, 50.0, 98.0, 99.0], 8.0, (0.0, 100.0));
        assert_eq!(spread.len(), 6);
        assert!(
            spread
                .windows(2)
                .all(|pair| pair[1] - pair[0] >= 8.0 - 1e-9),
            "{spread:?}"
        );
        assert!(spread[0] >= 3.9 && spread[5] <= 96.1, "{spread:?}");
        assert_eq!(spread[3], 50.0);
        assert_eq!(spread_out(&[], 8.0, (0.0, 1.0)), [] as [f64; 0]);
    }

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
