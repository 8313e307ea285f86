use super::{OrbitArg, StereoArg, camera_values, values};
use clap::Args;
use raycast_core::camera::{BrownConrady, Projection};
use raycast_core::glam::DVec3;

/// The camera: its pose, projection and image plane.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Camera")]
pub struct CameraArgs {
    /// Columns and rows of rays [default: 1280x720]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub size: Option<(u32, u32)>,
    /// Distance between neighbouring rays at the target, in scene units
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = camera_values::step)]
    pub step: Option<f64>,
    /// Vertical field of view in degrees [default: 45; panoramas: 180, cylindrical and cubemap 90, cubemap:cross 270]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = camera_values::fov)]
    pub fov: Option<f64>,
    /// How rays leave the camera [default: perspective]
    #[arg(long, value_name = "KIND", value_parser = values::named(camera_values::PROJECTIONS))]
    pub projection: Option<Projection>,
    /// Shift the frame off the view axis, to the right and up, in heights of the frame
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = camera_values::shift)]
    pub shift: Option<[f64; 2]>,
    /// Lens distortion of a perspective picture: OpenCV's Brown-Conrady coefficients
    #[arg(long, value_name = "K1,K2,P1,P2,K3", allow_hyphen_values = true, value_parser = camera_values::lens)]
    pub lens: Option<BrownConrady>,
    /// A picture for two eyes: `pair`, side by side with the left eye's on the left, or `ods`, omni-directional
    /// panoramas with the left eye's on top
    #[arg(long, value_name = "KIND", value_parser = values::named(camera_values::STEREO))]
    pub stereo: Option<StereoArg>,
    /// Distance between the two eyes, in scene units; the camera is in the middle
    #[arg(long, value_name = "D", allow_hyphen_values = true, value_parser = camera_values::eye_distance)]
    pub eye_distance: Option<f64>,
    /// Distance from the camera at which a pair's views coincide, or inf [default: the target's]
    #[arg(long, value_name = "D", allow_hyphen_values = true, value_parser = camera_values::convergence)]
    pub convergence: Option<f64>,
    /// The camera's position
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub eye: Option<DVec3>,
    /// The point that it looks at [default: the scene's centre]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub target: Option<DVec3>,
    /// The direction that is up in the picture [default: 0,1,0]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub up: Option<DVec3>,
    /// The camera's position by angles in degrees, around the scene's centre and above its horizon, and a distance in
    /// scene units [default: 22,16, with the whole scene in view]
    #[arg(
        long,
        value_name = "YAW,PITCH[,DISTANCE]",
        allow_hyphen_values = true,
        conflicts_with = "eye",
        value_parser = camera_values::orbit
    )]
    pub orbit: Option<OrbitArg>,
}
