//! Signals that end a command: part files are removed, and the exit status names the signal.

use super::part_file::unfinished;
use std::io::ErrorKind;
use std::path::Path;

/// From now on SIGINT, SIGTERM and SIGHUP remove this process's part files and end it with status 128 plus the signal's
/// number: 130, 143, 129. A SIGHUP that is ignored (`nohup`) stays ignored. A file that exceeds its size limit becomes
/// a write error instead of a signal.
///
/// If the system refuses a thread or a handler, signals end the process as they would without this, and the next
/// command removes the part files.
#[cfg(unix)]
pub fn watch_signals() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;
    use std::sync::mpsc::channel;

    // Once it is caught, the write fails; nothing else is needed.
    let _ = signal_hook::flag::register(SIGXFSZ, std::sync::Arc::default());
    let mut watched = vec![SIGINT, SIGTERM];
    if !is_ignored(SIGHUP) {
        watched.push(SIGHUP);
    }
    let (ready, is_ready) = channel::<()>();
    let watch = move || {
        // Registered only now: caught signals need a thread that waits for them.
        let signals = Signals::new(watched);
        drop(ready);
        if let Ok(mut signals) = signals
            && let Some(signal) = signals.forever().next()
        {
            remove_and_exit(128 + signal);
        }
    };
    let spawned = std::thread::Builder::new()
        .name("raycast-signals".to_owned())
        .spawn(watch);
    if spawned.is_ok() {
        // Waits until the sender is dropped: nothing is sent.
        let _ = is_ready.recv();
    }
}

/// From now on Ctrl-C removes this process's part files and ends it with 130.
#[cfg(not(unix))]
pub fn watch_signals() {
    // Refused only if there is a handler already; the next command then removes the part files.
    let _ = ctrlc::set_handler(|| remove_and_exit(130));
}

fn remove_and_exit(status: i32) -> ! {
    // Locked until the process has ended: no part file is created or renamed in between.
    let paths = unfinished();
    for path in paths.iter() {
        if std::fs::remove_file(path).is_err() {
            remove_folder(path);
        }
    }
    #[cfg(unix)]
    // Immediately: other threads must not delay it.
    signal_hook::low_level::exit(status);
    #[cfg(not(unix))]
    std::process::exit(status);
}

/// Removes a folder that other threads still write files into. Files that they create after it was listed are removed
/// at the next try: few are created during one, and none once the folder is gone.
fn remove_folder(path: &Path) {
    const MAX_ATTEMPTS: usize = 1000;
    for _ in 0..MAX_ATTEMPTS {
        match std::fs::remove_dir_all(path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {}
            _ => return,
        }
    }
}

/// Whether the process was started with this signal ignored; known only on Linux.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    ignored(&status, signal)
}

/// Whether a signal is in the `SigIgn` mask of a Linux process's status.
#[cfg(unix)]
fn ignored(status: &str, signal: i32) -> bool {
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_removed_although_threads_write_into_it() {
        use std::sync::atomic::{AtomicBool, Ordering};
        let folder = tempfile::tempdir().expect("a folder");
        for round in 0..8 {
            let part = folder.path().join(round.to_string());
            let tiles = part.join("tiles");
            std::fs::create_dir_all(&tiles).expect("a folder");
            let is_removed = AtomicBool::new(false);
            std::thread::scope(|scope| {
                for thread in 0..2 {
                    let (tiles, is_removed) = (&tiles, &is_removed);
                    scope.spawn(move || {
                        for tile in 0..20_000 {
                            // Fails once the folder is gone.
                            let written =
                                std::fs::write(tiles.join(format!("{thread}-{tile}")), b"");
                            if written.is_err() || is_removed.load(Ordering::Relaxed) {
                                break;
                            }
                        }
                    });
                }
                while std::fs::read_dir(&tiles).map_or(0, Iterator::count) < 10 {}
                remove_folder(&part);
                is_removed.store(true, Ordering::Relaxed);
                assert!(!part.exists());
            });
        }
    }

    #[test]
    fn ignored_signals_are_read_from_the_mask() {
        let status = "Name:\traycast\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000001001\n";
        assert!(ignored(status, 1) && ignored(status, 13));
        assert!(!ignored(status, 2) && !ignored(status, 15));
        assert!(!ignored("Name:\traycast\n", 1));
    }
}
