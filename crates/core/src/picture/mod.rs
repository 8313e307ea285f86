//! Pictures: what renders make, what files hold, and how fragments become one again.

mod animated_png;
mod band;
mod bands;
mod buffers;
mod encode;
mod error;
mod exr;
mod exr_read;
mod file;
mod format;
mod fragment;
mod halve;
mod image;
mod jpeg;
mod memory;
mod opaque;
mod place;
mod png;
mod png_bands;
mod ppm;
mod recipe;
mod rows;
mod tiff;
mod xmp;

pub use animated_png::AnimatedPng;
pub use band::{Band, BandSizes};
pub use bands::Bands;
pub use buffers::OutOfMemory;
pub use error::ImageError;
pub use file::ImageFile;
pub use format::Format;
pub use fragment::{Fragment, FragmentError, Part, check_parts, stitch};
pub use image::{Layers, Picture, Strip};
pub use memory::memory_of;
pub use recipe::Recipe;
pub use rows::RowReader;
