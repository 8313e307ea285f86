use super::values;
use clap::Args;
use raycast_core::glam::{DVec2, DVec3};
use raycast_core::scene::TextureProjection;

/// How surfaces find their place in a texture.
#[derive(Clone, Debug, Default, Args)]
pub struct TextureProjectionArgs {
    /// How surfaces find their place in the texture [default: the scene file's, uv]
    #[arg(long = "texture-projection", value_name = "KIND", value_parser = values::named(values::TEXTURE_PROJECTIONS))]
    pub kind: Option<TextureProjection>,
    /// Where the texture of a plane, sphere or cylinder stands, in each object's own space [default: the
    /// middle of its box]
    #[arg(long = "texture-center", value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub center: Option<DVec3>,
    /// From there to who looks at it: a plane's normal, longitude 0 [default: 0,0,1]
    #[arg(long = "texture-front", value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub front: Option<DVec3>,
    /// Up in it: the axis of a sphere or cylinder [default: 0,1,0]
    #[arg(id = "texture_up", long = "texture-up", value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub up: Option<DVec3>,
    /// Width and height of a plane; the height of a cylinder [default: the box's]
    #[arg(id = "texture_size", long = "texture-size", value_name = "W,H", allow_hyphen_values = true, value_parser = values::extent)]
    pub size: Option<DVec2>,
}
