use super::{ReadingArgs, values};
use clap::Args;
use std::path::PathBuf;

/// `raycast report`.
#[derive(Debug, Args)]
#[command(after_help = "\
The report is DIR/report.md, with plots as PNG and SVG and numbers as CSV beside it. It takes some
minutes, with --quick some seconds. Embree is measured too if it is installed; the environment
variable EMBREE_LIBRARY names a libembree4 elsewhere.

Examples:
  raycast report -o report
  raycast report bunny.obj teapot.obj -o report --quick")]
pub struct ReportArgs {
    /// Meshes or scene files, each measured on its own [default: the demo's, and some made in code]
    pub files: Vec<PathBuf>,
    /// The folder to write to: created if it does not exist, overwritten if it holds a report
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Also write to a folder that holds something other than a report
    #[arg(long)]
    pub force: bool,
    /// Measure little, in seconds, to see what a report looks like
    #[arg(long)]
    pub quick: bool,
    /// Worker threads, 0 to 256; 0 is one for each hardware thread
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::threads())]
    pub threads: u16,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}
