use super::{Camera, Ray};
use crate::math;

/// A rectangle of pixels of the full picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rect {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Rect {
    /// How many pixels it has.
    pub fn area(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The column after the last.
    pub fn right(&self) -> u32 {
        self.x + self.width
    }

    /// The row after the last.
    pub fn bottom(&self) -> u32 {
        self.y + self.height
    }
}

/// A camera over one rectangle of the full camera's image plane: same eye, same orientation, same
/// focal length, and a field of view of its own, off the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubCamera {
    /// The full camera.
    pub camera: Camera,
    /// Its rectangle of the full picture.
    pub rect: Rect,
}

impl SubCamera {
    /// The ray through (x, y) of its own rectangle: the full camera's ray at that place.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        self.camera
            .ray(x + f64::from(self.rect.x), y + f64::from(self.rect.y))
    }

    /// The angles in degrees from the view axis to its left, right, bottom and top edges,
    /// positive to the right and up: the off-axis field of view. Zero for orthographic cameras.
    pub fn field_of_view(&self) -> [f64; 4] {
        let plane = self.camera.plane();
        if self.camera.fov_degrees().is_none() {
            return [0.0; 4];
        }
        let angle =
            |pixels: f64| math::atan(pixels * plane.step / self.camera.distance()).to_degrees();
        let (half_width, half_height) =
            (f64::from(plane.columns) * 0.5, f64::from(plane.rows) * 0.5);
        [
            angle(f64::from(self.rect.x) - half_width),
            angle(f64::from(self.rect.right()) - half_width),
            angle(half_height - f64::from(self.rect.bottom())),
            angle(half_height - f64::from(self.rect.y)),
        ]
    }
}

/// How a picture is split into tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grid {
    /// So many columns and rows of sub-cameras, as equal as whole pixels allow.
    Count {
        /// Sub-cameras side by side.
        columns: u32,
        /// Sub-cameras one above the other.
        rows: u32,
    },
    /// Squares of so many pixels; those at the right and bottom may be smaller.
    Size(u32),
}

impl Default for Grid {
    /// 64 × 64 pixels: enough rays to share a walk through the tree, small enough to see it fill.
    fn default() -> Self {
        Self::Size(64)
    }
}

impl Grid {
    /// The tiles of a picture, row by row; together they cover it once.
    ///
    /// Counts beyond the pixels give one tile a pixel; zero counts as one.
    pub fn tiles(&self, columns: u32, rows: u32) -> Vec<Rect> {
        let (xs, ys) = match *self {
            Self::Count {
                columns: across,
                rows: down,
            } => (even_cuts(columns, across), even_cuts(rows, down)),
            Self::Size(size) => (regular_cuts(columns, size), regular_cuts(rows, size)),
        };
        ys.windows(2)
            .flat_map(|y| {
                xs.windows(2).map(move |x| Rect {
                    x: x[0],
                    y: y[0],
                    width: x[1] - x[0],
                    height: y[1] - y[0],
                })
            })
            .collect()
    }

    /// How many tiles lie side by side and one above the other.
    pub fn counts(&self, columns: u32, rows: u32) -> (u32, u32) {
        match *self {
            Self::Count {
                columns: across,
                rows: down,
            } => (across.clamp(1, columns.max(1)), down.clamp(1, rows.max(1))),
            Self::Size(size) => (columns.div_ceil(size.max(1)), rows.div_ceil(size.max(1))),
        }
    }
}

fn even_cuts(length: u32, parts: u32) -> Vec<u32> {
    let parts = parts.clamp(1, length.max(1));
    (0..=parts)
        .map(|i| (u64::from(length) * u64::from(i) / u64::from(parts)) as u32)
        .collect()
}

fn regular_cuts(length: u32, size: u32) -> Vec<u32> {
    (0..length)
        .step_by(size.max(1) as usize)
        .chain([length])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_the_picture_once() {
        for grid in [
            Grid::Size(1),
            Grid::Size(0),
            Grid::Size(7),
            Grid::Size(64),
            Grid::Size(1000),
            Grid::Count {
                columns: 3,
                rows: 2,
            },
            Grid::Count {
                columns: 0,
                rows: 99,
            },
        ] {
            let (columns, rows) = (37, 23);
            let tiles = grid.tiles(columns, rows);
            let (across, down) = grid.counts(columns, rows);
            assert_eq!(tiles.len() as u32, across * down, "{grid:?}");
            let mut seen = vec![0; (columns * rows) as usize];
            for tile in tiles {
                assert!(tile.area() > 0);
                for y in tile.y..tile.bottom() {
                    for x in tile.x..tile.right() {
                        seen[(y * columns + x) as usize] += 1;
                    }
                }
            }
            assert!(seen.iter().all(|&n| n == 1), "{grid:?}");
        }
    }
}
