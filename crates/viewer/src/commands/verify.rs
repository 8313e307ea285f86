mod image;

use self::image::{Image, WHOLE, cannot_read, read};
use super::render::render_rect;
use super::{Failure, warn_of_reading, workers};
use crate::cli::{CameraArgs, VerifyArgs};
use crate::progress::TerminalProgress;
use crate::{memory, output, setup};
use raycast_core::Cull;
use raycast_core::camera::{Camera, Grid, PixelFilter, Rect};
use raycast_core::formats::{ImageSettings, SceneFile};
use raycast_core::picture::{self, Picture, Recipe};
use raycast_core::render::View;
use raycast_core::scene::{ClippingPlanes, Scene};
use raycast_core::shade::Shading;
use raycast_report::verify::{Channels, Claim, Verification, WrongPixel, verify};
use raycast_report::{Stage, WrongAnswer};
use rayon::ThreadPool;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// The settings of a claimed picture, besides its scene.
#[derive(Clone, Copy)]
struct PictureSettings {
    camera: Camera,
    shading: Shading,
    samples: u32,
    pixel_filter: PixelFilter,
    cull: Cull,
    clip: ClippingPlanes,
}

/// Compares a picture's pixels with the truth.
pub(super) fn run(args: &VerifyArgs) -> Result<(), Failure> {
    let (path, files) = split(&args.files)?;
    let pool = workers(args.casting.threads)?;
    let image = path.map(read).transpose()?;

    let progress = TerminalProgress::new();
    progress.loading();
    let mut file = setup::load(files, &args.reading, &|share| progress.loaded(share))?;
    setup::paint(&mut file.scene, &args.shading, &args.reading)?;
    progress.building();
    let name = setup::name_of(files);
    let scene = std::mem::take(&mut file.scene);
    // The filter is known from the recipe, once there is a tree.
    memory::check_scene(&name, scene.triangle_count(), scene.level_bytes())?;
    let mut stage = pool.install(|| stage(&name, scene))?;
    let asked = Asked {
        args,
        file: &file,
        name: &name,
        stage: &stage,
    };
    let settings = match (path, &image) {
        (Some(path), Some(image)) => asked.settings_of(path, image.full_size(), image.recipe())?,
        _ => asked.settings(None, None)?,
    };
    stage = stage.clipped(settings.clip);
    let rect = match &image {
        Some(image) => image.rect(),
        None => settings.camera.whole().rect,
    };
    let mut view = stage.view(settings.camera, settings.cull);
    view.settings.precision = (args.casting.precision)
        .or(file.image.precision)
        .unwrap_or_default();
    view.settings.shading = settings.shading;
    view.settings.samples = settings.samples;
    view.settings.pixel_filter = settings.pixel_filter;
    // A picture with several bands is checked a band at a time, with the same fraction of pixels of each.
    let rows = match (&image, WHOLE / u64::from(rect.width)) {
        (Some(Image::Whole(_)), _) => rect.height,
        (_, rows) if rows >= u64::from(rect.height) => rect.height,
        (_, rows) => (rows as u32).next_multiple_of(32),
    };
    let band_memory = picture::memory_of(rect.width, rows, true);
    memory::check_band(Path::new(&name), band_memory)?;
    let checking = Checking {
        args,
        stage: &stage,
        view: &view,
        settings: &settings,
        pool: &pool,
        progress: &progress,
    };
    let found = checking.by_bands(rect, rows, image)?;
    progress.clear();

    warn_of_reading(&file.warnings, &stage.scene, &stage.accel);
    output::print(&told(&found))?;
    if found.wrong > 0 {
        return Err(Failure::could_not(format!(
            "the picture is not what its rays meet: {} of {} pixels checked are wrong",
            found.wrong, found.checked
        )));
    }
    Ok(())
}

/// A picture being checked.
struct Checking<'a> {
    args: &'a VerifyArgs,
    stage: &'a Stage,
    view: &'a View,
    settings: &'a PictureSettings,
    pool: &'a ThreadPool,
    progress: &'a TerminalProgress,
}

impl Checking<'_> {
    /// Checks a part of the picture, some rows at a time; without an image the rows are rendered.
    fn by_bands(
        &self,
        rect: Rect,
        rows: u32,
        mut image: Option<Image>,
    ) -> Result<Verification, Failure> {
        let Self {
            args,
            stage,
            settings,
            ..
        } = *self;
        let most = match args.all {
            true => rect.area(),
            false => rect.area().min(args.checks as usize),
        };
        self.progress.counting("verifying", most as u64);
        let done = |more| self.progress.done(more);
        let mut found = Verification::default();
        let mut drawn = 0;
        for y in (0..rect.height).step_by(rows as usize) {
            let band = Rect {
                y: rect.y + y,
                height: rows.min(rect.height - y),
                ..rect
            };
            let picture = self.picture(band, &mut image)?;
            let claim = Claim {
                camera: settings.camera,
                rect: band,
                cull: settings.cull,
                shading: settings.shading,
                samples: settings.samples,
                pixel_filter: settings.pixel_filter,
                picture: &picture,
            };
            // The number of pixels that should be checked in all rows down to here.
            let down = u128::from(y + band.height) * u128::from(rect.width);
            let share = most as u128 * down / rect.area().max(1) as u128;
            let seed = args.seed.wrapping_add(u64::from(y) << 32);
            let check = || verify(stage, &claim, share as usize - drawn, seed, &done);
            found += self.pool.install(check);
            drawn = share as usize;
        }
        Ok(found)
    }

    /// A band's pixels: the image's, or rendered.
    fn picture(&self, band: Rect, image: &mut Option<Image>) -> Result<Picture, Failure> {
        match image {
            Some(Image::Whole(image)) => {
                let nothing = Picture::blank(0, 0, false);
                Ok(std::mem::replace(&mut image.picture, nothing))
            }
            Some(Image::Rows(path, reader)) => reader
                .rows(band.height)
                .map_err(|error| cannot_read(path, &error)),
            None => {
                let part = self.settings.camera.sub_camera(band);
                let no_clock = || Duration::ZERO;
                let render = || render_rect(self.view, part, Grid::default(), &no_clock, &|_| {});
                Ok(self.pool.install(render)?.0)
            }
        }
    }
}

/// The requested settings, and the files that they apply to.
struct Asked<'a> {
    args: &'a VerifyArgs,
    /// The files' settings; their scene is on the stage.
    file: &'a SceneFile,
    name: &'a str,
    stage: &'a Stage,
}

impl Asked<'_> {
    /// The settings of an image: its recipe's, which must agree with the request; without a recipe, the requested
    /// ones.
    fn settings_of(
        &self,
        path: &Path,
        size: (u32, u32),
        recipe: Option<&Recipe>,
    ) -> Result<PictureSettings, Failure> {
        let args = self.args;
        let name = path.display();
        let settings = self.settings(Some(size), recipe)?;
        let plane = settings.camera.plane();
        let asked = args.camera.size.unwrap_or((plane.columns, plane.rows));
        if asked != size {
            return Err(Failure::usage(format!(
                "{name} is of {}x{} pixels, the camera that was asked for makes {}x{}",
                size.0, size.1, asked.0, asked.1
            )));
        }
        let Some(recipe) = recipe else {
            return Ok(settings);
        };
        let asked = Recipe {
            scene: self.stage.scene.content(),
            camera: settings.camera,
            samples: settings.samples,
            pixel_filter: settings.pixel_filter,
            cull: settings.cull,
            clip: settings.clip.only_enabled(),
            precision: recipe.precision,
            shading: settings.shading,
        };
        match asked.difference(recipe) {
            None => Ok(settings),
            Some(reason) if asked.scene != recipe.scene => Err(Failure::could_not(format!(
                "{name}: {reason} than these files make (--texture, --crop and --color are to be given as they were to `raycast render`)"
            ))),
            Some(reason) => Err(Failure::could_not(format!("{name}: {reason}"))),
        }
    }

    /// The requested settings, with defaults from the recipe, then the scene file, then the general ones.
    fn settings(
        &self,
        size: Option<(u32, u32)>,
        recipe: Option<&Recipe>,
    ) -> Result<PictureSettings, Failure> {
        let Self { args, file, .. } = self;
        let camera = match recipe {
            Some(recipe) if !places(&args.camera) => recipe.camera,
            _ => setup::camera(
                &args.camera,
                file.camera.as_ref(),
                ImageSettings {
                    size: size.or(file.image.size),
                    step: (file.image.step)
                        .filter(|_| size.is_none_or(|size| file.image.size == Some(size))),
                    ..file.image
                },
                &setup::bounds(&self.stage.scene, &self.stage.accel),
            )
            .map_err(|failure| setup::no_camera(&args.camera, self.name, failure))?,
        };
        let shading = recipe.map(|recipe| recipe.shading).or(file.shading);
        let samples = args
            .samples
            .or(recipe.map(|recipe| recipe.samples))
            .or(file.image.samples);
        Ok(PictureSettings {
            camera,
            shading: setup::shading(&args.shading, shading),
            samples: samples.unwrap_or(1).max(1),
            pixel_filter: (args.pixel_filter)
                .or(recipe.map(|recipe| recipe.pixel_filter))
                .or(file.image.pixel_filter)
                .unwrap_or_default(),
            cull: (args.casting.cull)
                .or(recipe.map(|recipe| recipe.cull))
                .or(file.image.cull)
                .unwrap_or_default(),
            clip: (args.casting.clip).planes(recipe.map_or(file.clip, |recipe| recipe.clip))?,
        })
    }
}

/// Whether any option is about the camera's placement or projection.
fn places(args: &CameraArgs) -> bool {
    let CameraArgs {
        size: _,
        step,
        fov,
        projection,
        eye,
        target,
        up,
        orbit,
        shift,
        lens,
        stereo,
        eye_distance,
        convergence,
    } = args;
    step.is_some()
        || shift.is_some()
        || lens.is_some()
        || stereo.is_some()
        || eye_distance.is_some()
        || convergence.is_some()
        || fov.is_some()
        || projection.is_some()
        || eye.is_some()
        || target.is_some()
        || up.is_some()
        || orbit.is_some()
}

/// The image, if the first file is one, and the scene's files.
fn split(files: &[PathBuf]) -> Result<(Option<&Path>, &[PathBuf]), Failure> {
    let is_image = |path: &&PathBuf| {
        let extension = path.extension();
        let is = |name: &str| extension.is_some_and(|other| other.eq_ignore_ascii_case(name));
        is("exr") || is("png")
    };
    let (image, scene) = match files.split_first() {
        Some((first, rest)) if is_image(&first) => (Some(first.as_path()), rest),
        _ => (None, files),
    };
    if let Some(second) = scene.iter().find(is_image) {
        return Err(Failure::usage(format!(
            "{}: one image can be verified at a time, and it comes first",
            second.display()
        )));
    }
    match image {
        Some(image) if scene.is_empty() => Err(Failure::usage(format!(
            "{}: name the meshes or the scene that it shows, too",
            image.display()
        ))),
        _ => Ok((image, scene)),
    }
}

fn stage(name: &str, scene: Scene) -> Result<Stage, Failure> {
    let accel = setup::visible(name, &scene, setup::single_tree(&scene)?)?;
    Ok(Stage::of_parts(Arc::new(scene), Arc::new(accel))?)
}

/// The result, in words.
fn told(found: &Verification) -> String {
    let Verification {
        pixels,
        checked,
        silhouettes,
        edges,
        channels,
        wrong,
        first_wrong,
    } = found;
    let Channels {
        numbers,
        depth,
        normal,
        uv,
        color,
    } = channels;
    let mut text = format!("{checked} of {pixels} pixels checked");
    // Writing to a string does not fail.
    let _ = match numbers {
        0 => writeln!(
            text,
            "\nchannels: colour at {color}; the picture tells no other"
        ),
        _ => writeln!(
            text,
            ": {silhouettes} where an object ends, {edges} where triangles meet, {} inside of one\n\
             channels: object and triangle at {numbers}, distance at {depth}, normal at {normal}, texture coordinates at {uv}, colour at {color}",
            checked - silhouettes - edges
        ),
    };
    if [depth, normal, uv].iter().any(|count| *count < numbers) || color < checked {
        let _ = writeln!(
            text,
            "not checked: what hangs on the place in a triangle that its ray grazes, colours under lines, textures that are \
             filtered by trilinear or ewa, do not repeat, or lie by triangle, plane, sphere or cylinder, colours by curvature, \
             what a legend covers, what rounding leaves open"
        );
    }
    let _ = match (wrong, checked == pixels) {
        (0, true) if *numbers > 0 => {
            writeln!(text, "0 wrong: every pixel shows what its ray meets first")
        }
        (0, true) => writeln!(
            text,
            "0 wrong: every colour checked is that of what its rays meet first"
        ),
        (0, false) => writeln!(
            text,
            "0 wrong of {checked}: with 95 % certainty, fewer than 3 in {checked} such pixels are"
        ),
        (wrong, _) => writeln!(text, "{wrong} wrong, of which the first are"),
    };
    for pixel in first_wrong {
        let WrongPixel {
            x,
            y,
            fault,
            shown,
            truth,
        } = pixel;
        let met = truth.map_or_else(
            || "nothing".to_owned(),
            |truth| meeting(truth.object, truth.triangle, truth.t),
        );
        let _ = match (shown, fault) {
            (Some((object, triangle, depth)), fault)
                if !matches!(fault, WrongAnswer::Channel { .. }) =>
            {
                let found = meeting(*object, *triangle, f64::from(*depth));
                writeln!(
                    text,
                    "  column {x}, row {y}: {fault}: expected {met}, found {found}"
                )
            }
            _ => writeln!(
                text,
                "  column {x}, row {y}: {fault}, where its ray meets {met}"
            ),
        };
    }
    text
}

fn meeting(object: u32, triangle: u32, depth: f64) -> String {
    if (object, triangle) == (u32::MAX, u32::MAX) {
        "nothing".to_owned()
    } else {
        format!("object {object}, triangle {triangle} at {depth}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_image_comes_first_and_alone() {
        let paths = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
        for name in ["a.EXR", "a.png"] {
            let both = paths(&[name, "b.obj"]);
            let (image, scene) = split(&both).expect("good usage");
            assert_eq!((image, scene), (Some(Path::new(name)), &both[1..]));
        }
        let scene = paths(&["b.obj", "c.obj"]);
        assert_eq!(split(&scene), Ok((None, &scene[..])));
        for bad in [&["a.exr"][..], &["a.exr", "b.exr"], &["b.obj", "a.exr"]] {
            assert!(matches!(split(&paths(bad)), Err(Failure::Usage(_))));
        }
    }

    #[test]
    fn what_was_found_is_told_in_words() {
        let good = Verification {
            pixels: 100,
            checked: 20,
            silhouettes: 5,
            edges: 6,
            channels: Channels {
                numbers: 20,
                depth: 19,
                normal: 20,
                uv: 20,
                color: 18,
            },
            ..Verification::default()
        };
        let text = told(&good);
        assert!(text.contains("fewer than 3 in 20"), "{text}");
        assert!(text.contains("distance at 19, normal at 20"), "{text}");
        assert!(text.contains("not checked: "), "{text}");
        let colors = Verification {
            checked: 100,
            channels: Channels {
                color: 100,
                ..Channels::default()
            },
            ..Verification::default()
        };
        let text = told(&colors);
        assert!(
            text.contains("colour at 100; the picture tells no other"),
            "{text}"
        );
        assert!(!text.contains("not checked"), "{text}");
        let all = Verification {
            checked: 100,
            ..good.clone()
        };
        assert!(told(&all).contains("every pixel"));
        let bad = Verification {
            wrong: 1,
            first_wrong: vec![WrongPixel {
                x: 3,
                y: 4,
                fault: WrongAnswer::Hit,
                shown: Some((1, 7, 2.5)),
                truth: None,
            }],
            ..good
        };
        let line = "  column 3, row 4: a hit where there is a miss: expected nothing, found object 1, triangle 7 at 2.5\n";
        assert!(told(&bad).ends_with(line), "{}", told(&bad));
        let mut repainted = bad;
        repainted.first_wrong[0].fault = WrongAnswer::Channel {
            channel: "G",
            found: 7.0,
            low: 9.0,
            high: 10.0,
        };
        let line = "  column 3, row 4: G is 7, expected 9 to 10, where its ray meets nothing\n";
        assert!(told(&repainted).ends_with(line), "{}", told(&repainted));
    }
}
