use super::{Settings, View};
use crate::picture::Recipe;

impl Recipe {
    /// What a view's pictures are made of.
    pub fn of(view: &View) -> Self {
        // Field by field: what settings get one day must be considered here.
        let Settings {
            shading,
            cull,
            clip,
            precision,
            samples,
            pixel_filter,
            layers: _,
        } = view.settings;
        Self {
            scene: view.scene.content(),
            camera: view.camera,
            samples: samples.max(1),
            pixel_filter,
            cull,
            clip: clip.only_enabled(),
            precision,
            shading,
        }
    }
}
