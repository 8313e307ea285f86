//! The split of a picture into tiles.

use raycast_core::camera::Rect;
use std::collections::HashMap;

/// A picture's tiles in reading order, and the index of each.
#[derive(Debug, Default)]
pub struct Layout {
    /// Columns and rows of the picture.
    pub size: (u32, u32),
    /// The tiles.
    pub tiles: Vec<Rect>,
    places: HashMap<(u32, u32), u32>,
}

impl Layout {
    /// The layout of these tiles.
    pub fn new(size: (u32, u32), tiles: Vec<Rect>) -> Self {
        let places = tiles
            .iter()
            .zip(0..)
            .map(|(rect, place)| ((rect.x, rect.y), place))
            .collect();
        Self {
            size,
            tiles,
            places,
        }
    }

    /// The index of the tile with this rectangle.
    pub fn place(&self, rect: Rect) -> Option<usize> {
        let place = *self.places.get(&(rect.x, rect.y))? as usize;
        (self.tiles[place] == rect).then_some(place)
    }
}
