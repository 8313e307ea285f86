use super::EdgeKinds;
use crate::camera::Projection;
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
    /// Lit, with the mesh's own normals between corners; as [`Mode::Flat`] where there are none.
    #[default]
    Smooth,
    /// Lit, as metals and dielectrics of their file's roughness are, with light of their own, over normals as
    /// [`Mode::Smooth`] has.
    Material,
    /// Directions of the surface as colours: x red, y green, z blue.
    Normals,
    /// Distance: near is light, far is dark.
    Depth,
    /// The weights of a triangle's corners as red, green and blue.
    Barycentric,
    /// Texture coordinates as red and green.
    Uv,
    /// The texture, unlit; the object's colours where there is none.
    Texture,
    /// Lines alone, over the background.
    Wireframe,
    /// All layers, each faint and lit as in [`Mode::Smooth`], the nearest over those behind it.
    XRay,
}

impl Mode {
    /// Whether it shows normals between corners.
    pub(crate) fn shows_normals(self) -> bool {
        matches!(
            self,
            Self::Smooth | Self::Material | Self::Normals | Self::XRay
        )
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

/// How a texture is read between its texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// Four texels, blended in linear light.
    #[default]
    Bilinear,
    /// Four texels of each of two of the image's smaller versions, by the longer side of what the pixel
    /// sees of it: what is far away does not shimmer, but blurs where it is seen at a slant.
    Trilinear,
    /// All texels that the pixel sees, under an elliptical Gaussian: it neither shimmers nor blurs.
    Ewa,
}

impl Filter {
    /// Whether a pixel's colour depends on how much of the texture it sees; the texture's smaller versions are then
    /// needed.
    pub fn has_footprint(self) -> bool {
        matches!(self, Self::Trilinear | Self::Ewa)
    }
}

/// Lines along triangles' edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wireframe {
    /// Width in pixels.
    pub width: f32,
    /// Colour of all lines but those of [`EdgeKinds::boundary`] and [`EdgeKinds::non_manifold`] edges, which have
    /// [`Wireframe::BOUNDARY`] and [`Wireframe::NON_MANIFOLD`].
    pub color: Color,
    /// Which edges have lines.
    pub edges: EdgeKinds,
    /// How strongly lines show through what hides them, from 0 (not at all) to 1; not in panoramas.
    pub hidden: f32,
}

impl Wireframe {
    /// Lines that stand by themselves before a dark background: what [`Mode::Wireframe`] draws
    /// where none are set.
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

    /// How strongly hidden lines show where nobody says how strongly.
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
    /// Dark lines, a pixel wide, over a surface.
    fn default() -> Self {
        Self {
            width: 1.0,
            color: Color([0x10, 0x14, 0x1a]),
            edges: EdgeKinds::ALL,
            hidden: 0.0,
        }
    }
}

/// What lies behind everything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// From the first colour at the top of the picture to the second at its bottom.
    Gradient(Color, Color),
    /// Nothing: alpha is zero.
    Transparent,
}

impl Default for Background {
    fn default() -> Self {
        Self::Gradient(Color([0x20, 0x24, 0x2c]), Color([0x3a, 0x44, 0x54]))
    }
}

/// How high the ground lies, in world space.
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

/// A text that says no [`Ground`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected lowest, or a height within 1e18 of zero")]
pub struct GroundError;

impl FromStr for Ground {
    type Err = GroundError;

    fn from_str(text: &str) -> Result<Self, GroundError> {
        if text == "lowest" {
            return Ok(Self::Lowest);
        }
        let height: f64 = text.parse().map_err(|_| GroundError)?;
        (height.abs() <= 1e18)
            .then_some(Self::At(height))
            .ok_or(GroundError)
    }
}

impl Ground {
    /// Lines across which x or z is a whole number of tens of cells.
    pub const LINES: Color = Color([0x8c, 0x94, 0xa0]);
    /// The line along which x grows.
    pub const X_AXIS: Color = Color([0xd8, 0x4c, 0x4c]);
    /// The line along which z grows.
    pub const Z_AXIS: Color = Color([0x4c, 0x7c, 0xe0]);
}

/// The lights of lit modes. They stand still to the camera, so that whatever one looks at is lit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightSet {
    /// A key light up and to the left, whose shadow side is soft, a fill from all around, lighter from above, and a faint
    /// rim where surfaces turn away.
    #[default]
    Soft,
    /// One light at the eye, where a mesh's faults show best: brightness tells the angle between surface and view.
    Headlight,
    /// A warm key light up and to the left, a cool fill light from the right, a rim light from behind and above, and a
    /// little light from all around: a photographer's.
    ThreePoint,
}

/// All that decides a picture's colours, besides the scene and the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shading {
    /// What to show.
    pub mode: Mode,
    /// Lines over it. [`Mode::Wireframe`] draws lines with or without this.
    pub wireframe: Option<Wireframe>,
    /// What lies behind.
    pub background: Background,
    /// Lines on a level plane: a cell is a power of ten wide, a fifth to a fiftieth of the scene. What surfaces let
    /// through shows it behind them all.
    pub ground: Option<Ground>,
    /// From the object's colours (0) to its texture (1).
    pub blend: f32,
    /// How textures are read.
    pub filter: Filter,
    /// How surfaces find their place in textures, where their object does not say it.
    pub projection: TextureProjection,
    /// Below which angle between two triangles, in degrees, the edge that they share is smooth, in meshes without
    /// normals; zero leaves every triangle flat. It is for light and for [`Mode::Normals`]; a picture's layers keep
    /// the file's normals.
    pub crease: f32,
    /// Where light comes from.
    pub lights: LightSet,
    /// The colour of triangles to which neither their file nor a rule gives one.
    pub plain_color: Color,
    /// How numbers become colours: those of [`ColorRule::Value`](crate::scene::ColorRule::Value), which have
    /// the default scale where this is `None`, and distances in [`Mode::Depth`], which are then greys over the
    /// scene's box. Fitted, depth is over what is seen.
    pub scale: Option<ColorScale>,
    /// The colour of triangles that are seen from behind, in place of their own and their texture's; `None` for the
    /// same as in front. In modes that show what surfaces look like.
    pub back_faces: Option<Color>,
    /// In [`Mode::XRay`], how much of what lies behind it a surface covers that is seen from above: 0 to 1.
    pub x_ray_opacity: f32,
}

impl Shading {
    /// Where none is given.
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
        self.crease > 0.0 && self.mode.shows_normals()
    }

    /// What windows begin with, where the files say nothing: edges of up to 40° smooth, three lights, and a
    /// warm grey.
    pub fn studio() -> Self {
        Self {
            crease: 40.0,
            lights: LightSet::ThreePoint,
            plain_color: Color([0xc8, 0xbf, 0xb2]),
            ..Self::default()
        }
    }
}
