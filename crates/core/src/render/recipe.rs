use super::{Settings, View};
use crate::picture::Recipe;

impl Recipe {
    /// The recipe of a view's pictures.
    pub fn of(view: &View) -> Self {
        // Destructured, so that the compiler demands a decision about each new setting.
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
