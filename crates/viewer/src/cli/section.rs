use super::{ClipArgs, ReadingArgs};
use clap::Args;
use std::path::PathBuf;

/// `raycast section`.
#[derive(Debug, Args)]
#[command(after_help = "\
The drawing is in scene units, seen from the side that the plane cuts away: y is up; for a
horizontal plane -z is up seen from above, and z from below. Which corners of a triangle are cut
away is decided exactly, so the outline of a closed mesh consists of closed lines. An .svg has a
filled path for each object; a .dxf (release 12) has a polyline for each line and a layer for each
object.

Examples:
  raycast section bunny.obj --clip x:0 -o bunny.svg
  raycast section scene.raycast.toml --clip 1,1,0,0.25 -o section.dxf")]
pub struct SectionArgs {
    /// Meshes or scene files
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The drawing to write: .svg or .dxf
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// The plane of the section.
    #[command(flatten)]
    pub clip: ClipArgs,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}
