//! The sections of a report; each module measures one subject and presents it.

pub mod breaking;
mod chosen_tile;
pub mod density;
pub mod feature_cost;
pub mod filters;
pub mod hard;
mod level_figure;
pub mod levels;
pub mod meshes;
pub mod numerics;
pub mod samples;
mod section;
pub mod shape;
pub mod time;

pub use section::Section;
