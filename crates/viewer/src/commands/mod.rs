//! Executing the command line: a file for each command that needs no window.

mod animation;
mod banded;
mod bench;
mod cast;
mod convert;
mod deep_zoom;
mod frames;
mod info;
mod opened_scene;
mod plan;
mod prepare;
mod render;
mod report;
mod saved_scene;
mod schedulers;
mod section;
mod stitch;
mod sub_cameras;
mod texture_map;
mod verify;
mod write_behind;

use crate::failure::Failure;

use crate::cli::{Cli, Subcommand};
use crate::output::print_error;
use crate::{app::open, memory, output, setup};
use raycast_core::Accel;
use raycast_core::formats;
use raycast_core::scene::Scene;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::process::ExitCode;

/// Executes the command line; reports a failure in one line on standard error.
///
/// The exit status is 0 for success, 1 for failure, 2 for bad usage; after signals it is 130, 143 or 129: see
/// [`output::watch_signals`].
pub fn run(cli: Cli) -> ExitCode {
    keep_quiet_about_caught_panics();
    output::watch_signals();
    let command = match cli.command {
        None => {
            return view(open::Options {
                files: cli.files,
                log: None,
                limits: cli.reading.limits(),
            });
        }
        Some(Subcommand::View {
            files,
            log,
            reading,
        }) => {
            let limits = reading.limits();
            return view(open::Options { files, log, limits });
        }
        Some(command) => command,
    };
    let done = match command {
        Subcommand::View { .. } => Ok(()),
        Subcommand::Render(args) => match frames::are_requested(&args) {
            true => frames::run(&args),
            false => render::run(&args),
        },
        Subcommand::Cast(args) => cast::run(&args),
        Subcommand::Stitch(args) => stitch::run(&args),
        Subcommand::Plan(args) => plan::run(&args),
        Subcommand::Convert(args) => convert::run(&args),
        Subcommand::Prepare(args) => prepare::run(&args),
        Subcommand::TextureMap(args) => texture_map::run(&args),
        Subcommand::Section(args) => section::run(&args),
        Subcommand::Info(args) => info::run(&args),
        Subcommand::Bench(args) => bench::run(&args),
        Subcommand::Report(args) => report::run(&args),
        Subcommand::Verify(args) => verify::run(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// Suppresses the messages of panics in libraries that read files: the reader catches them and returns an error,
/// which is reported in one line.
fn keep_quiet_about_caught_panics() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !formats::panic_is_caught() {
            report(panic);
        }
    }));
}

/// Opens the window, unless `RAYCAST_SIMD` names no instruction set of this machine: then no tree could be built.
fn view(options: open::Options) -> ExitCode {
    match setup::instruction_set() {
        Ok(_) => open::run(options),
        Err(failure) => failure.report(),
    }
}

/// A pool of this many worker threads; 0 for one for each hardware thread.
fn workers(threads: u16) -> Result<ThreadPool, Failure> {
    memory::check_threads()?;
    ThreadPoolBuilder::new()
        .num_threads(threads.into())
        .thread_name(|index| format!("raycast-{index}"))
        .build()
        .map_err(|error| Failure::could_not(format!("the workers could not be started: {error}")))
}

/// Reports on standard error what reading left out.
fn warn_of_reading(warnings: &[String], scene: &Scene, accel: &Accel) {
    for warning in warnings {
        warn(warning);
    }
    let dropped = setup::dropped(scene, accel);
    if dropped.total() > 0 {
        warn(&format!(
            "{} of {} triangles were dropped: {}",
            dropped.total(),
            scene.triangle_count(),
            setup::reasons(&dropped)
        ));
    }
}

/// Reports a warning on standard error.
fn warn(text: &str) {
    print_error(&format!("warning: {text}"));
}
