use super::Picture;

/// A kind of image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8-bit sRGB with alpha, lossless.
    Png,
    /// 8-bit sRGB, binary P6; alpha is laid over black.
    Ppm,
    /// 8-bit sRGB, lossy; alpha is laid over black.
    Jpeg,
    /// OpenEXR: linear light and every layer.
    Exr,
}

/// Why an image cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// An extension that names no kind we write.
    #[error("{name}: expected a name that ends in .png, .ppm, .jpg, .jpeg or .exr")]
    UnknownFormat {
        /// The file's name.
        name: String,
    },
    /// The encoder's own words.
    #[error("the image could not be encoded: {0}")]
    Encode(String),
}

impl Format {
    /// The kind that a file's name says.
    ///
    /// # Errors
    /// An extension that names none.
    pub fn from_name(name: &str) -> Result<Self, ImageError> {
        match name
            .rsplit('.')
            .next()
            .map(str::to_ascii_lowercase)
            .as_deref()
        {
            Some("png") => Ok(Self::Png),
            Some("ppm") => Ok(Self::Ppm),
            Some("jpg" | "jpeg") => Ok(Self::Jpeg),
            Some("exr") => Ok(Self::Exr),
            _ => Err(ImageError::UnknownFormat {
                name: name.to_owned(),
            }),
        }
    }
}

impl Picture {
    /// The bytes of an image file of this kind.
    ///
    /// # Errors
    /// Whatever the encoder refuses; [`Format::Exr`] needs the picture's layers.
    pub fn encode(&self, _format: Format) -> Result<Vec<u8>, ImageError> {
        unimplemented!()
    }
}
