use super::{camera_values, shading_values, values};
use clap::Args;
use raycast_core::camera::{BrownConrady, DEFAULT_FOV, Pose};
use raycast_core::glam::{DVec2, DVec3};
use raycast_core::scene::{Photograph, TextureProjection};

/// How texture coordinates are assigned to surfaces.
#[derive(Clone, Debug, Default, Args)]
pub struct TextureProjectionArgs {
    /// How texture coordinates are assigned to surfaces [default: the scene file's, uv]
    #[arg(long = "texture-projection", value_name = "KIND", value_parser = values::named(shading_values::TEXTURE_PROJECTIONS))]
    pub kind: Option<TextureProjection>,
    /// The centre of a texture's plane, sphere or cylinder, in each object's own space [default: the middle of its box]
    #[arg(long = "texture-center", value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub center: Option<DVec3>,
    /// The direction from the centre to the viewer: a plane's normal, longitude 0 of a sphere or cylinder [default:
    /// 0,0,1]
    #[arg(long = "texture-front", value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub front: Option<DVec3>,
    /// The direction that is up in the image: the axis of a sphere or cylinder [default: 0,1,0]
    #[arg(id = "texture_up", long = "texture-up", value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub up: Option<DVec3>,
    /// Width and height of a plane; the height of a cylinder [default: the box's]
    #[arg(id = "texture_size", long = "texture-size", value_name = "W,H", allow_hyphen_values = true, value_parser = shading_values::extent)]
    pub size: Option<DVec2>,
    /// Project the texture as a photograph onto what its camera saw: that camera's position, target and up direction,
    /// in world space [default up: 0,1,0]
    #[arg(id = "texture_camera", long = "texture-camera", value_name = "EYE/TARGET[/UP]", allow_hyphen_values = true, value_parser = camera_values::pose)]
    pub camera: Option<Pose>,
    /// The photograph's vertical field of view in degrees [default: 45]
    #[arg(id = "texture_fov", long = "texture-fov", value_name = "DEG", requires = "texture_camera", allow_hyphen_values = true, value_parser = camera_values::planar_fov)]
    pub fov: Option<f64>,
    /// The shift of the photograph's frame off its view axis, to the right and up, in heights of the frame
    #[arg(id = "texture_shift", long = "texture-shift", value_name = "X,Y", requires = "texture_camera", allow_hyphen_values = true, value_parser = camera_values::shift)]
    pub shift: Option<[f64; 2]>,
    /// The photograph's lens distortion: OpenCV's Brown-Conrady coefficients
    #[arg(id = "texture_lens", long = "texture-lens", value_name = "K1,K2,P1,P2,K3", requires = "texture_camera", allow_hyphen_values = true, value_parser = camera_values::lens)]
    pub lens: Option<BrownConrady>,
}

impl TextureProjectionArgs {
    /// The requested projection; a photograph's camera implies [`TextureProjection::Camera`].
    pub fn kind(&self) -> Option<TextureProjection> {
        let by_camera = self.camera.map(|_| TextureProjection::Camera);
        self.kind.or(by_camera)
    }

    /// The first given option that places a texture in space.
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

    /// The requested photograph's camera.
    pub fn photograph(&self) -> Option<Photograph> {
        let Pose { eye, target, up } = self.camera?;
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
