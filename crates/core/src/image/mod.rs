//! Pictures: what renders make, what files hold, and how fragments become one again.

mod encode;
mod exr;
mod file;
mod fragment;
mod jpeg;
mod memory;
mod picture;
mod png;
mod ppm;
mod recipe;

pub use encode::{Format, ImageError};
pub use file::ImageFile;
pub use fragment::{Fragment, FragmentError, stitch};
pub use memory::{OutOfMemory, memory_of};
pub use picture::{Layers, Picture, Strip};
pub use recipe::Recipe;
