//! The description of a chart.

use super::axis::Axis;
use super::series::Series;

/// A chart.
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
    /// The direction of better values.
    pub better: Better,
}

/// The direction in which a chart's values are better.
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
