use super::length_unit::LengthUnit;
use crate::camera::{CameraPath, PixelFilter, Pose, Projection, Stereo};
use crate::hit::{Cull, Precision};
use crate::scene::{ClippingPlanes, Scene};
use crate::shade::Shading;
use std::collections::HashSet;
use std::path::PathBuf;

/// The format of the file that a scene was read from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FileKind {
    /// A scene file, `.raycast.toml`.
    #[default]
    Scene,
    /// A Wavefront OBJ.
    Obj,
    /// A glTF 2.0, as JSON or as a GLB: in metres, Y up.
    Gltf,
    /// A 3MF, with Z up.
    Threemf,
    /// The triangle text of the original RayCast.
    TriangleText,
    /// OFF.
    Off,
    /// PLY, ASCII or binary.
    Ply,
    /// A prepared file, as `write_prepared` writes it.
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

/// The contents of a `.raycast.toml`, with everything that it names. What the file leaves out is `None`: the caller's
/// defaults apply.
#[derive(Clone, Debug, Default)]
pub struct SceneFile {
    /// The format of the file that it was read from; of several, the first.
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
    /// `[[clip]]`: the clipping planes.
    pub clip: ClippingPlanes,
    /// Faults too small to refuse the file: a line each. Never saved.
    pub warnings: Vec<String>,
    /// The files' metadata, and contents that are not used: a line each. Never saved.
    pub notes: Vec<String>,
    /// Every file that was opened, each once: the scene file itself, meshes, their material libraries, textures, files
    /// that could be opened but not read, and files that a mesh names but that are not shown. Nothing should be written
    /// over them. Absolute, or relative where they came from a caller's own store of files. Never saved.
    pub opened: Vec<PathBuf>,
}

/// A scene file's camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFile {
    /// Eye, target and up.
    pub pose: Pose,
    /// The projection.
    pub projection: Projection,
    /// Vertical field of view in degrees, or the orthographic frame's height in scene units.
    pub frame: f64,
}

/// The image settings of a scene file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImageSettings {
    /// Columns and rows.
    pub size: Option<(u32, u32)>,
    /// Samples a pixel.
    pub samples: Option<u32>,
    /// The filter that weighs them.
    pub pixel_filter: Option<PixelFilter>,
    /// The distance between neighbouring rays at the camera's target, in scene units, for pictures of `size`; kept
    /// because a field of view would round it.
    pub step: Option<f64>,
    /// The shift of the frame off the view axis, to the right and up, in heights of the frame.
    pub shift: Option<[f64; 2]>,
    /// The layout of a picture for two eyes.
    pub stereo: Option<Stereo>,
    /// Which faces rays hit.
    pub cull: Option<Cull>,
    /// Exact or rounded casting.
    pub precision: Option<Precision>,
}

/// A scene file's shading.
pub type ShadingFile = Shading;

impl SceneFile {
    /// Appends another file's objects, and takes from it the settings that this one lacks.
    pub fn append(&mut self, other: Self) {
        // The first file's unit and format apply as they are.
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
        // A step belongs to the size in its own file.
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
