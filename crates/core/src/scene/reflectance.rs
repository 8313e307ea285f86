use super::Texture;
use std::sync::Arc;

/// How a material reflects and emits light: glTF's metallic-roughness model.
#[derive(Clone, Debug, PartialEq)]
pub struct Reflectance {
    /// From dielectric (0) to metal (1).
    pub metallic: f32,
    /// Perceptual roughness, from mirror (0) to matt (1); its square is GGX's α.
    pub roughness: f32,
    /// An image of factors: roughness in green, metallic in blue, as plain numbers without sRGB decoding.
    pub texture: Option<Arc<Texture>>,
    /// Emitted light: linear, zero or more.
    pub emission: [f32; 3],
    /// An image of factors for the emitted light.
    pub emission_texture: Option<Arc<Texture>>,
    /// Whether it shows its colour without lighting.
    pub is_unlit: bool,
}

impl Default for Reflectance {
    /// The reflectance of surfaces without one in the file: a dielectric with a soft highlight.
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
