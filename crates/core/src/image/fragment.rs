use super::{Format, ImageError, Picture};
use crate::camera::Rect;

/// A tile in a file of its own, with what is needed to stitch it back.
#[derive(Clone, Debug, PartialEq)]
pub struct Fragment {
    /// Columns and rows of the full picture.
    pub full_size: (u32, u32),
    /// The fragment's place in it.
    pub rect: Rect,
    /// Names the view: fragments of different cameras or scenes do not stitch.
    pub view: u64,
    /// The rectangle's own pixels, and layers if it has them.
    pub picture: Picture,
}

/// Why fragments cannot be read or stitched.
#[derive(Debug, thiserror::Error)]
pub enum FragmentError {
    /// Not a fragment at all, or a damaged one.
    #[error(
        "{name}: expected a fragment (a PNG or EXR that `raycast render --sub-camera` wrote): {reason}"
    )]
    NotAFragment {
        /// The file's name.
        name: String,
        /// What was found instead.
        reason: String,
    },
}

impl Fragment {
    /// The bytes of a PNG (a text chunk tells its place) or an EXR (its data window does) file.
    ///
    /// # Errors
    /// Other kinds of file, which cannot hold a fragment; whatever the encoder refuses.
    pub fn encode(&self, _format: Format) -> Result<Vec<u8>, ImageError> {
        unimplemented!()
    }

    /// Reads what [`Fragment::encode`] made. `name` is for the error.
    ///
    /// # Errors
    /// Bytes that are no fragment.
    pub fn decode(_name: &str, _bytes: &[u8]) -> Result<Self, FragmentError> {
        unimplemented!()
    }
}

/// Puts named fragments together into the picture that the full camera would have made.
///
/// # Errors
/// None at all, views that differ, parts that are missing, or that overlap.
pub fn stitch(_fragments: &[(String, Fragment)]) -> Result<Picture, FragmentError> {
    unimplemented!()
}
