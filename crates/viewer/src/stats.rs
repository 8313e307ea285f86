//! The statistics of a command, as `--stats` writes them.

use crate::failure::Failure;
use crate::output::{Output, print};
use raycast_core::render::TileStats;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The numbers of `--stats`. Times are wall-clock milliseconds.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Stats {
    /// Triangles of the files, dropped ones included.
    pub triangles: u64,
    /// Triangles that no ray can hit.
    pub dropped: u64,
    /// Reading files.
    pub load_ms: f64,
    /// Building the tree.
    pub build_ms: f64,
    /// Visibility: see [`Shares`].
    pub cast_ms: f64,
    /// The rest of the rendering: see [`Shares`].
    pub shade_ms: f64,
    /// From the command's start to a written file.
    pub total_ms: f64,
    /// Rays cast.
    pub rays: u64,
    /// Rays that hit something.
    pub hits: u64,
    /// Rays that are misses because they are invalid.
    pub invalid_rays: u64,
    /// Nodes of the tree whose children's boxes were tested.
    pub nodes: u64,
    /// Triangles tested against packets.
    pub triangles_set_up: u64,
    /// Rays that single precision left undecided, and double precision decided.
    pub double_rays: u64,
    /// Rays that double precision left undecided too, and exact arithmetic decided.
    pub exact_rays: u64,
    /// Millions of rays a second of `cast_ms`; 0 where that is too short to measure.
    pub mrays_per_s: f64,
    /// Workers.
    pub threads: usize,
    /// The instruction set of the kernels.
    pub simd: &'static str,
    /// Whether there was a tree for each mesh, instead of one over all triangles.
    pub instances: bool,
    /// The peak memory of the process; 0 where the system does not report it.
    pub peak_bytes: u64,
}

impl Stats {
    /// The statistics as a JSON object, with a line end.
    ///
    /// # Errors
    /// Numbers that JSON cannot represent.
    pub fn to_json(&self) -> Result<String, Failure> {
        json(self)
    }
}

/// The destination of `--stats`.
#[derive(Clone, Debug)]
pub enum StatsTarget {
    /// None.
    Nowhere,
    /// `-`.
    Stdout,
    /// A file.
    File(Output),
}

impl StatsTarget {
    /// Checks the option's value.
    ///
    /// # Errors
    /// As [`Output::at`].
    pub fn at(path: Option<&Path>, inputs: &[&Path]) -> Result<Self, Failure> {
        match path {
            None => Ok(Self::Nowhere),
            Some(path) if path == Path::new("-") => Ok(Self::Stdout),
            Some(path) => Ok(Self::File(Output::at(path, inputs)?)),
        }
    }

    /// Checks that the destination is none of these files.
    ///
    /// # Errors
    /// As [`Output::check_against`].
    pub fn check_against(&self, opened: &[PathBuf]) -> Result<(), Failure> {
        match self {
            Self::Nowhere | Self::Stdout => Ok(()),
            Self::File(output) => output.check_against(opened),
        }
    }

    /// Writes the statistics.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, stats: &Stats) -> Result<(), Failure> {
        match self {
            Self::Nowhere => Ok(()),
            Self::Stdout => print(&stats.to_json()?),
            Self::File(output) => output.write(stats.to_json()?.as_bytes())?.finish(),
        }
    }
}

/// A render's wall-clock time, divided between visibility and everything else in proportion to the tiles' own times.
/// With several workers the tiles' times sum to more than the wall-clock time, and workers wait for the last tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shares {
    /// Visibility.
    pub cast: Duration,
    /// Shading, lines, conversion, assembling tiles.
    pub shade: Duration,
}

impl Shares {
    /// Divides `wall` in proportion to the tiles' statistics.
    pub fn new(wall: Duration, tiles: &TileStats) -> Self {
        let worked = (tiles.cast + tiles.shade).as_secs_f64();
        let cast = if worked > 0.0 {
            wall.mul_f64(tiles.cast.as_secs_f64() / worked).min(wall)
        } else {
            Duration::ZERO
        };
        Self {
            cast,
            shade: wall - cast,
        }
    }
}

/// Milliseconds, rounded to microseconds.
pub fn milliseconds(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e6).round() / 1e3
}

/// Millions of rays a second, to three decimals; 0 where the time is too short to measure.
pub fn mrays_per_s(rays: u64, time: Duration) -> f64 {
    if time.is_zero() {
        0.0
    } else {
        (rays as f64 / time.as_secs_f64() / 1e3).round() / 1e3
    }
}

/// The peak memory of this process in bytes; 0 where the system does not report it.
pub fn peak_bytes() -> u64 {
    std::fs::read_to_string("/proc/self/status").map_or(0, |status| high_water_mark(&status))
}

/// `VmHWM` of a Linux process's status, in bytes.
fn high_water_mark(status: &str) -> u64 {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kibibytes = line
        .and_then(|rest| rest.trim().strip_suffix("kB"))
        .and_then(|number| number.trim().parse::<u64>().ok());
    kibibytes.unwrap_or(0) * 1024
}

/// Indented JSON with a line end.
///
/// # Errors
/// Numbers that JSON cannot represent.
pub fn json(value: &impl Serialize) -> Result<String, Failure> {
    match serde_json::to_string_pretty(value) {
        Ok(text) => Ok(text + "\n"),
        Err(error) => Err(Failure::could_not(format!("no JSON can be made: {error}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_has_the_promised_keys() {
        let text = Stats::default().to_json().expect("JSON");
        let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        for key in [
            "triangles",
            "dropped",
            "load_ms",
            "build_ms",
            "cast_ms",
            "shade_ms",
            "total_ms",
            "rays",
            "hits",
            "mrays_per_s",
            "threads",
            "simd",
            "peak_bytes",
        ] {
            assert!(value.get(key).is_some(), "{key}");
        }
    }

    #[test]
    fn wall_clock_time_is_shared_out() {
        let ms = Duration::from_millis;
        let tiles = TileStats {
            cast: ms(30),
            shade: ms(10),
            ..TileStats::default()
        };
        let shares = Shares::new(ms(20), &tiles);
        assert_eq!((shares.cast, shares.shade), (ms(15), ms(5)));
        let idle = Shares::new(ms(20), &TileStats::default());
        assert_eq!((idle.cast, idle.shade), (ms(0), ms(20)));
    }

    #[test]
    fn rates_and_times() {
        assert_eq!(milliseconds(Duration::from_nanos(1_234_567)), 1.235);
        assert_eq!(mrays_per_s(2_000_000, Duration::from_millis(500)), 4.0);
        assert_eq!(mrays_per_s(5, Duration::ZERO), 0.0);
    }

    #[test]
    fn reads_the_high_water_mark() {
        let status = "Name:\traycast\nVmPeak:\t  900 kB\nVmHWM:\t   1234 kB\nVmRSS:\t 1 kB\n";
        assert_eq!(high_water_mark(status), 1234 * 1024);
        assert_eq!(high_water_mark("Name:\traycast\n"), 0);
        #[cfg(target_os = "linux")]
        assert!(peak_bytes() > 0);
    }
}
