//! Shading: from hits to colours.
//!
//! [`Shader`] has what a picture's pixels share, and defines the colour of one sample ([`Shader::color`]). Its
//! submodule `triangles` prepares shading triangles (`facet`), which have what a triangle's pixels share; `needs` says
//! what of that a mode needs. [`TileShader`] caches these. Where less is needed, `triangle_cache` looks ahead for eight
//! triangles at once: for their colours under flat light (`flat_colors`), or for normals and colours (`plain_facets`).
//! `texture` reads surfaces' images, and `lines` draws edges. `scanlines` shades rows whose colours follow from linear
//! functions (`short_spans` where triangles are as small as samples), `eight` shades eight samples of a row at once in
//! lanes, `eight_texture` reads their textures and `eight_channels` fills the other channels of a picture, all with the
//! bits of single samples.

mod depth_colors;
mod edge_choice;
mod edge_kinds;
mod edges;
mod eight;
mod eight_channels;
mod eight_colors;
mod eight_interpolation;
mod eight_lines;
mod eight_texture;
mod facet;
mod flat_colors;
mod ground;
mod hit_rows;
#[cfg(test)]
mod interpolant_tests;
mod interpolants;
mod legend;
mod light;
mod line_overlay;
#[cfg(test)]
mod line_tests;
mod lines;
mod mode;
mod numbers;
mod opacities;
mod own_color;
#[cfg(test)]
mod own_color_tests;
mod plain_facets;
mod ramp;
mod reflection;
mod row_textures;
mod sample;
#[cfg(test)]
mod scanline_tests;
mod scanlines;
mod section;
mod shader;
mod short_spans;
mod sides;
mod slopes;
mod smooth;
#[cfg(test)]
mod smooth_tests;
mod spans;
pub(crate) mod srgb;
#[cfg(test)]
mod tests;
mod texels;
mod texture;
mod tile;
mod tile_rays;
mod translucent;
mod triangle_cache;
mod vectors;
#[cfg(test)]
mod vertex_color_tests;

pub use edge_kinds::{EdgeKinds, EdgeKindsError};
pub(crate) use eight_channels::Channels;
pub(crate) use legend::DrawnLegend;
pub use legend::Legend;
pub use mode::{
    Background, Filter, Ground, GroundError, LightSet, Mode, Shading, Shows, Wireframe,
};
pub use own_color::own_color;
pub(crate) use section::{Cut, Section, Shown};
pub use shader::Shader;
pub(crate) use srgb::{
    encode, encode_all_premultiplied, encode_premultiplied, over_black, premultiply,
};
pub use texture::map::TextureMap;
pub use texture::mapping::{texture_corners, texture_point};
pub use texture::photograph::PhotographError;
pub use tile::TileShader;
pub(crate) use translucent::{SEEN, Translucent};
