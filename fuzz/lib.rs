//! What all fuzz targets share.

/// Makes this thread the only one of rayon's: a fuzzer runs one input at a time, and the same input
/// should take the same way each time.
///
/// A panic counts once it leaves the target: the fuzzer's own hook, which ends the process at once, is
/// taken away, for readers may catch what a library throws.
pub fn alone() {
    drop(std::panic::take_hook());
    // The only failure is a pool that is there already.
    let _ = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build_global();
}

/// Panics with what does not hold, which is how a fuzzer knows.
///
/// # Panics
/// A check that failed.
pub fn expect(checked: Result<(), String>) {
    if let Err(fault) = checked {
        panic!("{fault}");
    }
}
