//! A data series and its style.

use super::style::Ink;

/// A data series.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// The label beside it; empty for none.
    pub label: String,
    /// The points, in the units of the axes.
    pub points: Vec<(f64, f64)>,
    /// Their colour.
    pub ink: Ink,
    /// How they are drawn.
    pub form: Form,
}

/// The style of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Dots only.
    Dots,
    /// Dots joined by lines.
    Line,
    /// Open dots joined by dashed lines.
    Dashes,
    /// A Pareto front: a wide pale line that runs horizontally from each point to the next one's x.
    Front,
}

impl Series {
    /// One labelled dot.
    pub fn dot(label: impl Into<String>, point: (f64, f64), ink: Ink) -> Self {
        Self {
            label: label.into(),
            points: vec![point],
            ink,
            form: Form::Dots,
        }
    }

    /// A labelled line.
    pub fn line(label: impl Into<String>, points: Vec<(f64, f64)>, ink: Ink) -> Self {
        Self {
            label: label.into(),
            points,
            ink,
            form: Form::Line,
        }
    }

    /// Whether its points are joined by lines.
    pub(super) fn is_line(&self) -> bool {
        matches!(self.form, Form::Line | Form::Dashes)
    }
}
