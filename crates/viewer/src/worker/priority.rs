//! The priority of rendering below the window.

/// Lowers the calling thread's priority slightly, so that with a render thread on every core the window's thread
/// still gets one immediately. Does nothing where the system refuses.
pub(super) fn give_way() {
    #[cfg(target_os = "linux")]
    {
        // On Linux this is the calling thread's alone (setpriority(2), "C library/kernel
        // differences"). A refusal is harmless.
        let _ = rustix::process::nice(2);
    }
}
