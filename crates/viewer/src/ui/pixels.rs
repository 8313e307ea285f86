//! Copying rectangles of pixels: tiles into the picture, and parts of it to graphics memory.

use egui::{Color32, ColorImage};
use raycast_core::camera::Rect;
use raycast_core::render::Tile;

/// Whether tiles should be transferred one by one: each needs a copy and a call, while the whole picture is transferred
/// without a copy.
pub(super) fn few(rects: &[Rect], size: [usize; 2]) -> bool {
    let area: usize = rects.iter().map(Rect::area).sum();
    rects.len() <= 32 && area * 4 <= size[0] * size[1]
}

/// A copy of a rectangle of the picture.
pub(super) fn part(image: &ColorImage, rect: Rect) -> ColorImage {
    let width = image.width();
    let pixels = (rect.y as usize..rect.bottom() as usize)
        .flat_map(|y| &image.pixels[y * width + rect.x as usize..y * width + rect.right() as usize])
        .copied()
        .collect();
    ColorImage::new([rect.width as usize, rect.height as usize], pixels)
}

/// Swaps red and blue.
fn swapped(rgba: [u8; 4]) -> [u8; 4] {
    let pixel = u32::from_le_bytes(rgba);
    let others = pixel & 0xff00_ff00;
    (others | (pixel >> 16 & 0xff) | (pixel & 0xff) << 16).to_le_bytes()
}

/// Copies a tile into its place; returns `false`, without copying, if it does not fit.
pub(super) fn copy(image: &mut ColorImage, tile: &Tile, blue_first: bool) -> bool {
    let (width, height) = (image.width(), image.height());
    let rect = tile.rect;
    let columns = rect.width as usize;
    if columns == 0
        || tile.pixels.len() != rect.area()
        || rect.right() as usize > width
        || rect.bottom() as usize > height
    {
        return false;
    }
    for (y, row) in (rect.y as usize..).zip(tile.pixels.chunks_exact(columns)) {
        let start = y * width + rect.x as usize;
        let pixels = &mut image.pixels[start..start + columns];
        // Whole pixels as integers, which the compiler vectorises.
        let every = row
            .iter()
            .fold(u32::MAX, |every, &pixel| every & u32::from_le_bytes(pixel));
        if every >> 24 == 255 {
            for (pixel, &rgba) in pixels.iter_mut().zip(row) {
                let bytes = if blue_first { swapped(rgba) } else { rgba };
                let [first, green, third, alpha] = bytes;
                *pixel = Color32::from_rgba_premultiplied(first, green, third, alpha);
            }
        } else {
            for (pixel, &[r, g, b, a]) in pixels.iter_mut().zip(row) {
                let (r, b) = if blue_first { (b, r) } else { (r, b) };
                *pixel = Color32::from_rgba_unmultiplied(r, g, b, a);
            }
        }
    }
    true
}
