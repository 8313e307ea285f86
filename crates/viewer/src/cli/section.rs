use super::{ClipArgs, ReadingArgs};
use clap::Args;
use std::path::PathBuf;

/// `raycast section`.
#[derive(Debug, Args)]
#[command(after_help = "\
The drawing has the scene's units, and the axes of whoever stands where the plane cuts away: y is up, or
for a plane that lies flat, -z from above and z from below. Which corners of a triangle are cut away is decided
exactly: the outline of a closed mesh is of closed lines. An .svg has a path for each object, filled; a
.dxf (release 12) a polyline for each line, and a layer for each object.

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
    /// Through where: one plane.
    #[command(flatten)]
    pub clip: ClipArgs,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}
