//! Pictures: what renders make, what files hold, and how fragments become one again.

mod encode;
mod exr;
mod fragment;
mod jpeg;
mod picture;
mod png;
mod ppm;

pub use encode::{Format, ImageError};
pub use fragment::{Fragment, FragmentError, stitch};
pub use picture::{Layers, Picture, Strip};
