use super::{ImageError, Recipe};
use crate::camera::{Rect, SIDE_LIMIT};
use crate::digest::Digest;
use std::fmt;
use std::str::FromStr;

/// A fragment's position, as its file stores it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FragmentPosition {
    pub(super) full_size: (u32, u32),
    pub(super) rect: Rect,
    /// The recipe's digest.
    pub(super) recipe: Digest,
    /// The pixels' digest.
    pub(super) pixels: Digest,
}

impl FragmentPosition {
    /// Whether the rectangle is inside the full picture.
    pub(super) fn check(&self) -> Result<(), String> {
        check_rect(self.full_size, self.rect)
    }

    /// Whether the file has as many pixels as the rectangle, which is inside the full picture, and the full picture's
    /// recipe.
    pub(super) fn check_file(
        &self,
        size: (u32, u32),
        recipe: Option<&Recipe>,
    ) -> Result<(), String> {
        check_size(self.rect, size)?;
        self.check()?;
        match recipe {
            Some(recipe) if recipe.digest() == self.recipe => Ok(()),
            _ => Err("it does not say what it was made of as it was written".to_owned()),
        }
    }

    /// Whether these are the pixels that were written.
    pub(super) fn check_pixels(&self, pixels: Digest) -> Result<(), String> {
        match pixels == self.pixels {
            true => Ok(()),
            false => Err(
                "its pixels are not those that were written: their checksum is another".to_owned(),
            ),
        }
    }
}

/// Whether a file of this size has as many pixels as its rectangle.
pub(super) fn check_size(rect: Rect, (columns, rows): (u32, u32)) -> Result<(), String> {
    let Rect { width, height, .. } = rect;
    match (width, height) == (columns, rows) {
        true => Ok(()),
        false => Err(format!(
            "its position is {width} x {height}, but it has {columns} x {rows} pixels"
        )),
    }
}

/// Whether a rectangle is inside the full picture.
pub(super) fn check_rect((columns, rows): (u32, u32), rect: Rect) -> Result<(), String> {
    let Rect {
        x,
        y,
        width,
        height,
    } = rect;
    let inside = u64::from(x) + u64::from(width) <= u64::from(columns)
        && u64::from(y) + u64::from(height) <= u64::from(rows);
    if !inside || columns.max(rows) > SIDE_LIMIT {
        return Err(format!(
            "{width} x {height} pixels at ({x}, {y}) are not in a picture of {columns} x {rows}"
        ));
    }
    Ok(())
}

impl FragmentPosition {
    /// `full 1280 720 rect 64 0 64 64 recipe DIGEST pixels DIGEST`.
    pub(super) fn text(&self) -> String {
        let (columns, rows) = self.full_size;
        let Rect {
            x,
            y,
            width,
            height,
        } = self.rect;
        format!(
            "full {columns} {rows} rect {x} {y} {width} {height} recipe {} pixels {}",
            self.recipe, self.pixels
        )
    }
}

impl fmt::Display for FragmentPosition {
    /// [`FragmentPosition::text`] and a checksum of it, as of all else in the file: `… check DIGEST`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = self.text();
        write!(f, "{words} check {}", Digest::of(words.as_bytes()))
    }
}

impl FromStr for FragmentPosition {
    type Err = ImageError;

    fn from_str(text: &str) -> Result<Self, ImageError> {
        let expected = || ImageError::Decode(format!("its position reads {text:?}"));
        let words: Vec<&str> = text.split(' ').collect();
        let [
            "full",
            columns,
            rows,
            "rect",
            x,
            y,
            width,
            height,
            "recipe",
            recipe,
            "pixels",
            pixels,
            "check",
            _,
        ] = words[..]
        else {
            return Err(expected());
        };
        let number = |word: &str| word.parse::<u32>().map_err(|_| expected());
        let position = Self {
            full_size: (number(columns)?, number(rows)?),
            rect: Rect {
                x: number(x)?,
                y: number(y)?,
                width: number(width)?,
                height: number(height)?,
            },
            recipe: recipe.parse().map_err(|_| expected())?,
            pixels: pixels.parse().map_err(|_| expected())?,
        };
        // The only text of a position: another is damaged.
        if position.to_string() != text {
            return Err(ImageError::Decode(
                "its position is not the one that was written: its checksum is another".to_owned(),
            ));
        }
        Ok(position)
    }
}
