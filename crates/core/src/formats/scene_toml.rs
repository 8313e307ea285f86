//! The tables of a `.raycast.toml`, as they stand in the file.

use super::scene_words::{
    ColorMapToml, ColorRuleToml, ColorToml, CullToml, CurveToml, EaseToml, FilterToml,
    LightSetToml, ModeToml, PixelFilterToml, PrecisionToml, ProjectionToml, StereoKindToml,
    TextureProjectionToml, UpAxisToml, WrapToml,
};
use crate::scene::Shape;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use toml::Spanned;

/// The version of scene files that is written, and the newest that is read; a file without a version has this one. It
/// increases with changes after which a program that does not know them would show a different picture.
pub(super) const VERSION: i64 = 1;

/// The version of a scene file, whatever else it contains.
#[derive(Debug, Deserialize)]
pub(super) struct VersionToml {
    pub(super) version: Option<Spanned<i64>>,
}

#[derive(Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneToml {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) version: Option<Spanned<i64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) camera: Option<Spanned<CameraToml>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) animation: Option<Spanned<AnimationToml>>,
    #[serde(default, skip_serializing_if = "ImageToml::is_empty")]
    pub(super) image: ImageToml,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) shading: Option<ShadingToml>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) clip: Vec<Spanned<ClipToml>>,
    #[serde(default, rename = "object", skip_serializing_if = "Vec::is_empty")]
    pub(super) objects: Vec<Spanned<ObjectToml>>,
}

#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraToml {
    #[serde(default)]
    pub(super) projection: ProjectionToml,
    /// The lens of a perspective camera: k1, k2, p1, p2, k3.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) lens: Option<Spanned<Vec<f64>>>,
    pub(super) eye: Spanned<[f64; 3]>,
    pub(super) target: Spanned<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) up: Option<Spanned<[f64; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) fov: Option<Spanned<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) frame: Option<Spanned<f64>>,
}

/// A picture for two eyes.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct StereoToml {
    pub(super) kind: StereoKindToml,
    pub(super) eye_distance: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) convergence: Option<f64>,
}

/// The camera's keyframes.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AnimationToml {
    #[serde(default)]
    pub(super) curve: CurveToml,
    #[serde(default)]
    pub(super) ease: EaseToml,
    pub(super) key: Vec<Spanned<KeyToml>>,
}

#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KeyToml {
    /// The frame's number.
    pub(super) at: u32,
    pub(super) eye: Spanned<[f64; 3]>,
    pub(super) target: Spanned<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) up: Option<Spanned<[f64; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) fov: Option<Spanned<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) frame: Option<Spanned<f64>>,
}

#[derive(Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct ImageToml {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) size: Option<Spanned<[u32; 2]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) samples: Option<Spanned<u32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) pixel_filter: Option<PixelFilterToml>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) step: Option<Spanned<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) shift: Option<Spanned<[f64; 2]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) stereo: Option<Spanned<StereoToml>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) cull: Option<CullToml>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) precision: Option<PrecisionToml>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) background: Option<Spanned<BackgroundToml>>,
}

impl ImageToml {
    fn is_empty(&self) -> bool {
        let Self {
            size,
            samples,
            pixel_filter,
            step,
            shift,
            stereo,
            cull,
            precision,
            background,
        } = self;
        size.is_none()
            && samples.is_none()
            && pixel_filter.is_none()
            && step.is_none()
            && shift.is_none()
            && stereo.is_none()
            && cull.is_none()
            && precision.is_none()
            && background.is_none()
    }
}

#[derive(Debug, Deserialize, Serialize)]
#[serde(
    untagged,
    expecting = "\"transparent\" or two colours, [\"#rrggbb\", \"#rrggbb\"]"
)]
pub(super) enum BackgroundToml {
    Word(Transparent),
    Gradient([ColorToml; 2]),
}

#[derive(Debug, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Transparent {
    Transparent,
}

#[derive(Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct ShadingToml {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mode: Option<ModeToml>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) wireframe: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) wireframe_width: Option<Spanned<f32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) wireframe_color: Option<ColorToml>,
    /// Types of edges, separated by commas.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) wireframe_edges: Option<Spanned<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) wireframe_hidden: Option<Spanned<f32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) blend: Option<Spanned<f32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) filter: Option<FilterToml>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) texture_projection: Option<TextureProjectionToml>,
    /// The angle in degrees below which edges are smooth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) crease: Option<Spanned<f32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) lights: Option<LightSetToml>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) plain_color: Option<ColorToml>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) color_map: Option<ColorMapToml>,
    /// The numbers at the colour map's ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) color_range: Option<Spanned<[f64; 2]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) legend: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) back_faces: Option<ColorToml>,
    /// `lowest`, or a height.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) ground: Option<Spanned<GroundToml>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) x_ray_opacity: Option<Spanned<f32>>,
}

/// A clipping plane.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ClipToml {
    pub(super) normal: [f64; 3],
    #[serde(default)]
    pub(super) offset: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) enabled: Option<bool>,
}

#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(super) struct ObjectToml {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) name: Option<String>,
    /// A file; otherwise a shape is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mesh: Option<Spanned<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) shape: Option<Spanned<ShapeToml>>,
    /// The index of the mesh node to use, in a file with several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) node: Option<Spanned<u32>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) up_axis: Option<UpAxisToml>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) color: Option<Spanned<ColorRuleToml>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) seed: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) texture: Option<Spanned<String>>,
    /// The rectangle of the texture's image to use: left, top, width and height in its pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) crop: Option<Spanned<[u32; 4]>>,
    /// The texture's wrapping, along u and v.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) wrap: Option<[WrapToml; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) texture_projection: Option<TextureProjectionToml>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) texture_center: Option<Spanned<[f64; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) texture_front: Option<Spanned<[f64; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) texture_up: Option<Spanned<[f64; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) texture_size: Option<Spanned<[f64; 2]>>,
    /// The camera that took the texture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) texture_camera: Option<Spanned<PhotographToml>>,
    /// The scalar that says how much of the texture shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) blend_by: Option<Spanned<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) translate: Option<Spanned<[f64; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) rotate: Option<Spanned<[f64; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) scale: Option<Spanned<[f64; 3]>>,
    /// 12 or 16 numbers, row by row.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) matrix: Option<Spanned<Vec<f64>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) parent: Option<Spanned<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) visible: Option<bool>,
    /// The names of groups that rays cannot hit; the empty name is that of triangles in no group.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) hidden_groups: Option<Spanned<BTreeSet<String>>>,
}

/// The perspective camera that a texture was taken with.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PhotographToml {
    pub(super) eye: Spanned<[f64; 3]>,
    pub(super) target: Spanned<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) up: Option<Spanned<[f64; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) fov: Option<Spanned<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) shift: Option<Spanned<[f64; 2]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) lens: Option<Spanned<Vec<f64>>>,
}

/// Where the ground lies: `"lowest"` or a height, which is written as text and may be a number.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(untagged, expecting = "\"lowest\" or a height")]
pub(super) enum GroundToml {
    Number(f64),
    Text(String),
}

/// A shape by its parameters; the defaults are those of [`Shape::ALL`].
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(
    tag = "kind",
    rename_all = "kebab-case",
    deny_unknown_fields,
    expecting = "a table, as { kind = \"sphere\", radius = 2 }"
)]
pub(super) enum ShapeToml {
    Cube {
        #[serde(default = "lengths")]
        size: [f64; 3],
    },
    Plane {
        #[serde(default = "lengths")]
        size: [f64; 2],
    },
    Sphere {
        #[serde(default = "length")]
        radius: f64,
        #[serde(default = "segments")]
        segments: u32,
        #[serde(default = "rings")]
        rings: u32,
    },
    Cone {
        #[serde(default = "length")]
        radius: f64,
        #[serde(default = "length")]
        height: f64,
        #[serde(default = "segments")]
        segments: u32,
    },
    Cylinder {
        #[serde(default = "length")]
        radius: f64,
        #[serde(default = "length")]
        height: f64,
        #[serde(default = "segments")]
        segments: u32,
    },
    Torus {
        #[serde(default = "length")]
        radius: f64,
        #[serde(default = "tube")]
        tube: f64,
        #[serde(default = "segments")]
        segments: u32,
        #[serde(default = "rings")]
        rings: u32,
    },
    Disc {
        #[serde(default = "length")]
        radius: f64,
        #[serde(default = "segments")]
        segments: u32,
    },
    Monkey {
        #[serde(default = "length")]
        size: f64,
    },
    Dahlia {
        #[serde(default = "length")]
        size: f64,
        #[serde(default = "petals")]
        petals: u32,
    },
}

fn length() -> f64 {
    Shape::LENGTH
}

fn lengths<const N: usize>() -> [f64; N] {
    [Shape::LENGTH; N]
}

fn tube() -> f64 {
    Shape::TUBE
}

fn segments() -> u32 {
    Shape::SEGMENTS
}

fn rings() -> u32 {
    Shape::RINGS
}

fn petals() -> u32 {
    Shape::PETALS
}

/// Conversions between the same variants, field by field, in both directions.
macro_rules! shapes {
    ($($kind:ident { $($number:ident),+ }),+) => {
        impl From<ShapeToml> for Shape {
            fn from(shape: ShapeToml) -> Self {
                match shape {
                    $(ShapeToml::$kind { $($number),+ } => Self::$kind {
                        $($number: $number.into()),+
                    }),+
                }
            }
        }

        impl From<Shape> for ShapeToml {
            fn from(shape: Shape) -> Self {
                match shape {
                    $(Shape::$kind { $($number),+ } => Self::$kind {
                        $($number: $number.into()),+
                    }),+
                }
            }
        }
    };
}

shapes! {
    Cube { size },
    Plane { size },
    Sphere { radius, segments, rings },
    Cone { radius, height, segments },
    Cylinder { radius, height, segments },
    Torus { radius, tube, segments, rings },
    Disc { radius, segments },
    Monkey { size },
    Dahlia { size, petals }
}
