//! How far a report is.

/// Who wants to know how far a report is.
pub trait ReportProgress: Sync {
    /// So many steps of something begin.
    fn begin(&self, what: &'static str, steps: u64);

    /// One of them is done.
    fn step(&self);
}

/// Nobody.
impl ReportProgress for () {
    fn begin(&self, _: &'static str, _: u64) {}

    fn step(&self) {}
}
