//! A picture's tiles, split among workers.

use super::image::have_pixels;
use super::{Layers, Picture};
use crate::camera::{Grid, Rect};
use std::ops::Range;

/// Adjacent tiles of a picture's row of tiles.
#[derive(Debug)]
pub struct Strip<'p> {
    /// Their rectangles, from left to right, of equal height.
    pub tiles: Vec<Rect>,
    /// The pixels of all of them, row by row.
    pub rows: Vec<&'p mut [[u8; 4]]>,
    layers: Option<LayerRows<'p>>,
}

/// The rows of a strip's [`Layers`].
#[derive(Debug)]
struct LayerRows<'p> {
    color: Vec<&'p mut [[f32; 4]]>,
    depth: Vec<&'p mut [f32]>,
    object: Vec<&'p mut [u32]>,
    triangle: Vec<&'p mut [u32]>,
    normal: Vec<&'p mut [[f32; 3]]>,
    uv: Vec<&'p mut [[f32; 2]]>,
}

impl Picture {
    /// Splits the picture into strips of a grid's tiles, for workers that fill them in parallel: every tile once, in
    /// the order of [`Grid::tiles`]. `most` gives the largest number of tiles of a strip when so many tiles are left.
    pub fn strips(&mut self, grid: Grid, most: impl Fn(usize) -> usize) -> Vec<Strip<'_>> {
        let (across, _) = grid.counts(self.width, self.height);
        let tiles = grid.tiles(self.width, self.height);
        let mut strips: Vec<Vec<Rect>> = Vec::new();
        let mut left = tiles.len();
        for band in tiles.chunks(across.max(1) as usize) {
            let most = most(left).max(1);
            left -= band.len();
            strips.extend(band.chunks(most).map(<[_]>::to_vec));
        }
        let rows = deal(&mut self.pixels, &strips);
        let mut layers = (self.layers.as_mut())
            .map(|layers| LayerRows::deal(layers, &strips))
            .into_iter()
            .flatten();
        (strips.into_iter().zip(rows))
            .map(|(tiles, rows)| Strip {
                tiles,
                rows,
                layers: layers.next(),
            })
            .collect()
    }
}

impl Strip<'_> {
    /// The rows of a rectangle within the tiles, of their height.
    pub fn rows_of(&mut self, rect: Rect) -> impl Iterator<Item = &mut [[u8; 4]]> {
        part_of(&mut self.rows, columns(&self.tiles, rect))
    }

    /// Copies the pixels of a rectangle within the tiles, of their height (and layers, where both have them).
    ///
    /// Returns `false`, without copying, where a list has a wrong length.
    pub fn paste(&mut self, rect: Rect, pixels: &[[u8; 4]], layers: Option<&Layers>) -> bool {
        if !have_pixels(rect, pixels, layers) {
            return false;
        }
        let columns = columns(&self.tiles, rect);
        copy_rows(&mut self.rows, &columns, pixels);
        if let (Some(mine), Some(theirs)) = (&mut self.layers, layers) {
            copy_rows(&mut mine.color, &columns, &theirs.color);
            copy_rows(&mut mine.depth, &columns, &theirs.depth);
            copy_rows(&mut mine.object, &columns, &theirs.object);
            copy_rows(&mut mine.triangle, &columns, &theirs.triangle);
            copy_rows(&mut mine.normal, &columns, &theirs.normal);
            copy_rows(&mut mine.uv, &columns, &theirs.uv);
        }
        true
    }
}

/// A rectangle's columns in the rows of tiles.
fn columns(tiles: &[Rect], rect: Rect) -> Range<usize> {
    let left = tiles.first().map_or(rect.x, |first| first.x);
    (rect.x - left) as usize..(rect.x - left + rect.width) as usize
}

/// Some columns of rows, where rows have them.
fn part_of<'r, T>(
    rows: &'r mut [&mut [T]],
    columns: Range<usize>,
) -> impl Iterator<Item = &'r mut [T]> {
    (rows.iter_mut()).filter_map(move |row| row.get_mut(columns.clone()))
}

/// Copies values, row by row, into some columns of rows.
fn copy_rows<T: Copy>(rows: &mut [&mut [T]], columns: &Range<usize>, values: &[T]) {
    let values = values.chunks_exact(columns.len().max(1));
    for (row, values) in part_of(rows, columns.clone()).zip(values) {
        row.copy_from_slice(values);
    }
}

impl<'p> LayerRows<'p> {
    /// Those of each strip.
    fn deal(layers: &'p mut Layers, strips: &[Vec<Rect>]) -> impl Iterator<Item = Self> + use<'p> {
        let Layers {
            color,
            depth,
            object,
            triangle,
            normal,
            uv,
        } = layers;
        let numbers = deal(object, strips).into_iter().zip(deal(triangle, strips));
        let vectors = deal(normal, strips).into_iter().zip(deal(uv, strips));
        let lights = deal(color, strips).into_iter().zip(deal(depth, strips));
        lights.zip(numbers).zip(vectors).map(
            |(((color, depth), (object, triangle)), (normal, uv))| Self {
                color,
                depth,
                object,
                triangle,
                normal,
                uv,
            },
        )
    }
}

/// Deals a picture's values, row by row: to each strip its columns of each row.
fn deal<'p, T>(mut values: &'p mut [T], strips: &[Vec<Rect>]) -> Vec<Vec<&'p mut [T]>> {
    let mut all = Vec::with_capacity(strips.len());
    for band in strips.chunk_by(|one, next| one[0].y == next[0].y) {
        let first = all.len();
        let height = band[0][0].height as usize;
        all.extend(band.iter().map(|_| Vec::with_capacity(height)));
        for _ in 0..height {
            for (rows, tiles) in all[first..].iter_mut().zip(band) {
                let columns: u32 = tiles.iter().map(|tile| tile.width).sum();
                let columns = (columns as usize).min(values.len());
                let (row, after) = std::mem::take(&mut values).split_at_mut(columns);
                rows.push(row);
                values = after;
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::fragment::tests::{cut_picture, sample_picture};

    #[test]
    fn tiles_pasted_into_strips_are_the_picture() {
        for (width, height) in [(23, 17), (8, 8), (1, 30)] {
            for (grid, most) in [(8, 1), (8, 2), (5, 99), (64, 3)] {
                for has_layers in [false, true] {
                    let whole = sample_picture(width, height, has_layers);
                    let mut pasted = Picture::blank(width, height, has_layers);
                    for mut strip in pasted.strips(Grid::Size(grid), |_| most) {
                        assert!((1..=most).contains(&strip.tiles.len()));
                        for tile in strip.tiles.clone() {
                            let part = cut_picture(&whole, tile);
                            assert!(strip.paste(tile, &part.pixels, part.layers.as_ref()));
                        }
                    }
                    assert_eq!(pasted, whole, "{width} {height} {grid} {most}");
                }
            }
        }
    }

    #[test]
    fn lists_of_another_length_are_not_pasted() {
        let whole = sample_picture(9, 4, true);
        let mut blank = Picture::blank(9, 4, true);
        for mut strip in blank.strips(Grid::Size(64), |_| 1) {
            let tile = strip.tiles[0];
            assert!(!strip.paste(tile, &whole.pixels[1..], None));
            let mut layers = whole.layers.clone().expect("layers");
            layers.normal.pop();
            assert!(!strip.paste(tile, &whole.pixels, Some(&layers)));
        }
        assert_eq!(blank, Picture::blank(9, 4, true));
    }
}
