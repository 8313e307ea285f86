use super::ReadingArgs;
use clap::Args;
use std::path::PathBuf;

/// `raycast prepare`.
#[derive(Debug, Args)]
#[command(after_help = "\
A prepared file can be named wherever a mesh can: in every command, in the window, and in scene
files (`mesh = \"bunny.raycast\"`). Pictures have the same bytes. It holds the meshes as they are in
memory, with materials, images and the tree over them, and is read without parsing, triangulating
or building. A program with another version of the format refuses it and asks to prepare the
meshes again. The whole file is checked when it is read; damage is an error.

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
    /// Worker threads, 0 to 256; 0 is one for each hardware thread
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = super::values::threads())]
    pub threads: u16,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}
