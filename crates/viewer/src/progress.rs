//! A command's progress, on standard error if that is a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// The units of loading's progress: finer than a terminal can show.
const BAR_STEPS: u64 = 1000;

/// A bar for one stage after another. Its counts are atomic: workers add to them, and a thread of the bar's own
/// draws.
#[derive(Debug)]
pub struct TerminalProgress {
    bar: ProgressBar,
}

impl TerminalProgress {
    /// A bar on standard error, or a hidden one if that is no terminal.
    pub fn new() -> Self {
        if !std::io::stderr().is_terminal() {
            return Self::hidden();
        }
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        // The bar panics where it gets no thread of its own, as under a limit of address space: it is then drawn
        // whenever it changes.
        let probe = std::thread::Builder::new().spawn(|| ());
        if probe.is_ok_and(|probe| probe.join().is_ok()) {
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        Self { bar }
    }

    /// A hidden bar.
    pub fn hidden() -> Self {
        Self {
            bar: ProgressBar::hidden(),
        }
    }

    /// Starts the stage of loading files.
    pub fn loading(&self) {
        self.begin("loading", "{msg:>9} {bar:40} {percent:>3} %", BAR_STEPS);
    }

    /// Sets the fraction that is loaded, 0 to 1.
    pub fn loaded(&self, share: f32) {
        self.bar
            .set_position((f64::from(share) * BAR_STEPS as f64) as u64);
    }

    /// Starts the stage of building the tree, whose progress is unknown.
    pub fn building(&self) {
        self.begin("building", "{msg:>9} {spinner} {elapsed}", 1);
    }

    /// Starts a stage of `count` steps, counted by [`TerminalProgress::done`].
    pub fn counting(&self, what: &'static str, count: u64) {
        self.begin(what, "{msg:>9} {bar:40} {pos}/{len} {eta}", count);
    }

    /// Counts steps that are done.
    pub fn done(&self, count: u64) {
        self.bar.inc(count);
    }

    /// Removes the bar.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }

    fn begin(&self, what: &'static str, template: &str, length: u64) {
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.bar.set_style(style.progress_chars("=> "));
        }
        self.bar.set_message(what);
        self.bar.set_length(length);
        self.bar.set_position(0);
        self.bar.reset_elapsed();
    }
}

impl Default for TerminalProgress {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for TerminalProgress {
    /// An error's line must not share a line with the bar.
    fn drop(&mut self) {
        self.clear();
    }
}
