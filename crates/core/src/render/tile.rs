use crate::camera::Rect;
use crate::packet::CastCounts;
use crate::picture::Layers;
use crate::shade::DrawnLegend;
use std::time::Duration;

/// The statistics of rendering a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileStats {
    /// Rays cast.
    pub rays: u64,
    /// Counts of casting.
    pub counts: CastCounts,
    /// Time for visibility: which triangle each ray hits.
    pub cast: Duration,
    /// Time for everything else: interpolation, shading, lines, conversion.
    pub shade: Duration,
    /// The index of the rayon worker that rendered it.
    pub worker: u32,
}

impl std::ops::AddAssign for TileStats {
    /// Adds counts and times; the worker stays.
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.counts += other.counts;
        self.cast += other.cast;
        self.shade += other.shade;
    }
}

/// The rendered rectangle of a sub-camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// The rectangle in the full picture.
    pub rect: Rect,
    /// Its sRGB pixels, row by row, with straight alpha.
    pub pixels: Vec<[u8; 4]>,
    /// The layers, if [`Settings::layers`](super::Settings::layers) asks for them.
    pub layers: Option<Layers>,
    /// The statistics of rendering it.
    pub stats: TileStats,
}

impl Tile {
    /// Draws the part of the legend that overlaps the tile.
    pub(super) fn draw(&mut self, legend: Option<&DrawnLegend>) {
        if let Some(legend) = legend {
            let colors = self.layers.as_mut().map(|layers| &mut *layers.color);
            legend.over(self.rect, &mut self.pixels, colors);
        }
    }
}
