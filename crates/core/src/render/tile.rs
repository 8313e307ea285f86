use crate::camera::Rect;
use crate::packet::CastCounts;
use crate::picture::Layers;
use crate::shade::DrawnLegend;
use std::time::Duration;

/// What it took to render a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileStats {
    /// Rays cast.
    pub rays: u64,
    /// What visibility took, counted.
    pub counts: CastCounts,
    /// Time for visibility: which triangle each ray meets.
    pub cast: Duration,
    /// Time for everything else: where it meets it, shading, lines, conversion.
    pub shade: Duration,
    /// Which of rayon's workers made it.
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

/// A sub-camera's rectangle, rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// Its place in the full picture.
    pub rect: Rect,
    /// Its sRGB pixels, row by row, alpha not multiplied in.
    pub pixels: Vec<[u8; 4]>,
    /// Depth, numbers, normals and texture coordinates, when asked for.
    pub layers: Option<Layers>,
    /// What it took.
    pub stats: TileStats,
}

impl Tile {
    /// Draws the legend over it, as far as it reaches into it.
    pub(super) fn draw(&mut self, legend: Option<&DrawnLegend>) {
        if let Some(legend) = legend {
            let colors = self.layers.as_mut().map(|layers| &mut *layers.color);
            legend.over(self.rect, &mut self.pixels, colors);
        }
    }
}
