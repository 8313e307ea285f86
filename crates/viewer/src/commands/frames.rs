//! Rendering the frames of an animation: one scene and one tree; a frame is rendered while the one before is written.

use super::animation::AnimationFormat;
use super::banded::Banded;
use super::opened_scene::OpenedScene;
use super::render::{check_scene, render_rect, sub_camera_at};
use super::write_behind::write_behind;
use super::{Failure, workers};
use crate::cli::{FrameRange, RenderArgs, frame_path};
use crate::memory;
use crate::output::Output;
use crate::progress::TerminalProgress;
use crate::setup;
use crate::stats::StatsTarget;
use raycast_core::camera::{Camera, CameraPath, DEFAULT_FOV, Grid, Rect};
use raycast_core::formats::{CameraFile, ImageSettings};
use raycast_core::picture::{Format, Fragment, Picture, Recipe, RowReader};
use raycast_core::render::{TileStats, View};
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Whether a command line is for frames: by its options, or by an output that only frames can have.
pub(super) fn are_requested(args: &RenderArgs) -> bool {
    let name = args.output.to_string_lossy();
    let is_animation =
        || Format::from_name(&name).is_err() && AnimationFormat::from_name(&args.output).is_some();
    args.animation.range().is_some() || frame_path(&args.output, 0).is_some() || is_animation()
}

/// The frames that options name, else all of the scene file's animation. `output` is for errors.
///
/// # Errors
/// Neither; an animation with frames that are numbered too high.
pub(super) fn range(
    named: Option<FrameRange>,
    output: &Path,
    animation: Option<&CameraPath>,
) -> Result<FrameRange, Failure> {
    let name = output.display();
    match (named, animation.map(CameraPath::frames)) {
        (Some(range), _) => Ok(range),
        (None, Some((first, last))) => FrameRange::new(first, last).ok_or_else(|| {
            let end = FrameRange::END;
            Failure::usage(format!(
                "{name}: the [animation] ends at frame {last}: say which frames below {end} are meant (--frames A..B)"
            ))
        }),
        (None, None) => Err(Failure::usage(format!(
            "{name}: such a name is for several frames: give --turntable N, or a scene file that has an [animation]"
        ))),
    }
}

/// Checks a command line of frames without reading meshes, as far as that is possible.
///
/// # Errors
/// As [`render::check`](super::render::check).
pub(super) fn check(args: &RenderArgs) -> Result<(), Failure> {
    check_options(args)?;
    let file = check_scene(args)?;
    let animation = file.animation.as_ref();
    let range = range(args.animation.range(), &args.output, animation)?;
    CameraMotion::new(args, range, animation).map(drop)
}

/// Checks that the options are consistent. Returns the pictures' format, and the animation's if all frames are written to
/// one file.
fn check_options(args: &RenderArgs) -> Result<(Format, Option<AnimationFormat>), Failure> {
    let name = args.output.to_string_lossy().into_owned();
    let has_file_per_frame = frame_path(&args.output, 0).is_some();
    if !has_file_per_frame && name.contains('%') {
        return Err(Failure::usage(format!(
            "{name}: expected one place for the frame's number, as %d or %05d"
        )));
    }
    let animation = match has_file_per_frame {
        true => None,
        false => AnimationFormat::from_name(&args.output),
    };
    if !has_file_per_frame && (animation.is_none() || args.tiles.sub_camera.is_some()) {
        return Err(Failure::usage(format!(
            "{name}: several frames are written to a file each (out-%05d.png), or to one .png, .apng or .gif"
        )));
    }
    if let Some(animation) = animation {
        animation.check_rate(args)?;
    }
    // Frames of one file have no layers.
    let format = match animation {
        Some(_) => Format::Png,
        None => Format::from_name(&name)?,
    };
    if args.resume && !has_file_per_frame {
        return Err(Failure::usage(format!(
            "{name}: a file of several frames is written in one piece: leave out --resume"
        )));
    }
    if args.tiles.unfinished.is_some() || args.tiles.show_sub_cameras || args.save_scene.is_some() {
        return Err(Failure::usage(
            "--unfinished, --show-sub-cameras and --save-scene are for one picture, not for frames",
        ));
    }
    Ok((format, animation))
}

/// Renders the requested frames.
pub(super) fn run(args: &RenderArgs) -> Result<(), Failure> {
    let started = Instant::now();
    let (format, animation) = check_options(args)?;
    let range = match args.animation.range() {
        Some(range) => range,
        None => {
            let file = setup::load_settings(&args.files, &args.reading)?;
            range(None, &args.output, file.animation.as_ref())?
        }
    };
    let mut inputs: Vec<&Path> = args.files.iter().map(AsRef::as_ref).collect();
    inputs.extend(args.shading.texture.as_deref());
    let path = |frame| frame_path(&args.output, frame).unwrap_or_else(|| args.output.clone());
    // The first and the last output are checked before the work; each other one when it is started.
    for end in [range.first, range.last] {
        Output::at(&path(end), &inputs)?;
    }
    let outputs: Vec<PathBuf> = match animation {
        None => range.numbers().map(path).collect(),
        Some(_) => vec![args.output.clone()],
    };
    let named: Vec<PathBuf> = inputs.iter().map(|input| (*input).to_owned()).collect();
    Output::check_all(&outputs, &named)?;
    inputs.extend(outputs.iter().map(PathBuf::as_path));
    let stats_target = StatsTarget::at(args.stats.as_deref(), &inputs)?;
    let pool = workers(args.casting.threads)?;
    let progress = TerminalProgress::new();
    let opened = OpenedScene::open(args, format, &pool, &progress, &|opened| {
        stats_target.check_against(opened)
    })?;
    Output::check_all(&outputs, &opened.opened)?;
    let frames = Frames::new(args, range, &opened)?;

    let rendering = Instant::now();
    let clock = || rendering.elapsed();
    progress.counting("rendering", range.count().into());
    let mut sum = TileStats::default();
    // A fragment is one tile of the grid.
    let grid = match args.tiles.sub_camera {
        Some(_) => Grid::default(),
        None => args.tiles.grid(),
    };
    let render = |view: &View, rect: Rect, sum: &mut TileStats| {
        let part = view.camera.sub_camera(rect);
        let rendered = pool.install(|| render_rect(view, part, grid, &clock, &|_| {}));
        let (picture, tiles) = rendered?;
        *sum += tiles;
        Ok::<Picture, Failure>(picture)
    };
    match animation {
        None => write_each(args, &frames, format, &pool, &progress, &mut sum, render)?,
        Some(animation) => animation.write(args, &opened, range, &progress, |frame| {
            let view = frames.view(frame)?;
            render(&view, view.camera.whole().rect, &mut sum)
        })?,
    }
    progress.clear();
    opened.report(&stats_target, &sum, rendering.elapsed(), started, &pool)
}

/// The cameras of the frames.
struct Frames<'a> {
    args: &'a RenderArgs,
    range: FrameRange,
    opened: &'a OpenedScene,
    motion: CameraMotion<'a>,
}

/// The camera's motion from frame to frame.
enum CameraMotion<'a> {
    Turntable(u32),
    Path(&'a CameraPath),
}

impl<'a> CameraMotion<'a> {
    fn new(
        args: &RenderArgs,
        range: FrameRange,
        animation: Option<&'a CameraPath>,
    ) -> Result<Self, Failure> {
        let camera = &args.camera;
        match (args.animation.turntable, animation) {
            (Some(count), _) if range.last < count => Ok(Self::Turntable(count)),
            (Some(count), _) => Err(Failure::usage(format!(
                "a turntable of {count} frames has none beyond {}",
                count - 1
            ))),
            (None, Some(_)) if camera.eye.is_some() || camera.orbit.is_some() => {
                Err(Failure::usage(
                    "the camera's place is the scene file's [animation]: leave out --eye and --orbit",
                ))
            }
            (None, Some(path)) => Ok(Self::Path(path)),
            (None, None) => Err(Failure::usage(
                "--frames is of --turntable N, or of a scene file that has an [animation]",
            )),
        }
    }
}

impl<'a> Frames<'a> {
    fn new(
        args: &'a RenderArgs,
        range: FrameRange,
        opened: &'a OpenedScene,
    ) -> Result<Self, Failure> {
        let motion = CameraMotion::new(args, range, opened.animation.as_ref())?;
        Ok(Self {
            args,
            range,
            opened,
            motion,
        })
    }

    /// The view of a frame.
    fn view(&self, frame: u32) -> Result<View, Failure> {
        let view = &self.opened.view;
        let base = view.camera;
        let camera = match self.motion {
            CameraMotion::Turntable(count) => {
                let pose = CameraPath::turntable(&base.pose(), count, frame);
                Camera::new(pose, base.projection(), base.plane())
                    .shifted(base.shift())
                    .in_stereo(base.stereo())
            }
            CameraMotion::Path(path) => {
                let key = path.at(frame);
                let own = self.opened.camera_file;
                let file = CameraFile {
                    pose: key.pose,
                    projection: own.map(|own| own.projection).unwrap_or_default(),
                    frame: key.view.or(own.map(|own| own.frame)).unwrap_or(DEFAULT_FOV),
                };
                let bounds = setup::bounds(&view.scene, &view.accel);
                let image = ImageSettings {
                    size: Some((base.plane().columns, base.plane().rows)),
                    shift: Some(base.shift()),
                    stereo: base.stereo(),
                    ..ImageSettings::default()
                };
                setup::camera(&self.args.camera, Some(&file), image, &bounds)
                    .map_err(|error| Failure::could_not(format!("frame {frame}: {error}")))?
            }
        };
        Ok(View {
            camera,
            ..view.clone()
        })
    }
}

/// A rendered frame that is to be written.
struct RenderedFrame {
    output: Output,
    recipe: Recipe,
    rect: Rect,
    picture: Picture,
}

/// Writes a file for each frame, except those that exist already.
fn write_each(
    args: &RenderArgs,
    frames: &Frames<'_>,
    format: Format,
    pool: &rayon::ThreadPool,
    progress: &TerminalProgress,
    sum: &mut TileStats,
    render: impl Fn(&View, Rect, &mut TileStats) -> Result<Picture, Failure>,
) -> Result<(), Failure> {
    let is_part = args.tiles.sub_camera.is_some();
    let write = |cast: RenderedFrame| -> Result<(), Failure> {
        let RenderedFrame {
            output,
            recipe,
            rect,
            picture,
        } = cast;
        let bytes = if is_part {
            let fragment = Fragment {
                rect,
                recipe,
                picture,
            };
            pool.install(|| fragment.encode(format))?
        } else {
            pool.install(|| picture.encode_with(format, Some(&recipe)))?
        };
        output.write(&bytes)?.finish()?;
        progress.done(1);
        Ok(())
    };
    write_behind(write, |send| {
        for frame in frames.range.numbers() {
            let path = frame_path(&args.output, frame).unwrap_or_else(|| args.output.clone());
            let view = frames.view(frame)?;
            let recipe = Recipe::of(&view);
            let rect = match args.tiles.sub_camera {
                Some(cell) => sub_camera_at(view.camera, args.tiles.grid(), cell)?.rect,
                None => view.camera.whole().rect,
            };
            if is_complete(&path, format, &recipe, rect, is_part) {
                progress.done(1);
                continue;
            }
            let output = Output::at(&path, &[])?;
            let part = is_part.then_some(rect);
            let banded = Banded::new(&path, format, (&recipe, part), &output, args.resume)?;
            if let Some(banded) = banded {
                let quiet = TerminalProgress::hidden();
                banded
                    .write(&quiet, |rect| render(&view, rect, sum))?
                    .finish()?;
                progress.done(1);
                continue;
            }
            // The frame that is being written, and the next.
            let memory_for = |columns, rows| 2 * format.memory_for(columns, rows);
            memory::check_picture(&path, (rect.width, rect.height), memory_for, "")?;
            let picture = render(&view, rect, sum)?;
            let cast = RenderedFrame {
                output,
                recipe,
                rect,
                picture,
            };
            if send.send(cast).is_err() {
                // The writer failed, and returns the error.
                break;
            }
        }
        Ok(())
    })
}

/// Whether a frame's file exists, is complete, and has this recipe and rectangle.
fn is_complete(path: &Path, format: Format, recipe: &Recipe, rect: Rect, is_part: bool) -> bool {
    if !matches!(format, Format::Png | Format::Exr | Format::Tiff) || !path.is_file() {
        return false;
    }
    let Ok(file) = File::open(path) else {
        return false;
    };
    let length = file.metadata().map_or(0, |found| found.len());
    let Ok(mut reader) = RowReader::open(BufReader::new(file), length) else {
        return false;
    };
    let is_known = reader.recipe() == Some(recipe) && reader.rect() == rect;
    if !is_known || reader.is_fragment() != is_part {
        return false;
    }
    let mut left = rect.height;
    while left > 0 {
        let Ok(rows) = reader.rows(32) else {
            return false;
        };
        left -= rows.height;
    }
    true
}
