use super::{Camera, Rect, SubCamera};

/// How a picture is split into tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grid {
    /// This many columns and rows of sub-cameras, as equal as whole pixels allow.
    Count {
        /// Number of columns.
        columns: u32,
        /// Number of rows.
        rows: u32,
    },
    /// Squares of this many pixels a side; those at the right and bottom may be smaller.
    Size(u32),
}

impl Default for Grid {
    /// 64 × 64 pixels: enough rays to share a traversal of the tree, small enough to see it fill.
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

    /// The sub-camera of a column and row of the grid; `None` out of range.
    pub fn sub_camera(&self, camera: Camera, column: u32, row: u32) -> Option<SubCamera> {
        let plane = camera.plane();
        let (across, down) = self.counts(plane.columns, plane.rows);
        let index = row as usize * across as usize + column as usize;
        let tiles = self.tiles(plane.columns, plane.rows);
        (column < across && row < down).then(|| camera.sub_camera(tiles[index]))
    }

    /// The numbers of columns and rows of tiles.
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
    use crate::camera::{ImagePlane, Pose, Projection};
    use glam::DVec3;

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

    #[test]
    fn a_sub_camera_is_found_by_column_and_row_up_to_the_last() {
        let pose = Pose {
            eye: DVec3::Z,
            target: DVec3::ZERO,
            up: DVec3::Y,
        };
        let plane = ImagePlane::new(10, 7, 0.1).expect("a size and a step");
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let grid = Grid::Count {
            columns: 3,
            rows: 2,
        };
        let tiles = grid.tiles(10, 7);
        let rect = |column, row| grid.sub_camera(camera, column, row).map(|found| found.rect);
        assert_eq!(rect(0, 0), Some(tiles[0]));
        assert_eq!(rect(1, 1), Some(tiles[4]));
        for (column, row) in [(3, 0), (0, 2), (u32::MAX, u32::MAX)] {
            assert_eq!(rect(column, row), None);
        }
    }
}
