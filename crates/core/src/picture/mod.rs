//! Pictures: what renders make, what files hold, and how fragments become one again.

mod buffers;
mod encode;
mod error;
mod exr;
mod file;
mod format;
mod fragment;
mod image;
mod jpeg;
mod memory;
mod opaque;
mod place;
mod png;
mod ppm;
mod recipe;

pub use buffers::OutOfMemory;
pub use error::ImageError;
pub use file::ImageFile;
pub use format::Format;
pub use fragment::{Fragment, FragmentError, stitch};
pub use image::{Layers, Picture, Strip};
pub use memory::memory_of;
pub use recipe::Recipe;
