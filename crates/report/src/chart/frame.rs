//! The plot area: axes, data, and the labels around it.

use super::canvas::{Canvas, Point};
use super::error::ChartError;
use super::labels::{Area, OccupiedAreas};
use super::plot::{Better, Chart};
use super::series::{Form, Series};
use super::style::{self, SIZE};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

/// The side of the plot area on which a column of labels stands, and its x.
#[derive(Clone, Copy)]
pub(super) enum Side {
    /// To its right.
    Right(f64),
    /// To its left.
    Left(f64),
}

/// The plot area.
pub(super) struct Frame<'a> {
    pub(super) chart: &'a Chart,
    pub(super) low: Point,
    pub(super) high: Point,
}

impl Frame<'_> {
    pub(super) fn x(&self, place: f64) -> f64 {
        self.low.0 + (self.high.0 - self.low.0) * place
    }

    fn y(&self, place: f64) -> f64 {
        self.high.1 - (self.high.1 - self.low.1) * place
    }

    fn at(&self, (x, y): (f64, f64)) -> Point {
        let within = |place: f64| place.clamp(0.0, 1.0);
        (
            self.x(within(self.chart.x.position(x))),
            self.y(within(self.chart.y.position(y))),
        )
    }

    pub(super) fn heading<B: DrawingBackend>(
        &self,
        canvas: &Canvas<'_, B>,
    ) -> Result<(), ChartError> {
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

    pub(super) fn axes<B: DrawingBackend>(&self, canvas: &Canvas<'_, B>) -> Result<(), ChartError> {
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
                let at = self.x(x.position(*at));
                canvas.line(&[(at, top), (at, bottom)], 1.0, color.to_rgba())?;
                let anchor = (HPos::Center, VPos::Top);
                canvas.text(text, (at, bottom + 8.0), style::TICK, style::TEXT, anchor)?;
            }
            for (at, text) in y.ticks().iter().filter(|(_, text)| shown(text)) {
                let at = self.y(y.position(*at));
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

    /// Draws an arrow above the plot area that points towards better values.
    pub(super) fn better<B: DrawingBackend>(
        &self,
        canvas: &Canvas<'_, B>,
    ) -> Result<(), ChartError> {
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

    /// Draws labels of lines or dots in a column, each as near to its line's end as possible without overlap.
    pub(super) fn column<B: DrawingBackend>(
        &self,
        canvas: &Canvas<'_, B>,
        series: &[&Series],
        side: Side,
        occupied: &mut OccupiedAreas,
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
            occupied.areas.push(Area {
                low: (low, place - APART * 0.5),
                high: (low + width, place + APART * 0.5),
            });
        }
        Ok(())
    }

    /// The last point of a series.
    pub(super) fn end(&self, series: &Series) -> Point {
        let last = series.points.last().copied();
        last.map_or(self.high, |point| self.at(point))
    }

    /// Groups of three or more dots that lie nearly above one another, and all other dots.
    pub(super) fn piles<'s>(
        &self,
        dots: Vec<&'s Series>,
    ) -> (Vec<Vec<&'s Series>>, Vec<&'s Series>) {
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

    pub(super) fn series<B: DrawingBackend>(
        &self,
        canvas: &Canvas<'_, B>,
        series: &Series,
        occupied: &mut OccupiedAreas,
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
                occupied.line_points.extend(along(&steps));
                match steps[..] {
                    [alone] => canvas.halo(alone, 10.0, color.mix(0.22))?,
                    _ => canvas.line(&steps, 7.0, color.mix(0.22))?,
                }
                return Ok(());
            }
        }
        if series.form != Form::Dots {
            occupied.line_points.extend(along(&points));
        }
        for &point in &points {
            let is_open = series.form == Form::Dashes;
            canvas.dot(point, style::DOT + if is_open { -0.5 } else { 0.0 }, color)?;
            if is_open {
                canvas.dot(point, style::DOT - 2.0, WHITE)?;
            }
            occupied.areas.push(Area::around(point, style::DOT));
        }
        Ok(())
    }

    pub(super) fn label<B: DrawingBackend>(
        &self,
        canvas: &Canvas<'_, B>,
        series: &Series,
        occupied: &mut OccupiedAreas,
    ) -> Result<(), ChartError> {
        let (width, height) = canvas.measure(&series.label, style::LABEL)?;
        let points: Vec<Point> = series.points.iter().rev().map(|&p| self.at(p)).collect();
        if points.is_empty() {
            return Ok(());
        }
        let (area, point) = occupied.place((width + 4.0, height.max(15.0)), &points);
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

/// Moves ascending numbers as little as possible so that they are `apart`, and within the limits if there is room.
fn spread_out(numbers: &[f64], apart: f64, (low, high): (f64, f64)) -> Vec<f64> {
    // Groups of numbers that touch, each centred on the mean of its original numbers: (sum, count).
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

/// Samples a polyline every few pixels.
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
