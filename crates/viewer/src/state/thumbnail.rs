//! The image file of a texture, as a small picture on which a part of it is chosen.

use raycast_core::scene::{Crop, Texture, Wrap};
use std::path::PathBuf;
use std::sync::Arc;

/// What a texture shows of an image file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TexturePart {
    /// The rectangle; `None` for the whole image.
    pub crop: Option<Crop>,
    /// What lies beyond it along u and v.
    pub wrap: [Wrap; 2],
}

impl TexturePart {
    /// What a texture shows of its file.
    pub fn of(texture: &Texture) -> Self {
        Self {
            crop: texture.crop(),
            wrap: texture.wrap(),
        }
    }
}

/// A small picture of an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thumbnail {
    /// Columns and rows of the image.
    pub of: (u32, u32),
    /// Columns and rows.
    pub size: [usize; 2],
    /// Texels, row by row from the top: sRGB with straight alpha.
    pub texels: Vec<[u8; 4]>,
}

/// The image file that is shown, and what is there of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShownImage {
    /// The file.
    pub path: PathBuf,
    /// Its picture; `Ok(None)` while it is being read, and the reason where it cannot be read.
    pub found: Result<Option<Arc<Thumbnail>>, String>,
}
