//! Charts that can be read without the report's text: the title is a sentence, axes have units, labels stand at the
//! data instead of in a legend, and an arrow points towards better values.
//!
//! plotters draws; the code here computes the layout, so that labels do not overlap.

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
