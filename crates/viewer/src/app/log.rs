//! The window's frame log: the times of frames and pictures.
//!
//! One JSON object a line. A frame of the interface gives
//! `{"ms", "frame_ms", "last_frame_ms", "asked", "shown", "stride", "samples", "complete"}`: milliseconds
//! since the window opened, what this frame took up to painting, what the one before took with
//! painting, the newest picture asked for and the one on screen (they count up), the finished pass,
//! and whether the picture on screen is the newest and full. A picture asked for gives
//! `{"ms", "request", "size", "threads"}`.

use crate::failure::Failure;
use crate::output::Output;
use crate::ui::canvas::PictureProgress;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A log. Its lines are kept in memory until the first scene is read: the log's file could be one that the scene is
/// read from.
#[derive(Debug)]
pub struct FrameLog {
    output: Output,
    lines: Lines,
}

/// The destination of lines.
#[derive(Debug)]
enum Lines {
    Held(Vec<u8>),
    Written(BufWriter<File>),
    Lost,
}

/// The values of a frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameLine {
    /// The time at the frame's end, since the window opened.
    pub now: Duration,
    /// The frame's duration up to painting: applying news, layout.
    pub frame: Duration,
    /// The last frame's duration, with painting.
    pub last_with_painting: Option<f32>,
    /// The newest requested picture.
    pub asked: u64,
    /// The picture on screen.
    pub shown: u64,
    /// Its progress.
    pub progress: PictureProgress,
}

impl FrameLog {
    /// A log at a path, which must be none of these files.
    ///
    /// # Errors
    /// As [`Output::at`].
    pub fn at(path: &Path, files: &[PathBuf]) -> Result<Self, Failure> {
        let inputs: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
        Ok(Self {
            output: Output::at(path, &inputs)?,
            lines: Lines::Held(Vec::new()),
        })
    }

    /// Starts writing: replaces the file's contents by the lines so far, and writes further lines immediately.
    ///
    /// # Errors
    /// A file that is one of those `opened`, or that cannot be written: nothing is logged then.
    pub fn begin(&mut self, opened: &[PathBuf]) -> Result<(), Failure> {
        let Lines::Held(held) = &self.lines else {
            return Ok(());
        };
        let opened = self.output.check_against(opened);
        let file = opened.and_then(|()| self.output.open_in_place());
        let mut file = match file {
            Ok(file) => BufWriter::new(file),
            Err(failure) => {
                self.lines = Lines::Lost;
                return Err(failure);
            }
        };
        let _ = file.write_all(held).and_then(|()| file.flush());
        self.lines = Lines::Written(file);
        Ok(())
    }

    /// Logs a frame. A full disk must not end the session: logging stops then.
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

    /// Logs a request.
    pub fn request(&mut self, now: Duration, generation: u64, size: (u32, u32), threads: usize) {
        self.write(&serde_json::json!({
            "ms": milliseconds(now),
            "request": generation,
            "size": [size.0, size.1],
            "threads": threads,
        }));
    }

    fn write(&mut self, value: &serde_json::Value) {
        let _ = match &mut self.lines {
            Lines::Held(held) => writeln!(held, "{value}"),
            Lines::Written(file) => writeln!(file, "{value}").and_then(|()| file.flush()),
            Lines::Lost => Ok(()),
        };
    }
}

fn milliseconds(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e6).round() * 1e-3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_the_scene_is_not_written_over() {
        let folder = tempfile::tempdir().expect("a folder");
        let [mesh, library, path] =
            ["mesh.obj", "mesh.mtl", "log"].map(|name| folder.path().join(name));
        for file in [&mesh, &library, &path] {
            std::fs::write(file, "what it held").expect("written");
        }
        let files = [mesh.clone()];
        assert!(FrameLog::at(&mesh, &files).is_err());

        let opened = [mesh, library.clone()];
        let mut log = FrameLog::at(&library, &files).expect("not yet known");
        assert!(log.begin(&opened).is_err());
        log.request(Duration::ZERO, 1, (1, 1), 1);
        assert_eq!(std::fs::read(&library).expect("the file"), b"what it held");

        let mut log = FrameLog::at(&path, &files).expect("a log");
        log.request(Duration::ZERO, 1, (1, 1), 1);
        assert_eq!(std::fs::read(&path).expect("the file"), b"what it held");
        log.begin(&opened).expect("another file");
        log.request(Duration::ZERO, 2, (1, 1), 1);
        let text = std::fs::read_to_string(&path).expect("the log");
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 2, "{text}");
        assert!(lines[0].contains("\"request\":1") && lines[1].contains("\"request\":2"));
    }
}
