use super::values;
use clap::Args;
use raycast_core::camera::Grid;

/// How a picture is split.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Tiles")]
pub struct TileArgs {
    /// Split the picture into a grid of this many sub-cameras
    #[arg(long, value_name = "CxR", conflicts_with = "tile_size", value_parser = values::counts)]
    pub tiles: Option<(u32, u32)>,
    /// Split the picture into squares with sides of this many pixels [default: 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub tile_size: Option<u32>,
    /// Render only the grid's tile in this column and row, counted from 0,0, and write it as a fragment
    #[arg(long, value_name = "C,R", value_parser = values::cell)]
    pub sub_camera: Option<(u32, u32)>,
    /// Render the picture as it looks when this many tiles are done, from the middle outwards; the rest has every 16th
    /// ray in both directions
    #[arg(long, value_name = "N", conflicts_with = "sub_camera")]
    pub unfinished: Option<usize>,
    /// Draw the split from outside: the scene, and the frustum of each sub-camera up to the plane of the camera's
    /// target; for panoramas and lenses, up to the sphere through it
    #[arg(long, conflicts_with_all = ["sub_camera", "unfinished"])]
    pub show_sub_cameras: bool,
}

impl TileArgs {
    /// The requested grid.
    pub fn grid(&self) -> Grid {
        match (self.tiles, self.tile_size) {
            (Some((columns, rows)), _) => Grid::Count { columns, rows },
            (None, Some(size)) => Grid::Size(size),
            (None, None) => Grid::default(),
        }
    }
}
