//! Plots that a person understands without help: a sentence for a title, units on the axes, labels
//! at what they name, an arrow towards what is better.
//!
//! plotters draws; what is here decides what goes where, so that labels do not lie over one another.

mod axis;
mod canvas;
mod draw;
mod error;
mod frame;
mod labels;
mod notes;
mod output;
mod plot;
mod series;
mod strip;
mod style;

pub use axis::{Axis, Scale, Zero, number};
pub use error::ChartError;
pub use notes::{Note, QUIET, TEXT, annotated};
pub use plot::{Better, Chart};
pub use series::{Form, Series};
pub use strip::captioned;
pub use style::Ink;
