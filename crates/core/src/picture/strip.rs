//! A picture's tiles, split among workers.

use super::image::have_pixels;
use super::{LayerRow, Layers, Picture};
use crate::camera::{Grid, Rect};
use crate::num::simd::prefetch;
use std::ops::Range;

/// Adjacent tiles of a picture's row of tiles.
#[derive(Debug)]
pub struct Strip<'p> {
    /// Their rectangles, from left to right, of equal height.
    pub tiles: Vec<Rect>,
    /// The pixels of all of them, row by row.
    pub rows: Vec<&'p mut [[u8; 4]]>,
    /// The layers of these pixels, row by row; empty where the picture has none.
    pub layers: Vec<LayerRow<'p>>,
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
        let mut pixels = &mut *self.pixels;
        let rows = deal(&strips, |columns| {
            let columns = columns.min(pixels.len());
            pixels.split_off_mut(..columns).unwrap_or_default()
        });
        let layers = match &mut self.layers {
            Some(layers) => {
                let mut left = layers.all();
                deal(&strips, |columns| left.split_off(columns))
            }
            None => strips.iter().map(|_| Vec::new()).collect(),
        };
        (strips.into_iter().zip(rows).zip(layers))
            .map(|((tiles, rows), layers)| Strip {
                tiles,
                rows,
                layers,
            })
            .collect()
    }
}

impl Strip<'_> {
    /// The rows of a rectangle within the tiles, of their height.
    pub fn rows_of(&mut self, rect: Rect) -> impl Iterator<Item = &mut [[u8; 4]]> {
        part_of(&mut self.rows, columns(&self.tiles, rect))
    }

    /// The same rows, with their layers; none where the picture has no layers.
    pub(crate) fn layered_rows_of(
        &mut self,
        rect: Rect,
    ) -> impl Iterator<Item = (&mut [[u8; 4]], LayerRow<'_>)> {
        let columns = columns(&self.tiles, rect);
        let layers = self.layers.iter_mut();
        let layers = layers.map({
            let columns = columns.clone();
            move |row| row.part(columns.clone())
        });
        part_of(&mut self.rows, columns).zip(layers)
    }

    /// Copies the pixels of a rectangle within the tiles, of their height (and layers, where both have them).
    ///
    /// Returns `false`, without copying, where a list has a wrong length.
    pub fn paste(&mut self, rect: Rect, pixels: &[[u8; 4]], layers: Option<&Layers>) -> bool {
        if !have_pixels(rect, pixels, layers) {
            return false;
        }
        let columns = columns(&self.tiles, rect);
        let values = pixels.chunks_exact(columns.len().max(1));
        for (row, values) in part_of(&mut self.rows, columns.clone()).zip(values) {
            row.copy_from_slice(values);
        }
        if let Some(layers) = layers {
            for (row, mine) in self.layers.iter_mut().enumerate() {
                mine.copy(columns.start, layers, row * columns.len(), columns.len());
            }
        }
        true
    }
}

/// A rectangle's columns in the rows of tiles.
fn columns(tiles: &[Rect], rect: Rect) -> Range<usize> {
    let left = tiles.first().map_or(rect.x, |first| first.x);
    (rect.x - left) as usize..(rect.x - left + rect.width) as usize
}

/// How many rows ahead of the one that is written are fetched into the caches. A tile's rows lie on different pages of
/// memory, and a picture has more pages than a processor's TLB has entries: under flat light up to a third of shading
/// was waiting to write. With 4 rows more of the wait is left, with 16 as much as with 8.
const AHEAD: usize = 8;

/// Pixels of a cache line.
const LINE: usize = 64 / size_of::<[u8; 4]>();

/// Some columns of rows, where rows have them.
fn part_of<'r>(
    rows: &'r mut [&mut [[u8; 4]]],
    columns: Range<usize>,
) -> impl Iterator<Item = &'r mut [[u8; 4]]> {
    let fetch = {
        let columns = columns.clone();
        move |row: &[[u8; 4]]| {
            columns
                .clone()
                .step_by(LINE)
                .for_each(|at| prefetch(row, at))
        }
    };
    rows.iter().take(AHEAD).for_each(|row| fetch(row));
    let mut rows = rows.iter_mut();
    let rows = std::iter::from_fn(move || {
        let row = rows.next()?;
        if let Some(ahead) = rows.as_slice().get(AHEAD - 1) {
            fetch(ahead);
        }
        Some(row)
    });
    rows.filter_map(move |row| row.get_mut(columns.clone()))
}

/// Deals a picture's rows to strips: to each its columns of each row. `next` gives the next so many columns, row by row.
fn deal<R>(strips: &[Vec<Rect>], mut next: impl FnMut(usize) -> R) -> Vec<Vec<R>> {
    let mut all = Vec::with_capacity(strips.len());
    for band in strips.chunk_by(|one, next| one[0].y == next[0].y) {
        let first = all.len();
        let height = band[0][0].height as usize;
        all.extend(band.iter().map(|_| Vec::with_capacity(height)));
        for _ in 0..height {
            for (rows, tiles) in all[first..].iter_mut().zip(band) {
                let columns: u32 = tiles.iter().map(|tile| tile.width).sum();
                rows.push(next(columns as usize));
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
