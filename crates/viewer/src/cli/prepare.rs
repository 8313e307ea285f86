use super::ReadingArgs;
use clap::Args;
use std::path::PathBuf;

/// `raycast prepare`.
#[derive(Debug, Args)]
#[command(after_help = "\
A prepared file stands for the meshes that it was made of, wherever a mesh is named: every command, the
window, `mesh = \"bunny.raycast\"` in a scene file. Pictures have the same bytes. It holds the meshes as
they are stored, with materials, images and the tree over them, and is read without parsing, checking
polygons or building. It is of this version of its format: a program of another one says so, and asks
for it to be prepared again. All of it is checked when it is read; damage is an error.

Examples:
  raycast prepare bunny.obj -o bunny.raycast
  raycast render bunny.raycast -o bunny.png
  raycast prepare scan.ply.gz --up-axis z -o scan.raycast
  raycast plan bunny.raycast --turntable 100 -o turn")]
pub struct PrepareArgs {
    /// Meshes
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The file to write: .raycast
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Workers, 0 to 256; 0 is one for each of the machine's
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = super::values::threads())]
    pub threads: u16,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}
