//! The `raycast` binary.

use std::process::ExitCode;

fn main() -> ExitCode {
    raycast_viewer::app::run(&[])
}
