//! From a pixel to its ray: the image plane, the camera, its sub-cameras, and camera motion.

mod brown_conrady;
mod cube_face;
mod eyes;
mod grid;
mod lattice;
mod orbit;
mod panorama;
mod panorama_rays;
mod path;
mod pixel_filter;
mod placement;
mod plane;
mod projection;
mod rect;
mod sample_pattern;
mod stereo;
mod sub_camera;
mod view;

pub use crate::ray::Ray;
pub(crate) use brown_conrady::FLATTEST;
pub use brown_conrady::{BrownConrady, LensError};
pub use grid::Grid;
pub use lattice::Lattice;
pub use orbit::Orbit;
pub use panorama::Panorama;
pub(crate) use panorama_rays::{PanoramaRays, Vectors};
pub use path::{CameraPath, Curve, Ease, Keyframe};
pub use pixel_filter::PixelFilter;
pub use placement::{Placement, PlacementError};
pub use plane::{FrameLock, ImagePlane, PlaneError, PlaneRequest, SIDE_LIMIT, check_step};
pub use projection::{Camera, DEFAULT_FOV, Projection, fov_to_frame, frame_to_fov};
pub use rect::Rect;
pub use sample_pattern::{Sample, SamplePattern};
pub use stereo::{Stereo, StereoError, StereoKind};
pub use sub_camera::SubCamera;
pub use view::fit_distance;
