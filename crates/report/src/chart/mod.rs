//! Plots that a person understands without help: a sentence for a title, units on the axes, labels
//! at what they name, an arrow towards what is better.
//!
//! plotters draws; what is here decides what goes where, so that labels do not lie over one another.

mod axis;
mod canvas;
mod draw;
mod labels;
mod notes;
mod strip;
mod style;

pub use axis::{Axis, Scale, Zero, number};
pub use draw::ChartError;
pub use notes::{Note, QUIET, TEXT, annotated};
pub use strip::captioned;
pub use style::Ink;

/// A plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// What it shows, as a sentence.
    pub title: String,
    /// How to read it.
    pub subtitle: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What is drawn, from back to front.
    pub series: Vec<Series>,
    /// Where things are better.
    pub better: Better,
}

/// The corner or side of a plot where one would like to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// Up.
    Higher,
    /// Down.
    Lower,
    /// Up and left.
    HigherLeft,
    /// Down and left.
    LowerLeft,
}

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
}
