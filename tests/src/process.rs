//! What the system says of a running program: its memory, open files and threads. Linux alone tells.

use std::fs;
use std::io;

/// What a program has of the system's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Usage {
    /// Memory that is resident, in kB.
    pub resident_kb: u64,
    /// Files, sockets and pipes that are open.
    pub files: usize,
    /// Threads.
    pub threads: usize,
}

impl Usage {
    /// What the process of this number has now.
    ///
    /// # Errors
    /// A process that has ended, or a system without `/proc`.
    pub fn of(process: u32) -> io::Result<Self> {
        let status = fs::read_to_string(format!("/proc/{process}/status"))?;
        let number = |key: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(key));
            let word = line.and_then(|rest| rest.trim_start_matches(':').split_whitespace().next());
            word.and_then(|word| word.parse::<u64>().ok())
                .ok_or_else(|| io::Error::other(format!("/proc/{process}/status has no {key}")))
        };
        Ok(Self {
            resident_kb: number("VmRSS")?,
            files: fs::read_dir(format!("/proc/{process}/fd"))?.count(),
            threads: number("Threads")? as usize,
        })
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_counted_while_it_is_open() {
        // Other tests open files too: so many at once they do not.
        const MANY: usize = 200;
        let count = || {
            Usage::of(std::process::id())
                .expect("this process runs")
                .files
        };
        let before = count();
        let open = [(); MANY].map(|()| fs::File::open("/dev/null").expect("it is there"));
        let during = count();
        drop(open);
        assert!(during > before + MANY / 2, "{before}, then {during}");
        assert!(count() < during - MANY / 2);
    }

    #[test]
    fn a_process_that_is_none_is_an_error() {
        assert!(Usage::of(u32::MAX).is_err());
    }
}
