//! The window's own frame log: what a person feels, written down.
//!
//! One JSON object a line. A frame of the interface gives
//! `{"ms", "frame_ms", "last_frame_ms", "asked", "shown", "stride", "samples", "complete"}`: milliseconds
//! since the window opened, what this frame took up to painting, what the one before took with
//! painting, the newest picture asked for and the one on screen (they count up), the finished pass,
//! and whether the picture on screen is the newest and full. A picture asked for gives
//! `{"ms", "request", "size", "threads"}`.

use crate::ui::canvas::Progress;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Duration;

/// An open log.
#[derive(Debug)]
pub struct FrameLog(BufWriter<File>);

/// What a line tells of a frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameLine {
    /// Since the window opened, at the frame's end.
    pub now: Duration,
    /// What the frame took so far: reading news, laying out.
    pub frame: Duration,
    /// What the last frame took, with its painting.
    pub last_with_painting: Option<f32>,
    /// The newest picture asked for.
    pub asked: u64,
    /// The one on screen.
    pub shown: u64,
    /// How far that is.
    pub progress: Progress,
}

impl FrameLog {
    /// Starts a log in a new file.
    ///
    /// # Errors
    /// The system's refusal.
    pub fn create(path: &Path) -> std::io::Result<Self> {
        Ok(Self(BufWriter::new(File::create(path)?)))
    }

    /// Writes a frame down. A full disk must not end the session: then there is no more log.
    pub fn frame(&mut self, line: FrameLine) {
        let pass = line.progress.pass;
        let value = serde_json::json!({
            "ms": milliseconds(line.now),
            "frame_ms": milliseconds(line.frame),
            "last_frame_ms": line.last_with_painting.map(|seconds| f64::from(seconds) * 1e3),
            "asked": line.asked,
            "shown": line.shown,
            "stride": pass.map(|pass| pass.stride),
            "samples": pass.map(|pass| pass.samples),
            "complete": line.progress.complete && line.asked == line.shown,
        });
        self.write(&value);
    }

    /// Writes a request down.
    pub fn request(&mut self, now: Duration, generation: u64, size: (u32, u32), threads: usize) {
        self.write(&serde_json::json!({
            "ms": milliseconds(now),
            "request": generation,
            "size": [size.0, size.1],
            "threads": threads,
        }));
    }

    fn write(&mut self, value: &serde_json::Value) {
        let _ = writeln!(self.0, "{value}").and_then(|()| self.0.flush());
    }
}

fn milliseconds(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e6).round() * 1e-3
}
