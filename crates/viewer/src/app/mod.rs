//! The window's state and what its commands do to it.

use std::path::PathBuf;
use std::process::ExitCode;

/// Opens the window on `files`; on the demo scene if there are none. Returns when it is closed.
///
/// With no display it prints one line that names `raycast render`, and exits with 1.
pub fn run(_files: &[PathBuf]) -> ExitCode {
    ExitCode::FAILURE
}
