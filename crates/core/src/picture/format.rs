use super::ImageError;
use std::ffi::OsStr;
use std::path::Path;

/// An image file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8-bit sRGB with alpha, lossless.
    Png,
    /// 8-bit sRGB, binary P6; composited over black.
    Ppm,
    /// 8-bit sRGB, lossy; composited over black.
    Jpeg,
    /// 8-bit sRGB with alpha, lossless, in tiles; BigTIFF where the file may be large.
    Tiff,
    /// OpenEXR: linear light and every layer.
    Exr,
}

impl Format {
    /// The format that a file name's extension names. A name that is only an extension (`png`, `.png`) names none.
    ///
    /// # Errors
    /// An unknown extension.
    pub fn from_name(name: &str) -> Result<Self, ImageError> {
        let extension = Path::new(name).extension().and_then(OsStr::to_str);
        match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("png") => Ok(Self::Png),
            Some("ppm") => Ok(Self::Ppm),
            Some("jpg" | "jpeg") => Ok(Self::Jpeg),
            Some("tif" | "tiff") => Ok(Self::Tiff),
            Some("exr") => Ok(Self::Exr),
            _ => Err(ImageError::UnknownFormat {
                name: name.to_owned(),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_select_the_format() {
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
}
