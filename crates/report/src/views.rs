//! Where scenes are looked at from: the same views for every measurement.

use raycast_core::camera::{Camera, Orbit, PlaneError, PlaneRequest, Projection, fov_to_frame};
use raycast_core::math;
use raycast_core::scene::Scene;

/// The vertical field of view in degrees.
pub const FOV: f64 = 45.0;

/// A view from the usual angles with the scene's bounding sphere as high as the frame; `nearer` times
/// as near as that.
///
/// # Errors
/// A size that no picture can have.
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
        // A scene that is a point, or nothing, has no size to fill the frame with.
        distance: if distance > 0.0 { distance } else { 1.0 },
    };
    let plane = PlaneRequest {
        size: Some(size),
        ..PlaneRequest::default()
    }
    .resolve(size, fov_to_frame(fov, orbit.distance))?;
    Ok(Camera::new(
        orbit.placement(),
        Projection::Perspective,
        plane,
    ))
}
