//! Standard views of scenes, the same for every measurement.

use raycast_core::camera::{Camera, Orbit, PlaneError, PlaneRequest, Projection, fov_to_frame};
use raycast_core::math;
use raycast_core::scene::Scene;

/// The vertical field of view in degrees.
pub const FOV: f64 = 45.0;

/// A view from the default angles with the scene's bounding sphere as high as the frame, or `nearer` times as close.
///
/// # Errors
/// A size out of range.
pub fn filling(
    scene: &Scene,
    size: (u32, u32),
    fov: f64,
    nearer: f64,
) -> Result<Camera, PlaneError> {
    let (center, radius) = scene.bounding_sphere();
    let (yaw, pitch) = Orbit::DEFAULT_ANGLES;
    let distance = radius / math::sin(fov.to_radians() * 0.5) / nearer;
    let orbit = Orbit {
        pivot: center,
        yaw,
        pitch,
        // A scene that is a point, or empty, has no size to fill the frame.
        distance: if distance > 0.0 { distance } else { 1.0 },
    };
    let plane = PlaneRequest {
        size: Some(size),
        ..PlaneRequest::default()
    }
    .resolve(size, fov_to_frame(fov, orbit.distance))?;
    Ok(Camera::new(orbit.pose(), Projection::Perspective, plane))
}
