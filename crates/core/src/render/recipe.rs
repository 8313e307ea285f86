use super::{Settings, View};
use crate::digest::Digest;
use crate::picture::Recipe;
use crate::scene::{ClippingPlanes, Scene};
use crate::shade::{Mode, Shading};

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
            layers,
        } = view.settings;
        let clip = clip.only_enabled();
        let mut recipe = Self {
            scene: Digest::of(&[]),
            camera: view.camera,
            samples: samples.max(1),
            pixel_filter,
            cull,
            clip,
            precision,
            shading,
        };
        // Layers hold normals and texture coordinates, whatever the mode shows.
        let triangles = match layers {
            true => None,
            false => recipe.triangle_content(&view.scene),
        };
        recipe.scene = triangles.unwrap_or_else(|| view.scene.content());
        recipe
    }

    /// Whether it is of pictures of this scene.
    pub fn is_of(&self, scene: &Scene) -> bool {
        self.triangle_content(scene) == Some(self.scene) || scene.content() == self.scene
    }

    /// The checksum of a scene's triangles, where a picture without layers shows nothing else of it.
    fn triangle_content(&self, scene: &Scene) -> Option<Digest> {
        let Shading {
            mode, wireframe, ..
        } = self.shading;
        let shows_triangles = match mode {
            Mode::Color | Mode::Flat | Mode::Texture | Mode::Depth | Mode::Barycentric => true,
            Mode::Smooth | Mode::Material | Mode::Normals | Mode::Uv => false,
            Mode::Wireframe | Mode::XRay => false,
        };
        // Lines and sections depend on which triangles share vertices.
        let is_plain = shows_triangles && wireframe.is_none() && self.clip == ClippingPlanes::NONE;
        match is_plain {
            true => scene.triangle_content(mode.shows().colors),
            false => None,
        }
    }
}
