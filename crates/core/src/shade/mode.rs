use super::EdgeKinds;
use crate::camera::Projection;
use crate::ranges::{self, OutOfRange};
use crate::scene::{Color, ColorScale, TextureProjection};
use std::fmt;
use std::str::FromStr;

/// What a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// The triangles' own colours, unlit.
    Color,
    /// Lit, one brightness a triangle.
    Flat,
    /// Lit, with the mesh's interpolated normals; as [`Mode::Flat`] where there are none.
    #[default]
    Smooth,
    /// Lit by the metallic-roughness model of the file's materials, with emission; normals as in [`Mode::Smooth`].
    Material,
    /// Surface normals as colours: x red, y green, z blue.
    Normals,
    /// Distance: near is light, far is dark.
    Depth,
    /// Barycentrics of the corners as red, green and blue.
    Barycentric,
    /// Texture coordinates as red and green.
    Uv,
    /// The texture, unlit; the object's colours where there is none.
    Texture,
    /// Only lines, over the background.
    Wireframe,
    /// All layers, each faint and lit as in [`Mode::Smooth`], composited front to back.
    XRay,
}

/// What a [`Mode`] shows of surfaces: shading computes no more than that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shows {
    /// The objects' own colours.
    pub colors: bool,
    /// Textures over them.
    pub textures: bool,
    /// Interpolated normals.
    pub normals: bool,
    /// Surfaces, which may be translucent, and sections where clipping planes cut them; else properties of hits.
    pub surfaces: bool,
}

impl Mode {
    /// What it shows.
    pub fn shows(self) -> Shows {
        let nothing = Shows::default();
        let unlit = Shows {
            colors: true,
            surfaces: true,
            ..nothing
        };
        let flat = Shows {
            textures: true,
            ..unlit
        };
        let normals = Shows {
            normals: true,
            ..nothing
        };
        match self {
            Self::Color => unlit,
            Self::Flat | Self::Texture => flat,
            Self::Smooth | Self::Material => Shows {
                normals: true,
                ..flat
            },
            // All surfaces are translucent in their own way, and sections are not filled.
            Self::XRay => Shows {
                colors: true,
                textures: true,
                ..normals
            },
            Self::Normals => normals,
            Self::Depth | Self::Barycentric | Self::Uv | Self::Wireframe => nothing,
        }
    }

    /// Each of them.
    pub const ALL: [Self; 11] = [
        Self::Color,
        Self::Flat,
        Self::Smooth,
        Self::Material,
        Self::Normals,
        Self::Depth,
        Self::Barycentric,
        Self::Uv,
        Self::Texture,
        Self::Wireframe,
        Self::XRay,
    ];
}

/// Texture filtering.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// Four texels, interpolated in linear light.
    #[default]
    Bilinear,
    /// Four texels of each of two mip levels, chosen by the longer side of the pixel's footprint: distant textures do
    /// not shimmer, but blur at grazing angles.
    Trilinear,
    /// All texels in the pixel's footprint, under an elliptical Gaussian (elliptical weighted average): neither
    /// shimmers nor blurs.
    Ewa,
}

impl Filter {
    /// Whether a pixel's colour depends on its footprint, so that mip levels are needed.
    pub fn has_footprint(self) -> bool {
        matches!(self, Self::Trilinear | Self::Ewa)
    }
}

/// Lines along triangles' edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wireframe {
    /// Width in pixels.
    pub width: f32,
    /// The colour of all lines except along [`EdgeKinds::boundary`] and [`EdgeKinds::non_manifold`] edges, which have
    /// [`Wireframe::BOUNDARY`] and [`Wireframe::NON_MANIFOLD`].
    pub color: Color,
    /// Which edges have lines.
    pub edges: EdgeKinds,
    /// The opacity of lines behind surfaces, from 0 (invisible) to 1; not in panoramas.
    pub hidden: f32,
}

impl Wireframe {
    /// Lines in front of a dark background: the default of [`Mode::Wireframe`].
    pub const ALONE: Self = Self {
        width: 1.0,
        color: Color([0xd6, 0xde, 0xe8]),
        edges: EdgeKinds::ALL,
        hidden: 0.0,
    };

    /// The colour of boundary edges.
    pub const BOUNDARY: Color = Color([0xff, 0x9d, 0x2e]);

    /// The colour of non-manifold edges.
    pub const NON_MANIFOLD: Color = Color([0xff, 0x3b, 0x5c]);

    /// The default opacity of hidden lines.
    pub const FAINT: f32 = 0.25;

    /// Which of the lines a picture of this projection leaves out, in words: of a panorama those where no triangle at a
    /// pixel has them, since its edges are no straight lines.
    pub fn left_out(&self, projection: Projection) -> Option<&'static str> {
        projection.panorama()?;
        match (self.edges.silhouette, self.hidden > 0.0) {
            (true, true) => Some("hidden lines and silhouettes"),
            (true, false) => Some("silhouettes"),
            (false, true) => Some("hidden lines"),
            (false, false) => None,
        }
    }
}

impl Default for Wireframe {
    /// Dark lines, one pixel wide, over a surface.
    fn default() -> Self {
        Self {
            width: 1.0,
            color: Color([0x10, 0x14, 0x1a]),
            edges: EdgeKinds::ALL,
            hidden: 0.0,
        }
    }
}

/// The background.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// A vertical gradient from the first colour at the top of the picture to the second at its bottom.
    Gradient(Color, Color),
    /// Transparent: alpha is zero.
    Transparent,
}

impl Default for Background {
    fn default() -> Self {
        Self::Gradient(Color([0x20, 0x24, 0x2c]), Color([0x3a, 0x44, 0x54]))
    }
}

/// The height of the ground, in world space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Ground {
    /// At the lowest point of the scene.
    #[default]
    Lowest,
    /// At this y.
    At(f64),
}

/// `lowest`, or the height.
impl fmt::Display for Ground {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lowest => f.write_str("lowest"),
            Self::At(height) => height.fmt(f),
        }
    }
}

/// A text that is no [`Ground`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GroundError {
    /// Neither the word nor a number.
    #[error("expected lowest, or a height")]
    Word,
    /// A height out of range.
    #[error(transparent)]
    Range(#[from] OutOfRange),
}

impl FromStr for Ground {
    type Err = GroundError;

    fn from_str(text: &str) -> Result<Self, GroundError> {
        if text == "lowest" {
            return Ok(Self::Lowest);
        }
        let height = text.parse().map_err(|_| GroundError::Word)?;
        Self::at(height)
    }
}

impl Ground {
    /// At a height.
    ///
    /// # Errors
    /// A height out of its range, [`ranges::ground_height`].
    pub fn at(height: f64) -> Result<Self, GroundError> {
        Ok(Self::At(ranges::ground_height(height)?))
    }

    /// Lines at which x or z is a multiple of ten cells.
    pub const LINES: Color = Color([0x8c, 0x94, 0xa0]);
    /// The x axis.
    pub const X_AXIS: Color = Color([0xd8, 0x4c, 0x4c]);
    /// The z axis.
    pub const Z_AXIS: Color = Color([0x4c, 0x7c, 0xe0]);
}

/// The lights of lit modes. They are fixed to the camera, so that whatever it looks at is lit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightSet {
    /// A key light from the upper left with a soft shadow side, an ambient fill that is lighter from above, and a
    /// faint rim where surfaces turn away.
    #[default]
    Soft,
    /// One light at the eye, which shows a mesh's faults best: brightness depends only on the angle between surface
    /// and view.
    Headlight,
    /// A photographer's set: a warm key light from the upper left, a cool fill light from the right, a rim light from
    /// behind and above, and a little ambient light.
    ThreePoint,
}

/// The settings that decide a picture's colours, besides scene and camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shading {
    /// What the picture shows.
    pub mode: Mode,
    /// Lines over the surfaces. [`Mode::Wireframe`] draws lines with or without this.
    pub wireframe: Option<Wireframe>,
    /// The background.
    pub background: Background,
    /// A grid on a horizontal plane, whose cells are a power of ten wide, between a fifth and a fiftieth of the
    /// scene's size. It is visible behind translucent surfaces.
    pub ground: Option<Ground>,
    /// How much of the texture shows: from the object's colours only (0) to the texture only (1).
    pub blend: f32,
    /// How textures are read.
    pub filter: Filter,
    /// How textures are mapped to objects without a mapping of their own.
    pub projection: TextureProjection,
    /// The angle between two triangles, in degrees, up to which their common edge is smooth, in meshes without
    /// normals; zero leaves every triangle flat. It affects lighting and [`Mode::Normals`]; a picture's layers keep
    /// the file's normals.
    pub crease: f32,
    /// The lights.
    pub lights: LightSet,
    /// The colour of triangles to which neither their file nor a rule gives one.
    pub plain_color: Color,
    /// The colour scale of numbers: of [`ColorRule::Value`](crate::scene::ColorRule::Value), with the default scale
    /// for `None`, and of distances in [`Mode::Depth`], which for `None` are greys over the scene's box. Without a
    /// given range, depth is fitted to the visible surfaces.
    pub scale: Option<ColorScale>,
    /// The colour of back faces, instead of their own and their texture's; `None` for the same as front faces. It
    /// applies in modes that show what surfaces look like.
    pub back_faces: Option<Color>,
    /// In [`Mode::XRay`], the opacity of a surface seen perpendicularly, 0 to 1.
    pub x_ray_opacity: f32,
}

impl Shading {
    /// The default opacity.
    pub const X_RAY_OPACITY: f32 = 0.2;
}

impl Default for Shading {
    fn default() -> Self {
        Self {
            mode: Mode::default(),
            wireframe: None,
            background: Background::default(),
            ground: None,
            blend: 1.0,
            filter: Filter::default(),
            projection: TextureProjection::default(),
            crease: 0.0,
            lights: LightSet::default(),
            plain_color: Color::DEFAULT,
            scale: None,
            back_faces: None,
            x_ray_opacity: Self::X_RAY_OPACITY,
        }
    }
}

impl Shading {
    /// Whether meshes without normals get those of the crease angle.
    pub fn is_creased(&self) -> bool {
        self.crease > 0.0 && self.mode.shows().normals
    }

    /// The initial settings of windows, where files set nothing: smooth edges up to 40°, three lights, and a warm
    /// grey.
    pub fn studio() -> Self {
        Self {
            crease: 40.0,
            lights: LightSet::ThreePoint,
            plain_color: Color([0xc8, 0xbf, 0xb2]),
            ..Self::default()
        }
    }
}
