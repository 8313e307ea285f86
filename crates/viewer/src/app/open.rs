//! Opens the window, or prints in one line why it cannot.

use super::frames::{self, Frames};
use super::log::FrameLog;
use super::{App, Link};
use crate::output::print_error;
use crate::state::listing::in_working_folder;
use crate::worker::SharedClock;
use crate::worker::outbox::Outbox;
use raycast_core::formats::Limits;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use winit::event_loop::EventLoop;

/// Options of the window.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Meshes and scenes to open together; the demo scene if there are none.
    pub files: Vec<PathBuf>,
    /// Where to write the window's [frame log](super::log). Such a window starts from the default
    /// settings and remembers nothing, so that two logs can be compared.
    pub log: Option<PathBuf>,
    /// The limits of reading files.
    pub limits: Limits,
}

/// Opens the window; on the demo scene if there are no files. Returns when it is closed.
///
/// With no display it prints one line that names `raycast render`, and exits with 1.
pub fn run(options: Options) -> ExitCode {
    let log = options.log.as_deref();
    let log = match log
        .map(|path| FrameLog::at(path, &options.files))
        .transpose()
    {
        Ok(log) => log,
        Err(failure) => return failure.report(),
    };
    if !has_display() {
        return refuse(NO_DISPLAY);
    }
    let native = native(log.is_none());
    // winit panics for some displays that do not exist; its message is discarded.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let opened = AtomicBool::new(false);
    let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        LAST_ERROR.listen();
        let event_loop = EventLoop::with_user_event().build()?;
        let outbox = Arc::new(Outbox::default());
        let opening = Instant::now();
        let clock: SharedClock = Arc::new(move || opening.elapsed());
        let link = Link {
            outbox: Arc::clone(&outbox),
            clock: Arc::clone(&clock),
            nudge: frames::nudge(&event_loop),
            limits: options.limits,
        };
        let create: eframe::AppCreator<'_> = Box::new(|context| {
            std::panic::set_hook(hook);
            let files = options.files.into_iter().map(in_working_folder).collect();
            let app = App::new(context, files, log, link)?;
            opened.store(true, Ordering::Relaxed);
            Ok(Box::new(app))
        });
        let window = eframe::create_native("raycast", native, create, &event_loop);
        event_loop.run_app(&mut Frames::new(window, outbox, clock))
    }));
    let failure = match &outcome {
        Ok(Err(error)) => Some(error.to_string()),
        _ => LAST_ERROR.take(),
    };
    let reason = match failure {
        Some(error) => format!(" ({})", last_words(&error)),
        None => String::new(),
    };
    match (opened.into_inner(), outcome) {
        (true, Ok(Ok(()))) if reason.is_empty() => ExitCode::SUCCESS,
        (true, _) => refuse(&format!(
            "the window was closed by a fault of its own{reason}"
        )),
        (false, _) => refuse(&format!("{NO_WINDOW}{reason}")),
    }
}

fn native(remembers: bool) -> eframe::NativeOptions {
    eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_app_id("raycast")
            .with_title("RayCast")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([640.0, 400.0])
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Glow,
        persist_window: remembers,
        // Without a GPU the cores that cast rays also paint the window. Everything drawn is flat or the picture itself,
        // and needs no dithering.
        dithering: false,
        ..Default::default()
    }
}

const NO_DISPLAY: &str =
    "there is no display to open a window on; `raycast render` makes pictures without one";
const NO_WINDOW: &str =
    "the window could not be opened; `raycast render` makes pictures without one";

/// The line that explains why there is no window.
fn refuse(reason: &str) -> ExitCode {
    print_error(reason);
    ExitCode::FAILURE
}

/// The last part of an error's chain, on one line: the parts before it are positions in other crates' sources.
fn last_words(text: &str) -> String {
    let last = text.rsplit(": ").next().unwrap_or(text);
    last.trim_end_matches(')')
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}

/// Whether the environment names a display. Systems without X11 and Wayland always have one.
fn has_display() -> bool {
    if !cfg!(all(unix, not(target_vendor = "apple"))) {
        return true;
    }
    ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"]
        .iter()
        .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

/// Collects eframe's error: with an event loop of our own it is only logged.
struct LastError(Mutex<Option<String>>);

static LAST_ERROR: LastError = LastError(Mutex::new(None));

impl LastError {
    fn listen(&'static self) {
        // A logger is set already only if the process had another window.
        if log::set_logger(self).is_ok() {
            log::set_max_level(log::LevelFilter::Error);
        }
    }

    fn take(&self) -> Option<String> {
        self.lock().take()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Option<String>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl log::Log for LastError {
    fn enabled(&self, about: &log::Metadata<'_>) -> bool {
        about.target().starts_with("eframe")
    }

    fn log(&self, record: &log::Record<'_>) {
        let text = record.args().to_string();
        if self.enabled(record.metadata()) && text.starts_with("Exiting because of error") {
            *self.lock() = Some(text);
        }
    }

    fn flush(&self) {}
}
