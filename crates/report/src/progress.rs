//! Progress of a report.

/// Receives the progress of a report.
pub trait ReportProgress: Sync {
    /// A task of this many steps begins.
    fn begin(&self, what: &'static str, steps: u64);

    /// A step is done.
    fn step(&self);
}

/// Ignores progress.
impl ReportProgress for () {
    fn begin(&self, _: &'static str, _: u64) {}

    fn step(&self) {}
}
