//! From a view to a picture: tiles, passes, samples, in parallel.

mod pass;
mod tile;
mod view;

pub use pass::{Pass, Passes};
pub use tile::{Tile, TileStats};
pub use view::{Cancel, Clock, Precision, Settings, View};
