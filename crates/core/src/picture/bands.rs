//! Writing files in bands: pictures larger than memory.

use super::band::{Band, BandSizes, Source, length};
use super::file::Tags;
use super::fragment_position::FragmentPosition;
use super::{
    Format, ImageError, OutOfMemory, Picture, PixelDigest, Recipe, exr, opaque, png_bands, ppm,
    tiff,
};
use crate::camera::Rect;
use crate::digest::Digest;

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
    format: Format,
    size: (u32, u32),
    /// Rows of each band except the last.
    rows: u32,
    kind: Kind,
    /// Of a fragment: the full picture's recipe, and its position, with a placeholder for the pixels' checksum.
    fragment: Option<Box<(Recipe, FragmentPosition)>>,
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

    /// The bands of a fragment: a rectangle of the picture with this recipe.
    ///
    /// # Errors
    /// As [`Bands::new`]; formats that cannot store fragments; a rectangle outside the picture.
    pub fn of_fragment(format: Format, rect: Rect, recipe: &Recipe) -> Result<Self, ImageError> {
        if !matches!(format, Format::Png | Format::Exr) {
            return Err(ImageError::NotForFragments);
        }
        let plane = recipe.camera.plane();
        let position = FragmentPosition {
            full_size: (plane.columns, plane.rows),
            rect,
            recipe: recipe.digest(),
            pixels: Digest::of(&[]),
        };
        position.check().map_err(ImageError::Encode)?;
        let tags = Tags {
            recipe: Some(recipe),
            position: Some(&position),
        };
        let size = (rect.width, rect.height);
        let bands = Self::tagged(format, size, recipe.is_opaque(), tags)?;
        Ok(Self {
            fragment: Some(Box::new((*recipe, position))),
            ..bands
        })
    }

    /// A checksum that all rows of a fragment must be added to, for [`Bands::finish_fragment`]; `None` for a whole
    /// picture.
    pub fn pixel_digest(&self) -> Option<PixelDigest> {
        let has_layers = self.needs_layers();
        self.fragment.as_ref().map(|_| PixelDigest::new(has_layers))
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
            format,
            fragment: None,
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

    /// [`Bands::finish`] for a fragment, whose head stores the checksum of its pixels.
    ///
    /// # Errors
    /// As [`Bands::finish`].
    pub fn finish_fragment(
        &self,
        bands: &[BandSizes],
        pixels: PixelDigest,
    ) -> Result<(Vec<u8>, Vec<u8>), ImageError> {
        let Some((recipe, position)) = self.fragment.as_deref() else {
            return self.finish(bands);
        };
        let position = FragmentPosition {
            pixels: pixels.finish(),
            ..*position
        };
        let tags = Tags {
            recipe: Some(recipe),
            position: Some(&position),
        };
        let known = Self::tagged(self.format, self.size, recipe.is_opaque(), tags)?;
        let rows = self.rows;
        Self { rows, ..known }.finish(bands)
    }

    /// The file of a picture in memory.
    pub(super) fn encode_all(&self, picture: &Picture) -> Result<Vec<u8>, ImageError> {
        let mut file = self.head();
        let mut sizes = Vec::with_capacity(self.len());
        for index in 0..self.len() {
            let band = self.encode(index, picture, 0)?;
            let more = band.bytes.len();
            file.try_reserve(more)
                .map_err(|_| OutOfMemory { bytes: more as u64 })?;
            file.extend(band.bytes);
            sizes.push(band.sizes);
        }
        let (head, tail) = match self.pixel_digest() {
            Some(mut digest) => {
                digest.add(picture);
                self.finish_fragment(&sizes, digest)?
            }
            None => self.finish(&sizes)?,
        };
        file[..head.len()].copy_from_slice(&head);
        file.extend(tail);
        Ok(file)
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
    let size = (picture.width, picture.height);
    Bands::tagged(format, size, is_opaque, tags)?.encode_all(picture)
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::{cut_picture, sample_picture};
    use super::super::recipe::tests::sample_recipe;
    use super::super::{Fragment, Part, RowReader};
    use super::*;

    /// A file made of bands, each from a picture of its own rows only.
    fn by_bands(picture: &Picture, bands: &Bands) -> Vec<u8> {
        let (mut file, sizes) = by_bands_with(picture, bands, |_| {});
        let (head, tail) = bands.finish(&sizes).expect("all are there");
        file[..head.len()].copy_from_slice(&head);
        file.extend(tail);
        file
    }

    /// The placeholder of a file's head and its bands, with their sizes; `see` sees their rows.
    fn by_bands_with(
        picture: &Picture,
        bands: &Bands,
        mut see: impl FnMut(&Picture),
    ) -> (Vec<u8>, Vec<BandSizes>) {
        let mut file = bands.head();
        let mut sizes = Vec::new();
        for index in 0..bands.len() {
            let rect = bands.rect(index);
            let part = cut_picture(picture, rect);
            see(&part);
            let band = bands.encode(index, &part, rect.y).expect("encodes");
            assert_eq!(band.sizes.bytes(), band.bytes.len() as u64);
            assert_eq!(band, bands.encode(index, picture, 0).expect("encodes"));
            file.extend(band.bytes);
            sizes.push(band.sizes);
        }
        (file, sizes)
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
    fn a_fragment_in_bands_is_the_whole_ones_and_its_checksum_is_that_of_all_rows() {
        let rect = Rect {
            x: 20,
            y: 40,
            width: 30,
            height: 131,
        };
        let recipe = sample_recipe(300, 200);
        for format in [Format::Exr, Format::Png] {
            let picture = sample_picture(30, 131, format == Format::Exr);
            let mut bands = Bands::of_fragment(format, rect, &recipe).expect("bands");
            bands.rows = 32;
            let mut digest = bands.pixel_digest().expect("it is a fragment");
            let file = by_bands_with(&picture, &bands, |rows| digest.add(rows));
            let sizes = file.1;
            let (head, tail) = bands.finish_fragment(&sizes, digest).expect("all there");
            let mut file = file.0;
            file[..head.len()].copy_from_slice(&head);
            file.extend(tail);
            let fragment = Fragment {
                rect,
                recipe,
                picture: picture.clone(),
            };
            if format == Format::Exr {
                assert!(file == fragment.encode(format).expect("encodes"));
            }
            assert_eq!(Fragment::decode("a", &file).expect("decodes"), fragment);
            let open = |file: &[u8]| {
                RowReader::open(std::io::Cursor::new(file.to_vec()), file.len() as u64)
            };
            let mut reader = open(&file).expect("opens");
            let part = Part::check("a", &mut reader).expect("a fragment");
            assert_eq!(part, Part::new("a", &fragment));

            // Other pixels with the same head.
            let mut other = picture.clone();
            other.pixels[7 * 30] = [1, 2, 3, 4];
            if let Some(layers) = &mut other.layers {
                layers.uv[7 * 30] = [-5.0, 5.0];
            }
            let (mut damaged, _) = by_bands_with(&other, &bands, |_| {});
            damaged[..head.len()].copy_from_slice(&head);
            let tail = by_bands(&other, &bands).split_off(damaged.len());
            damaged.extend(tail);
            if format == Format::Exr {
                // Its table of offsets is in the head.
                damaged = by_bands(&other, &bands);
            }
            let error = open(&damaged).and_then(|mut reader| reader.rows(131));
            let error = error.expect_err("other pixels").to_string();
            assert!(error.contains("their checksum is another"), "{error}");
        }
        for format in [Format::Tiff, Format::Ppm, Format::Jpeg] {
            assert!(Bands::of_fragment(format, rect, &recipe).is_err());
        }
        let outside = Rect { x: 271, ..rect };
        assert!(Bands::of_fragment(Format::Png, outside, &recipe).is_err());
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
