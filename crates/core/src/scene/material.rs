use super::{Color, Opacity, Reflectance, Texture};
use std::sync::Arc;

/// A named material of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The file's name for it.
    pub name: String,
    /// Base colour (diffuse colour), sRGB.
    pub color: Color,
    /// An image for the surfaces that have it.
    pub texture: Option<Arc<Texture>>,
    /// Whether the file's vertex colours take precedence over `color`, where all three corners have one.
    pub by_vertex: bool,
    /// How it reflects light, where the file says so.
    pub reflectance: Option<Arc<Reflectance>>,
    /// Opaque, masked or blended.
    pub opacity: Opacity,
}

impl Material {
    /// A material of one colour.
    pub fn new(name: impl Into<String>, color: Color) -> Self {
        Self {
            name: name.into(),
            color,
            texture: None,
            by_vertex: false,
            reflectance: None,
            opacity: Opacity::Opaque,
        }
    }
}
