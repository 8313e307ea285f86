use super::{CastingArgs, ReadingArgs, camera_values, shading_values, values};
use clap::Args;
use raycast_core::camera::{BrownConrady, Projection};
use raycast_core::glam::DVec3;
use raycast_core::shade::Mode;
use raycast_report::scenes::Made;
use std::path::PathBuf;

/// `raycast bench`.
#[derive(Debug, Args)]
#[command(after_help = "\
The views are `medium` (the scene's bounding sphere fills the frame's height) and `close` (half as
far), both from yaw 22, pitch 16; with --eye only that view, named `given`.

cast_ms is a frame's wall-clock time for visibility alone; frame_ms is that of visibility, shading
and the picture's bytes; mrays_per_s follows from the median cast_ms.
--passes adds `passes`: for each stride the time of a pass of so many rays.

Example:
  raycast bench bunny.obj dragon.obj --frames 50 --threads 1")]
pub struct BenchArgs {
    /// Meshes or scene files
    #[arg(required_unless_present = "made")]
    pub files: Vec<PathBuf>,
    /// A scene made in code: ball:TRIANGLES, or interior:TRIANGLES, which is seen from inside, with a field
    /// of view of its own unless --eye is given
    #[arg(long, value_name = "SCENE", value_parser = <Made as std::str::FromStr>::from_str)]
    pub made: Vec<Made>,
    /// Frames to measure in each view, after one that warms up
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: u32,
    /// Columns and rows of rays
    #[arg(long, value_name = "WxH", default_value = "1920x1080", value_parser = values::size)]
    pub size: (u32, u32),
    /// Vertical field of view in degrees [default: 45; panoramas: 180, cylindrical and cubemap 90, cubemap:cross 270]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = camera_values::fov)]
    pub fov: Option<f64>,
    /// How rays leave the camera
    #[arg(long, value_name = "KIND", default_value = "perspective", value_parser = values::named(camera_values::PROJECTIONS))]
    pub projection: Projection,
    /// Lens distortion of a perspective picture, as that of `render`
    #[arg(long, value_name = "K1,K2,P1,P2,K3", allow_hyphen_values = true, conflicts_with = "projection", value_parser = camera_values::lens)]
    pub lens: Option<BrownConrady>,
    /// Measure only the view from this point
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub eye: Option<DVec3>,
    /// The point that this view looks at [default: the scene's centre]
    #[arg(long, value_name = "X,Y,Z", requires = "eye", allow_hyphen_values = true, value_parser = values::point)]
    pub target: Option<DVec3>,
    /// The direction that is up in this view [default: 0,1,0]
    #[arg(long, value_name = "X,Y,Z", requires = "eye", allow_hyphen_values = true, value_parser = values::point)]
    pub up: Option<DVec3>,
    /// What the pictures show
    #[arg(long, value_name = "MODE", default_value = "smooth", value_parser = values::named(shading_values::MODES))]
    pub mode: Mode,
    /// Measure visibility and the pictures of all modes in turns; frame_beside_cast is the geometric mean over the
    /// views of frame time over cast time, written_ms the time that writing the picture's bytes alone takes
    #[arg(long, conflicts_with_all = ["mode", "baselines"])]
    pub modes: bool,
    /// Also measure the passes of every ray, of every 2nd, 4th and 8th one in both directions, as the window makes them while
    /// the camera moves
    #[arg(long, conflicts_with = "modes")]
    pub passes: bool,
    /// How rays are cast.
    #[command(flatten)]
    pub casting: CastingArgs,
    /// Also measure obvhs's traversals, and Embree's if it is installed, on the same rays, frame by frame in turns, and
    /// brute force on a sample of them; and building trees, in turns with Embree's, five times each
    #[arg(long)]
    pub baselines: bool,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

impl BenchArgs {
    /// The projection, through the lens if there is one.
    pub fn projection(&self) -> Projection {
        self.lens.map_or(self.projection, Projection::through)
    }
}
