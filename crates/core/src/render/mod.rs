//! From a view to a picture: tiles, passes, samples, in parallel.

mod job;
mod pass;
#[cfg(test)]
mod pass_tests;
mod sample;
mod tile;
mod view;

pub use crate::intersect::Precision;
pub use pass::{Pass, Passes};
pub use tile::{Tile, TileStats};
pub use view::{Cancel, Clock, Settings, View, from_the_middle};
