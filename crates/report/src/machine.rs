//! The machine and the program version of a report.

use raycast_core::Simd;
use std::fmt;

/// The machine, and the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// The processor's name.
    pub processor: String,
    /// Cores available to this process.
    pub cores: usize,
    /// Worker threads.
    pub threads: usize,
    /// The instruction set of the kernels.
    pub simd: &'static str,
    /// Operating system and architecture.
    pub system: String,
    /// The commit that the program was built from.
    pub commit: &'static str,
}

impl Machine {
    /// This machine, with `threads` worker threads.
    pub fn this(threads: usize) -> Self {
        let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        Self {
            processor: processor(&cpuinfo)
                .unwrap_or("unknown processor")
                .to_owned(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            threads,
            simd: Simd::best().name(),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            commit: option_env!("RAYCAST_COMMIT").unwrap_or("unknown"),
        }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}, {} cores, {}; {} threads, {} instructions; commit {}",
            self.processor, self.cores, self.system, self.threads, self.simd, self.commit
        )
    }
}

/// The processor's name in the text of `/proc/cpuinfo`.
fn processor(cpuinfo: &str) -> Option<&str> {
    let line = cpuinfo
        .lines()
        .find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, name)| name.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_the_processors_name() {
        let cpuinfo = "processor\t: 0\nmodel name\t: A CPU @ 2.50GHz\nflags\t\t: fpu\n";
        assert_eq!(processor(cpuinfo), Some("A CPU @ 2.50GHz"));
        assert_eq!(processor(""), None);
    }
}
