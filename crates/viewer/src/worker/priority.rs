//! Rendering gives way to the window.

/// Lowers the calling thread's priority a little, so that with a render thread on every core the window's
/// thread still gets one at once. Where the system has no such thing, or refuses, nothing changes.
pub(super) fn give_way() {
    #[cfg(target_os = "linux")]
    {
        // On Linux this is the calling thread's alone (setpriority(2), "C library/kernel
        // differences"). A refusal is harmless.
        let _ = rustix::process::nice(2);
    }
}
