use super::place::Place;
use super::{ImageError, Picture, Recipe};
use crate::camera::Rect;

/// What an image file tells besides its pixels.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tags<'a> {
    /// What the picture was made of.
    pub(super) recipe: Option<&'a Recipe>,
    /// Of a fragment, its place.
    pub(super) place: Option<&'a Place>,
}

/// What a PNG or an EXR of RayCast's holds, whole or a fragment.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageFile {
    /// The pixels, with layers in an EXR.
    pub picture: Picture,
    /// What the picture was made of, where the file tells it.
    pub recipe: Option<Recipe>,
    /// Of a fragment, its place.
    pub(super) place: Option<Place>,
}

impl ImageFile {
    /// The file of these, if they agree with one another.
    pub(super) fn checked(
        picture: Picture,
        recipe: Option<Recipe>,
        place: Option<Place>,
    ) -> Result<Self, ImageError> {
        if let Some(place) = &place {
            place.check(&picture).map_err(ImageError::Decode)?;
            if recipe.is_none_or(|recipe| recipe.digest() != place.recipe) {
                return Err(ImageError::Decode(
                    "it does not tell what it was made of as it was written".to_owned(),
                ));
            }
            if picture.digest() != place.pixels {
                return Err(ImageError::Decode(
                    "its pixels are not those that were written: their checksum is another"
                        .to_owned(),
                ));
            }
        }
        Ok(Self {
            picture,
            recipe,
            place,
        })
    }

    /// Columns and rows of the whole picture: a fragment's, of the picture that it is part of.
    pub fn full_size(&self) -> (u32, u32) {
        let own = (self.picture.width, self.picture.height);
        self.place.map_or(own, |place| place.full_size)
    }

    /// The place of the pixels in the whole picture.
    pub fn rect(&self) -> Rect {
        let whole = Rect {
            x: 0,
            y: 0,
            width: self.picture.width,
            height: self.picture.height,
        };
        self.place.map_or(whole, |place| place.rect)
    }
}
