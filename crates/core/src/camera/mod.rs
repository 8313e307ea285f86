//! From a pixel to its ray: the image plane, the camera, its sub-cameras, and camera motion.

mod brown_conrady;
#[expect(
    clippy::module_inception,
    reason = "the room is named after its main type"
)]
mod camera;
mod cube_face;
mod distortion;
mod equidistant;
mod eyes;
mod grid;
mod lattice;
mod lens_patch;
mod lens_region;
mod orbit;
mod panorama;
mod panorama_rays;
mod path;
mod pixel_filter;
mod plane;
mod pose;
mod projection;
mod rect;
mod sample_pattern;
mod stereo;
mod sub_camera;
mod view;

pub use crate::ray::Ray;
pub use brown_conrady::{BrownConrady, LensError};
pub use camera::Camera;
pub(crate) use distortion::FLATTEST;
pub use grid::Grid;
pub use lattice::Lattice;
pub(crate) use lens_patch::{LensPatch, PlaceScale};
pub(crate) use lens_region::LensRegion;
pub use orbit::Orbit;
pub use panorama::Panorama;
pub(crate) use panorama_rays::{EightDirections, PanoramaRays};
pub use path::{CameraPath, Curve, Ease, Keyframe};
pub use pixel_filter::PixelFilter;
pub use plane::{FrameLock, ImagePlane, PlaneError, PlaneRequest, SIDE_LIMIT, check_step};
pub use pose::{Pose, PoseError};
pub use projection::{DEFAULT_FOV, Projection, fov_to_frame, frame_to_fov};
pub use rect::Rect;
pub use sample_pattern::{Sample, SamplePattern};
pub use stereo::{Stereo, StereoError, StereoKind};
pub use sub_camera::SubCamera;
pub use view::fit_distance;
