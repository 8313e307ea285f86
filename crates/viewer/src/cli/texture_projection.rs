use super::values;
use clap::Args;
use raycast_core::camera::{BrownConrady, DEFAULT_FOV, Placement};
use raycast_core::glam::{DVec2, DVec3};
use raycast_core::scene::{Photograph, TextureProjection};

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
    /// Project the texture as the photograph that a camera took, onto what it saw: where that stood, what it
    /// looked at, and which way was up, in world space [default up: 0,1,0]
    #[arg(id = "texture_camera", long = "texture-camera", value_name = "EYE/TARGET[/UP]", allow_hyphen_values = true, value_parser = values::placement)]
    pub camera: Option<Placement>,
    /// The photograph's vertical field of view in degrees [default: 45]
    #[arg(id = "texture_fov", long = "texture-fov", value_name = "DEG", requires = "texture_camera", allow_hyphen_values = true, value_parser = values::planar_fov)]
    pub fov: Option<f64>,
    /// How many of its heights its frame was moved to the right and up off the view axis
    #[arg(id = "texture_shift", long = "texture-shift", value_name = "X,Y", requires = "texture_camera", allow_hyphen_values = true, value_parser = values::shift)]
    pub shift: Option<[f64; 2]>,
    /// The calibrated lens that it was taken through, Brown-Conrady as OpenCV has it
    #[arg(id = "texture_lens", long = "texture-lens", value_name = "K1,K2,P1,P2,K3", requires = "texture_camera", allow_hyphen_values = true, value_parser = values::lens)]
    pub lens: Option<BrownConrady>,
}

impl TextureProjectionArgs {
    /// The projection that was asked for: a photograph's camera asks for one, too.
    pub fn kind(&self) -> Option<TextureProjection> {
        let by_camera = self.camera.map(|_| TextureProjection::Camera);
        self.kind.or(by_camera)
    }

    /// The option that says where a texture stands in space, if one does.
    pub fn placing(&self) -> Option<&'static str> {
        [
            (self.camera.is_some(), "--texture-camera"),
            (self.center.is_some(), "--texture-center"),
            (self.front.is_some(), "--texture-front"),
            (self.up.is_some(), "--texture-up"),
            (self.size.is_some(), "--texture-size"),
        ]
        .into_iter()
        .find_map(|(is_given, name)| is_given.then_some(name))
    }

    /// The camera of the photograph that was asked for.
    pub fn photograph(&self) -> Option<Photograph> {
        let Placement { eye, target, up } = self.camera?;
        Some(Photograph {
            eye,
            target,
            up,
            fov: self.fov.unwrap_or(DEFAULT_FOV),
            shift: self.shift.unwrap_or_default(),
            lens: self.lens.map(|lens| lens.coefficients()),
        })
    }
}
