//! Writing a picture band by band: pictures larger than memory.

use super::Failure;
use crate::memory;
use crate::output::{Journal, Output, Unfinished};
use crate::progress::TerminalProgress;
use raycast_core::camera::Rect;
use raycast_core::digest::Digest;
use raycast_core::picture::{BandSizes, Bands, Format, Picture, Recipe};
use std::path::Path;
use std::time::{Duration, Instant};

/// How often what was written is noted in the journal: so much work at most is done twice.
const NOTED_EVERY: Duration = Duration::from_millis(250);

/// A picture's file, to be written band by band.
pub(super) struct Banded<'a> {
    pub(super) format: Format,
    pub(super) bands: Bands,
    /// What the picture is made of: what a part file must be of to be gone on with.
    pub(super) recipe: &'a Recipe,
    pub(super) output: &'a Output,
    /// Whether to go on with what an earlier command left.
    pub(super) resume: bool,
}

impl<'a> Banded<'a> {
    /// A picture of a recipe, if its kind of file is written in bands at its size.
    ///
    /// # Errors
    /// What the kind of file cannot hold; a band for which there is not the memory.
    pub(super) fn of(
        name: &Path,
        format: Format,
        recipe: &'a Recipe,
        output: &'a Output,
        resume: bool,
    ) -> Result<Option<Self>, Failure> {
        let plane = recipe.camera.plane();
        // What stands before TIFF's and EXR's bands is known after them.
        let goes_back = matches!(format, Format::Tiff | Format::Exr);
        if !format.is_banded(plane.columns, plane.rows) || (goes_back && !output.can_seek()) {
            return Ok(None);
        }
        let size = (plane.columns, plane.rows);
        let bands = Bands::new(format, size, recipe.is_opaque(), Some(recipe))?;
        memory::check_band(name, bands.memory())?;
        Ok(Some(Self {
            format,
            bands,
            recipe,
            output,
            resume,
        }))
    }

    /// Writes all bands, each as `make` gives it, from the first that is not there yet.
    ///
    /// # Errors
    /// What `make` fails at; a file that cannot be written.
    pub(super) fn write(
        &self,
        progress: &TerminalProgress,
        mut make: impl FnMut(Rect) -> Result<Picture, Failure>,
    ) -> Result<Written, Failure> {
        let Self { bands, output, .. } = self;
        let head = bands.head();
        let (mut file, mut journal) = if self.resume {
            let (file, journal) = output.resume(&self.key(), &head)?;
            (file, Some(journal))
        } else {
            let mut file = output.create()?;
            file.append(&head)?;
            (file, None)
        };
        let known = journal.iter().flat_map(|journal| journal.pieces());
        let mut sizes: Vec<BandSizes> = known.map(|words| read(words)).collect::<Result<_, _>>()?;
        progress.counting("rendering", bands.len() as u64);
        progress.done(sizes.len() as u64);
        let mut noted = Instant::now();
        for index in sizes.len()..bands.len() {
            let rect = bands.rect(index);
            let picture = make(rect)?;
            let band = bands.encode(index, &picture, rect.y)?;
            drop(picture);
            file.append(&band.bytes)?;
            if let Some(journal) = &mut journal {
                journal.remember(&band.bytes, &words(&band.sizes));
                if noted.elapsed() >= NOTED_EVERY {
                    file.note(journal)?;
                    noted = Instant::now();
                }
            }
            sizes.push(band.sizes);
            progress.done(1);
        }
        if let Some(journal) = &mut journal {
            file.note(journal)?;
        }
        let (known, tail) = bands.finish(&sizes)?;
        file.append(&tail)?;
        if known != head {
            file.rewrite_head(&known)?;
        }
        Ok(Written { file, journal })
    }

    /// What a part file must be of, to be gone on with: another version may compress otherwise.
    fn key(&self) -> String {
        let mut of = format!("{:?}\n", self.format).into_bytes();
        of.extend(self.recipe.to_string().bytes());
        of.extend(self.bands.head());
        let version = env!("CARGO_PKG_VERSION");
        format!("raycast {version} journal 1 of {}", Digest::of(&of))
    }
}

/// A file that was written, and is to be put in its place.
pub(super) struct Written {
    file: Unfinished,
    journal: Option<Journal>,
}

impl Written {
    /// A file that has no journal.
    pub(super) fn whole(file: Unfinished) -> Self {
        Self {
            file,
            journal: None,
        }
    }

    /// Puts it there.
    ///
    /// # Errors
    /// As [`Unfinished::finish`].
    pub(super) fn finish(self) -> Result<(), Failure> {
        self.file.finish()?;
        if let Some(journal) = self.journal {
            journal.remove();
        }
        Ok(())
    }
}

/// What a journal says of a band: its checksum, and the length of each part.
fn words(sizes: &BandSizes) -> String {
    let parts = sizes.parts.iter().map(|part| format!(" {part}"));
    std::iter::once(sizes.check.to_string())
        .chain(parts)
        .collect()
}

fn read(words: &str) -> Result<BandSizes, Failure> {
    let numbers: Result<Vec<u32>, _> = words.split(' ').map(str::parse).collect();
    match numbers.as_deref() {
        Ok([check, parts @ ..]) => Ok(BandSizes {
            parts: parts.to_vec(),
            check: *check,
        }),
        _ => Err(Failure::could_not(
            "the journal of its part file is not this program's",
        )),
    }
}
