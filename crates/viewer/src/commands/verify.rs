mod image;
mod settings;
mod summary;

use self::image::{Image, WHOLE, cannot_read, read};
use self::settings::{PictureSettings, Request};
use self::summary::summary;
use super::render::render_rect;
use super::{Failure, warn_of_reading, workers};
use crate::cli::VerifyArgs;
use crate::progress::TerminalProgress;
use crate::{memory, output, setup};
use raycast_core::camera::{Grid, Rect};
use raycast_core::picture::{self, Picture};
use raycast_core::render::View;
use raycast_core::scene::Scene;
use raycast_report::Stage;
use raycast_report::verify::{Claim, Verification, verify};
use rayon::ThreadPool;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Compares a picture's pixels with the truth.
pub(super) fn run(args: &VerifyArgs) -> Result<(), Failure> {
    let (path, files) = split(&args.files)?;
    let pool = workers(args.casting.threads)?;
    let image = path.map(read).transpose()?;

    let progress = TerminalProgress::new();
    progress.loading();
    let mut file = setup::load(files, &args.reading, &|share| progress.loaded(share))?;
    setup::apply_textures_and_colors(&mut file.scene, &args.shading, &args.reading)?;
    progress.building();
    let name = setup::name_of(files);
    let scene = std::mem::take(&mut file.scene);
    // The filter is known from the recipe, once there is a tree.
    memory::check_scene(&name, scene.triangle_count(), scene.level_bytes())?;
    let mut stage = pool.install(|| stage(&name, scene))?;
    let request = Request {
        args,
        file: &file,
        name: &name,
        stage: &stage,
    };
    let settings = match (path, &image) {
        (Some(path), Some(image)) => {
            request.settings_for(path, image.full_size(), image.recipe())?
        }
        _ => request.settings(None, None)?,
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
    let found = checking.check_bands(rect, rows, image)?;
    progress.clear();

    warn_of_reading(&file.warnings, &stage.scene, &stage.accel);
    output::print(&summary(&found))?;
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
    fn check_bands(
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
            // The number of pixels to check in all rows down to here.
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

/// The image, if the first file is one, and the scene's files.
fn split(files: &[PathBuf]) -> Result<(Option<&Path>, &[PathBuf]), Failure> {
    let is_image = |path: &&PathBuf| {
        let extension = path.extension();
        let is = |name: &str| extension.is_some_and(|other| other.eq_ignore_ascii_case(name));
        ["exr", "png", "tif", "tiff"].into_iter().any(is)
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
    Ok(Stage::from_parts(Arc::new(scene), Arc::new(accel))?)
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
}
