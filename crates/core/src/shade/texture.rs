//! How surfaces find their texels: places in the image (`mapping`, and what it is made of), what a pixel sees of it
//! (`footprint`), and what that looks like (`mipmap`, `texturing`). `map` draws the image with its mesh in it.

pub(in crate::shade) mod footprint;
pub(in crate::shade) mod map;
pub(in crate::shade) mod mapping;
pub(in crate::shade) mod mipmap;
pub(in crate::shade) mod per_triangle;
pub(in crate::shade) mod photograph;
pub(in crate::shade) mod placed_image;
pub(in crate::shade) mod texturing;
pub(in crate::shade) mod triplanar;
