use super::Failure;
use crate::output::{Output, Unfinished};
use raycast_core::camera::CameraPath;
use raycast_core::formats::{CameraFile, ImageSettings, SceneFile};
use raycast_core::render::View;
use std::path::Path;

/// A scene file to which a picture's scene is written, with all that decides its bytes.
pub(super) struct SavedScene<'a> {
    path: &'a Path,
    output: Output,
}

impl<'a> SavedScene<'a> {
    /// A scene file at `path`, which must be none of `inputs`.
    ///
    /// # Errors
    /// A name without a scene file's extension; as [`Output::at`].
    pub(super) fn at(path: &'a Path, inputs: &[&Path]) -> Result<Self, Failure> {
        if path.extension().is_none_or(|end| end != "toml") {
            return Err(Failure::usage(format!(
                "{}: a scene file's name ends in .toml",
                path.display()
            )));
        }
        let output = Output::at(path, inputs)?;
        Ok(Self { path, output })
    }

    /// As [`Output::check_against`].
    pub(super) fn check_against<P: AsRef<Path>>(&self, opened: &[P]) -> Result<(), Failure> {
        self.output.check_against(opened)
    }

    /// Writes it, ready to be finished.
    ///
    /// # Errors
    /// A scene that no file can hold; a full disk.
    pub(super) fn write(
        &self,
        view: &View,
        animation: Option<&CameraPath>,
    ) -> Result<Unfinished, Failure> {
        let path = std::path::absolute(self.path).unwrap_or_else(|_| self.path.to_owned());
        let folder = path.parent().unwrap_or(Path::new("."));
        let text = scene_file(view, animation)
            .to_toml(folder)
            .map_err(|error| Failure::could_not(error.to_string()))?;
        self.output.write(text.as_bytes())
    }
}

fn scene_file(view: &View, animation: Option<&CameraPath>) -> SceneFile {
    let (camera, settings) = (view.camera, &view.settings);
    let plane = camera.plane();
    SceneFile {
        scene: view.scene.as_ref().clone(),
        camera: Some(CameraFile {
            pose: camera.pose(),
            projection: camera.projection(),
            frame: camera.fov_degrees().unwrap_or(plane.frame_height()),
        }),
        animation: animation.cloned(),
        image: ImageSettings {
            size: Some((plane.columns, plane.rows)),
            samples: Some(settings.samples),
            pixel_filter: Some(settings.pixel_filter),
            step: Some(plane.step),
            shift: Some(camera.shift()).filter(|shift| *shift != [0.0; 2]),
            stereo: camera.stereo(),
            cull: Some(settings.cull),
            precision: Some(settings.precision),
        },
        shading: Some(settings.shading),
        clip: settings.clip,
        ..SceneFile::default()
    }
}
