//! The settings of the picture that is verified: from its recipe, the command line and the scene file.

use crate::cli::{CameraArgs, VerifyArgs};
use crate::failure::Failure;
use crate::setup;
use raycast_core::Cull;
use raycast_core::camera::{Camera, PixelFilter};
use raycast_core::formats::{ImageSettings, SceneFile};
use raycast_core::picture::Recipe;
use raycast_core::scene::ClippingPlanes;
use raycast_core::shade::Shading;
use raycast_report::Stage;
use std::path::Path;

/// The settings of a claimed picture, besides its scene.
#[derive(Clone, Copy)]
pub(super) struct PictureSettings {
    pub(super) camera: Camera,
    pub(super) shading: Shading,
    pub(super) samples: u32,
    pub(super) pixel_filter: PixelFilter,
    pub(super) cull: Cull,
    pub(super) clip: ClippingPlanes,
}

/// The requested settings, and the files that they apply to.
pub(super) struct Request<'a> {
    pub(super) args: &'a VerifyArgs,
    /// The files' settings; their scene is on the stage.
    pub(super) file: &'a SceneFile,
    pub(super) name: &'a str,
    pub(super) stage: &'a Stage,
}

impl Request<'_> {
    /// The settings of an image: its recipe's, which must agree with the request; without a recipe, the requested
    /// ones.
    pub(super) fn settings_for(
        &self,
        path: &Path,
        size: (u32, u32),
        recipe: Option<&Recipe>,
    ) -> Result<PictureSettings, Failure> {
        let args = self.args;
        let name = path.display();
        let settings = self.settings(Some(size), recipe)?;
        let plane = settings.camera.plane();
        let requested = args.camera.size.unwrap_or((plane.columns, plane.rows));
        if requested != size {
            return Err(Failure::usage(format!(
                "{name} is of {}x{} pixels, the requested camera makes {}x{}",
                size.0, size.1, requested.0, requested.1
            )));
        }
        let Some(recipe) = recipe else {
            return Ok(settings);
        };
        let scene = &self.stage.scene;
        let requested = Recipe {
            scene: match recipe.is_of(scene) {
                true => recipe.scene,
                false => scene.content(),
            },
            camera: settings.camera,
            samples: settings.samples,
            pixel_filter: settings.pixel_filter,
            cull: settings.cull,
            clip: settings.clip.only_enabled(),
            precision: recipe.precision,
            shading: settings.shading,
        };
        match requested.difference(recipe) {
            None => Ok(settings),
            Some(reason) if requested.scene != recipe.scene => Err(Failure::could_not(format!(
                "{name}: {reason} than these files make (--texture, --crop and --color are to be given as they were to `raycast render`)"
            ))),
            Some(reason) => Err(Failure::could_not(format!("{name}: {reason}"))),
        }
    }

    /// The requested settings, with defaults from the recipe, then the scene file, then the general ones.
    pub(super) fn settings(
        &self,
        size: Option<(u32, u32)>,
        recipe: Option<&Recipe>,
    ) -> Result<PictureSettings, Failure> {
        let Self { args, file, .. } = self;
        let camera = match recipe {
            Some(recipe) if !sets_camera(&args.camera) => recipe.camera,
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
            .map_err(|failure| setup::camera_failure(&args.camera, self.name, failure))?,
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

/// Whether any option sets the camera's pose or projection.
fn sets_camera(args: &CameraArgs) -> bool {
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
