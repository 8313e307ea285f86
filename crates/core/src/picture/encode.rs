use super::file::Tags;
use super::memory::{OutOfMemory, reserved};
use super::{ImageFile, Picture, Recipe, exr, jpeg, png, ppm};
use std::ffi::OsStr;
use std::path::Path;

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

impl Format {
    /// The kind that the end of a file's name says, after its last dot. A name of that end alone
    /// (`png`, `.png`) says none.
    ///
    /// # Errors
    /// An extension that names none.
    pub fn from_name(name: &str) -> Result<Self, ImageError> {
        let extension = Path::new(name).extension().and_then(OsStr::to_str);
        match extension.map(str::to_ascii_lowercase).as_deref() {
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
    /// The bytes of an image file of this kind: the same for the same picture.
    ///
    /// # Errors
    /// As [`Picture::encode_with`].
    pub fn encode(&self, format: Format) -> Result<Vec<u8>, ImageError> {
        self.encode_with(format, None)
    }

    /// The same with what the picture was made of: PNG and EXR tell it, PPM and JPEG have no place for
    /// it.
    ///
    /// # Errors
    /// A side of no pixels, or more than the kind of file can hold; [`Format::Exr`] needs the
    /// picture's layers.
    pub fn encode_with(
        &self,
        format: Format,
        recipe: Option<&Recipe>,
    ) -> Result<Vec<u8>, ImageError> {
        self.check()?;
        let tags = Tags {
            recipe,
            place: None,
        };
        match format {
            Format::Png => png::encode(self, tags),
            Format::Ppm => ppm::encode(self),
            Format::Jpeg => jpeg::encode(self),
            Format::Exr => exr::encode(self, tags),
        }
    }

    /// Reads an EXR that [`Picture::encode`] or [`Fragment::encode`](super::Fragment::encode)
    /// made: the pixels inside its data window.
    ///
    /// # Errors
    /// Bytes that are no EXR, a damaged one, or one without RayCast's channels.
    pub fn decode_exr(bytes: &[u8]) -> Result<Self, ImageError> {
        exr::decode(bytes).map(|ImageFile { picture, .. }| picture)
    }

    /// Whether there are as many pixels as the sides say, and at least one.
    pub(super) fn check(&self) -> Result<(), ImageError> {
        let pixels = self.width as usize * self.height as usize;
        let layers_agree = self
            .layers
            .as_ref()
            .is_none_or(|layers| layers.counts().iter().all(|&count| count == pixels));
        if pixels == 0 {
            Err(ImageError::Encode("it has no pixels".to_owned()))
        } else if self.pixels.len() != pixels || !layers_agree {
            Err(ImageError::Encode(format!(
                "it should have {} x {} pixels in every layer",
                self.width, self.height
            )))
        } else {
            Ok(())
        }
    }
}

/// The red, green and blue of pixels laid over black, after some other bytes.
pub(super) fn over_black(before: &[u8], pixels: &[[u8; 4]]) -> Result<Vec<u8>, OutOfMemory> {
    let mut bytes = reserved(before.len() + pixels.len() * 3)?;
    bytes.extend_from_slice(before);
    for &[r, g, b, a] in pixels {
        bytes.extend(match a {
            u8::MAX => [r, g, b],
            _ => crate::shade::over_black([r, g, b, a]),
        });
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_the_kind() {
        assert_eq!(Format::from_name("a.b/c.PNG").ok(), Some(Format::Png));
        assert_eq!(Format::from_name("c.jpeg").ok(), Some(Format::Jpeg));
        for bad in [
            "",
            "a.gif",
            "a.png.bak",
            "a.",
            "png",
            ".png",
            "a/.png",
            "a.png/b",
        ] {
            let error = Format::from_name(bad).expect_err("names no kind");
            assert!(
                error
                    .to_string()
                    .contains("expected a name that ends in .png")
            );
        }
    }

    #[test]
    fn pictures_that_disagree_with_themselves_are_refused() {
        let mut odd = Picture::blank(3, 2, true);
        odd.pixels.pop();
        let mut odd_layers = Picture::blank(3, 2, true);
        if let Some(layers) = &mut odd_layers.layers {
            layers.depth.pop();
        }
        for picture in [odd, odd_layers, Picture::blank(0, 2, true)] {
            for format in [Format::Png, Format::Ppm, Format::Jpeg, Format::Exr] {
                assert!(matches!(picture.encode(format), Err(ImageError::Encode(_))));
            }
        }
        let flat = Picture::blank(3, 2, false).encode(Format::Exr);
        assert!(matches!(flat, Err(ImageError::NoLayers)));
    }
}
