//! Cameras and their rays, made in code.

use raycast_core::camera::{Camera, ImagePlane, Lattice, Pose, Projection};
use raycast_core::glam::DVec3;

/// Both planar projections.
pub const PROJECTIONS: [Projection; 2] = [Projection::Perspective, Projection::Orthographic];

/// A camera at `eye` that looks at `target`, its frame `height` high there, with +Y up.
///
/// The size must be 1 to 65536 a side, and `height` positive: anything else is a programming error.
pub fn camera(
    eye: DVec3,
    target: DVec3,
    projection: Projection,
    (columns, rows): (u32, u32),
    height: f64,
) -> Camera {
    let plane = ImagePlane::new(columns, rows, height / f64::from(rows)).expect("a good plane");
    let pose = Pose {
        eye,
        target,
        up: DVec3::Y,
    };
    Camera::new(pose, projection, plane)
}

/// The rays through the centres of all of a camera's pixels.
pub fn whole(camera: Camera) -> Lattice {
    camera.whole().lattice()
}
