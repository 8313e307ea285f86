use super::{Pass, Tile};
use crate::accel::Accel;
use crate::camera::{Camera, Grid, Rect};
use crate::image::Picture;
use crate::intersect::Cull;
use crate::scene::Scene;
use crate::shade::Shading;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How sure a picture's triangles are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Rounded arithmetic alone: at most one pixel in a million may show another triangle.
    Fast,
    /// What exact arithmetic gives.
    #[default]
    Exact,
}

/// How a picture is made, besides scene and camera.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Colours.
    pub shading: Shading,
    /// Which faces rays meet.
    pub cull: Cull,
    /// How sure the triangles are.
    pub precision: Precision,
    /// Rays a pixel, at least 1. The first goes through the pixel's centre.
    pub samples: u32,
    /// Whether to keep depth, numbers, normals and texture coordinates beside the colours.
    pub layers: bool,
}

/// A clock from outside: time since some moment of the caller's. The core has none of its own.
pub type Clock<'a> = &'a (dyn Fn() -> Duration + Sync);

/// Tells a render to stop; shared between threads.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// Asks the render to stop at its next tile.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was asked to.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Everything that decides a picture.
#[derive(Clone, Debug)]
pub struct View {
    /// The objects.
    pub scene: Arc<Scene>,
    /// The tree over them: `Accel::build(&scene)`.
    pub accel: Arc<Accel>,
    /// Where from.
    pub camera: Camera,
    /// How.
    pub settings: Settings,
}

impl View {
    /// Renders the whole picture, tile by tile, in parallel on rayon's current pool.
    ///
    /// `sink` is called from the workers as each tile is done, with its statistics. The picture is
    /// the same, byte for byte, for every grid and thread count. `None` if cancelled.
    pub fn render(
        &self,
        _grid: Grid,
        _clock: Clock<'_>,
        _cancel: &Cancel,
        _sink: &(dyn Fn(&Tile) + Sync),
    ) -> Option<Picture> {
        unimplemented!()
    }

    /// Renders one rectangle of the picture: what the sub-camera over it sees.
    pub fn render_rect(&self, _rect: Rect, _clock: Clock<'_>) -> Tile {
        unimplemented!()
    }

    /// Renders `passes` one after another, each tile of each pass handed to `sink` whole, from the
    /// worker that made it. Within a pass tiles come from the middle of the view outwards.
    ///
    /// A tile of a coarse pass has every pixel filled: those between its rays take the colour of
    /// the ray above and to the left. After the last pass the tiles are those of [`View::render`].
    /// Returns whether it ran to the end.
    pub fn render_progressively(
        &self,
        _tiles: &[Rect],
        _passes: &[Pass],
        _clock: Clock<'_>,
        _cancel: &Cancel,
        _sink: &(dyn Fn(Pass, Tile) + Sync),
    ) -> bool {
        unimplemented!()
    }
}
