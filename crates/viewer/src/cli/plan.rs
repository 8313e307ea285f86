use super::{FrameRange, values};
use clap::Args;
use std::ffi::OsString;
use std::path::PathBuf;

/// `raycast plan`.
#[derive(Debug, Args)]
#[command(after_help = "\
PLAN is a text file with a command line for each job. Jobs are independent and may run in any
order; a job that runs again writes the same bytes, and its output appears whole or not at all.
Options after `--` go to every render. PLAN.stitch has a line for each picture, to be run when all
of PLAN is done: it stitches the picture, if it is in tiles, and verifies it. PLAN.slurm submits
both as job arrays (`sh PLAN.slurm`); PLAN.yaml and PLAN.stitch.yaml are Indexed Jobs for
Kubernetes, whose volume and image are to be filled in. Fragments are in the folder PLAN.parts.
Paths are absolute paths of this machine. Options are checked as a job checks them before it
reads meshes, and files must be there. An existing plan is replaced with all these files;
without one, none of them may exist.

A large mesh is best prepared once for all jobs (`raycast prepare`); each then starts at once.

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
    /// The pictures' file name; with frames it has a placeholder for their number, as out-%05d.png [default: PLAN.png
    /// or PLAN-%05d.png]
    #[arg(long, value_name = "FILE")]
    pub pictures: Option<PathBuf>,
    /// Render these frames, both ends included, of --turntable or of the scene file's keyframes [default: all, with
    /// --turntable or --pictures with a placeholder]
    #[arg(long, value_name = "A..B")]
    pub frames: Option<FrameRange>,
    /// Turn the camera once around its target in this many frames
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=999_999))]
    pub turntable: Option<u32>,
    /// A job for each sub-camera of a grid of this many, instead of one for the whole picture
    #[arg(long, value_name = "CxR", value_parser = values::counts)]
    pub tiles: Option<(u32, u32)>,
    /// The program that jobs run [default: this one]
    #[arg(long, value_name = "FILE")]
    pub program: Option<PathBuf>,
    /// Options of `raycast render`, except files, output, tiles and frames
    #[arg(last = true, value_name = "OPTIONS")]
    pub render: Vec<OsString>,
}
