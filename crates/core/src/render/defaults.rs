use super::{Cancel, Settings, View};
use crate::bvh::Accel;
use crate::camera::{Camera, Grid};
use crate::picture::Picture;
use crate::scene::{Scene, SceneError};
use std::sync::Arc;
use std::time::Duration;

/// Renders a scene with default settings: smooth shading, both faces, one ray a pixel, exact, in parallel on rayon's
/// current pool.
///
/// Builds the tree first. To render several pictures of one scene, or with other settings, build a [`View`] and keep
/// it.
///
/// # Errors
/// As [`Accel::build`].
pub fn render(scene: &Scene, camera: &Camera) -> Result<Picture, SceneError> {
    let view = View {
        accel: Arc::new(Accel::build(scene)?),
        scene: Arc::new(scene.clone()),
        camera: *camera,
        settings: Settings::default(),
    };
    let no_clock = || Duration::ZERO;
    let picture = view.render(Grid::default(), &no_clock, &Cancel::default(), &|_| ());
    // Only a cancelled render gives no picture.
    Ok(picture
        .unwrap_or_else(|| Picture::blank(camera.plane().columns, camera.plane().rows, false)))
}
