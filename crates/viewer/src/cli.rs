//! What a command line may hold.

mod clip;
mod frames;
mod mistyped;
mod plan;
mod reading;
mod section;
mod shell;
mod texture_map;
mod texture_projection;
mod values;
mod written;

pub use clip::{ClipArg, ClipArgs};
pub use frames::{FrameArgs, FrameRange, frame_path};
pub use mistyped::mistyped;
pub use plan::PlanArgs;
pub use reading::{LimitArg, ReadingArgs};
pub use section::SectionArgs;
pub use shell::quoted_for_posix;
pub use texture_map::TextureMapArgs;
pub use texture_projection::TextureProjectionArgs;
pub use values::{OrbitArg, SceneColor, WireframeArg};
pub use written::{camera_of, camera_options, has_own_projection, render_command};

use crate::failure::Failure;
use crate::output;
use clap::{Args, Parser, Subcommand};
use raycast_core::Cull;
use raycast_core::camera::{Grid, Projection};
use raycast_core::glam::DVec3;
use raycast_core::render::Precision;
use raycast_core::scene::{Color, ColorMap, Crop, Wrap};
use raycast_core::shade::{Background, Filter, Mode};
use raycast_report::scenes::Made;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  raycast                                      the demo scene in a window
  raycast bunny.obj                            a mesh in a window
  raycast render bunny.obj -o bunny.png        its picture, without a window
  raycast render bunny.obj -o close.png --orbit 40,10,0.2 --size 1920x1080 --samples 4
  raycast render spot.obj -o spot.png --mode texture --texture spot_texture.png
  raycast render bunny.obj -o part.png --tiles 3x2 --sub-camera 1,0
  raycast convert bunny.obj -o bunny.ply
  raycast info bunny.obj";

/// Look at meshes through exact rays, in a window or without one.
#[derive(Debug, Parser)]
#[command(
    name = "raycast",
    version,
    args_conflicts_with_subcommands = true,
    after_help = EXAMPLES
)]
pub struct Cli {
    /// What to do without a window.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Meshes or scene files to open in the window [default: the demo scene]
    pub files: Vec<PathBuf>,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Open files in the window, whatever they are called
    View {
        /// Meshes or scene files [default: the demo scene]
        files: Vec<PathBuf>,
        /// Write a line of JSON a frame, for measuring; such a window remembers nothing
        #[arg(long, value_name = "FILE")]
        log: Option<PathBuf>,
        /// How files are read.
        #[command(flatten)]
        reading: ReadingArgs,
    },
    /// Render a picture, or one fragment of it, to an image file
    Render(Box<RenderArgs>),
    /// Answer a file of rays with a file of hits
    Cast(CastArgs),
    /// Put fragments together into the picture that the full camera would have made
    Stitch(StitchArgs),
    /// Write pictures and fragments as command lines, for an engine that runs many jobs
    Plan(PlanArgs),
    /// Write the meshes of files in another format
    Convert(ConvertArgs),
    /// Draw a mesh's triangles into its texture
    TextureMap(Box<TextureMapArgs>),
    /// Draw the outline of a section as SVG or DXF
    Section(SectionArgs),
    /// Tell what files hold
    Info(InfoArgs),
    /// Measure frame times on this machine; prints JSON
    Bench(BenchArgs),
    /// Measure speed against error, beside other ways of casting rays, and write a report
    Report(ReportArgs),
    /// Prove a picture: hold its pixels against exact rational arithmetic
    Verify(Box<VerifyArgs>),
}

/// `raycast render`.
#[derive(Debug, Args)]
#[command(after_help = "\
Size, step and field of view are bound by `rows x step = 2 x distance x tan(fov / 2)`: give two of
the three at most. The eye, by default, is where the whole scene is in view.

In --stats, cast_ms and shade_ms are the render's wall-clock time, shared out as the tiles' own
times for visibility and for everything else are.

Examples:
  raycast render bunny.obj -o bunny.png
  raycast render bunny.obj -o dense.exr --step 0.0001 --fov 30
  raycast render scene.raycast.toml -o scene.png --samples 16 --stats -
  raycast render bunny.obj -o large.tif --size 65536x32768 --resume
  raycast render bunny.obj -o cut.png --clip x:0 --clip -y:0.1
  raycast render bunny.obj -o turn-%05d.png --turntable 100
  raycast render a.obj b.obj -o both.png --eye -1,2,5 --target 0,0.5,0")]
pub struct RenderArgs {
    /// Meshes, or a scene file whose camera, image and shading are then the defaults
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The image to write: .png, .ppm, .jpg, .tif or .exr (a fragment: .png or .exr); or a .dzi, a pyramid of
    /// tiles with a page for a browser
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Go on where an earlier render of the same picture was ended, and leave what is done if this one is: a
    /// part file and its journal beside the image. For large pictures, but .jpg
    #[arg(long, conflicts_with_all = ["sub_camera", "unfinished"])]
    pub resume: bool,
    /// Where from.
    #[command(flatten)]
    pub camera: CameraArgs,
    /// In which colours.
    #[command(flatten)]
    pub shading: ShadingArgs,
    /// In which parts.
    #[command(flatten)]
    pub tiles: TileArgs,
    /// Rays a pixel, 1 to 4096; the first goes through its centre [default: 1]
    #[arg(
        long,
        value_name = "N",
        help_heading = "Casting",
        value_parser = values::samples
    )]
    pub samples: Option<u32>,
    /// How rays meet triangles.
    #[command(flatten)]
    pub casting: CastingArgs,
    /// Which frames.
    #[command(flatten)]
    pub animation: FrameArgs,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
    /// Write what it took to this file as JSON; `-` is standard output
    #[arg(long, value_name = "FILE", help_heading = None)]
    pub stats: Option<PathBuf>,
}

/// Where the camera stands and what its rays are.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Camera")]
pub struct CameraArgs {
    /// Columns and rows of rays [default: 1280x720]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub size: Option<(u32, u32)>,
    /// Distance between neighbouring rays at the target, in scene units
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = values::step)]
    pub step: Option<f64>,
    /// Vertical field of view in degrees [default: 45, of a panorama all of it or half a turn]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = values::fov)]
    pub fov: Option<f64>,
    /// How rays leave the camera [default: perspective]
    #[arg(long, value_name = "KIND", value_parser = values::named(values::PROJECTIONS))]
    pub projection: Option<Projection>,
    /// Where the camera stands
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub eye: Option<DVec3>,
    /// What it looks at [default: the scene's centre]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub target: Option<DVec3>,
    /// Which way is up [default: 0,1,0]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub up: Option<DVec3>,
    /// Degrees about the scene's centre and above its horizon; distance in scene units [default:
    /// 22,16, as far as the whole scene needs]
    #[arg(
        long,
        value_name = "YAW,PITCH[,DISTANCE]",
        allow_hyphen_values = true,
        conflicts_with = "eye",
        value_parser = values::orbit
    )]
    pub orbit: Option<OrbitArg>,
}

/// In which colours a picture is made.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Shading")]
pub struct ShadingArgs {
    /// What the picture shows [default: smooth]
    #[arg(long, value_name = "MODE", value_parser = values::named(values::MODES))]
    pub mode: Option<Mode>,
    /// Draw triangles' edges over the mode, so many pixels wide [default width: 1]; or `none`, also where a scene
    /// file has them
    #[arg(
        long,
        value_name = "WIDTH",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "1",
        value_parser = values::wireframe
    )]
    pub wireframe: Option<WireframeArg>,
    /// The color of these edges: `#rrggbb` or `#rgb`
    #[arg(long, value_name = "COLOR", requires = "wireframe")]
    pub wireframe_color: Option<Color>,
    /// An image for the surface of every object
    #[arg(long, value_name = "IMAGE")]
    pub texture: Option<PathBuf>,
    /// The part of the texture's image to use, in its pixels from the top left
    #[arg(long, value_name = "X,Y,W,H", requires = "texture", value_parser = values::crop)]
    pub crop: Option<Crop>,
    /// What the texture shows beyond its image, along both its axes or along each: `repeat`, `mirror`,
    /// `clamp`, `border` (the object's own colours) or `border:#rrggbb` [default: repeat]
    #[arg(long, value_name = "KIND[,KIND]", requires = "texture", value_parser = values::wrap)]
    pub wrap: Option<[Wrap; 2]>,
    /// How surfaces find their place in the texture.
    #[command(flatten)]
    pub projection: TextureProjectionArgs,
    /// From the object's colours (0) to its texture (1) [default: 1]
    #[arg(long, value_name = "0..1", allow_hyphen_values = true, value_parser = values::blend)]
    pub blend: Option<f32>,
    /// How the texture is read between its texels [default: bilinear]
    #[arg(long, value_name = "KIND", value_parser = values::named(values::FILTERS))]
    pub filter: Option<Filter>,
    /// Every object's colours: `file`, `per-triangle[:SEED]`, `object` (one each), `normal`, `#rrggbb` or `#rgb`;
    /// or a number through a colour map: `area`, `distance[:X,Y,Z]` (from the eye or a point),
    /// `curvature[:gaussian]` or `scalar:NAME` (the file's; `raycast info` lists them) [default: the file's own,
    /// or one a triangle where it has none]
    #[arg(long, value_name = "COLOR", value_parser = values::scene_color)]
    pub color: Option<SceneColor>,
    /// The colours of numbers, from low to high; with it, or either of the next two, `--mode depth` is in these
    /// colours instead of greys, over the distances seen [default: viridis]
    #[arg(long, value_name = "MAP", value_parser = values::named(values::COLOR_MAPS))]
    pub color_map: Option<ColorMap>,
    /// The numbers at the map's ends [default: fitted to what there is]
    #[arg(long, value_name = "LOW,HIGH", allow_hyphen_values = true, value_parser = values::color_range)]
    pub color_range: Option<[f64; 2]>,
    /// Draw what the colours stand for into the picture
    #[arg(long)]
    pub legend: bool,
    /// What lies behind: `#top,#bottom`, `#rrggbb`, `#rgb` or `transparent`
    #[arg(long, value_name = "COLORS", value_parser = values::background)]
    pub background: Option<Background>,
}

/// How a picture is split.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Tiles")]
pub struct TileArgs {
    /// Split the picture into a grid of so many sub-cameras
    #[arg(long, value_name = "CxR", conflicts_with = "tile_size", value_parser = values::counts)]
    pub tiles: Option<(u32, u32)>,
    /// Split the picture into squares of so many pixels [default: 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub tile_size: Option<u32>,
    /// Render that column and row of the grid alone, from 0,0, and write it as a fragment
    #[arg(long, value_name = "C,R", value_parser = values::cell)]
    pub sub_camera: Option<(u32, u32)>,
    /// The picture as it stands when so many tiles are done, from the middle outwards; of the rest
    /// there is every 16th ray
    #[arg(long, value_name = "N", conflicts_with = "sub_camera")]
    pub unfinished: Option<usize>,
    /// Draw the split from outside: the scene, and around it the frustum of each sub-camera, up to the plane of
    /// the camera's target
    #[arg(long, conflicts_with_all = ["sub_camera", "unfinished"])]
    pub show_sub_cameras: bool,
}

impl TileArgs {
    /// The grid that was asked for.
    pub fn grid(&self) -> Grid {
        match (self.tiles, self.tile_size) {
            (Some((columns, rows)), _) => Grid::Count { columns, rows },
            (None, Some(size)) => Grid::Size(size),
            (None, None) => Grid::default(),
        }
    }
}

/// How rays meet triangles.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Casting")]
pub struct CastingArgs {
    /// Workers, 0 to 256; 0 is one for each of the machine's
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::threads())]
    pub threads: u16,
    /// How sure a picture's triangles are
    #[arg(long, value_name = "KIND", default_value = "exact", value_parser = values::named(values::PRECISIONS))]
    pub precision: Precision,
    /// Which faces rays pass through: none, or those seen from the back
    #[arg(long, value_name = "FACES", default_value = "none", value_parser = values::named(values::CULLS))]
    pub cull: Cull,
    /// What is cut away.
    #[command(flatten)]
    pub clip: ClipArgs,
}

/// `raycast cast`.
#[derive(Debug, Args)]
#[command(after_help = "\
Both files are little-endian. A ray is eight 32-bit floats: origin x y z, t_min, direction x y z,
t_max. A hit is 20 bytes: t (float, infinity at a miss), object, triangle (unsigned, 4294967295 at a
miss), u, v (float), with the point at (1-u-v) a + u b + v c. A hit has t_min < t <= t_max, and a t_max
of +infinity is no limit; a ray with any other number that is not finite, or a direction of zero, is a
miss, and counted on standard error.

Example:
  raycast cast bunny.obj --rays rays.bin --hits hits.bin --stats -")]
pub struct CastArgs {
    /// Meshes or scene files
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The rays, 32 bytes each
    #[arg(long, value_name = "FILE")]
    pub rays: PathBuf,
    /// The hits to write, 20 bytes each, in the rays' order
    #[arg(long, value_name = "FILE")]
    pub hits: PathBuf,
    /// Which faces rays pass through: none, or those seen from the back
    #[arg(long, value_name = "FACES", default_value = "none", value_parser = values::named(values::CULLS))]
    pub cull: Cull,
    /// What is cut away.
    #[command(flatten)]
    pub clip: ClipArgs,
    /// Workers, 0 to 256; 0 is one for each of the machine's
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::threads())]
    pub threads: u16,
    /// Write what it took to this file as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// `raycast stitch`.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  raycast render bunny.obj --tiles 2x1 --sub-camera 0,0 -o left.png
  raycast render bunny.obj --tiles 2x1 --sub-camera 1,0 -o right.png
  raycast stitch left.png right.png -o bunny.png")]
pub struct StitchArgs {
    /// What `raycast render --sub-camera` wrote
    #[arg(required = true)]
    pub fragments: Vec<PathBuf>,
    /// The image to write: .png, .ppm, .jpg, .tif or .exr
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// `raycast convert`.
#[derive(Debug, Args)]
#[command(after_help = "\
The scene's meshes are written each in its place: transforms are applied. Triangles keep their order and
their numbers; those that no ray can meet are written too, and counted. Coordinates are what they were,
bit for bit, where the format's numbers hold them; else it is told how many vertices are moved, and how
far. A .ply has double precision where single does not do; a .glb, single precision about its nodes; an
.stl, single precision alone. Kept are normals, texture coordinates, colours of vertices and of
materials where the format has them (an .obj has its materials in an .mtl beside it); what is not kept
is told.

Examples:
  raycast convert bunny.obj -o bunny.glb
  raycast convert scan.ply.gz -o scan.stl --ascii
  raycast convert scene.raycast.toml -o scene.obj")]
pub struct ConvertArgs {
    /// Meshes or scene files
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The mesh to write: .obj, .ply, .stl, .glb or .txt (triangle text)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Write a .ply or an .stl as text [default: binary]
    #[arg(long)]
    pub ascii: bool,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// `raycast info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// Meshes or scene files
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Print a JSON array, an element a file
    #[arg(long)]
    pub json: bool,
    /// Look for holes, flipped triangles and other faults in each mesh, and tell its area and volume
    #[arg(long)]
    pub health: bool,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// `raycast bench`.
#[derive(Debug, Args)]
#[command(after_help = "\
Views are `medium` (the scene's bounding sphere fills the frame's height) and `close` (half as far),
both from yaw 22, pitch 16; with --eye it is that view alone, named `given`.

cast_ms is a frame's wall-clock time for visibility alone; frame_ms is visibility, shading and the
picture; mrays_per_s comes from the median cast_ms.

Example:
  raycast bench bunny.obj dragon.obj --frames 50 --threads 1")]
pub struct BenchArgs {
    /// Meshes or scene files
    #[arg(required_unless_present = "made")]
    pub files: Vec<PathBuf>,
    /// A scene made in code: ball:TRIANGLES, or interior:TRIANGLES, which is seen from inside, with a field
    /// of view of its own unless --eye is given
    #[arg(long, value_name = "SCENE", value_parser = <Made as std::str::FromStr>::from_str)]
    pub made: Vec<Made>,
    /// Frames to measure a view, after one that is not
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: u32,
    /// Columns and rows of rays
    #[arg(long, value_name = "WxH", default_value = "1920x1080", value_parser = values::size)]
    pub size: (u32, u32),
    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEG", default_value_t = 45.0, allow_hyphen_values = true, value_parser = values::planar_fov)]
    pub fov: f64,
    /// How rays leave the camera
    #[arg(long, value_name = "KIND", default_value = "perspective", value_parser = values::named(values::PLANAR))]
    pub projection: Projection,
    /// Measure the view from here alone
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub eye: Option<DVec3>,
    /// What the given view looks at [default: the scene's centre]
    #[arg(long, value_name = "X,Y,Z", requires = "eye", allow_hyphen_values = true, value_parser = values::point)]
    pub target: Option<DVec3>,
    /// Which way is up in the given view [default: 0,1,0]
    #[arg(long, value_name = "X,Y,Z", requires = "eye", allow_hyphen_values = true, value_parser = values::point)]
    pub up: Option<DVec3>,
    /// What the pictures show
    #[arg(long, value_name = "MODE", default_value = "smooth", value_parser = values::named(values::MODES))]
    pub mode: Mode,
    /// How rays meet triangles.
    #[command(flatten)]
    pub casting: CastingArgs,
    /// Measure obvhs's own traversals, and Embree's where the machine has it, on the same rays, frame
    /// by frame in turn, and brute force on a sample of them; build trees in turn with Embree's, five
    /// times each
    #[arg(long)]
    pub baselines: bool,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// `raycast report`.
#[derive(Debug, Args)]
#[command(after_help = "\
The report is DIR/report.md, with plots as PNG and SVG and numbers as CSV beside it. It takes some
minutes, with --quick some seconds. Embree is compared with where the machine has it; the environment
variable EMBREE_LIBRARY names a libembree4 elsewhere.

Examples:
  raycast report -o report
  raycast report bunny.obj teapot.obj -o report --quick")]
pub struct ReportArgs {
    /// Meshes or scene files, each measured for itself [default: the demo's, and some made in code]
    pub files: Vec<PathBuf>,
    /// The folder to write to: made if it is not there, and written over if it holds a report
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Write to a folder that is not empty and holds no report, too
    #[arg(long)]
    pub force: bool,
    /// Measure little, in seconds: to see what a report is like
    #[arg(long)]
    pub quick: bool,
    /// Workers, 0 to 256; 0 is one for each of the machine's
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::threads())]
    pub threads: u16,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// `raycast verify`.
#[derive(Debug, Args)]
#[command(after_help = "\
A third of the checks goes to pixels where an object ends, a third to those where triangles meet, the
rest to any. Each asks rational arithmetic, which rounds nothing, what the pixel's ray meets first; it
must be the triangle that the picture tells, at the distance that it tells (4 units in the last place,
where the ray does not graze the triangle). Normal, texture coordinates and colour are worked out from
that hit once more, on a path of their own, and must be the picture's but for what rounding can make of
them; of several samples each is cast again. A PNG tells colours alone. How many pixels each channel was
checked at is told; lines are not checked. The exit status is 1 if any pixel is wrong.

A picture tells what it was made of: camera, samples and shading need not be given, and files that make
another scene are refused. Give --texture, --crop and --color as they were given to `raycast render`. Of
a picture without such a recipe, give all as it was given there; the size is the image's own.

Examples:
  raycast verify bunny.obj
  raycast render bunny.obj -o bunny.exr --orbit 40,10
  raycast verify bunny.exr bunny.obj --checks 100000
  raycast verify bunny.exr bunny.obj --all")]
pub struct VerifyArgs {
    /// The image, an .exr or .png as `raycast render` writes it, if one is there; then the meshes or
    /// scene files that it shows, which are rendered if there is none
    #[arg(required = true, value_name = "[IMAGE] FILES")]
    pub files: Vec<PathBuf>,
    /// Pixels to check, or all if there are no more
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(1..))]
    pub checks: u32,
    /// Check every pixel
    #[arg(long, conflicts_with = "checks")]
    pub all: bool,
    /// Which pixels are drawn: the same number draws the same ones
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Where from.
    #[command(flatten)]
    pub camera: CameraArgs,
    /// In which colours.
    #[command(flatten)]
    pub shading: ShadingArgs,
    /// Rays a pixel, 1 to 4096 [default: the recipe's, else 1]
    #[arg(
        long,
        value_name = "N",
        help_heading = "Casting",
        value_parser = clap::value_parser!(u32).range(1..=4096)
    )]
    pub samples: Option<u32>,
    /// How rays meet triangles.
    #[command(flatten)]
    pub casting: CastingArgs,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// Says on standard error what is wrong with a command line, in one line; help and version go to
/// standard output in full. Returns the exit status.
pub fn refuse(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() {
        let printed = error.print().and_then(|()| std::io::stdout().flush());
        return match output::written(printed) {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => failure.tell(),
        };
    }
    Failure::usage(one_line(&error.to_string())).tell()
}

/// clap's message without its usage: `error: …`, details on lines of their own, then hints.
fn one_line(message: &str) -> String {
    let told: Vec<_> = message
        .lines()
        .map(str::trim)
        .take_while(|line| {
            !["Usage:", "For more information", "tip: to pass"]
                .iter()
                .any(|hint| line.starts_with(hint))
        })
        .filter(|line| !line.is_empty())
        .collect();
    let told = told.join(" ");
    let told = told.strip_prefix("error: ").unwrap_or(&told);
    if told.is_empty() {
        "no such command line; see `raycast --help`".to_owned()
    } else {
        format!("{told} (see `raycast --help`)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn parse(line: &str) -> Result<Cli, clap::Error> {
        Cli::try_parse_from(std::iter::once("raycast").chain(line.split_whitespace()))
    }

    fn render(line: &str) -> RenderArgs {
        match parse(line).expect("a good command line").command {
            Some(Command::Render(args)) => *args,
            other => panic!("not a render: {other:?}"),
        }
    }

    #[test]
    fn the_declaration_holds_together() {
        Cli::command().debug_assert();
    }

    #[test]
    fn files_open_the_window_beside_the_commands() {
        let cli = parse("a.obj b.obj").expect("files");
        assert!(cli.command.is_none());
        assert_eq!(cli.files, ["a.obj", "b.obj"].map(PathBuf::from));
        assert!(parse("").expect("nothing").files.is_empty());
        match parse("view render").expect("a file named render").command {
            Some(Command::View { files, .. }) => assert_eq!(files, [PathBuf::from("render")]),
            other => panic!("not a view: {other:?}"),
        }
        let after = parse("a.obj render").expect("two files");
        assert!(after.command.is_none());
        assert_eq!(after.files.len(), 2);
    }

    #[test]
    fn negative_numbers_are_values() {
        let args = render("render a.obj -o a.png --eye -1,-2.5,3 --target -0,0,-1e3 --up 0,0,-1");
        assert_eq!(args.camera.eye, Some(DVec3::new(-1.0, -2.5, 3.0)));
        assert_eq!(args.camera.target, Some(DVec3::new(0.0, 0.0, -1000.0)));
        assert_eq!(args.camera.up, Some(DVec3::NEG_Z));
        let orbit = render("render a.obj -o a.png --orbit -30,-10").camera.orbit;
        assert_eq!(
            orbit.map(|o| (o.yaw, o.pitch, o.distance)),
            Some((-30.0, -10.0, None))
        );
    }

    #[test]
    fn wireframe_takes_its_width_after_an_equals_sign_alone() {
        for (option, expected) in [
            ("", None),
            ("--wireframe", Some(WireframeArg::Width(1.0))),
            ("--wireframe=2.5", Some(WireframeArg::Width(2.5))),
            ("--wireframe=none", Some(WireframeArg::None)),
        ] {
            let args = render(&format!("render -o a.png {option} a.obj"));
            assert_eq!(args.shading.wireframe, expected, "{option}");
        }
    }

    #[test]
    fn bad_usage_is_refused() {
        for line in [
            "render a.obj",
            "render -o a.png",
            "render a.obj -o a.png --size 0x5",
            "render a.obj -o a.png --size 5",
            "render a.obj -o a.png --size 70000x5",
            "render a.obj -o a.png --fov 361",
            "render a.obj -o a.png --fov -1",
            "render a.obj -o a.png --step 0",
            "render a.obj -o a.png --step nan",
            "render a.obj -o a.png --step 1e-320",
            "render a.obj -o a.png --wireframe=101",
            "render a.obj -o a.png --wireframe=no",
            "render a.obj -o a.png --limit rows=3",
            "info a.obj --limit bytes=x",
            "render a.obj -o a.png --eye 1,2",
            "render a.obj -o a.png --eye 1,2,inf",
            "render a.obj -o a.png --eye 0,0,1 --orbit 0,0",
            "render a.obj -o a.png --orbit 0,91",
            "render a.obj -o a.png --orbit 0,0,0",
            "render a.obj -o a.png --tiles 2x2 --tile-size 8",
            "render a.obj -o a.png --tiles 0x2",
            "render a.obj -o a.png --tile-size 0",
            "render a.obj -o a.png --samples 0",
            "render a.obj -o a.png --samples 4097",
            "render a.obj -o a.png --threads 257",
            "render a.obj -o a.png --blend 1.5",
            "render a.obj -o a.png --mode pretty",
            "render a.obj -o a.png --crop 0,0,1,1",
            "render a.obj -o a.png --wireframe=0",
            "render a.obj -o a.png --background #000000,#ffffff,#000000",
            "cast a.obj --rays r",
            "stitch a.png",
            "bench",
            "bench a.obj --target 0,0,0",
            "render a.obj -o a.png --clip 0,0,0,1",
            "cast a.obj --rays r --hits h --clip w:1",
            "info",
            "--colour",
        ] {
            let error = parse(line).expect_err(line);
            assert_eq!(error.exit_code(), 2, "{line}");
            let told = one_line(&error.to_string());
            assert!(!told.contains('\n') && told.len() > 20, "{line}: {told}");
        }
    }
}
