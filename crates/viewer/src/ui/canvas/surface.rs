//! The picture's pixels in memory, and their copy on the graphics side.

use crate::ui::pixels::{copy, few, part};
use crate::ui::present::{Dirty, Presenter};
use crate::ui::theme;
use egui::{Color32, ColorImage, TextureHandle, TextureOptions};
use raycast_core::camera::Rect;
use raycast_core::render::Tile;
use std::sync::Arc;

/// Nearest: few rays show as the blocks that they are.
const OPTIONS: TextureOptions = TextureOptions::NEAREST;

/// How the picture gets to the window in this frame.
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

/// Pixels, those that are new, and how they get to the window.
#[derive(Default)]
pub(super) struct Surface {
    pub(super) image: Arc<ColorImage>,
    /// Whether pixels hold blue first, for the [`Presenter`], in place of red.
    blue_first: bool,
    presenter: Option<Presenter>,
    texture: Option<TextureHandle>,
    pub(super) dirty: Dirty,
    shown: Shown,
}

impl Surface {
    /// No pixels yet; they are copied to the window where it can be done.
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

    /// Forgets all pixels.
    pub(super) fn clear(&mut self) {
        let nothing = self.nothing();
        Arc::make_mut(&mut self.image).pixels.fill(nothing);
        self.dirty = Dirty::All;
    }

    /// Takes a tile's pixels in; whether it fits.
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

    /// What shows the picture by copying its pixels as they are over `rect`, which is of their number;
    /// `None` where the window has no such way. To be followed by [`Surface::hand_over`].
    pub(super) fn copy_to(&mut self, rect: egui::Rect) -> Option<egui::Shape> {
        let shape = self.presenter.as_ref()?.shape(rect);
        self.arrange(true);
        self.shown = Shown::Copied;
        Some(shape)
    }

    /// Hands the picture over, with what has come since it was put into this frame: the last thing
    /// before the frame is painted.
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

    /// A pixel of which nothing is known: clear, or what is behind it where nothing shows through.
    fn nothing(&self) -> Color32 {
        let [r, g, b, _] = theme::BACKDROP.to_array();
        match (&self.presenter, self.blue_first) {
            (None, _) => Color32::TRANSPARENT,
            (Some(_), false) => theme::BACKDROP,
            (Some(_), true) => Color32::from_rgb(b, g, r),
        }
    }

    /// Orders each pixel's bytes.
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

    /// The texture that shows the picture, of its size: brought up to date by [`Surface::hand_over`].
    /// `None` before the first picture.
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

    /// Brings the texture up to date: at most one transfer of the whole picture, or the few tiles
    /// that are new.
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
            // All at once, shared, without a copy: and into the storage that is there.
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
