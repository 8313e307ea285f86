//! The `raycast` binary.

use clap::Parser;
use raycast_viewer::{cli, commands};
use std::process::ExitCode;

fn main() -> ExitCode {
    match cli::Cli::try_parse() {
        Ok(cli) => commands::run(cli),
        Err(error) => cli::refuse(&error),
    }
}
