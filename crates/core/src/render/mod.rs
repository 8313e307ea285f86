//! From a view to a picture: tiles, passes and samples, in parallel.

mod buffers;
mod compositor;
mod defaults;
mod eyes;
#[cfg(test)]
mod instance_tests;
mod job;
#[cfg(test)]
mod layer_tests;
#[cfg(test)]
mod mask_tests;
mod parallel;
mod pass;
#[cfg(test)]
mod pass_tests;
#[cfg(test)]
mod photograph_tests;
mod photographs;
mod recipe;
#[cfg(test)]
mod section_tests;
mod tile;
mod tile_renderer;
mod view;
mod workers;

pub use defaults::render;
pub use pass::{Pass, Passes};
pub use tile::{Tile, TileStats};
pub use view::{Cancel, Clock, Settings, View};
pub use workers::center_first;
