use super::Texture;
use std::sync::Arc;

/// How a material reflects light and glows: glTF's model of metal and roughness.
#[derive(Clone, Debug, PartialEq)]
pub struct Reflectance {
    /// From a dielectric (0) to a metal (1).
    pub metallic: f32,
    /// Perceptual roughness, from a mirror (0) to what has no highlight (1); its square is GGX's α.
    pub roughness: f32,
    /// Factors of both: of roughness in green, of metal in blue, as numbers and not as light.
    pub texture: Option<Arc<Texture>>,
    /// Light of its own: linear, zero or more.
    pub emission: [f32; 3],
    /// A factor of that light.
    pub emission_texture: Option<Arc<Texture>>,
    /// Whether no light falls on it: it shows its colour.
    pub is_unlit: bool,
}

impl Default for Reflectance {
    /// What surfaces are of which nothing is known: a dielectric with a soft highlight.
    fn default() -> Self {
        Self {
            metallic: 0.0,
            roughness: 0.5,
            texture: None,
            emission: [0.0; 3],
            emission_texture: None,
            is_unlit: false,
        }
    }
}

impl Reflectance {
    /// Whether it has images, which need texture coordinates.
    pub fn has_textures(&self) -> bool {
        self.texture.is_some() || self.emission_texture.is_some()
    }
}
