//! Images that RayCast wrote, read whole or by rows.

use crate::failure::Failure;
use raycast_core::camera::Rect;
use raycast_core::formats;
use raycast_core::picture::{ImageError, ImageFile, Recipe, RowReader};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// The most pixels of an image that are read, or rendered, at once.
pub(super) const WHOLE: u64 = 1 << 21;

/// An image that RayCast wrote.
pub(super) enum Image<'a> {
    /// A small image, read whole.
    Whole(Box<ImageFile>),
    /// Read from the top; the path is for errors.
    Rows(&'a Path, Box<RowReader<BufReader<File>>>),
}

impl Image<'_> {
    pub(super) fn full_size(&self) -> (u32, u32) {
        match self {
            Self::Whole(image) => image.full_size(),
            Self::Rows(_, reader) => reader.full_size(),
        }
    }

    pub(super) fn rect(&self) -> Rect {
        match self {
            Self::Whole(image) => image.rect(),
            Self::Rows(_, reader) => reader.rect(),
        }
    }

    pub(super) fn recipe(&self) -> Option<&Recipe> {
        match self {
            Self::Whole(image) => image.recipe.as_ref(),
            Self::Rows(_, reader) => reader.recipe(),
        }
    }
}

/// Opens an image that RayCast wrote, whole or a fragment.
pub(super) fn read(path: &Path) -> Result<Image<'_>, Failure> {
    let cannot = |error: std::io::Error| Failure::could_not(format!("{}: {error}", path.display()));
    let file = formats::open_regular(path)?;
    let length = file.metadata().map_err(cannot)?.len();
    let reader = RowReader::open(BufReader::new(file), length);
    let reader = reader.map_err(|error| cannot_read(path, &error))?;
    let (columns, rows) = reader.size();
    if u64::from(columns) * u64::from(rows) > WHOLE {
        return Ok(Image::Rows(path, Box::new(reader)));
    }
    let image = ImageFile::decode(&std::fs::read(path).map_err(cannot)?);
    let image = image.map_err(|error| cannot_read(path, &error))?;
    Ok(Image::Whole(Box::new(image)))
}

pub(super) fn cannot_read(path: &Path, error: &ImageError) -> Failure {
    Failure::could_not(format!("{}: {error}", path.display()))
}
