use super::{ReadingArgs, ShadingArgs, TextureProjectionArgs, shading_values};
use clap::Args;
use raycast_core::scene::{Crop, Wrap};
use std::path::PathBuf;

/// `raycast texture-map`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  raycast texture-map --texture leopard.png --crop 64,64,256,256 -o crop.png
  raycast texture-map cube.obj --texture leopard.png -o all.png
  raycast texture-map cube.obj --texture leopard.png --texture-projection per-triangle --triangle 3 -o one.png")]
pub struct TextureMapArgs {
    /// Meshes or scene files whose triangles are drawn [default: none]
    pub files: Vec<PathBuf>,
    /// The image to write: .png, .ppm, .tif or .jpg
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// The texture's image
    #[arg(long, value_name = "IMAGE")]
    pub texture: PathBuf,
    /// The part of the image to use, in its pixels from the top left; it is outlined
    #[arg(long, value_name = "X,Y,W,H", value_parser = shading_values::crop)]
    pub crop: Option<Crop>,
    /// Draw this triangle of the object alone, filled [default: all]
    #[arg(long, value_name = "N", requires = "files")]
    pub triangle: Option<u32>,
    /// The object whose triangles are drawn, from 0 [default: all; 0 with --triangle]
    #[arg(long, value_name = "N", requires = "files")]
    pub object: Option<u32>,
    /// Width of lines in pixels
    #[arg(long, value_name = "WIDTH", default_value = "1.5", value_parser = shading_values::line_width)]
    pub line_width: f32,
    /// As `raycast render --wrap`
    #[arg(long, value_name = "KIND[,KIND]", value_parser = shading_values::wrap)]
    pub wrap: Option<[Wrap; 2]>,
    /// How texture coordinates are assigned.
    #[command(flatten)]
    pub projection: TextureProjectionArgs,
    /// How files are read.
    #[command(flatten)]
    pub reading: ReadingArgs,
}

impl TextureMapArgs {
    /// The same options as those of `raycast render`.
    pub fn shading(&self) -> ShadingArgs {
        ShadingArgs {
            texture: Some(self.texture.clone()),
            crop: self.crop,
            wrap: self.wrap,
            projection: self.projection.clone(),
            ..ShadingArgs::default()
        }
    }
}
