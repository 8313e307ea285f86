//! Pictures: what renders make, what files hold, and how fragments become one again.

mod encode;
mod exr;
mod fragment;
mod image;
mod jpeg;
mod png;
mod ppm;

pub use encode::{Format, ImageError};
pub use fragment::{Fragment, FragmentError, stitch};
pub use image::{Layers, Picture, Strip};
