use super::{Camera, DEFAULT_FOV, ImagePlane, Orbit, PlaneError, Projection, fov_to_frame};
use crate::math;
use crate::scene::Bounds;

/// The frame's size relative to a scene that fits the picture: 6 % leave a visible border without making the scene
/// small.
const MARGIN: f64 = 1.06;

/// The distance from the pivot at which an orbiting camera has all of `bounds` in view, and the frame's height there.
///
/// `fov_degrees` is the vertical field of view (an orthographic frame follows from the distance by the same formula,
/// so that switching the projection keeps the picture), `aspect` is columns by rows. In a panorama the scene fills at
/// most [`Projection::fitting_fov`]. An empty scene, or a point, is seen from one unit away.
pub fn fit_distance(
    bounds: &Bounds,
    orbit: &Orbit,
    projection: Projection,
    fov_degrees: f64,
    aspect: f64,
) -> f64 {
    let fov_degrees = projection.fitting_fov(fov_degrees);
    let slope = math::tan(fov_degrees.to_radians() * 0.5) / MARGIN;
    let (right, up, back) = (orbit.right(), orbit.up(), orbit.back());
    let needed = |corner: glam::DVec3| {
        let relative = corner - orbit.pivot;
        let reach = (relative.dot(up).abs()).max(relative.dot(right).abs() / aspect) / slope;
        match projection {
            Projection::Perspective | Projection::Panoramic(_) => reach + relative.dot(back),
            // The whole scene must be in front of the image plane, which goes through the eye.
            Projection::Orthographic => reach.max(relative.dot(back) * MARGIN),
        }
    };
    let distance = if bounds.is_empty() {
        1.0
    } else {
        bounds.corners().into_iter().map(needed).fold(0.0, f64::max)
    };
    if distance.is_finite() && distance > 0.0 {
        distance
    } else {
        1.0
    }
}

impl Camera {
    /// A perspective camera with the vertical field of view [`DEFAULT_FOV`] that has all of `bounds` in view, at
    /// `yaw` and `pitch` degrees around their centre (see [`Orbit`]), over `columns × rows` pixels.
    ///
    /// # Errors
    /// A size out of range.
    pub fn fitting(
        bounds: &Bounds,
        (yaw, pitch): (f64, f64),
        (columns, rows): (u32, u32),
    ) -> Result<Self, PlaneError> {
        let mut orbit = Orbit {
            pivot: bounds.center(),
            yaw,
            pitch,
            distance: 1.0,
        };
        let aspect = f64::from(columns) / f64::from(rows.max(1));
        orbit.distance = fit_distance(bounds, &orbit, Projection::Perspective, DEFAULT_FOV, aspect);
        let step = fov_to_frame(DEFAULT_FOV, orbit.distance) / f64::from(rows.max(1));
        let plane = ImagePlane::new(columns, rows, step)?;
        Ok(Self::new(orbit.pose(), Projection::Perspective, plane))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn everything_is_in_view() {
        let bounds = Bounds {
            min: DVec3::new(-3.0, 0.0, 1.0),
            max: DVec3::new(2.0, 0.5, 40.0),
        };
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let mut orbit = Orbit {
                pivot: bounds.center(),
                yaw: 22.0,
                pitch: 16.0,
                distance: 1.0,
            };
            orbit.distance = fit_distance(&bounds, &orbit, projection, DEFAULT_FOV, 2.0);
            let step = fov_to_frame(DEFAULT_FOV, orbit.distance) / 100.0;
            let plane = ImagePlane::new(200, 100, step).expect("a good plane");
            let camera = Camera::new(orbit.pose(), projection, plane);
            for corner in bounds.corners() {
                let (x, y) = camera.project(corner).expect("in front");
                assert!(
                    (0.0..200.0).contains(&x) && (0.0..100.0).contains(&y),
                    "{x} {y}"
                );
            }
        }
    }
}
