//! What a command took, as `--stats` writes it.

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
    /// Triangles that no ray can meet.
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
    /// Rays that met something.
    pub hits: u64,
    /// Rays that were misses for being no rays.
    pub invalid_rays: u64,
    /// Nodes of the tree that tiles went through.
    pub nodes: u64,
    /// Triangles set up for blocks of rays.
    pub triangles_set_up: u64,
    /// Rays that single precision left open, and doubles decided.
    pub double_rays: u64,
    /// Rays that doubles left open too, decided by exact arithmetic.
    pub exact_rays: u64,
    /// Millions of rays a second of `cast_ms`; 0 where that is too short to tell.
    pub mrays_per_s: f64,
    /// Workers.
    pub threads: usize,
    /// The instructions of the casting loops.
    pub simd: &'static str,
    /// Whether there was a tree for each mesh instead of one over all triangles.
    pub instances: bool,
    /// The most memory that the process held at once; 0 where the system does not tell.
    pub peak_bytes: u64,
}

impl Stats {
    /// One JSON object and a line's end.
    ///
    /// # Errors
    /// Numbers that JSON does not have.
    pub fn to_json(&self) -> Result<String, Failure> {
        json(self)
    }
}

/// Where `--stats` go.
#[derive(Clone, Debug)]
pub enum StatsTarget {
    /// Nobody asked for them.
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

    /// Checks that they do not go to one of these files.
    ///
    /// # Errors
    /// As [`Output::check_against`].
    pub fn check_against(&self, opened: &[PathBuf]) -> Result<(), Failure> {
        match self {
            Self::Nowhere | Self::Stdout => Ok(()),
            Self::File(output) => output.check_against(opened),
        }
    }

    /// Writes them.
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

/// A render's wall-clock time, shared out between visibility and everything else as the tiles' own
/// times are: with more workers than one, tiles' times add up to more than what passed, and while
/// the last tiles are made some workers wait.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shares {
    /// Visibility.
    pub cast: Duration,
    /// Shading, lines, conversion, putting tiles together.
    pub shade: Duration,
}

impl Shares {
    /// Shares out `wall` by the sum of all tiles' statistics.
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

/// Milliseconds, to the microsecond.
pub fn milliseconds(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e6).round() / 1e3
}

/// Millions of rays a second, to three decimals; 0 where the time is too short to tell.
pub fn mrays_per_s(rays: u64, time: Duration) -> f64 {
    if time.is_zero() {
        0.0
    } else {
        (rays as f64 / time.as_secs_f64() / 1e3).round() / 1e3
    }
}

/// The most memory that this process has held at once, in bytes; 0 where the system does not tell.
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

/// JSON for people and programs: indented, with a line's end.
///
/// # Errors
/// What JSON does not have.
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
