//! Pictures: what renders make, what files hold, and how fragments become one again.

mod encode;
mod exr;
mod file;
mod fragment;
mod image;
mod jpeg;
mod memory;
mod png;
mod ppm;
mod recipe;

pub use encode::{Format, ImageError};
pub use file::ImageFile;
pub use fragment::{Fragment, FragmentError, stitch};
pub use image::{Layers, Picture, Strip};
pub use memory::{OutOfMemory, memory_of};
pub use recipe::Recipe;
