//! Hard cases as scenes for the window.

use raycast_core::formats::{CameraFile, SceneFile};
use raycast_core::scene::ColorRule;
use raycast_core::shade::{Mode, Shading};
use raycast_report::cases;

/// The first setting of the case of this name as its first camera sees it, a colour a triangle;
/// `None` where there is no such case.
pub fn scene(name: &str) -> Option<SceneFile> {
    let case = cases::find(name)?;
    let mut setting = (case.setting)(0);
    for object in &mut setting.scene.objects {
        object.color = ColorRule::PerTriangle { seed: 1 };
    }
    let camera = setting.cameras.first().map(|camera| CameraFile {
        pose: camera.pose(),
        projection: camera.projection(),
        frame: camera
            .fov_degrees()
            .unwrap_or(camera.plane().frame_height()),
    });
    Some(SceneFile {
        scene: setting.scene,
        camera,
        shading: Some(Shading {
            mode: Mode::Color,
            ..Shading::default()
        }),
        warnings: vec![case.difficulty.to_owned()],
        ..SceneFile::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::Accel;

    #[test]
    fn every_case_can_be_looked_at() {
        for case in cases::all() {
            let file = scene(case.name).expect("a case of the list");
            assert!(file.camera.is_some(), "{}", case.name);
            let accel = Accel::build(&file.scene).expect("a valid scene");
            assert!(!accel.is_empty(), "{}", case.name);
        }
        assert!(scene("no such case").is_none());
    }
}
