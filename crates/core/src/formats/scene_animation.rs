//! A scene file's `[animation]`.

use super::scene_toml::{AnimationToml, KeyToml};
use crate::camera::{CameraPath, Keyframe, Projection};
use toml::Spanned;

/// The table of a camera's path; `projection` decides the meaning of its keyframes' views.
pub(super) fn table(path: &CameraPath, projection: Projection) -> AnimationToml {
    let spanned = |values: glam::DVec3| Spanned::new(0..0, values.to_array());
    let key = |key: &Keyframe| {
        let view = key.view.map(|view| Spanned::new(0..0, view));
        let (fov, frame) = match projection {
            Projection::Orthographic => (None, view),
            Projection::Perspective | Projection::Panoramic(_) => (view, None),
        };
        let key = KeyToml {
            at: key.frame,
            eye: spanned(key.pose.eye),
            target: spanned(key.pose.target),
            up: Some(spanned(key.pose.up)),
            fov,
            frame,
        };
        Spanned::new(0..0, key)
    };
    AnimationToml {
        curve: path.curve().into(),
        ease: path.ease().into(),
        key: path.keys().iter().map(key).collect(),
    }
}
