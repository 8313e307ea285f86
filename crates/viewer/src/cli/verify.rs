use super::{CameraArgs, CastingArgs, ReadingArgs, ShadingArgs, values};
use clap::Args;
use raycast_core::camera::PixelFilter;
use std::path::PathBuf;

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
        value_parser = values::samples
    )]
    pub samples: Option<u32>,
    /// How samples are weighed by their place; wider than a pixel but for a box [default: the recipe's, else box]
    #[arg(
        long,
        value_name = "KIND",
        help_heading = "Casting",
        value_parser = values::named(values::PIXEL_FILTERS)
    )]
    pub pixel_filter: Option<PixelFilter>,
    /// How rays meet triangles.
    #[command(flatten)]
    pub casting: CastingArgs,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}
