//! Writing files in bands: pictures larger than memory.

use super::band::{Band, BandSizes, Source, length};
use super::file::Tags;
use super::fragment_position::FragmentPosition;
use super::{Format, ImageError, OutOfMemory, Picture, Recipe, exr, opaque, png_bands, ppm, tiff};
use crate::camera::Rect;

/// The most pixels of a PNG that is encoded as one deflate stream. A larger one restarts the stream at each band,
/// which gives other bytes for the same pixels.
const WHOLE_PNG: u64 = 1 << 24;

/// The most pixels of a picture that is not worth splitting into bands.
const WHOLE: u64 = 1 << 21;

/// Pixels of a band, unless the format's least number of rows needs more: enough work for all threads, and little
/// memory compared with a scene.
const BAND: u64 = 1 << 21;

/// The message for formats that cannot be written in bands.
const NOT_BANDED: &str = "this kind of file is not written in bands";

impl Format {
    /// Whether [`Bands`] should write a picture of this size: memory is then the same for every size. The file's
    /// bytes are those of [`Picture::encode_with`] either way, where memory suffices for that.
    pub fn is_banded(self, columns: u32, rows: u32) -> bool {
        let pixels = u64::from(columns) * u64::from(rows);
        match self {
            Self::Png => pixels > WHOLE_PNG,
            Self::Ppm | Self::Tiff | Self::Exr => pixels > WHOLE,
            Self::Jpeg => false,
        }
    }
}

/// A picture's file in bands: rectangles as wide as the picture, one below the other, each encoded independently. The
/// file's head and tail follow from the bands' sizes.
///
/// ```
/// use raycast_core::picture::{Bands, Format, Picture};
///
/// let picture = Picture::blank(300, 200, false);
/// let bands = Bands::new(Format::Tiff, (300, 200), false, None)?;
/// let mut file = bands.head();
/// let mut sizes = Vec::new();
/// for index in 0..bands.len() {
///     let band = bands.encode(index, &picture, 0)?;
///     file.extend(&band.bytes);
///     sizes.push(band.sizes);
/// }
/// let (head, tail) = bands.finish(&sizes)?;
/// file[..head.len()].copy_from_slice(&head);
/// file.extend(tail);
/// assert_eq!(file, picture.encode(Format::Tiff)?);
/// # Ok::<(), raycast_core::picture::ImageError>(())
/// ```
#[derive(Debug)]
pub struct Bands {
    size: (u32, u32),
    /// Rows of each band except the last.
    rows: u32,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    Png(png_bands::Banded),
    Ppm,
    Tiff(tiff::Banded),
    Exr(Box<exr::Banded>),
}

impl Bands {
    /// The bands of a picture of this size. With a recipe, its background decides whether the file needs alpha;
    /// without one, `is_opaque` says whether every pixel covers what lies behind it.
    ///
    /// # Errors
    /// A side of zero pixels, or of more than the format can hold; [`Format::Jpeg`], which cannot be written in
    /// bands.
    pub fn new(
        format: Format,
        size: (u32, u32),
        is_opaque: bool,
        recipe: Option<&Recipe>,
    ) -> Result<Self, ImageError> {
        let tags = Tags {
            recipe,
            position: None,
        };
        Self::tagged(format, size, is_opaque, tags)
    }

    /// [`Bands::new`] for a whole picture or a fragment.
    pub(super) fn tagged(
        format: Format,
        size: (u32, u32),
        is_opaque: bool,
        tags: Tags<'_>,
    ) -> Result<Self, ImageError> {
        let (columns, rows) = size;
        if columns == 0 || rows == 0 {
            return Err(ImageError::Encode("it has no pixels".to_owned()));
        }
        let is_opaque = tags.recipe.map_or(is_opaque, Recipe::is_opaque);
        let kind = match format {
            Format::Png => Kind::Png(png_bands::Banded::new(size, is_opaque, tags)?),
            Format::Ppm => Kind::Ppm,
            Format::Tiff => Kind::Tiff(tiff::Banded::new(size, is_opaque, tags.recipe)?),
            Format::Exr => {
                let whole = tags
                    .position
                    .map_or(size, |position: &FragmentPosition| position.full_size);
                let pixels = u64::from(whole.0) * u64::from(whole.1);
                // Sizes up to this one are encoded whole, and their bytes must stay what they were.
                let is_tiled = pixels > WHOLE_PNG && tags.position.is_none();
                Kind::Exr(Box::new(exr::Banded::new(size, is_tiled, tags)?))
            }
            Format::Jpeg => return Err(ImageError::Encode(NOT_BANDED.to_owned())),
        };
        let least = match &kind {
            Kind::Png(_) | Kind::Ppm => 64,
            Kind::Tiff(_) => tiff::TILE,
            Kind::Exr(_) => exr::BAND_ROWS,
        };
        let most = BAND / u64::from(columns) / u64::from(least) * u64::from(least);
        Ok(Self {
            size,
            rows: most.clamp(least.into(), 1 << 16) as u32,
            kind,
        })
    }

    /// The number of bands.
    #[allow(clippy::len_without_is_empty, reason = "there is one at least")]
    pub fn len(&self) -> usize {
        self.size.1.div_ceil(self.rows) as usize
    }

    /// A band's rectangle of the picture. `index` < [`Bands::len`].
    pub fn rect(&self, index: usize) -> Rect {
        let (width, height) = self.size;
        let y = (index as u32).saturating_mul(self.rows).min(height);
        Rect {
            x: 0,
            y,
            width,
            height: self.rows.min(height - y),
        }
    }

    /// Whether encoding needs the picture's layers.
    pub fn needs_layers(&self) -> bool {
        matches!(self.kind, Kind::Exr(_))
    }

    /// A placeholder for the file's start until all bands are encoded, of the same length as the head that
    /// [`Bands::finish`] gives.
    pub fn head(&self) -> Vec<u8> {
        match &self.kind {
            Kind::Png(png) => png.head(),
            Kind::Ppm => ppm::head(self.size),
            Kind::Tiff(tiff) => tiff.head(&[]),
            Kind::Exr(exr) => exr.head(&[]),
        }
    }

    /// Encodes a band of a picture that starts at row `first` of the whole and has all of the band's rows. It runs in
    /// parallel on rayon's current pool; the bytes do not depend on the pool.
    ///
    /// # Errors
    /// A picture without those rows, or without layers where the format needs them; memory.
    pub fn encode(&self, index: usize, picture: &Picture, first: u32) -> Result<Band, ImageError> {
        picture.check()?;
        let rect = self.rect(index);
        let has = |y: u32| (first..=first.saturating_add(picture.height)).contains(&y);
        if picture.width != rect.width || !has(rect.y) || !has(rect.bottom()) {
            return Err(ImageError::Encode(format!(
                "rows {} to {} are not in it",
                rect.y,
                rect.bottom()
            )));
        }
        let source = Source {
            picture,
            rect,
            first,
        };
        match &self.kind {
            Kind::Png(png) => png.encode(source),
            Kind::Ppm => {
                let bytes = opaque::over_black(&[], source.pixels())?;
                let parts = vec![length(&bytes)?];
                Ok(Band {
                    bytes,
                    sizes: BandSizes { parts, check: 0 },
                })
            }
            Kind::Tiff(tiff) => tiff.encode(source),
            Kind::Exr(exr) => exr.encode(source),
        }
    }

    /// The file's head and tail, once all bands are encoded. The head replaces [`Bands::head`] where it differs from
    /// that (in TIFF and EXR).
    ///
    /// # Errors
    /// A wrong number of bands or parts.
    pub fn finish(&self, bands: &[BandSizes]) -> Result<(Vec<u8>, Vec<u8>), ImageError> {
        let is_known = bands.len() == self.len()
            && (bands.iter().enumerate()).all(|(i, band)| band.parts.len() == self.parts(i));
        if !is_known {
            return Err(ImageError::Encode("some bands are missing".to_owned()));
        }
        let parts = || bands.iter().flat_map(|band| band.parts.iter().copied());
        Ok(match &self.kind {
            Kind::Png(png) => {
                let checks = bands.iter().enumerate().map(|(i, band)| {
                    let rect = self.rect(i);
                    (band.check, png.filtered_bytes(rect))
                });
                (png.head(), png.tail(checks)?)
            }
            Kind::Ppm => (self.head(), Vec::new()),
            Kind::Tiff(tiff) => (tiff.head(&parts().collect::<Vec<_>>()), Vec::new()),
            Kind::Exr(exr) => (exr.head(&parts().collect::<Vec<_>>()), Vec::new()),
        })
    }

    /// The number of parts of a band.
    pub fn parts(&self, index: usize) -> usize {
        let rect = self.rect(index);
        match &self.kind {
            Kind::Png(_) | Kind::Ppm => 1,
            Kind::Tiff(_) => tiff::tiles(rect),
            Kind::Exr(exr) => exr.blocks(rect),
        }
    }

    /// An upper bound of the memory that a band takes, from its rays to its encoded bytes.
    pub fn memory(&self) -> u64 {
        let pixels = u64::from(self.size.0) * u64::from(self.rows.min(self.size.1));
        let (values, file) = if self.needs_layers() {
            (52, 48)
        } else {
            (4, 4)
        };
        // The file counts twice: a part before compression, and the compressed part.
        pixels * (values + 2 * file)
    }
}

/// A whole picture's file, encoded in bands.
pub(super) fn encode(
    picture: &Picture,
    format: Format,
    tags: Tags<'_>,
) -> Result<Vec<u8>, ImageError> {
    let is_opaque = picture.pixels.iter().all(|pixel| pixel[3] == u8::MAX);
    let bands = Bands::tagged(format, (picture.width, picture.height), is_opaque, tags)?;
    let mut file = bands.head();
    let mut sizes = Vec::with_capacity(bands.len());
    for index in 0..bands.len() {
        let band = bands.encode(index, picture, 0)?;
        let more = band.bytes.len();
        file.try_reserve(more)
            .map_err(|_| OutOfMemory { bytes: more as u64 })?;
        file.extend(band.bytes);
        sizes.push(band.sizes);
    }
    let (head, tail) = bands.finish(&sizes)?;
    file[..head.len()].copy_from_slice(&head);
    file.extend(tail);
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::sample_picture;
    use super::*;

    /// A file made of bands, each from a picture of its own rows only.
    fn by_bands(picture: &Picture, bands: &Bands) -> Vec<u8> {
        let mut file = bands.head();
        let mut sizes = Vec::new();
        for index in 0..bands.len() {
            let rect = bands.rect(index);
            let part = cut(picture, rect);
            let band = bands.encode(index, &part, rect.y).expect("encodes");
            assert_eq!(band.sizes.bytes(), band.bytes.len() as u64);
            assert_eq!(band, bands.encode(index, picture, 0).expect("encodes"));
            file.extend(band.bytes);
            sizes.push(band.sizes);
        }
        let (head, tail) = bands.finish(&sizes).expect("all are there");
        file[..head.len()].copy_from_slice(&head);
        file.extend(tail);
        file
    }

    fn cut(picture: &Picture, rect: Rect) -> Picture {
        let all = Rect {
            x: 0,
            y: 0,
            width: picture.width,
            height: picture.height,
        };
        assert_eq!(rect.width, all.width);
        let range =
            rect.y as usize * all.width as usize..rect.bottom() as usize * all.width as usize;
        Picture {
            width: rect.width,
            height: rect.height,
            pixels: picture.pixels[range.clone()].to_vec(),
            layers: picture.layers.as_ref().map(|layers| super::super::Layers {
                color: layers.color[range.clone()].to_vec(),
                depth: layers.depth[range.clone()].to_vec(),
                object: layers.object[range.clone()].to_vec(),
                triangle: layers.triangle[range.clone()].to_vec(),
                normal: layers.normal[range.clone()].to_vec(),
                uv: layers.uv[range].to_vec(),
            }),
        }
    }

    #[test]
    fn bands_of_rows_alone_make_the_whole_files_bytes() {
        let picture = sample_picture(300, 531, true);
        for format in [Format::Ppm, Format::Tiff, Format::Exr] {
            let mut bands = Bands::new(format, (300, 531), false, None).expect("bands");
            bands.rows = match format {
                Format::Ppm => 64,
                Format::Tiff => 256,
                _ => 32,
            };
            assert!(bands.len() > 2);
            assert!(by_bands(&picture, &bands) == picture.encode(format).expect("encodes"));
        }
    }

    #[test]
    fn a_png_in_bands_has_the_pixels_of_the_whole_one() {
        for (is_opaque, width) in [(false, 300), (true, 300), (true, 1)] {
            let mut picture = sample_picture(width, 531, false);
            if is_opaque {
                picture.pixels.iter_mut().for_each(|pixel| pixel[3] = 255);
            }
            let size = (width, 531);
            let mut bands = Bands::new(Format::Png, size, is_opaque, None).expect("bands");
            for rows in [64, 192, 1024] {
                bands.rows = rows;
                let file = by_bands(&picture, &bands);
                // The truth is another decoder, which checks every checksum.
                let other = image::load_from_memory(&file).expect("decodes").to_rgba8();
                assert!(other.as_raw() == picture.pixels.as_flattened());
            }
        }
    }

    #[test]
    fn rows_that_are_not_there_and_bands_that_are_missing_are_errors() {
        let picture = sample_picture(30, 100, true);
        for format in [Format::Png, Format::Ppm, Format::Tiff, Format::Exr] {
            let bands = Bands::new(format, (30, 200), true, None).expect("bands");
            assert!(bands.encode(0, &picture, 0).is_err());
            assert!(bands.encode(0, &picture, 150).is_err());
            assert!(bands.finish(&[]).is_err());
            assert!(
                bands
                    .finish(&[BandSizes {
                        parts: vec![1; 99],
                        check: 0
                    }])
                    .is_err()
            );
        }
        assert!(Bands::new(Format::Jpeg, (30, 200), true, None).is_err());
        assert!(Bands::new(Format::Png, (0, 200), true, None).is_err());
    }

    #[test]
    fn a_band_takes_little_memory_whatever_the_size() {
        for format in [Format::Png, Format::Ppm, Format::Tiff, Format::Exr] {
            for size in [
                (65_536, 65_536),
                (65_536, 32_768),
                (4097, 4097),
                (65_536, 257),
            ] {
                let bands = Bands::new(format, size, true, None).expect("bands");
                assert!(bands.memory() < 330_000_000, "{format:?} {size:?}");
            }
        }
    }
}
