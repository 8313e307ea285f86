//! The picture in the window: its pixels in memory, and their copy in graphics memory.

mod surface;

use super::present::Presenter;
use crate::worker::layout::Layout;
use crate::worker::outbox::{Arrival, Batch, PassReport};
use raycast_core::camera::Rect;
use raycast_core::render::{Pass, TileStats};
use raycast_core::shade::{Background, Legend};
use std::sync::Arc;
use std::time::Duration;
use surface::Surface;

/// A tile of the picture on screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileNote {
    /// Its statistics in the last pass that it was in.
    pub stats: TileStats,
    /// Its number in that pass's order of arrival, from zero.
    pub order: u32,
    /// The background, if it shows nothing else.
    empty: Option<Background>,
}

impl TileNote {
    /// `background` as in [`Batch`].
    fn new(arrival: &Arrival, background: Option<Background>) -> Self {
        let stats = arrival.tile.stats;
        // Interpolation between the rays of coarse passes, and between samples, makes other colours.
        let plain = arrival.pass.stride == 1 && arrival.pass.samples == 1;
        Self {
            stats,
            order: arrival.order,
            empty: background.filter(|_| plain && stats.counts.hits == 0),
        }
    }
}

/// The picture's progress.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PictureProgress {
    /// The pass of the newest tile.
    pub pass: Option<Pass>,
    /// The last pass that was finished.
    pub report: Option<PassReport>,
    /// Rays of all finished passes.
    pub rays: u64,
    /// Whether the picture is complete.
    pub complete: bool,
    /// The time from the request until now, or until completion.
    pub elapsed: Duration,
}

/// The picture's pixels, tiles and texture.
#[derive(Default)]
pub struct Canvas {
    surface: Surface,
    generation: u64,
    layout: Arc<Layout>,
    notes: Vec<Option<TileNote>>,
    progress: PictureProgress,
    legend: Option<Arc<Legend>>,
    /// Counts changes of the tiles' notes, for overlays that are kept between frames.
    pub notes_version: u64,
}

impl Canvas {
    /// A canvas that copies its pixels to the window by the presenter, if there is one.
    pub fn with_presenter(presenter: Option<Presenter>) -> Self {
        Self {
            surface: Surface::with_presenter(presenter),
            ..Self::default()
        }
    }

    /// The picture's columns and rows; zero before the first picture.
    pub fn size(&self) -> (u32, u32) {
        self.surface.size()
    }

    /// The number of the picture's request.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// The picture's legend.
    pub fn legend(&self) -> Option<&Arc<Legend>> {
        self.legend.as_ref()
    }

    /// The picture's progress.
    pub fn progress(&self) -> PictureProgress {
        self.progress
    }

    /// The tiles and their notes.
    pub fn notes(&self) -> impl ExactSizeIterator<Item = (Rect, Option<TileNote>)> {
        self.layout
            .tiles
            .iter()
            .copied()
            .zip(self.notes.iter().copied())
    }

    /// Clears the picture before another scene: nothing older than `generation` is shown from now on.
    pub fn clear(&mut self, generation: u64) {
        self.generation = generation;
        self.surface.clear();
        self.notes.fill(None);
        self.progress = PictureProgress::default();
    }

    /// Stores tiles from the workers. Tiles of pictures older than the one on screen, and tiles that do not fit, are
    /// ignored.
    pub fn take_in(&mut self, batch: Batch) {
        if batch.generation < self.generation {
            return;
        }
        if batch.generation > self.generation || self.size() != batch.layout.size {
            self.generation = batch.generation;
            self.progress = PictureProgress::default();
            self.surface.resize(batch.layout.size);
        }
        if !Arc::ptr_eq(&self.layout, &batch.layout) {
            self.notes = vec![None; batch.layout.tiles.len()];
            self.layout = Arc::clone(&batch.layout);
        }
        self.legend = batch.legend;
        for arrival in batch.tiles {
            let Some(note) = self.notes.get_mut(arrival.place) else {
                continue;
            };
            let mut new = TileNote::new(&arrival, batch.background);
            // A legend may lie over the background.
            if self
                .legend
                .as_ref()
                .is_some_and(|legend| legend.scale.legend)
            {
                new.empty = None;
            }
            let empty = note.and_then(|note| note.empty);
            // Background that stays the same while the camera moves need not be copied.
            let is_new = empty.is_none() || empty != new.empty;
            if is_new && !self.surface.put(&arrival.tile) {
                continue;
            }
            *note = Some(new);
            self.progress.pass = Some(arrival.pass);
        }
        for report in batch.reports {
            self.progress.rays += report.stats.rays;
            self.progress.report = Some(report);
        }
        self.progress.complete |= batch.complete;
        self.progress.elapsed = batch.elapsed;
        self.notes_version += 1;
    }

    /// The paint callback that copies the picture's pixels unscaled to `rect`, which has the same size; `None` without
    /// a presenter. [`Canvas::hand_over`] must follow.
    pub fn copy_to(&mut self, rect: egui::Rect) -> Option<egui::Shape> {
        self.surface.copy_to(rect)
    }

    /// The texture with the picture, which [`Canvas::hand_over`] updates. `None` before the first picture.
    pub fn texture(&mut self, context: &egui::Context) -> Option<egui::TextureId> {
        self.surface.texture(context)
    }

    /// Hands over the picture with all tiles that arrived since it was laid out: the last step before the frame is
    /// painted.
    pub fn hand_over(&mut self) {
        self.surface.hand_over();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::present::Dirty;
    use crate::worker::outbox::Arrival;
    use egui::Color32;
    use raycast_core::camera::Grid;
    use raycast_core::packet::CastCounts;
    use raycast_core::render::Tile;
    use raycast_core::scene::Color;

    const PASS: Pass = Pass {
        stride: 1,
        samples: 1,
    };

    fn batch(generation: u64, size: (u32, u32), places: &[usize], value: u8) -> Batch {
        let layout = Arc::new(Layout::new(size, Grid::Size(4).tiles(size.0, size.1)));
        let tiles = places
            .iter()
            .zip(0..)
            .map(|(&place, order)| Arrival {
                place,
                order,
                pass: PASS,
                tile: Tile {
                    rect: layout.tiles[place],
                    pixels: vec![[value, value, value, 255]; layout.tiles[place].area()],
                    layers: None,
                    stats: TileStats {
                        counts: CastCounts {
                            hits: 1,
                            ..CastCounts::default()
                        },
                        ..TileStats::default()
                    },
                },
            })
            .collect();
        Batch {
            generation,
            layout,
            background: Some(Background::default()),
            legend: None,
            tiles,
            reports: Vec::new(),
            complete: false,
            elapsed: Duration::ZERO,
        }
    }

    fn values(canvas: &Canvas) -> Vec<u8> {
        canvas
            .surface
            .image
            .pixels
            .iter()
            .map(|pixel| pixel.r())
            .collect()
    }

    #[test]
    fn stale_pictures_are_ignored() {
        let mut canvas = Canvas::default();
        canvas.take_in(batch(2, (8, 4), &[0, 1], 20));
        canvas.take_in(batch(1, (8, 4), &[0, 1], 10));
        assert_eq!(canvas.generation(), 2);
        assert!(values(&canvas).iter().all(|&value| value == 20));
    }

    #[test]
    fn a_cleared_canvas_shows_nothing_of_the_last_scene() {
        let mut canvas = Canvas::default();
        canvas.take_in(batch(1, (8, 4), &[0, 1], 10));
        canvas.clear(2);
        canvas.take_in(batch(1, (8, 4), &[0, 1], 10));
        assert!(
            canvas
                .surface
                .image
                .pixels
                .iter()
                .all(|pixel| *pixel == Color32::TRANSPARENT)
        );
        canvas.take_in(batch(2, (8, 4), &[0, 1], 20));
        assert!(values(&canvas).iter().all(|&value| value == 20));
    }

    #[test]
    fn tiles_land_in_their_places_over_what_was_there() {
        let mut canvas = Canvas::default();
        canvas.take_in(batch(1, (8, 4), &[0, 1], 10));
        canvas.take_in(batch(2, (8, 4), &[1], 20));
        for (index, value) in values(&canvas).into_iter().enumerate() {
            assert_eq!(value, if index % 8 < 4 { 10 } else { 20 });
        }
        let orders: Vec<_> = canvas
            .notes()
            .map(|(_, note)| note.map(|n| n.order))
            .collect();
        assert_eq!(orders, [None, Some(0)]);
    }

    #[test]
    fn nothing_before_the_same_background_is_copied_once() {
        let mut canvas = Canvas::default();
        let show = |canvas: &mut Canvas, generation, hits, background, pass| {
            let mut batch = batch(generation, (8, 4), &[0], generation as u8);
            batch.layout = Arc::clone(&canvas.layout);
            if batch.layout.tiles.is_empty() {
                batch.layout = Arc::new(Layout::new((8, 4), Grid::Size(4).tiles(8, 4)));
            }
            batch.background = background;
            batch.tiles[0].pass = pass;
            batch.tiles[0].tile.stats.counts.hits = hits;
            canvas.take_in(batch);
            canvas.hand_over();
            canvas.surface.image.pixels[0].r()
        };
        let here = Some(Background::default());
        let other = Some(Background::Gradient(Color([1; 3]), Color([2; 3])));
        let coarse = Pass { stride: 2, ..PASS };
        assert_eq!(show(&mut canvas, 1, 0, here, PASS), 1, "new");
        assert_eq!(show(&mut canvas, 2, 0, here, PASS), 1, "as it was");
        assert_eq!(
            show(&mut canvas, 3, 0, other, PASS),
            3,
            "another background"
        );
        assert_eq!(show(&mut canvas, 4, 9, other, PASS), 4, "something is met");
        assert_eq!(
            show(&mut canvas, 5, 0, other, PASS),
            5,
            "nothing is left of it"
        );
        assert_eq!(show(&mut canvas, 6, 0, other, coarse), 6, "blocks");
        assert_eq!(
            show(&mut canvas, 7, 0, other, PASS),
            7,
            "no blocks any more"
        );
        canvas.clear(8);
        assert_eq!(
            show(&mut canvas, 8, 0, other, PASS),
            8,
            "after another scene"
        );
        for generation in [9, 10] {
            let shown = show(&mut canvas, generation, 0, None, PASS);
            assert_eq!(u64::from(shown), generation, "a ground that has moved");
        }
    }

    #[test]
    fn another_layout_after_another_scene_is_shown_whole() {
        let mut canvas = Canvas::default();
        canvas.take_in(batch(1, (8, 4), &[0, 1], 10));
        canvas.clear(2);
        let layout = Arc::new(Layout::new((8, 4), Grid::Size(2).tiles(8, 4)));
        let mut finer = batch(2, (8, 4), &[], 20);
        finer.tiles = layout
            .tiles
            .iter()
            .zip(0..)
            .map(|(&rect, place)| {
                let mut arrival = batch(2, (8, 4), &[0], 20).tiles.remove(0);
                arrival.place = place;
                arrival.tile.rect = rect;
                arrival.tile.pixels.truncate(rect.area());
                arrival
            })
            .collect();
        finer.layout = layout;
        canvas.take_in(finer);
        assert!(values(&canvas).iter().all(|&value| value == 20));
    }

    #[test]
    fn another_size_starts_from_the_last_picture() {
        let mut canvas = Canvas::default();
        canvas.take_in(batch(1, (8, 4), &[0, 1], 10));
        canvas.take_in(batch(2, (12, 8), &[0], 20));
        assert_eq!(canvas.size(), (12, 8));
        let values = values(&canvas);
        assert_eq!((values[0], values[11], values[12 * 7]), (20, 10, 10));
    }

    #[test]
    fn a_tile_that_does_not_fit_is_refused() {
        let mut canvas = Canvas::default();
        let mut wrong = batch(1, (8, 4), &[0], 10);
        wrong.tiles[0].tile.rect.x = 6;
        canvas.take_in(wrong);
        assert!(values(&canvas).iter().all(|&value| value == 0));
    }

    #[test]
    fn the_texture_follows() {
        let context = egui::Context::default();
        let mut canvas = Canvas::default();
        assert_eq!(canvas.texture(&context), None);
        canvas.take_in(batch(1, (64, 64), &[0], 10));
        let id = canvas.texture(&context);
        assert!(id.is_some());
        canvas.take_in(batch(2, (64, 64), &[5], 20));
        assert_eq!(
            canvas.surface.dirty,
            Dirty::Tiles(vec![canvas.layout.tiles[5]])
        );
        assert_eq!(canvas.texture(&context), id);
        assert_ne!(canvas.surface.dirty, Dirty::Nothing, "more may come");
        canvas.hand_over();
        assert_eq!(canvas.surface.dirty, Dirty::Nothing);
        canvas.take_in(batch(2, (64, 64), &[6], 20));
        canvas.hand_over();
        assert_ne!(
            canvas.surface.dirty,
            Dirty::Nothing,
            "this frame does not show it"
        );
        let delta = context.tex_manager().write().take_delta();
        assert_eq!(
            id.and_then(|id| delta.set.get(&id)).map(|sets| sets.len()),
            Some(2)
        );
    }
}
