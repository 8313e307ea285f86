//! A plot, before it is drawn.

use super::axis::Axis;
use super::series::Series;

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
