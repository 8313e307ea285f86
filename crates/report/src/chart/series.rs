//! Points that belong together, and how they are drawn.

use super::style::Ink;

/// Points that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What stands beside them; empty for nothing.
    pub label: String,
    /// Where they are, in the axes' units.
    pub points: Vec<(f64, f64)>,
    /// Their colour.
    pub ink: Ink,
    /// How they are drawn.
    pub form: Form,
}

/// How points are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Each for itself.
    Dots,
    /// Dots with lines from one to the next.
    Line,
    /// The same with broken lines and open dots.
    Dashes,
    /// A wide pale line that leaves each point level: a front.
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

    /// Whether its points are joined.
    pub(super) fn is_line(&self) -> bool {
        matches!(self.form, Form::Line | Form::Dashes)
    }
}
