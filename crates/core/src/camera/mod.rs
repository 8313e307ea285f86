//! From a pixel to its ray: the image plane, the camera, its sub-cameras, and ways to move it.

mod lattice;
mod orbit;
mod placement;
mod plane;
mod projection;
mod sub_camera;
mod view;

pub use crate::ray::Ray;
pub use lattice::Lattice;
pub use orbit::Orbit;
pub use placement::{Placement, PlacementError};
pub use plane::{
    FrameLock, ImagePlane, PIXEL_LIMIT, PlaneError, PlaneRequest, SIDE_LIMIT, check_step,
};
pub use projection::{Camera, Projection, fov_to_frame, frame_to_fov};
pub use sub_camera::{Grid, Rect, SubCamera};
pub use view::fit_distance;
