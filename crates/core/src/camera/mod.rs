//! From a pixel to its ray: the image plane, the camera, its sub-cameras, and ways to move it.

mod grid;
mod lattice;
mod orbit;
mod panorama;
mod panorama_rays;
mod path;
mod placement;
mod plane;
mod projection;
mod rect;
mod sub_camera;
mod view;

pub use crate::ray::Ray;
pub use grid::Grid;
pub use lattice::Lattice;
pub use orbit::Orbit;
pub use panorama::Panorama;
pub(crate) use panorama_rays::{PanoramaRays, Vectors};
pub use path::{CameraPath, Curve, Ease, Keyframe};
pub use placement::{Placement, PlacementError};
pub use plane::{FrameLock, ImagePlane, PlaneError, PlaneRequest, SIDE_LIMIT, check_step};
pub use projection::{Camera, DEFAULT_FOV, Projection, fov_to_frame, frame_to_fov};
pub use rect::Rect;
pub use sub_camera::SubCamera;
pub use view::fit_distance;
