use super::OutOfMemory;

/// Why an image cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// An extension of no format that is written.
    #[error("{name}: expected a name that ends in .png, .ppm, .jpg, .jpeg, .tif, .tiff or .exr")]
    UnknownFormat {
        /// The file's name.
        name: String,
    },
    /// A picture without the layers that EXR needs.
    #[error("an EXR needs the picture's layers, and this picture was made without them")]
    NoLayers,
    /// A format that cannot store a fragment's position.
    #[error("fragments are PNG or EXR: other kinds of image cannot say where a tile belongs")]
    NotForFragments,
    /// A picture whose lists have wrong lengths, or with a side that the format cannot hold.
    #[error("the image could not be encoded: {0}")]
    Encode(String),
    /// An allocation that failed.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
    /// Bytes that are not a valid file.
    #[error("the image could not be read: {0}")]
    Decode(String),
}

impl ImageError {
    /// The error for bytes of no kind of image that is read.
    pub(super) fn neither() -> Self {
        Self::Decode("it is neither PNG nor EXR nor TIFF".to_owned())
    }
}
