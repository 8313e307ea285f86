use super::{OrbitArg, StereoArg, values};
use clap::Args;
use raycast_core::camera::{BrownConrady, Projection};
use raycast_core::glam::DVec3;

/// Where the camera stands and what its rays are.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Camera")]
pub struct CameraArgs {
    /// Columns and rows of rays [default: 1280x720]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub size: Option<(u32, u32)>,
    /// Distance between neighbouring rays at the target, in scene units
    #[arg(long, value_name = "S", allow_hyphen_values = true, value_parser = values::step)]
    pub step: Option<f64>,
    /// Vertical field of view in degrees [default: 45, of a panorama all of it or half a turn]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = values::fov)]
    pub fov: Option<f64>,
    /// How rays leave the camera [default: perspective]
    #[arg(long, value_name = "KIND", value_parser = values::named(values::PROJECTIONS))]
    pub projection: Option<Projection>,
    /// Off-centre frame: so many heights of the frame to the right and up of the view axis
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, value_parser = values::shift)]
    pub shift: Option<[f64; 2]>,
    /// See a perspective picture through a calibrated lens, Brown-Conrady as OpenCV has it
    #[arg(long, value_name = "K1,K2,P1,P2,K3", allow_hyphen_values = true, value_parser = values::lens)]
    pub lens: Option<BrownConrady>,
    /// A picture for two eyes: side by side, or panoramas above one another, the left eye's first
    #[arg(long, value_name = "KIND", value_parser = values::named(values::STEREO))]
    pub stereo: Option<StereoArg>,
    /// From eye to eye, in scene units; the camera is in the middle
    #[arg(long, value_name = "D", allow_hyphen_values = true, value_parser = values::eye_distance)]
    pub eye_distance: Option<f64>,
    /// Where a pair's views coincide: a distance from the camera, or inf [default: the target's]
    #[arg(long, value_name = "D", allow_hyphen_values = true, value_parser = values::convergence)]
    pub convergence: Option<f64>,
    /// Where the camera stands
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub eye: Option<DVec3>,
    /// What it looks at [default: the scene's centre]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub target: Option<DVec3>,
    /// Which way is up [default: 0,1,0]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = values::point)]
    pub up: Option<DVec3>,
    /// Degrees about the scene's centre and above its horizon; distance in scene units [default:
    /// 22,16, as far as the whole scene needs]
    #[arg(
        long,
        value_name = "YAW,PITCH[,DISTANCE]",
        allow_hyphen_values = true,
        conflicts_with = "eye",
        value_parser = values::orbit
    )]
    pub orbit: Option<OrbitArg>,
}
