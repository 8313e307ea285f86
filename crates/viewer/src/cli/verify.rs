use super::{CameraArgs, CastingArgs, ReadingArgs, ShadingArgs, values};
use clap::Args;
use raycast_core::camera::PixelFilter;
use std::path::PathBuf;

/// `raycast verify`.
#[derive(Debug, Args)]
#[command(after_help = "\
A third of the checks are pixels at the outlines of objects, a third pixels at edges between
triangles, the rest any pixels. For each, rational arithmetic, which rounds nothing, finds the
closest hit of the pixel's ray. The picture must have that triangle and distance (to 4 units in
the last place, where the ray does not graze the triangle). Normal, texture coordinates and colour
are computed from that hit independently, and must agree within rounding; with several samples
each is cast again. A PNG has colours alone. Colours under lines are not checked. The number of
pixels checked is printed for each channel. The exit status is 1 if any pixel is wrong.

A picture holds its recipe: camera, samples and shading need not be given, and files that make
another scene are refused. Give --texture, --crop and --color as they were given to `raycast
render`. For a picture without a recipe give all options as they were given there; the size is the
image's.

Examples:
  raycast verify bunny.obj
  raycast render bunny.obj -o bunny.exr --orbit 40,10
  raycast verify bunny.exr bunny.obj --checks 100000
  raycast verify bunny.exr bunny.obj --all")]
pub struct VerifyArgs {
    /// The image to check, an .exr, .png or .tif that `raycast render` wrote, and the meshes or scene files that it shows;
    /// without an image the files are rendered, and that is checked
    #[arg(required = true, value_name = "[IMAGE] FILES")]
    pub files: Vec<PathBuf>,
    /// The number of pixels to check; all if there are fewer
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(1..))]
    pub checks: u32,
    /// Check every pixel
    #[arg(long, conflicts_with = "checks")]
    pub all: bool,
    /// The seed of the random choice of pixels
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// The camera.
    #[command(flatten)]
    pub camera: CameraArgs,
    /// The shading.
    #[command(flatten)]
    pub shading: ShadingArgs,
    /// Rays per pixel, 1 to 4096 [default: the recipe's, else 1]
    #[arg(
        long,
        value_name = "N",
        help_heading = "Casting",
        value_parser = values::samples
    )]
    pub samples: Option<u32>,
    /// The pixel's reconstruction filter; all but box are wider than a pixel [default: the recipe's, else box]
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
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}
