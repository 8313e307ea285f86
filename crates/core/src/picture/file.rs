use super::fragment_position::FragmentPosition;
use super::{ImageError, Picture, PixelDigest, Recipe};
use crate::camera::Rect;

/// What an image file stores besides its pixels.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tags<'a> {
    /// The picture's recipe.
    pub(super) recipe: Option<&'a Recipe>,
    /// A fragment's position.
    pub(super) position: Option<&'a FragmentPosition>,
}

/// The contents of one of RayCast's PNG, EXR or TIFF files, a whole picture or a fragment.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageFile {
    /// The pixels, with layers in an EXR.
    pub picture: Picture,
    /// The picture's recipe, where the file stores it.
    pub recipe: Option<Recipe>,
    /// A fragment's position.
    pub(super) position: Option<FragmentPosition>,
}

impl ImageFile {
    /// The contents, if they are consistent.
    pub(super) fn checked(
        picture: Picture,
        recipe: Option<Recipe>,
        position: Option<FragmentPosition>,
    ) -> Result<Self, ImageError> {
        if let Some(position) = &position {
            let size = (picture.width, picture.height);
            (position.check_file(size, recipe.as_ref()))
                .and_then(|()| position.check_pixels(PixelDigest::of(&picture)))
                .map_err(ImageError::Decode)?;
        }
        Ok(Self {
            picture,
            recipe,
            position,
        })
    }

    /// Columns and rows of the full picture, also for a fragment.
    pub fn full_size(&self) -> (u32, u32) {
        let own = (self.picture.width, self.picture.height);
        self.position.map_or(own, |position| position.full_size)
    }

    /// The rectangle of the pixels in the full picture.
    pub fn rect(&self) -> Rect {
        let whole = Rect {
            x: 0,
            y: 0,
            width: self.picture.width,
            height: self.picture.height,
        };
        self.position.map_or(whole, |position| position.rect)
    }
}
