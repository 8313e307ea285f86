//! From hits to colours.

mod edges;
mod facet;
mod light;
mod mode;
mod sample;
mod shader;
mod smooth;
#[cfg(test)]
mod smooth_tests;
pub(crate) mod srgb;
#[cfg(test)]
mod tests;
mod tile;
mod triplanar;

pub use mode::{Background, Filter, Mode, Shading, TextureProjection, Wireframe};
pub use shader::Shader;
pub(crate) use srgb::{encode_premultiplied, over_black};
pub use tile::TileShader;
