use super::{
    BackFacesArg, GroundArg, SceneColor, TextureProjectionArgs, WireframeArg, shading_values,
    values,
};
use clap::Args;
use raycast_core::scene::{Color, ColorMap, Crop, Wrap};
use raycast_core::shade::{Background, EdgeKinds, Filter, LightSet, Mode};
use std::path::PathBuf;

/// How surfaces are shaded.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Shading")]
pub struct ShadingArgs {
    /// What the picture shows [default: smooth]
    #[arg(long, value_name = "MODE", value_parser = values::named(shading_values::MODES))]
    pub mode: Option<Mode>,
    /// Draw edges over the mode, with lines this many pixels wide [default width: 1]; `none` for no lines, whatever the
    /// scene file says
    #[arg(
        long,
        value_name = "WIDTH",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "1",
        value_parser = shading_values::wireframe
    )]
    pub wireframe: Option<WireframeArg>,
    /// The color of these lines: `#rrggbb` or `#rgb`
    #[arg(long, value_name = "COLOR", requires = "wireframe")]
    pub wireframe_color: Option<Color>,
    /// The edges to draw: `all`, or some of `polygon` (edges of the file's polygons), `feature[:DEGREES]` (where the
    /// surface turns by at least this angle; 30), `silhouette`, `boundary`, `non-manifold`, separated by commas
    /// [default: all]
    #[arg(long, value_name = "KINDS")]
    pub wireframe_edges: Option<EdgeKinds>,
    /// How strongly hidden lines show: 0 (not at all) to 1 (as visible ones) [default: 0; 0.25 without a number]
    #[arg(
        long,
        value_name = "0..1",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "0.25",
        value_parser = shading_values::hidden_lines
    )]
    pub wireframe_hidden: Option<f32>,
    /// The color of back faces, in place of their own: `#rrggbb`, `#rgb` or `none`
    #[arg(long, value_name = "COLOR", value_parser = shading_values::back_faces)]
    pub back_faces: Option<BackFacesArg>,
    /// Draw a grid on a horizontal plane at the scene's lowest point, or at a height; `none` for no grid, whatever the
    /// scene file says
    #[arg(
        long,
        value_name = "HEIGHT",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "lowest",
        value_parser = shading_values::ground
    )]
    pub ground: Option<GroundArg>,
    /// In `--mode x-ray`, the opacity of surfaces that face the eye; at grazing angles it is higher [default: 0.2]
    #[arg(long, value_name = "0..1", allow_hyphen_values = true, value_parser = shading_values::opacity)]
    pub x_ray_opacity: Option<f32>,
    /// A texture image for every object
    #[arg(long, value_name = "IMAGE")]
    pub texture: Option<PathBuf>,
    /// The part of the texture's image to use, in its pixels from the top left
    #[arg(long, value_name = "X,Y,W,H", requires = "texture", value_parser = shading_values::crop)]
    pub crop: Option<Crop>,
    /// What the texture shows beyond its image, along both its axes or along each: `repeat`, `mirror`,
    /// `clamp`, `border` (the object's own colours) or `border:#rrggbb` [default: repeat]
    #[arg(long, value_name = "KIND[,KIND]", requires = "texture", value_parser = shading_values::wrap)]
    pub wrap: Option<[Wrap; 2]>,
    /// How texture coordinates are assigned.
    #[command(flatten)]
    pub projection: TextureProjectionArgs,
    /// Blend from the object's colours (0) to its texture (1) [default: 1]
    #[arg(long, value_name = "0..1", allow_hyphen_values = true, value_parser = shading_values::blend)]
    pub blend: Option<f32>,
    /// A scalar of the file, 0 to 1, that `--blend` is multiplied by at each point; `raycast info` lists the scalars
    #[arg(long, value_name = "SCALAR")]
    pub blend_by: Option<String>,
    /// The texture filter [default: bilinear]
    #[arg(long, value_name = "KIND", value_parser = values::named(shading_values::FILTERS))]
    pub filter: Option<Filter>,
    /// Every object's colours: `file`, `per-triangle[:SEED]`, `object` (one each), `group` (one for each group of an OBJ
    /// or STL file), `normal`, `#rrggbb` or `#rgb`; or a number through a colour map: `area`, `distance[:X,Y,Z]` (from
    /// the eye or a point), `curvature[:gaussian]` or `scalar:NAME` (the file's; `raycast info` lists them) [default: the
    /// scene file's, file]
    #[arg(long, value_name = "COLOR", value_parser = shading_values::scene_color)]
    pub color: Option<SceneColor>,
    /// The colour of triangles to which neither their file nor `--color` gives one (`#c8ccd2` by default)
    #[arg(long, value_name = "COLOR")]
    pub plain_color: Option<Color>,
    /// Give meshes without normals smooth ones across edges where the surface turns by at most this angle; 0 leaves
    /// every triangle flat [default: 0]
    #[arg(long, value_name = "DEGREES", value_parser = shading_values::crease)]
    pub crease: Option<f32>,
    /// The lights, which move with the camera [default: soft]
    #[arg(long, value_name = "KIND", value_parser = values::named(shading_values::LIGHTS))]
    pub lights: Option<LightSet>,
    /// The colour map of numbers, from low to high; with it, or either of the next two, `--mode depth` maps the visible
    /// depths to its colours instead of greys [default: viridis]
    #[arg(long, value_name = "MAP", value_parser = values::named(shading_values::COLOR_MAPS))]
    pub color_map: Option<ColorMap>,
    /// The numbers at the map's ends [default: fitted to the values]
    #[arg(long, value_name = "LOW,HIGH", allow_hyphen_values = true, value_parser = shading_values::color_range)]
    pub color_range: Option<[f64; 2]>,
    /// Draw the colour map's legend into the picture
    #[arg(long)]
    pub legend: bool,
    /// The background: `#top,#bottom`, `#rrggbb`, `#rgb` or `transparent`
    #[arg(long, value_name = "COLORS", value_parser = shading_values::background)]
    pub background: Option<Background>,
}
