//! The picture's pixels in memory, and their copy in graphics memory.

use crate::ui::pixels::{copy, few, part};
use crate::ui::present::{Dirty, Presenter};
use crate::ui::theme;
use egui::{Color32, ColorImage, TextureHandle, TextureOptions};
use raycast_core::camera::Rect;
use raycast_core::render::Tile;
use std::sync::Arc;

/// Nearest: each ray of a coarse picture shows as a block.
const OPTIONS: TextureOptions = TextureOptions::NEAREST;

/// How the picture is shown in this frame.
#[derive(Clone, Copy, Default)]
enum Shown {
    /// Not at all.
    #[default]
    Not,
    /// By the [`Presenter`].
    Copied,
    /// As a texture.
    Painted,
}

/// The picture's pixels, which of them are new, and how they are shown.
#[derive(Default)]
pub(super) struct Surface {
    pub(super) image: Arc<ColorImage>,
    /// Whether blue comes first in pixels, for the [`Presenter`], rather than red.
    blue_first: bool,
    presenter: Option<Presenter>,
    texture: Option<TextureHandle>,
    pub(super) dirty: Dirty,
    shown: Shown,
}

impl Surface {
    /// A surface without pixels, shown by the presenter if there is one.
    pub(super) fn with_presenter(presenter: Option<Presenter>) -> Self {
        Self {
            presenter,
            ..Self::default()
        }
    }

    /// Columns and rows.
    pub(super) fn size(&self) -> (u32, u32) {
        (self.image.width() as u32, self.image.height() as u32)
    }

    /// Clears all pixels.
    pub(super) fn clear(&mut self) {
        let nothing = self.nothing();
        Arc::make_mut(&mut self.image).pixels.fill(nothing);
        self.dirty = Dirty::All;
    }

    /// Stores a tile's pixels; returns whether it fits.
    pub(super) fn put(&mut self, tile: &Tile) -> bool {
        let fits = copy(Arc::make_mut(&mut self.image), tile, self.blue_first);
        if fits {
            self.dirty.add(tile.rect);
        }
        fits
    }

    /// A picture of another size starts from the last one, scaled, so that nothing flashes.
    pub(super) fn resize(&mut self, (columns, rows): (u32, u32)) {
        let (old_columns, old_rows) = self.size();
        if (columns, rows) == (old_columns, old_rows) {
            return;
        }
        let mut image = ColorImage::filled([columns as usize, rows as usize], self.nothing());
        if old_columns > 0 && old_rows > 0 && columns > 0 {
            let source = |at: usize, new: u32, old: u32| at * old as usize / new as usize;
            let from: Vec<_> = (0..columns as usize)
                .map(|x| source(x, columns, old_columns))
                .collect();
            for (y, row) in image.pixels.chunks_exact_mut(columns as usize).enumerate() {
                let start = source(y, rows, old_rows) * old_columns as usize;
                for (pixel, &x) in row.iter_mut().zip(&from) {
                    *pixel = self.image.pixels[start + x];
                }
            }
        }
        self.image = Arc::new(image);
        self.dirty = Dirty::All;
    }

    /// The paint callback that copies the picture's pixels unscaled to `rect`, which has the same size; `None` without
    /// a presenter. [`Surface::hand_over`] must follow.
    pub(super) fn copy_to(&mut self, rect: egui::Rect) -> Option<egui::Shape> {
        let shape = self.presenter.as_ref()?.shape(rect);
        self.arrange(true);
        self.shown = Shown::Copied;
        Some(shape)
    }

    /// Hands over the picture with all tiles that arrived since it was laid out: the last step before the frame is
    /// painted.
    pub(super) fn hand_over(&mut self) {
        match (std::mem::take(&mut self.shown), &self.presenter) {
            (Shown::Copied, Some(presenter)) => {
                let dirty = std::mem::take(&mut self.dirty);
                presenter.hand_over(Arc::clone(&self.image), dirty);
            }
            (Shown::Painted, _) => self.upload(),
            _ => {}
        }
    }

    /// An unknown pixel: transparent, or the backdrop's colour for the presenter, which ignores alpha.
    fn nothing(&self) -> Color32 {
        let [r, g, b, _] = theme::BACKDROP.to_array();
        match (&self.presenter, self.blue_first) {
            (None, _) => Color32::TRANSPARENT,
            (Some(_), false) => theme::BACKDROP,
            (Some(_), true) => Color32::from_rgb(b, g, r),
        }
    }

    /// Reorders each pixel's bytes.
    fn arrange(&mut self, blue_first: bool) {
        if self.blue_first != blue_first {
            self.blue_first = blue_first;
            self.dirty = Dirty::All;
            for pixel in &mut Arc::make_mut(&mut self.image).pixels {
                let [r, g, b, a] = pixel.to_array();
                *pixel = Color32::from_rgba_premultiplied(b, g, r, a);
            }
        }
    }

    /// The texture with the picture, which [`Surface::hand_over`] updates. `None` before the first picture.
    pub(super) fn texture(&mut self, context: &egui::Context) -> Option<egui::TextureId> {
        if self.image.pixels.is_empty() {
            return None;
        }
        self.arrange(false);
        self.shown = Shown::Painted;
        let size = self.image.size;
        if self.texture.as_ref().map(TextureHandle::size) != Some(size) {
            let image = Arc::clone(&self.image);
            self.texture = Some(context.load_texture("picture", image, OPTIONS));
            self.dirty = Dirty::Nothing;
        }
        self.texture.as_ref().map(TextureHandle::id)
    }

    /// Updates the texture: by one transfer of the whole picture, or of the few tiles that are new.
    fn upload(&mut self) {
        let size = self.image.size;
        let Some(texture) = self.texture.as_mut().filter(|of| of.size() == size) else {
            return;
        };
        match std::mem::take(&mut self.dirty) {
            Dirty::Nothing => {}
            Dirty::Tiles(rects) if few(&rects, size) => {
                for rect in rects {
                    let corner = [rect.x as usize, rect.y as usize];
                    texture.set_partial(corner, part(&self.image, rect), OPTIONS);
                }
            }
            // The whole picture at once, shared without a copy, into the existing texture.
            _ => texture.set_partial([0, 0], Arc::clone(&self.image), OPTIONS),
        }
    }
}

impl Dirty {
    fn add(&mut self, rect: Rect) {
        match self {
            Self::All => {}
            Self::Nothing => *self = Self::Tiles(vec![rect]),
            Self::Tiles(rects) => rects.push(rect),
        }
    }
}
