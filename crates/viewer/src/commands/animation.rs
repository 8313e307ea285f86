//! All frames in one file: an animated PNG or GIF.

use super::opened_scene::OpenedScene;
use super::write_behind::write_behind;
use super::{Failure, warn};
use crate::cli::{FrameRange, RenderArgs};
use crate::memory;
use crate::output::{Output, Unfinished};
use crate::progress::TerminalProgress;
use raycast_core::picture::{
    AnimatedGif, AnimatedPng, Format, ImageError, Picture, Recipe, memory_of,
};
use std::ffi::OsStr;
use std::path::Path;

/// The default frames a second.
const RATE: u16 = 25;

/// A format of files that hold several frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AnimationFormat {
    Png,
    Gif,
}

impl AnimationFormat {
    /// The format that a file's extension names.
    pub(super) fn from_name(path: &Path) -> Option<Self> {
        let extension = path.extension().and_then(OsStr::to_str)?;
        match extension.to_ascii_lowercase().as_str() {
            "png" | "apng" => Some(Self::Png),
            "gif" => Some(Self::Gif),
            _ => None,
        }
    }

    /// Refuses a rate that the format cannot hold, and says where it has to round frames' times.
    pub(super) fn check_rate(self, args: &RenderArgs) -> Result<(), Failure> {
        let rate = args.animation.rate.unwrap_or(RATE);
        if self == Self::Png {
            return Ok(());
        }
        let most = Gif::MOST_RATE;
        let name = args.output.display();
        if rate > most {
            return Err(Failure::usage(format!(
                "{name}: a GIF has at most {most} frames a second (--rate {rate}): browsers show faster ones at 10"
            )));
        }
        let (least, most) = Gif::delays(rate);
        if least != most {
            warn(&format!(
                "{name}: a GIF's delays are hundredths of a second: at {rate} frames a second they are {least} and {most} by turns"
            ));
        }
        Ok(())
    }

    /// An upper bound of the bytes that rendering and writing takes: the frame that is written, the next, and the
    /// encoder's.
    fn memory_for(self, columns: u32, rows: u32) -> u64 {
        match self {
            Self::Png => 2 * Format::Png.memory_for(columns, rows),
            Self::Gif => 2 * memory_of(columns, rows, false) + Gif::memory_for(columns, rows),
        }
    }

    /// Renders all frames into one file; a frame is rendered while the one before is written.
    pub(super) fn write(
        self,
        args: &RenderArgs,
        opened: &OpenedScene,
        range: FrameRange,
        progress: &TerminalProgress,
        mut render: impl FnMut(u32) -> Result<Picture, Failure>,
    ) -> Result<(), Failure> {
        let output = Output::at(&args.output, &[])?;
        let plane = opened.view.camera.plane();
        let size = (plane.columns, plane.rows);
        let memory_for = |columns, rows| self.memory_for(columns, rows);
        memory::check_picture(&args.output, size, memory_for, "")?;
        let rate = args.animation.rate.unwrap_or(RATE);
        let is_opaque = Recipe::of(&opened.view).is_opaque();
        let mut file: Unfinished = output.create()?;
        let mut animation = match self {
            Self::Png => {
                let count = range.count();
                Animation::Png(AnimatedPng::new(&mut file, size, count, rate, is_opaque)?)
            }
            Self::Gif => Animation::Gif(AnimatedGif::new(&mut file, size, rate, is_opaque)?),
        };
        let write = |picture: Picture| -> Result<(), Failure> {
            animation.add(&picture)?;
            progress.done(1);
            Ok(())
        };
        write_behind(write, |send| {
            for frame in range.numbers() {
                if send.send(render(frame)?).is_err() {
                    // The writer failed, and returns the error.
                    break;
                }
            }
            Ok(())
        })?;
        animation.finish()?;
        file.finish()
    }
}

/// A GIF that is written to a file.
type Gif<'a> = AnimatedGif<&'a mut Unfinished>;

/// A file of several frames while it is written.
enum Animation<'a> {
    Png(AnimatedPng<&'a mut Unfinished>),
    Gif(Gif<'a>),
}

impl Animation<'_> {
    fn add(&mut self, picture: &Picture) -> Result<(), ImageError> {
        match self {
            Self::Png(png) => png.add(picture),
            Self::Gif(gif) => gif.add(picture),
        }
    }

    fn finish(self) -> Result<(), ImageError> {
        match self {
            Self::Png(png) => png.finish(),
            Self::Gif(gif) => gif.finish(),
        }
    }
}
