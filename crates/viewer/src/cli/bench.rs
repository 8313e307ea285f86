use super::{CastingArgs, ReadingArgs, values};
use clap::Args;
use raycast_core::camera::Projection;
use raycast_core::glam::DVec3;
use raycast_core::shade::Mode;
use raycast_report::scenes::Made;
use std::path::PathBuf;

/// `raycast bench`.
#[derive(Debug, Args)]
#[command(after_help = "\
Views are `medium` (the scene's bounding sphere fills the frame's height) and `close` (half as far),
both from yaw 22, pitch 16; with --eye it is that view alone, named `given`.

cast_ms is a frame's wall-clock time for visibility alone; frame_ms is visibility, shading and the
picture; mrays_per_s comes from the median cast_ms.

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
    /// Frames to measure a view, after one that is not
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: u32,
    /// Columns and rows of rays
    #[arg(long, value_name = "WxH", default_value = "1920x1080", value_parser = values::size)]
    pub size: (u32, u32),
    /// Vertical field of view in degrees [default: 45, of a panorama all of it or half a turn]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = values::fov)]
    pub fov: Option<f64>,
    /// How rays leave the camera
    #[arg(long, value_name = "KIND", default_value = "perspective", value_parser = values::named(values::PROJECTIONS))]
    pub projection: Projection,
    /// Measure the view from here alone
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub eye: Option<DVec3>,
    /// What the given view looks at [default: the scene's centre]
    #[arg(long, value_name = "X,Y,Z", requires = "eye", allow_hyphen_values = true, value_parser = values::point)]
    pub target: Option<DVec3>,
    /// Which way is up in the given view [default: 0,1,0]
    #[arg(long, value_name = "X,Y,Z", requires = "eye", allow_hyphen_values = true, value_parser = values::point)]
    pub up: Option<DVec3>,
    /// What the pictures show
    #[arg(long, value_name = "MODE", default_value = "smooth", value_parser = values::named(values::MODES))]
    pub mode: Mode,
    /// Measure the pictures of all modes beside visibility, in turn; frame_beside_cast is the geometric mean over the
    /// views, written_ms what writing the picture's bytes alone takes
    #[arg(long, conflicts_with_all = ["mode", "baselines"])]
    pub modes: bool,
    /// How rays meet triangles.
    #[command(flatten)]
    pub casting: CastingArgs,
    /// Measure obvhs's own traversals, and Embree's where the machine has it, on the same rays, frame
    /// by frame in turn, and brute force on a sample of them; build trees in turn with Embree's, five
    /// times each
    #[arg(long)]
    pub baselines: bool,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}
