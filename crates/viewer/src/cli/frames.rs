//! Options for the frames of an animation, and the names of their files.

use clap::Args;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// `--frames`: the first and the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRange {
    /// The first frame.
    pub first: u32,
    /// The last frame, included.
    pub last: u32,
}

impl FrameRange {
    /// Frames are numbered below this: a mistyped number would otherwise fill a disk.
    pub const END: u32 = 1_000_000;

    /// The frames from the first to the last; `None` if there are none, or if they are numbered too high.
    pub fn new(first: u32, last: u32) -> Option<Self> {
        (first <= last && last < Self::END).then_some(Self { first, last })
    }

    /// The number of frames.
    pub fn count(&self) -> u32 {
        // Numbers are below END.
        self.last - self.first + 1
    }

    /// The frames' numbers, ascending.
    pub fn numbers(&self) -> std::ops::RangeInclusive<u32> {
        self.first..=self.last
    }
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (first, last) = text.split_once("..").unwrap_or((text, text));
        let ends = first.parse().ok().zip(last.parse().ok());
        ends.and_then(|(first, last)| Self::new(first, last))
            .ok_or_else(|| {
                let end = Self::END;
                format!("expected the first frame and the last, as 0..99, below {end}")
            })
    }
}

/// The frames of an animation.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Animation")]
pub struct FrameArgs {
    /// Render these frames, both ends included, of --turntable or of the scene file's keyframes: each to an image of
    /// its own, -o out-%05d.png, or all to one animated PNG or GIF, -o out.png, -o out.gif [default: all, with
    /// --turntable or an output that only frames can have, as out-%05d.png, out.apng or out.gif]
    #[arg(long, value_name = "A..B")]
    pub frames: Option<FrameRange>,
    /// Turn the camera once around its target in this many frames
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=999_999))]
    pub turntable: Option<u32>,
    /// Frames per second of an animated PNG or GIF, a GIF's at most 50 [default: 25]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub rate: Option<u16>,
}

impl FrameArgs {
    /// The frames that options name; `None` without any.
    pub fn range(&self) -> Option<FrameRange> {
        let turn = |count: u32| FrameRange {
            first: 0,
            last: count - 1,
        };
        self.frames.or(self.turntable.map(turn))
    }
}

/// The file of a frame: in the file's name `%d` stands for its number, and `%05d` for its number with at least five
/// digits. `None` where the name has no such placeholder, or several.
pub fn frame_path(pattern: &Path, frame: u32) -> Option<PathBuf> {
    let name = pattern.file_name()?.to_str()?;
    let (before, after) = name.split_once('%')?;
    let digits = after.find('d')?;
    let width = match &after[..digits] {
        "" => 0,
        width => width
            .strip_prefix('0')?
            .parse()
            .ok()
            .filter(|width| *width < 20)?,
    };
    let after = &after[digits + 1..];
    if after.contains('%') {
        return None;
    }
    let name = OsString::from(format!("{before}{frame:0width$}{after}"));
    Some(pattern.with_file_name(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_have_both_ends() {
        let range: FrameRange = "3..12".parse().expect("a range");
        assert_eq!((range.count(), range.numbers().last()), (10, Some(12)));
        assert_eq!("7".parse(), Ok(FrameRange { first: 7, last: 7 }));
        for bad in [
            "",
            "..",
            "3..",
            "..4",
            "4..3",
            "-1..3",
            "0..1000000",
            "1...3",
        ] {
            assert!(bad.parse::<FrameRange>().is_err(), "{bad}");
        }
    }

    #[test]
    fn a_frames_number_stands_where_the_name_says() {
        let path = |pattern: &str| frame_path(Path::new(pattern), 42);
        for (pattern, expected) in [
            ("out-%05d.png", "out-00042.png"),
            ("a%b/%d.png", "a%b/42.png"),
            ("x%01d", "x42"),
        ] {
            assert_eq!(path(pattern), Some(PathBuf::from(expected)), "{pattern}");
        }
        for bad in [
            "out.png",
            "%",
            "%5d.png",
            "%s.png",
            "%d-%d.png",
            "%0d.png",
            "%099d.png",
        ] {
            assert_eq!(path(bad), None, "{bad}");
        }
    }
}
