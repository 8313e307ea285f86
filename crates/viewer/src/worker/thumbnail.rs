//! Parts of images, and small pictures of them.

use crate::state::thumbnail::{TexturePart, Thumbnail};
use raycast_core::scene::Texture;

/// The longest side of a thumbnail: sharp in the panel at a scale of two. A larger one takes longer to draw for the first
/// time.
const THUMBNAIL_SIDE: u32 = 512;

/// A part of an image; `None` where the image is smaller.
pub(super) fn part_of(image: Texture, TexturePart { crop, wrap }: TexturePart) -> Option<Texture> {
    let part = match crop {
        Some(crop) => image.cropped(crop)?,
        None => image,
    };
    Some(part.wrapped(wrap))
}

/// An image in at most [`THUMBNAIL_SIDE`] columns and rows.
pub(super) fn thumbnail(image: &Texture) -> Thumbnail {
    let of = (image.width(), image.height());
    let share = f64::from(THUMBNAIL_SIDE) / f64::from(of.0.max(of.1));
    let side = |side: u32| ((f64::from(side) * share.min(1.0)).round() as u32).max(1);
    let (columns, rows) = (side(of.0), side(of.1));
    let texels = image.texels().as_flattened();
    let small = image::ImageBuffer::<image::Rgba<u8>, _>::from_raw(of.0, of.1, texels)
        .map(|image| image::imageops::thumbnail(&image, columns, rows).into_raw())
        .unwrap_or_default();
    Thumbnail {
        of,
        size: [columns, rows].map(|side| side as usize),
        texels: small.as_chunks().0.to_vec(),
    }
}
