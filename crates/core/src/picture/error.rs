use super::OutOfMemory;

/// Why an image cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// An extension that names no kind we write.
    #[error("{name}: expected a name that ends in .png, .ppm, .jpg, .jpeg, .tif, .tiff or .exr")]
    UnknownFormat {
        /// The file's name.
        name: String,
    },
    /// A picture without the layers that an EXR holds.
    #[error("an EXR needs the picture's layers, and this picture was made without them")]
    NoLayers,
    /// A kind of file that has no place for a fragment's place.
    #[error("fragments are PNG or EXR: other kinds of image cannot tell where a tile belongs")]
    NotForFragments,
    /// A picture whose counts do not agree, or with a side that the kind of file cannot have.
    #[error("the image could not be encoded: {0}")]
    Encode(String),
    /// A buffer that could not be had.
    #[error(transparent)]
    OutOfMemory(#[from] OutOfMemory),
    /// Bytes that are not the file they should be.
    #[error("the image could not be read: {0}")]
    Decode(String),
}
