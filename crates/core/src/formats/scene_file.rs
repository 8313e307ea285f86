use super::length_unit::LengthUnit;
use crate::camera::{CameraPath, PixelFilter, Placement, Projection, Stereo};
use crate::hit::{Cull, Precision};
use crate::scene::{ClippingPlanes, Scene};
use crate::shade::Shading;
use std::collections::HashSet;
use std::path::PathBuf;

/// What kind of file a scene was read from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FileKind {
    /// A scene file, `.raycast.toml`.
    #[default]
    Scene,
    /// A Wavefront OBJ.
    Obj,
    /// A glTF 2.0, as JSON or as a GLB: in metres, Y up.
    Gltf,
    /// A 3MF, Z up.
    Threemf,
    /// The triangle text of the original RayCast.
    TriangleText,
    /// OFF.
    Off,
    /// PLY, ASCII or binary.
    Ply,
    /// What `write_prepared` wrote of files of other kinds.
    Prepared,
    /// STL, ASCII or binary.
    Stl,
}

impl std::fmt::Display for FileKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Scene => "scene file",
            Self::Obj => "OBJ",
            Self::Gltf => "glTF",
            Self::Threemf => "3MF",
            Self::TriangleText => "triangle text",
            Self::Off => "OFF",
            Self::Ply => "PLY",
            Self::Prepared => "prepared mesh",
            Self::Stl => "STL",
        })
    }
}

/// A scene as a `.raycast.toml` holds it, read with everything that it names. What the file leaves
/// out is `None`: the caller's defaults stand.
#[derive(Clone, Debug, Default)]
pub struct SceneFile {
    /// What kind of file it was read from; of several, the first.
    pub kind: FileKind,
    /// The unit that the mesh file says its coordinates are in; `None` of scene files, and of several files that are
    /// not in one unit.
    pub unit: Option<LengthUnit>,
    /// The objects.
    pub scene: Scene,
    /// `[camera]`.
    pub camera: Option<CameraFile>,
    /// `[animation]`: the camera's keyframes.
    pub animation: Option<CameraPath>,
    /// `[image]`.
    pub image: ImageSettings,
    /// `[shading]`, with the background of `[image]`.
    pub shading: Option<ShadingFile>,
    /// `[[clip]]`: what is cut away.
    pub clip: ClippingPlanes,
    /// What was not as it should be, and did not matter enough to stop: a line each. Never saved.
    pub warnings: Vec<String>,
    /// What the files are, say of themselves, and hold that is not used: a line each. Never saved.
    pub notes: Vec<String>,
    /// Every file that was opened on the way, each once: the scene file itself, meshes, their
    /// material libraries, textures, and those that could be opened and then not be read. Nothing
    /// should be written over them. Absolute, or relative where they came from a caller's own store
    /// of files. Never saved.
    pub opened: Vec<PathBuf>,
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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImageSettings {
    /// Columns and rows.
    pub size: Option<(u32, u32)>,
    /// Rays a pixel.
    pub samples: Option<u32>,
    /// How they are weighed by their place.
    pub pixel_filter: Option<PixelFilter>,
    /// Distance between neighbouring rays at the camera's target, in scene units, for pictures of `size`: the bits
    /// that a field of view would round.
    pub step: Option<f64>,
    /// How far the frame is off the view axis, to the right and up, in heights of the frame.
    pub shift: Option<[f64; 2]>,
    /// How it is for two eyes.
    pub stereo: Option<Stereo>,
    /// Which faces rays pass through.
    pub cull: Option<Cull>,
    /// How sure the triangles are.
    pub precision: Option<Precision>,
}

/// A scene file's shading.
pub type ShadingFile = Shading;

impl SceneFile {
    /// Adds another file's objects behind these, and takes from it the settings that this one does
    /// not have.
    pub fn append(&mut self, other: Self) {
        // What is there first has nothing to differ from.
        let is_first = self.scene.objects.is_empty();
        self.unit = other
            .unit
            .filter(|unit| is_first || self.unit == Some(*unit));
        let shift = self.scene.objects.len();
        let moved = other.scene.objects.into_iter().map(|mut object| {
            object.parent = object.parent.map(|parent| parent + shift);
            object
        });
        self.scene.objects.extend(moved);
        self.camera = self.camera.or(other.camera);
        self.animation = self.animation.take().or(other.animation);
        // A step is of its own file's size.
        if self.image.size.is_none() && self.image.step.is_none() {
            self.image.step = other.image.step;
        }
        self.image.size = self.image.size.or(other.image.size);
        self.image.shift = self.image.shift.or(other.image.shift);
        self.image.stereo = self.image.stereo.or(other.image.stereo);
        self.image.cull = self.image.cull.or(other.image.cull);
        self.image.precision = self.image.precision.or(other.image.precision);
        self.image.samples = self.image.samples.or(other.image.samples);
        self.image.pixel_filter = self.image.pixel_filter.or(other.image.pixel_filter);
        self.shading = self.shading.or(other.shading);
        if self.clip.all().is_empty() {
            self.clip = other.clip;
        }
        self.warnings.extend(other.warnings);
        self.notes.extend(other.notes);
        let known: HashSet<PathBuf> = self.opened.iter().cloned().collect();
        let new = other
            .opened
            .into_iter()
            .filter(|path| !known.contains(path));
        self.opened.extend(new);
    }
}
