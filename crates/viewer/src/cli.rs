//! The command line's options, as clap declares them.

mod bench;
mod camera;
mod camera_values;
mod casting;
mod clip;
mod frames;
mod mistyped;
mod plan;
mod prepare;
mod reading;
mod refusal;
mod render_options;
mod report;
mod section;
mod shading;
mod shading_values;
mod shell;
mod texture_map;
mod texture_projection;
mod tiles;
mod values;
mod verify;

pub use bench::BenchArgs;
pub use camera::CameraArgs;
pub use camera_values::{OrbitArg, StereoArg};
pub use casting::CastingArgs;
pub use clip::{ClipArg, ClipArgs};
pub use frames::{FrameArgs, FrameRange, frame_path};
pub use mistyped::mistyped;
pub use plan::PlanArgs;
pub use prepare::PrepareArgs;
pub use reading::{LimitArg, ReadingArgs};
pub use refusal::refuse;
pub use render_options::{
    camera_options, has_own_projection, parse_camera_options, render_command,
};
pub use report::ReportArgs;
pub use section::SectionArgs;
pub use shading::ShadingArgs;
pub use shading_values::{BackFacesArg, GroundArg, SceneColor, WireframeArg};
pub use shell::quoted_for_posix;
pub use texture_map::TextureMapArgs;
pub use texture_projection::TextureProjectionArgs;
pub use tiles::TileArgs;
pub use verify::VerifyArgs;

use clap::{Args, Parser};
use raycast_core::Cull;
use raycast_core::camera::PixelFilter;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  raycast                                      the demo scene in a window
  raycast bunny.obj                            a mesh in a window
  raycast render bunny.obj -o bunny.png        its picture, without a window
  raycast render bunny.obj -o close.png --orbit 40,10,0.2 --size 1920x1080 --samples 4
  raycast render spot.obj -o spot.png --mode texture --texture spot_texture.png
  raycast render bunny.obj -o part.png --tiles 3x2 --sub-camera 1,0
  raycast convert bunny.obj -o bunny.ply
  raycast prepare bunny.obj -o bunny.raycast   the same mesh, read at once from then on
  raycast info bunny.obj";

/// View and render triangle meshes by exact ray casting, in a window or without one.
#[derive(Debug, Parser)]
#[command(
    name = "raycast",
    version,
    args_conflicts_with_subcommands = true,
    after_help = EXAMPLES
)]
pub struct Cli {
    /// The command; without one, the window opens.
    #[command(subcommand)]
    pub command: Option<Subcommand>,
    /// Meshes or scene files to open in the window [default: the demo scene]
    pub files: Vec<PathBuf>,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

/// The commands.
#[derive(Debug, clap::Subcommand)]
pub enum Subcommand {
    /// Open files in the window, even if they are named like a command
    View {
        /// Meshes or scene files [default: the demo scene]
        files: Vec<PathBuf>,
        /// Write a line of JSON for each frame, for measuring; this window neither loads nor saves settings
        #[arg(long, value_name = "FILE")]
        log: Option<PathBuf>,
        /// How files are read.
        #[command(flatten)]
        reading: ReadingArgs,
    },
    /// Render a picture, or one fragment of it, to an image file
    Render(Box<RenderArgs>),
    /// Cast the rays of a file and write a file of their hits
    Cast(CastArgs),
    /// Assemble fragments into the picture that the full camera would have made
    Stitch(StitchArgs),
    /// Split pictures and animations into many jobs: write a command line for each
    Plan(PlanArgs),
    /// Convert meshes to another format
    Convert(ConvertArgs),
    /// Store meshes with their tree, so that later commands start at once
    Prepare(PrepareArgs),
    /// Draw a mesh's triangles into its texture
    TextureMap(Box<TextureMapArgs>),
    /// Write the outline of a section as SVG or DXF
    Section(SectionArgs),
    /// Describe files: triangles, bounds, materials, faults
    Info(InfoArgs),
    /// Measure frame times on this machine; prints JSON
    Bench(Box<BenchArgs>),
    /// Measure speed and errors beside other ray casters, and write a report
    Report(ReportArgs),
    /// Check a picture's pixels against exact rational arithmetic
    Verify(Box<VerifyArgs>),
}

/// `raycast render`.
#[derive(Debug, Args)]
#[command(after_help = "\
Size, step and field of view are bound by `rows x step = 2 x distance x tan(fov / 2)`: give at
most two of the three. By default the eye is where the whole scene is in view.

In --stats, cast_ms and shade_ms are the render's wall-clock time, divided in proportion to the
tiles' times for visibility and for everything else.

Examples:
  raycast render bunny.obj -o bunny.png
  raycast render bunny.obj -o dense.exr --step 0.0001 --fov 30
  raycast render scene.raycast.toml -o scene.png --samples 16 --stats -
  raycast render bunny.obj -o large.tif --size 65536x32768 --resume
  raycast render bunny.obj -o cut.png --clip x:0 --clip -y:0.1
  raycast render bunny.obj -o turn-%05d.png --turntable 100
  raycast render a.obj b.obj -o both.png --eye -1,2,5 --target 0,0.5,0")]
pub struct RenderArgs {
    /// Meshes or scene files; the first scene file's camera, image and shading are the defaults
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The image to write: .png, .ppm, .jpg, .tif or .exr (a fragment: .png or .exr); or a .dzi, a pyramid of
    /// tiles with a page for a browser
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Continue an interrupted render of the same picture, and if this one is interrupted keep what is done: a part
    /// file and its journal beside the image. For large pictures as .png, .ppm, .tif or .exr, and for frames with such a
    /// file each
    #[arg(long, conflicts_with_all = ["sub_camera", "unfinished"])]
    pub resume: bool,
    /// The camera.
    #[command(flatten)]
    pub camera: CameraArgs,
    /// The shading.
    #[command(flatten)]
    pub shading: ShadingArgs,
    /// The split.
    #[command(flatten)]
    pub tiles: TileArgs,
    /// Rays per pixel, 1 to 4096; the first goes through its centre [default: 1]
    #[arg(
        long,
        value_name = "N",
        help_heading = "Casting",
        value_parser = values::samples
    )]
    pub samples: Option<u32>,
    /// The pixel's reconstruction filter; all but box are wider than a pixel [default: box]
    #[arg(
        long,
        value_name = "KIND",
        help_heading = "Casting",
        value_parser = values::named(values::PIXEL_FILTERS)
    )]
    pub pixel_filter: Option<PixelFilter>,
    /// How rays are cast.
    #[command(flatten)]
    pub casting: CastingArgs,
    /// The frames of an animation.
    #[command(flatten)]
    pub animation: FrameArgs,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
    /// Also write a scene file with everything that decides the picture: rendering it gives the same bytes
    #[arg(
        long,
        value_name = "FILE",
        help_heading = None,
        conflicts_with_all = ["frames", "turntable", "sub_camera", "unfinished", "show_sub_cameras"]
    )]
    pub save_scene: Option<PathBuf>,
    /// Write times and counts to this file as JSON; `-` is standard output
    #[arg(long, value_name = "FILE", help_heading = None)]
    pub stats: Option<PathBuf>,
}

/// `raycast cast`.
#[derive(Debug, Args)]
#[command(after_help = "\
Both files are little-endian. A ray is eight 32-bit floats: origin x y z, t_min, direction x y z,
t_max. A hit is 20 bytes: t (float, infinity at a miss), object, triangle (unsigned, 4294967295 at
a miss), u, v (float); the point is (1-u-v) a + u b + v c. A hit has t_min < t <= t_max; a t_max
of +infinity is no limit. A ray with any other number that is not finite, or with a direction of
zero, is a miss, and such rays are counted on standard error.

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
    /// The faces that rays pass through: none, or back faces
    #[arg(long, value_name = "FACES", default_value = "none", value_parser = values::named(values::CULLS))]
    pub cull: Cull,
    /// The clipping planes.
    #[command(flatten)]
    pub clip: ClipArgs,
    /// Worker threads, 0 to 256; 0 is one for each hardware thread
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = values::threads())]
    pub threads: u16,
    /// Write times and counts to this file as JSON; `-` is standard output
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
    /// Fragments, as `raycast render --sub-camera` writes them
    #[arg(required = true)]
    pub fragments: Vec<PathBuf>,
    /// The image to write: .png, .ppm, .jpg, .tif or .exr
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// `raycast convert`.
#[derive(Debug, Args)]
#[command(after_help = "\
Meshes are written with their transforms applied. Triangles keep their order and numbers; those
that no ray can hit are written too, and counted. Coordinates keep their bits where the format can
represent them; otherwise the number of moved vertices and the largest move are reported. A .ply
has double precision where single is not enough, a .glb single precision relative to its nodes, an
.stl single precision. Normals, texture coordinates, and colours of vertices and materials are
kept where the format has them (an .obj has its materials in an .mtl beside it); what is lost is
reported.

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
    /// Print a JSON array with an element for each file
    #[arg(long)]
    pub json: bool,
    /// Look for holes, flipped triangles and other faults in each mesh, and print its area and volume
    #[arg(long)]
    pub health: bool,
    /// Also look for triangles of a mesh that intersect, overlap or touch elsewhere than at common edges and corners
    #[arg(long, requires = "health")]
    pub self_intersections: bool,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

#[cfg(test)]
mod tests {
    use super::refusal::one_line;
    use super::*;
    use clap::CommandFactory;
    use raycast_core::glam::DVec3;

    fn parse(line: &str) -> Result<Cli, clap::Error> {
        Cli::try_parse_from(std::iter::once("raycast").chain(line.split_whitespace()))
    }

    fn render(line: &str) -> RenderArgs {
        match parse(line).expect("a good command line").command {
            Some(Subcommand::Render(args)) => *args,
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
            Some(Subcommand::View { files, .. }) => assert_eq!(files, [PathBuf::from("render")]),
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
            let message = one_line(&error.to_string());
            assert!(
                !message.contains('\n') && message.len() > 20,
                "{line}: {message}"
            );
        }
    }
}
