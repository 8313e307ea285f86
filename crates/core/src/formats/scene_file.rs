use crate::camera::{Placement, Projection};
use crate::scene::Scene;
use crate::shade::Shading;

/// A scene as a `.raycast.toml` holds it, read with everything that it names. What the file leaves
/// out is `None`: the caller's defaults stand.
#[derive(Clone, Debug, Default)]
pub struct SceneFile {
    /// The objects.
    pub scene: Scene,
    /// `[camera]`.
    pub camera: Option<CameraFile>,
    /// `[image]`.
    pub image: ImageFile,
    /// `[shading]`.
    pub shading: Option<ShadingFile>,
}

/// A scene file's camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFile {
    /// Eye, target, up.
    pub placement: Placement,
    /// How rays leave it.
    pub projection: Projection,
    /// Vertical field of view in degrees, or the orthographic frame's height in scene units.
    pub frame: f64,
}

/// A scene file's picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImageFile {
    /// Columns and rows.
    pub size: Option<(u32, u32)>,
    /// Rays a pixel.
    pub samples: Option<u32>,
}

/// A scene file's shading.
pub type ShadingFile = Shading;
