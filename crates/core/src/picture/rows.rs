use super::fragment_position::FragmentPosition;
use super::{ImageError, Picture, PixelDigest, Recipe, exr_read, png, tiff_read};
use crate::camera::Rect;
use std::io::{BufRead, Seek};

/// Reads one of RayCast's PNG, EXR or TIFF files, a whole picture or a fragment, from the top, some rows at a time: for
/// pictures larger than memory.
pub struct RowReader<R: BufRead + Seek> {
    kind: Kind<R>,
    recipe: Option<Recipe>,
    position: Option<FragmentPosition>,
    /// The checksum of a fragment's rows so far.
    digest: Option<PixelDigest>,
    /// The number of rows read.
    read: u32,
}

enum Kind<R: BufRead + Seek> {
    Png(Box<png::Reader<R>>),
    Exr(Box<exr_read::Reader<R>>),
    Tiff(Box<tiff_read::Reader<R>>),
}

impl<R: BufRead + Seek> RowReader<R> {
    /// Opens a file of `length` bytes.
    ///
    /// # Errors
    /// Bytes that are neither PNG nor EXR nor TIFF, or of other channels; a damaged recipe or position; a fragment whose
    /// position or recipe is not the file's.
    pub fn open(mut read: R, length: u64) -> Result<Self, ImageError> {
        let begin = read
            .fill_buf()
            .map_err(|error| ImageError::Decode(error.to_string()))?;
        let (kind, recipe, position) = if begin.starts_with(b"\x89PNG") {
            let png = png::Reader::open(read, length)?;
            let (recipe, position) = (png.recipe()?, png.position()?);
            (Kind::Png(Box::new(png)), recipe, position)
        } else if begin.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
            let exr = exr_read::Reader::open(read, length)?;
            let (recipe, position) = (exr.recipe()?, exr.position()?);
            (Kind::Exr(Box::new(exr)), recipe, position)
        } else if tiff_read::is_tiff(begin) {
            let tiff = tiff_read::Reader::open(read, length)?;
            let recipe = tiff.recipe().cloned();
            (Kind::Tiff(Box::new(tiff)), recipe, None)
        } else {
            return Err(ImageError::neither());
        };
        let mut reader = Self {
            kind,
            recipe,
            position,
            digest: None,
            read: 0,
        };
        if let Some(position) = &reader.position {
            position
                .check_file(reader.size(), reader.recipe())
                .map_err(ImageError::Decode)?;
            reader.digest = Some(PixelDigest::new(reader.has_layers()));
        }
        Ok(reader)
    }

    /// Columns and rows of the file's own pixels.
    pub fn size(&self) -> (u32, u32) {
        match &self.kind {
            Kind::Png(png) => png.size(),
            Kind::Exr(exr) => exr.size(),
            Kind::Tiff(tiff) => tiff.size(),
        }
    }

    /// Columns and rows of the full picture, also for a fragment.
    pub fn full_size(&self) -> (u32, u32) {
        self.position
            .map_or(self.size(), |position| position.full_size)
    }

    /// The rectangle of its pixels in the full picture.
    pub fn rect(&self) -> Rect {
        let (width, height) = self.size();
        let whole = Rect {
            x: 0,
            y: 0,
            width,
            height,
        };
        self.position.map_or(whole, |position| position.rect)
    }

    /// The picture's recipe, where the file stores it.
    pub fn recipe(&self) -> Option<&Recipe> {
        self.recipe.as_ref()
    }

    /// Whether the file has layers, as an EXR.
    pub fn has_layers(&self) -> bool {
        matches!(self.kind, Kind::Exr(_))
    }

    /// Whether it is a fragment, which stores its position in a full picture.
    pub fn is_fragment(&self) -> bool {
        self.position.is_some()
    }

    /// The next `most` rows, or those that are left.
    ///
    /// # Errors
    /// A file that is damaged or ends early; with a fragment's last rows, pixels that are not those of its checksum;
    /// memory.
    pub fn rows(&mut self, most: u32) -> Result<Picture, ImageError> {
        let (_, height) = self.size();
        let rows = most.min(height - self.read);
        let picture = match &mut self.kind {
            Kind::Png(png) => png.rows(rows)?,
            Kind::Exr(exr) => exr.rows(rows)?,
            Kind::Tiff(tiff) => tiff.rows(rows)?,
        };
        self.read += rows;
        if let Some(digest) = &mut self.digest {
            digest.add(&picture);
        }
        if self.read == height
            && let (Some(digest), Some(position)) = (self.digest.take(), &self.position)
        {
            (position.check_pixels(digest.finish())).map_err(ImageError::Decode)?;
        }
        if let Kind::Png(png) = &mut self.kind
            && self.read == height
            && rows > 0
        {
            png.finish()?;
        }
        Ok(picture)
    }
}

#[cfg(test)]
mod tests {
    use super::super::fragment::tests::sample_picture;
    use super::super::{Bands, Format};
    use super::*;
    use std::io::Cursor;

    #[test]
    fn rows_are_those_of_the_whole() {
        for format in [Format::Png, Format::Exr, Format::Tiff] {
            let picture = sample_picture(37, 101, format == Format::Exr);
            let bytes = picture.encode(format).expect("encodes");
            for most in [1, 5, 16, 32, 33, 101, 1000] {
                let read = Cursor::new(&bytes);
                let mut reader = RowReader::open(read, bytes.len() as u64).expect("opens");
                assert_eq!((reader.size(), reader.full_size()), ((37, 101), (37, 101)));
                let mut back = Picture::blank(37, 101, reader.has_layers());
                let mut y = 0;
                while y < 101 {
                    let rows = reader.rows(most).expect("reads");
                    let rect = Rect {
                        x: 0,
                        y,
                        width: 37,
                        height: rows.height,
                    };
                    assert!(back.paste(rect, &rows.pixels, rows.layers.as_ref()));
                    y += rows.height;
                }
                assert_eq!(reader.rows(most).expect("nothing is left").height, 0);
                assert!(back == picture, "{format:?} {most}");
            }
            for length in (0..bytes.len() - 1).step_by(499) {
                let read = Cursor::new(&bytes[..length]);
                let rows = RowReader::open(read, length as u64).and_then(|mut file| file.rows(101));
                assert!(rows.is_err(), "{format:?} cut to {length}");
            }
        }
    }

    #[test]
    fn a_tiled_exr_is_read_as_it_was_written() {
        // One row more than pictures have that are written in blocks of rows.
        let (columns, rows) = (65_536, 257);
        let mut picture = Picture::blank(columns, rows, true);
        let last = picture.pixels.len() - 1;
        let layers = picture.layers.as_mut().expect("layers");
        for (i, at) in [(0usize, 7u32), (last / 2, 8), (last, 9)] {
            layers.triangle[i] = at;
            layers.normal[i] = [0.0, at as f32, 1.0];
        }
        let bands = Bands::new(Format::Exr, (columns, rows), true, None).expect("bands");
        assert!(
            bands.parts(0) == 512 && bands.len() == 9,
            "tiles of 128 x 32"
        );
        let bytes = picture.encode(Format::Exr).expect("encodes");
        let read = Cursor::new(&bytes);
        let mut reader = RowReader::open(read, bytes.len() as u64).expect("opens");
        let mut at = 0;
        let layers = picture.layers.as_ref().expect("layers");
        while at <= last {
            let band = reader.rows(32).expect("reads");
            let band = band.layers.expect("layers");
            let all = at..at + band.triangle.len();
            assert!(band.triangle == layers.triangle[all.clone()]);
            assert!(band.normal == layers.normal[all]);
            at += band.triangle.len();
        }
    }
}
