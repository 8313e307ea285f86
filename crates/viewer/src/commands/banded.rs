//! Writing a large picture in bands, with memory for a band at a time.

use super::Failure;
use crate::memory;
use crate::output::{Journal, Output, Unfinished};
use crate::progress::TerminalProgress;
use raycast_core::camera::Rect;
use raycast_core::digest::Digest;
use raycast_core::picture::{BandSizes, Bands, Format, Picture, Recipe};
use std::path::Path;
use std::time::{Duration, Instant};

/// The interval at which progress is stored in the journal: the most work that is repeated after an interruption. With
/// a shorter one syncing takes longer.
const JOURNAL_INTERVAL: Duration = Duration::from_millis(250);

/// A picture's file that is written in bands.
pub(super) struct Banded<'a> {
    pub(super) format: Format,
    pub(super) bands: Bands,
    /// The picture's recipe; a part file is resumed only if it has the same.
    pub(super) recipe: &'a Recipe,
    /// The rectangle of the picture that the file has.
    pub(super) rect: Rect,
    pub(super) output: &'a Output,
    /// Whether to resume an earlier command's part file.
    pub(super) resume: bool,
}

impl<'a> Banded<'a> {
    /// The file of a picture, or of `part` of it, if its format is written in bands at its size. A fragment is never
    /// resumed.
    ///
    /// # Errors
    /// A picture that the format cannot hold; too little memory for a band.
    pub(super) fn new(
        name: &Path,
        format: Format,
        (recipe, part): (&'a Recipe, Option<Rect>),
        output: &'a Output,
        resume: bool,
    ) -> Result<Option<Self>, Failure> {
        let rect = part.unwrap_or(recipe.camera.whole().rect);
        // The heads of TIFF, EXR and fragments are written last, when the sizes and pixels of all bands are known.
        let goes_back = matches!(format, Format::Tiff | Format::Exr) || part.is_some();
        if !format.is_banded(rect.width, rect.height) || (goes_back && !output.can_seek()) {
            return Ok(None);
        }
        let size = (rect.width, rect.height);
        let bands = match part {
            Some(rect) => Bands::of_fragment(format, rect, recipe)?,
            None => Bands::new(format, size, recipe.is_opaque(), Some(recipe))?,
        };
        memory::check_band(name, bands.memory())?;
        Ok(Some(Self {
            format,
            bands,
            recipe,
            rect,
            output,
            resume: resume && part.is_none(),
        }))
    }

    /// Writes all bands, as `render` gives them for rectangles of the whole picture, from the first that is missing.
    ///
    /// # Errors
    /// Those of `render`; a file that cannot be written.
    pub(super) fn write(
        &self,
        progress: &TerminalProgress,
        mut render: impl FnMut(Rect) -> Result<Picture, Failure>,
    ) -> Result<Written, Failure> {
        let Self { bands, output, .. } = self;
        let head = bands.head();
        let (mut file, mut journal) = if self.resume {
            let (file, journal) = output.resume(self.key(), &head)?;
            (file, Some(journal))
        } else {
            let mut file = output.create()?;
            file.append(&head)?;
            (file, None)
        };
        let known = journal.iter().flat_map(|journal| journal.pieces());
        let mut sizes: Vec<BandSizes> = known
            .map(|entry| parse_band_entry(entry))
            .collect::<Result<_, _>>()?;
        progress.counting("rendering", bands.len() as u64);
        progress.done(sizes.len() as u64);
        let mut digest = bands.pixel_digest();
        let mut last_note = Instant::now();
        for index in sizes.len()..bands.len() {
            let rect = bands.rect(index);
            let picture = render(Rect {
                x: self.rect.x,
                y: self.rect.y + rect.y,
                ..rect
            })?;
            let band = bands.encode(index, &picture, rect.y)?;
            if let Some(digest) = &mut digest {
                digest.add(&picture);
            }
            drop(picture);
            file.append(&band.bytes)?;
            if let Some(journal) = &mut journal {
                journal.record(&band.bytes, &band_entry(&band.sizes));
                if last_note.elapsed() >= JOURNAL_INTERVAL {
                    file.store_journal(journal)?;
                    last_note = Instant::now();
                }
            }
            sizes.push(band.sizes);
            progress.done(1);
        }
        if let Some(journal) = &mut journal {
            file.store_journal(journal)?;
        }
        let (final_head, tail) = match digest {
            Some(digest) => bands.finish_fragment(&sizes, digest)?,
            None => bands.finish(&sizes)?,
        };
        file.append(&tail)?;
        if final_head != head {
            file.rewrite_head(&final_head)?;
        }
        Ok(Written { file, journal })
    }

    /// The key of the journal.
    fn key(&self) -> Digest {
        let mut key = format!("{:?}\n", self.format).into_bytes();
        key.extend(self.recipe.to_string().bytes());
        key.extend(self.bands.head());
        Digest::of(&key)
    }
}

/// A written file that is ready to be renamed.
pub(super) struct Written {
    file: Unfinished,
    journal: Option<Journal>,
}

impl Written {
    /// A file without a journal.
    pub(super) fn whole(file: Unfinished) -> Self {
        Self {
            file,
            journal: None,
        }
    }

    /// Renames the file to its final path.
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

/// A band's entry in the journal: its checksum, and the length of each part.
fn band_entry(sizes: &BandSizes) -> String {
    let parts = sizes.parts.iter().map(|part| format!(" {part}"));
    std::iter::once(sizes.check.to_string())
        .chain(parts)
        .collect()
}

fn parse_band_entry(entry: &str) -> Result<BandSizes, Failure> {
    let numbers: Result<Vec<u32>, _> = entry.split(' ').map(str::parse).collect();
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
