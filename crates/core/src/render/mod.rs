//! From a view to a picture: tiles, passes, samples, in parallel.

mod defaults;
mod job;
mod pass;
mod recipe;
mod sample;
mod tile;
mod view;

pub use crate::hit::Precision;
pub use defaults::render;
pub use pass::{Pass, Passes};
pub use tile::{Tile, TileStats};
pub use view::{Cancel, Clock, Settings, View, from_the_middle};
