use super::{FrameRange, values};
use clap::Args;
use std::ffi::OsString;
use std::path::PathBuf;

/// `raycast plan`.
#[derive(Debug, Args)]
#[command(after_help = "\
PLAN is a text of one command line a job, in any order, each for itself; a job that is run again leaves
the same bytes, and its output is there whole or not at all. What follows `--` is given to every render.
PLAN.stitch has a line a picture, to be run once all of PLAN is done: it stitches the picture, if it is in
tiles, and verifies it. Beside them lie PLAN.slurm, which submits both as job arrays (`sh PLAN.slurm`), and
PLAN.yaml and PLAN.stitch.yaml, Indexed Jobs for Kubernetes whose volume and image are to be filled in.
Fragments are in the folder PLAN.parts. Folders and files are named as they are on this machine. A plan that is
there is replaced with all of these; where it is not, none of them may be there.

A large mesh is best prepared once for all jobs (`raycast prepare`): each then starts at once.

Examples:
  raycast plan bunny.obj --turntable 100 -o turn -- --size 1920x1080 --samples 16
  parallel --joblog turn.log --retries 3 < turn && parallel < turn.stitch
  raycast plan scene.raycast.toml --tiles 8x8 -o large -- --size 65536x32768
  sh large.slurm")]
pub struct PlanArgs {
    /// Meshes, or a scene file
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The plan to write; other files are named after it
    #[arg(short, long, value_name = "PLAN")]
    pub output: PathBuf,
    /// The pictures: with frames a name that tells where their number stands, as out-%05d.png
    /// [default: PLAN.png or PLAN-%05d.png]
    #[arg(long, value_name = "FILE")]
    pub pictures: Option<PathBuf>,
    /// These frames, both ends included, of --turntable or of the scene file's keyframes
    #[arg(long, value_name = "A..B")]
    pub frames: Option<FrameRange>,
    /// Turn once around what the camera looks at in so many frames [default frames: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=999_999))]
    pub turntable: Option<u32>,
    /// A job for each sub-camera of a grid of so many, in place of one for the whole picture
    #[arg(long, value_name = "CxR", value_parser = values::counts)]
    pub tiles: Option<(u32, u32)>,
    /// The program that jobs run [default: this one]
    #[arg(long, value_name = "FILE")]
    pub program: Option<PathBuf>,
    /// Options of `raycast render`, but files, output, tiles and frames
    #[arg(last = true, value_name = "OPTIONS")]
    pub render: Vec<OsString>,
}
