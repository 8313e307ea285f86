use super::banded::{Banded, Written};
use super::deep_zoom::{DeepZoom, is_deep_zoom};
use super::opened_scene::OpenedScene;
use super::saved_scene::SavedScene;
use super::sub_cameras::outside_view;
use super::{Failure, warn, workers};
use crate::cli::{RenderArgs, TileArgs};
use crate::memory;
use crate::output::{Output, Unfinished};
use crate::progress::TerminalProgress;
use crate::setup;
use crate::stats::StatsTarget;
use raycast_core::camera::{Camera, Grid, Rect, SubCamera};
use raycast_core::formats::{self, SceneFile};
use raycast_core::picture::{Format, Fragment, Picture, Recipe};
use raycast_core::render::{Cancel, Clock, Pass, TileStats, View, center_first};
use rayon::ThreadPool;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Renders a picture, or a fragment of one, to a file.
pub(super) fn run(args: &RenderArgs) -> Result<(), Failure> {
    let started = Instant::now();
    let (format, deep_zoom) = check_options(args)?;
    let mut inputs: Vec<&Path> = args.files.iter().map(AsRef::as_ref).collect();
    inputs.extend(args.shading.texture.as_deref());
    let output = Output::at(&args.output, &inputs)?;
    let deep_zoom = match deep_zoom {
        true => Some(DeepZoom::at(&args.output, output.clone(), &inputs)?),
        false => None,
    };
    inputs.push(&args.output);
    inputs.extend(deep_zoom.as_ref().map(DeepZoom::page));
    let saved_scene = match &args.save_scene {
        Some(path) => Some(SavedScene::at(path, &inputs)?),
        None => None,
    };
    inputs.extend(args.save_scene.as_deref());
    let stats_target = StatsTarget::at(args.stats.as_deref(), &inputs)?;
    let pool = workers(args.casting.threads)?;

    let progress = TerminalProgress::new();
    let opened = OpenedScene::open(args, format, &pool, &progress, &|opened| {
        output.check_against(opened)?;
        if let Some(scene) = &saved_scene {
            scene.check_against(opened)?;
        }
        stats_target.check_against(opened)
    })?;
    // Before the work, so that a scene that cannot be saved fails immediately.
    let saved_scene = match &saved_scene {
        Some(scene) => Some(scene.write(&opened.view, opened.animation.as_ref())?),
        None => None,
    };
    let outside = match args.tiles.show_sub_cameras {
        true => Some(pool.install(|| outside_view(&opened.view, args.tiles.grid()))?),
        false => None,
    };
    let view = outside.as_ref().unwrap_or(&opened.view);
    if args.shading.legend && view.legend().is_none() {
        warn(
            "--legend has no effect: the picture shows no numbers as colors (--color area, --mode depth, …)",
        );
    }
    let grid = args.tiles.grid();
    let part = match args.tiles.sub_camera {
        Some(cell) => Some(sub_camera_at(view.camera, grid, cell)?),
        None => None,
    };
    let rendering = Rendering {
        args,
        view,
        grid,
        output: &output,
        pool: &pool,
        progress: &progress,
        started: Instant::now(),
    };
    if let Some(deep_zoom) = deep_zoom {
        let (tiles, wall) = rendering.render_deep_zoom(&deep_zoom)?;
        progress.clear();
        saved_scene.map_or(Ok(()), Unfinished::finish)?;
        return opened.report(&stats_target, &tiles, wall, started, &pool);
    }
    let recipe = Recipe::of(view);
    let rect = part.map(|part| part.rect);
    if args.resume && part.is_some() {
        rendering.warn_resume("a fragment is never resumed");
    }
    let banded = match args.tiles.unfinished {
        None => Banded::new(&args.output, format, (&recipe, rect), &output, args.resume)?,
        Some(_) => None,
    };
    let (file, tiles, wall) = match banded {
        Some(banded) => rendering.render_bands(banded, part)?,
        None => {
            if args.resume && part.is_none() {
                let (columns, rows) = rendering.size(None);
                let why = format!("a picture of {columns}x{rows} is written in one piece");
                rendering.warn_resume(&why);
            }
            rendering.check_memory(format, part)?;
            match part {
                Some(part) => rendering.render_fragment(format, recipe, part)?,
                None => rendering.render_in_memory(format, &recipe)?,
            }
        }
    };
    progress.clear();
    opened.report(&stats_target, &tiles, wall, started, &pool)?;
    file.finish()?;
    saved_scene.map_or(Ok(()), Unfinished::finish)
}

/// Checks a command line of one picture without reading meshes, as far as that is possible.
///
/// # Errors
/// What [`run`] refuses: options, files that are not there, a scene file's text.
pub(super) fn check(args: &RenderArgs) -> Result<(), Failure> {
    check_options(args)?;
    check_scene(args).map(drop)
}

/// Checks options and files that one picture and frames have in common. Returns what the scene files say beside objects.
///
/// # Errors
/// As [`check`].
pub(super) fn check_scene(args: &RenderArgs) -> Result<SceneFile, Failure> {
    let file = setup::load_settings(&args.files, &args.reading)?;
    if let Some(texture) = &args.shading.texture {
        formats::open_regular(texture)?;
    }
    args.casting.clip.planes(file.clip)?;
    let name = setup::name_of(&args.files);
    let size = setup::check_camera(&args.camera, file.camera.as_ref(), file.image)
        .map_err(|error| setup::camera_failure(&args.camera, &name, error))?;
    if let (Some((columns, rows)), Some(cell)) = (size, args.tiles.sub_camera) {
        let counts = args.tiles.grid().counts(columns, rows);
        if cell.0 >= counts.0 || cell.1 >= counts.1 {
            return Err(no_sub_camera(counts, cell));
        }
    }
    Ok(file)
}

/// Checks that the options are consistent. Returns the format, and whether the picture is a deep zoom.
fn check_options(args: &RenderArgs) -> Result<(Format, bool), Failure> {
    let deep_zoom = is_deep_zoom(&args.output);
    let format = match deep_zoom {
        true => Format::Png,
        false => Format::from_name(&args.output.to_string_lossy())?,
    };
    if deep_zoom
        && (args.tiles.sub_camera.is_some() || args.tiles.unfinished.is_some() || args.resume)
    {
        return Err(Failure::usage(
            "a deep zoom (.dzi) is of a whole picture: leave out --sub-camera, --unfinished and --resume",
        ));
    }
    if args.tiles.sub_camera.is_some() {
        check_fragment(&args.tiles, format)?;
    }
    if args.tiles.unfinished.is_some() && format == Format::Exr {
        return Err(Failure::usage(
            "an unfinished picture has no layers: write it as .png, .ppm, .jpg or .tif",
        ));
    }
    Ok((format, deep_zoom))
}

/// A picture that is rendered to a file.
struct Rendering<'a> {
    args: &'a RenderArgs,
    view: &'a View,
    grid: Grid,
    output: &'a Output,
    pool: &'a ThreadPool,
    progress: &'a TerminalProgress,
    started: Instant,
}

/// The file, the statistics of all its tiles, and the time it took.
type Rendered = (Written, TileStats, Duration);

impl Rendering<'_> {
    fn size(&self, part: Option<SubCamera>) -> (u32, u32) {
        let plane = self.view.camera.plane();
        let whole = (plane.columns, plane.rows);
        part.map_or(whole, |part| (part.rect.width, part.rect.height))
    }

    /// Refuses a picture that is rendered whole if too little memory is left.
    fn check_memory(&self, format: Format, part: Option<SubCamera>) -> Result<(), Failure> {
        let otherwise = match format {
            Format::Png | Format::Exr => {
                ", or its parts one by one (--tiles COLUMNSxROWS --sub-camera C,R)"
            }
            _ => "",
        };
        let memory_for = |columns, rows| format.memory_for(columns, rows);
        memory::check_picture(&self.args.output, self.size(part), memory_for, otherwise)
    }

    fn warn_resume(&self, why: &str) {
        let name = self.args.output.display();
        warn(&format!("{name}: --resume has no effect: {why}"));
    }

    /// Renders a rectangle of the picture in tiles of a grid; adds its statistics to `sum`.
    fn render_rows(&self, rect: Rect, grid: Grid, sum: &mut TileStats) -> Result<Picture, Failure> {
        let part = self.view.camera.sub_camera(rect);
        let clock = || self.started.elapsed();
        let (picture, tiles) = render_rect(self.view, part, grid, &clock, &|_| {})?;
        *sum += tiles;
        Ok(picture)
    }

    fn render_deep_zoom(&self, deep_zoom: &DeepZoom) -> Result<(TileStats, Duration), Failure> {
        let mut sum = TileStats::default();
        let size = self.size(None);
        self.pool.install(|| {
            deep_zoom.write(size, self.progress, |rect| {
                self.render_rows(rect, self.grid, &mut sum)
            })
        })?;
        Ok((sum, self.started.elapsed()))
    }

    fn render_bands(&self, banded: Banded, part: Option<SubCamera>) -> Result<Rendered, Failure> {
        // A fragment is one tile of the grid.
        let grid = part.map_or(self.grid, |_| Grid::default());
        let mut sum = TileStats::default();
        let write = || banded.write(self.progress, |rect| self.render_rows(rect, grid, &mut sum));
        let file = self.pool.install(write)?;
        Ok((file, sum, self.started.elapsed()))
    }

    fn render_fragment(
        &self,
        format: Format,
        recipe: Recipe,
        part: SubCamera,
    ) -> Result<Rendered, Failure> {
        let clock = || self.started.elapsed();
        let render = || render_part(self.view, part, &clock, self.progress);
        let (picture, tiles) = self.pool.install(render)?;
        let wall = self.started.elapsed();
        let fragment = Fragment {
            rect: part.rect,
            recipe,
            picture,
        };
        let file = self.output.write(&fragment.encode(format)?)?;
        Ok((Written::whole(file), tiles, wall))
    }

    fn render_in_memory(&self, format: Format, recipe: &Recipe) -> Result<Rendered, Failure> {
        let clock = || self.started.elapsed();
        let unfinished = self.args.tiles.unfinished;
        let (picture, tiles) = self.pool.install(|| match unfinished {
            Some(done) => render_unfinished(self.view, self.grid, done, &clock),
            None => render_whole(self.view, self.grid, &clock, self.progress),
        })?;
        let wall = self.started.elapsed();
        // An unfinished picture is not that of its recipe.
        let recipe = unfinished.is_none().then_some(recipe);
        let bytes = picture.encode_with(format, recipe)?;
        Ok((Written::whole(self.output.write(&bytes)?), tiles, wall))
    }
}

/// Checks the options of a fragment.
fn check_fragment(tiles: &TileArgs, format: Format) -> Result<(), Failure> {
    if tiles.tiles.is_none() && tiles.tile_size.is_none() {
        return Err(Failure::usage(
            "--sub-camera names a tile of a grid: give --tiles or --tile-size with it",
        ));
    }
    match format {
        Format::Png | Format::Exr => Ok(()),
        Format::Ppm | Format::Jpeg | Format::Tiff => Err(Failure::usage(
            "a fragment (--sub-camera) is written as .png or .exr, which can hold its position",
        )),
    }
}

/// The sub-camera of a grid's column and row.
pub(super) fn sub_camera_at(
    camera: Camera,
    grid: Grid,
    (column, row): (u32, u32),
) -> Result<SubCamera, Failure> {
    let plane = camera.plane();
    let counts = grid.counts(plane.columns, plane.rows);
    let found = grid.sub_camera(camera, column, row);
    found.ok_or_else(|| no_sub_camera(counts, (column, row)))
}

fn no_sub_camera((across, down): (u32, u32), (column, row): (u32, u32)) -> Failure {
    Failure::usage(format!(
        "there is no sub-camera {column},{row} in a grid of {across}x{down}: the last is {},{}",
        across - 1,
        down - 1
    ))
}

/// Renders the whole picture; returns the statistics of all tiles as well.
fn render_whole(
    view: &View,
    grid: Grid,
    clock: Clock<'_>,
    progress: &TerminalProgress,
) -> Result<(Picture, TileStats), Failure> {
    let plane = view.camera.plane();
    let (across, down) = grid.counts(plane.columns, plane.rows);
    progress.counting("rendering", u64::from(across) * u64::from(down));
    render_rect(view, view.camera.whole(), grid, clock, &|count| {
        progress.done(count)
    })
}

/// Renders a sub-camera's picture; returns the statistics of all its tiles as well. `done` is called after each.
pub(super) fn render_rect(
    view: &View,
    part: SubCamera,
    grid: Grid,
    clock: Clock<'_>,
    done: &(dyn Fn(u64) + Sync),
) -> Result<(Picture, TileStats), Failure> {
    let sum = Mutex::new(TileStats::default());
    let (columns, rows) = (part.rect.width, part.rect.height);
    let mut picture = Picture::try_blank(columns, rows, view.settings.layers)?;
    let sink = |&stats: &TileStats| {
        *sum.lock().unwrap_or_else(PoisonError::into_inner) += stats;
        done(1);
    };
    let is_done = view.render_part_into(part, grid, clock, &Cancel::default(), &sink, &mut picture);
    let sum = sum.into_inner().unwrap_or_else(PoisonError::into_inner);
    if is_done {
        Ok((picture, sum))
    } else {
        Err(Failure::could_not("the render was stopped"))
    }
}

/// The picture after `done` tiles are finished, as the window shows it on the way.
fn render_unfinished(
    view: &View,
    grid: Grid,
    done: usize,
    clock: Clock<'_>,
) -> Result<(Picture, TileStats), Failure> {
    let plane = view.camera.plane();
    let tiles = center_first(&grid.tiles(plane.columns, plane.rows), plane);
    let finished = &tiles[..done.min(tiles.len())];
    let coarse = Pass {
        stride: 16,
        samples: 1,
    };
    let full = Pass {
        stride: 1,
        samples: view.settings.samples,
    };
    let blank = Picture::try_blank(plane.columns, plane.rows, false)?;
    let made = Mutex::new((blank, TileStats::default()));
    for (tiles, pass) in [(&tiles[..], coarse), (finished, full)] {
        view.render_progressively(tiles, &[pass], clock, &Cancel::default(), &|_, tile| {
            let mut made = made.lock().unwrap_or_else(PoisonError::into_inner);
            made.0.paste(tile.rect, &tile.pixels, None);
            made.1 += tile.stats;
        });
    }
    Ok(made.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Renders one sub-camera's picture.
fn render_part(
    view: &View,
    part: SubCamera,
    clock: Clock<'_>,
    progress: &TerminalProgress,
) -> Result<(Picture, TileStats), Failure> {
    let grid = Grid::default();
    let (across, down) = grid.counts(part.rect.width, part.rect.height);
    progress.counting("rendering", u64::from(across) * u64::from(down));
    render_rect(view, part, grid, clock, &|count| progress.done(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fragments_need_a_grid_and_a_file_that_holds_their_place() {
        let none = TileArgs::default();
        assert!(check_fragment(&none, Format::Png).is_err());
        let some = TileArgs {
            tiles: Some((2, 2)),
            ..TileArgs::default()
        };
        assert!(check_fragment(&some, Format::Png).is_ok());
        assert!(check_fragment(&some, Format::Jpeg).is_err());
    }
}
