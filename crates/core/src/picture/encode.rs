use super::file::Tags;
use super::{
    Format, ImageError, ImageFile, Picture, Recipe, bands, exr_read, jpeg, png, tiff_read,
};

impl Picture {
    /// The bytes of an image file in this format; they depend on the picture only.
    ///
    /// # Errors
    /// As [`Picture::encode_with`].
    pub fn encode(&self, format: Format) -> Result<Vec<u8>, ImageError> {
        self.encode_with(format, None)
    }

    /// As [`Picture::encode`], with the recipe that the picture was made by. PNG, TIFF and EXR store it; PPM and JPEG
    /// have no field for it. PNG and JPEG mark panoramas for viewers (GPano).
    ///
    /// # Errors
    /// A side of zero pixels, or of more than the format can hold; [`Format::Exr`] needs the picture's layers.
    pub fn encode_with(
        &self,
        format: Format,
        recipe: Option<&Recipe>,
    ) -> Result<Vec<u8>, ImageError> {
        self.check()?;
        let tags = Tags {
            recipe,
            position: None,
        };
        match format {
            Format::Png if !format.is_banded(self.width, self.height) => png::encode(self, tags),
            Format::Png => bands::encode(self, format, tags),
            Format::Jpeg => jpeg::encode(self, recipe),
            Format::Ppm | Format::Tiff | Format::Exr => bands::encode(self, format, tags),
        }
    }

    /// Reads an EXR that [`Picture::encode`] or [`Fragment::encode`](super::Fragment::encode)
    /// made: the pixels inside its data window.
    ///
    /// # Errors
    /// Bytes that are no EXR, a damaged one, or one without RayCast's channels.
    pub fn decode_exr(bytes: &[u8]) -> Result<Self, ImageError> {
        exr_read::decode(bytes).map(|ImageFile { picture, .. }| picture)
    }
}

impl ImageFile {
    /// Reads a PNG, an EXR or a TIFF that [`Picture::encode`], [`Picture::encode_with`] or
    /// [`Fragment::encode`](super::Fragment::encode) made.
    ///
    /// # Errors
    /// Bytes that are none of them, damaged ones, an EXR without RayCast's channels, a PNG or a TIFF
    /// without 8-bit colours, a fragment whose pixels do not match their checksum.
    pub fn decode(bytes: &[u8]) -> Result<Self, ImageError> {
        if bytes.starts_with(b"\x89PNG") {
            png::decode(bytes)
        } else if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
            exr_read::decode(bytes)
        } else if tiff_read::is_tiff(bytes) {
            tiff_read::decode(bytes)
        } else {
            Err(ImageError::neither())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_that_disagree_with_themselves_are_refused() {
        let mut odd = Picture::blank(3, 2, true);
        odd.pixels.pop();
        let mut odd_layers = Picture::blank(3, 2, true);
        if let Some(layers) = &mut odd_layers.layers {
            layers.depth.pop();
        }
        for picture in [odd, odd_layers, Picture::blank(0, 2, true)] {
            for format in [
                Format::Png,
                Format::Ppm,
                Format::Jpeg,
                Format::Tiff,
                Format::Exr,
            ] {
                assert!(matches!(picture.encode(format), Err(ImageError::Encode(_))));
            }
        }
        let flat = Picture::blank(3, 2, false).encode(Format::Exr);
        assert!(matches!(flat, Err(ImageError::NoLayers)));
    }
}
