//! The `raycast` binary.

use clap::Parser;
use raycast_viewer::memory::HugePages;
use raycast_viewer::{cli, commands};
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: HugePages = HugePages;

fn main() -> ExitCode {
    let first = std::env::args_os().nth(1);
    if let Some(refused) = first.as_deref().and_then(cli::mistyped) {
        return refused.report();
    }
    match cli::Cli::try_parse() {
        Ok(cli) => commands::run(cli),
        Err(error) => cli::refuse(&error),
    }
}
