//! Deep zoom: a picture as a pyramid of tiles (Microsoft, "Deep Zoom File Format Overview", 2008), and a page that
//! shows it in a browser.

use super::Failure;
use crate::memory;
use crate::output::{Output, PartFolder};
use crate::progress::TerminalProgress;
use raycast_core::camera::Rect;
use raycast_core::picture::{Format, Picture};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Columns and rows of a tile; tiles do not overlap.
const TILE: u32 = 256;

/// The page, with placeholders for the picture's name and sizes.
const PAGE: &str = include_str!("deep_zoom.html");

/// A pyramid's files: `NAME.dzi`, and the page `NAME.html` and the tiles in `NAME_files`, which must not exist yet.
pub(super) struct DeepZoom {
    dzi: Output,
    page: Output,
    page_path: PathBuf,
    folder: PathBuf,
    name: PathBuf,
}

/// Whether a path is that of a pyramid.
pub(super) fn is_deep_zoom(path: &Path) -> bool {
    let extension = path.extension();
    extension.is_some_and(|extension| extension.eq_ignore_ascii_case("dzi"))
}

impl DeepZoom {
    /// The outputs of the pyramid at `path`, whose `dzi` is checked already.
    ///
    /// # Errors
    /// As [`Output::at`]; a page or tiles that exist.
    pub(super) fn at(path: &Path, dzi: Output, inputs: &[&Path]) -> Result<Self, Failure> {
        let page_path = path.with_extension("html");
        let page = Output::at(&page_path, inputs)?;
        if page.is_taken() {
            return Err(Failure::could_not(format!(
                "{}: cannot be made: it is there already",
                page_path.display()
            )));
        }
        let mut folder = path.with_extension("").into_os_string();
        folder.push("_files");
        // Created and removed again: failing now is better than after the work.
        drop(PartFolder::create(Path::new(&folder))?);
        Ok(Self {
            dzi,
            page,
            page_path,
            folder: folder.into(),
            name: path.to_owned(),
        })
    }

    /// The page's path, which no other output may have.
    pub(super) fn page(&self) -> &Path {
        &self.page_path
    }

    /// Writes the pyramid of a picture, which `make` renders in rectangles of the full width, from the top.
    ///
    /// # Errors
    /// Those of `make`; files that cannot be written; too little memory for a row of tiles of every level.
    pub(super) fn write(
        &self,
        (columns, rows): (u32, u32),
        progress: &TerminalProgress,
        mut make: impl FnMut(Rect) -> Result<Picture, Failure>,
    ) -> Result<(), Failure> {
        // A level needs a row of tiles twice, as it is and while it is halved and encoded; each further level needs
        // half of that.
        let row = u64::from(columns) * u64::from(TILE) * 4;
        memory::check_band(&self.name, 4 * row)?;
        let folder = PartFolder::create(&self.folder)?;
        let levels = (0..32)
            .find(|&level| 1 << level >= u64::from(columns.max(rows)))
            .unwrap_or(32);
        progress.counting("rendering", rows.div_ceil(TILE).into());
        let mut pyramid = Pyramid::new(folder.path(), (columns, rows), levels)?;
        for y in (0..rows).step_by(TILE as usize) {
            let band = Rect {
                x: 0,
                y,
                width: columns,
                height: TILE.min(rows - y),
            };
            pyramid.add(levels, make(band)?)?;
            progress.done(1);
        }
        let text = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <Image xmlns=\"http://schemas.microsoft.com/deepzoom/2008\" Format=\"png\" Overlap=\"0\" TileSize=\"{TILE}\">\n  \
             <Size Width=\"{columns}\" Height=\"{rows}\"/>\n</Image>\n"
        );
        let tiles = self
            .folder
            .file_name()
            .unwrap_or_default()
            .to_string_lossy();
        // Replaced last, since the name may contain any word.
        let tiles = serde_json::json!(tiles).to_string().replace('<', "\\u003c");
        let page = PAGE
            .replace("COLUMNS", &columns.to_string())
            .replace("ROWS", &rows.to_string())
            .replace("LEVELS", &levels.to_string())
            .replace("TILES", &tiles);
        let page = self.page.write(page.as_bytes())?;
        let dzi = self.dzi.write(text.as_bytes())?;
        // The tiles first: a page without them shows nothing.
        folder.persist()?;
        page.finish()?;
        dzi.finish()
    }
}

/// The levels, each with half the sides of the one before, down to one pixel, and the rows of each that are not in
/// tiles yet.
struct Pyramid<'a> {
    folder: &'a Path,
    levels: Vec<Level>,
}

struct Level {
    size: (u32, u32),
    /// Rows that wait for the rest of their tiles.
    waiting: Picture,
    /// The number of rows that are in tiles.
    done: u32,
}

impl<'a> Pyramid<'a> {
    fn new(folder: &'a Path, size: (u32, u32), top: u32) -> Result<Self, Failure> {
        let mut levels = Vec::new();
        for level in 0..=top {
            std::fs::create_dir(folder.join(level.to_string()))
                .map_err(|error| cannot(folder, &error))?;
            let side = |side: u32| u64::from(side).div_ceil(1 << (top - level)) as u32;
            let size = (side(size.0), side(size.1));
            levels.push(Level {
                size,
                waiting: Picture::blank(size.0, 0, false),
                done: 0,
            });
        }
        Ok(Self { folder, levels })
    }

    /// Adds rows to a level: complete rows of tiles are written, and halved for the next level.
    fn add(&mut self, number: u32, rows: Picture) -> Result<(), Failure> {
        let level = &mut self.levels[number as usize];
        level.waiting.pixels.extend_from_slice(&rows.pixels);
        level.waiting.height += rows.height;
        drop(rows);
        let is_last = level.done + level.waiting.height >= level.size.1;
        if level.waiting.height < TILE && !is_last {
            return Ok(());
        }
        let blank = Picture::blank(level.size.0, 0, false);
        let strip = std::mem::replace(&mut level.waiting, blank);
        let row = level.done / TILE;
        level.done += strip.height;
        let folder = self.folder.join(number.to_string());
        (0..strip.width.div_ceil(TILE))
            .into_par_iter()
            .try_for_each(|column| {
                let x = column * TILE;
                let bytes = cut(&strip, x, TILE.min(strip.width - x)).encode(Format::Png)?;
                let path = folder.join(format!("{column}_{row}.png"));
                std::fs::write(&path, bytes).map_err(|error| cannot(&path, &error))
            })?;
        match number.checked_sub(1) {
            Some(below) => self.add(below, strip.halved()?),
            None => Ok(()),
        }
    }
}

/// Columns of a picture.
fn cut(strip: &Picture, x: u32, width: u32) -> Picture {
    let columns = x as usize..(x + width) as usize;
    let rows = strip.pixels.chunks_exact(strip.width as usize);
    Picture {
        width,
        height: strip.height,
        pixels: rows
            .flat_map(|row| row[columns.clone()].iter().copied())
            .collect(),
        layers: None,
    }
}

fn cannot(path: &Path, error: &std::io::Error) -> Failure {
    Failure::could_not(format!("{}: cannot be written: {error}", path.display()))
}
