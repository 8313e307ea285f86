use super::{ImagePlane, Placement, Ray};
use crate::math;
use glam::DVec3;

/// How rays leave the camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projection {
    /// All from the eye, through the image plane.
    #[default]
    Perspective,
    /// Side by side along the view axis, from the plane through the eye.
    Orthographic,
}

/// An eye, an orientation and an image plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    placement: Placement,
    projection: Projection,
    plane: ImagePlane,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    distance: f64,
}

impl Camera {
    /// A camera at `placement`.
    ///
    /// An eye in its target looks along −Z from one unit away; an `up` along the view axis, or
    /// zero, gives way to −Z or +Y. [`Placement::check`] says whether either is the case.
    pub fn new(placement: Placement, projection: Projection, plane: ImagePlane) -> Self {
        let sight = placement.target - placement.eye;
        let length = sight.length();
        let (forward, distance) = if length.is_finite() && length > 0.0 {
            (sight / length, length)
        } else {
            (DVec3::NEG_Z, 1.0)
        };
        let sideways = |up: DVec3| forward.cross(up.normalize_or_zero());
        let right = [placement.up, DVec3::NEG_Z, DVec3::Y]
            .into_iter()
            .map(sideways)
            .find(|right| right.length() > Placement::LEAST_SINE)
            .unwrap_or(DVec3::X)
            .normalize();
        Self {
            placement,
            projection,
            plane,
            right,
            up: right.cross(forward),
            forward,
            distance,
        }
    }

    /// The ray through the point (x, y) of the picture, in pixels from its top left corner.
    ///
    /// This is the one definition of a pixel's ray: the pixel in column c and row r has its centre
    /// at (c + ½, r + ½). The direction is of unit length, so `t` is the distance from the eye, or
    /// from the image plane of an orthographic camera.
    #[inline(always)]
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let on_plane = self.on_plane(x, y);
        match self.projection {
            Projection::Perspective => {
                let direction = on_plane + self.forward * self.distance;
                Ray::new(self.placement.eye, direction / direction.length())
            }
            Projection::Orthographic => Ray::new(self.placement.eye + on_plane, self.forward),
        }
    }

    /// How far (x, y) of the picture is to the right of and above the view axis, in scene units at
    /// the target.
    #[inline(always)]
    pub(crate) fn across_and_along(&self, x: f64, y: f64) -> (f64, f64) {
        let across = (x - f64::from(self.plane.columns) * 0.5) * self.plane.step;
        let along = (f64::from(self.plane.rows) * 0.5 - y) * self.plane.step;
        (across, along)
    }

    /// From the view axis to (x, y) of the picture, on the plane through the target.
    #[inline(always)]
    pub(crate) fn on_plane(&self, x: f64, y: f64) -> DVec3 {
        let (across, along) = self.across_and_along(x, y);
        self.right * across + self.up * along
    }

    /// The direction through (x, y) before it is made unit length: linear in x and y.
    ///
    /// Perspective: from the eye to the point on the plane through the target.
    /// Orthographic: the view axis.
    pub fn direction(&self, x: f64, y: f64) -> DVec3 {
        match self.projection {
            Projection::Perspective => self.on_plane(x, y) + self.forward * self.distance,
            Projection::Orthographic => self.forward,
        }
    }

    /// Where a world point falls in the picture, in pixels; `None` at or behind the eye's plane.
    pub fn project(&self, point_in_world: DVec3) -> Option<(f64, f64)> {
        let relative = point_in_world - self.placement.eye;
        let depth = relative.dot(self.forward);
        let scale = match self.projection {
            Projection::Perspective if depth > 0.0 => self.distance / depth,
            Projection::Orthographic => 1.0,
            Projection::Perspective => return None,
        } / self.plane.step;
        let x = f64::from(self.plane.columns) * 0.5 + relative.dot(self.right) * scale;
        let y = f64::from(self.plane.rows) * 0.5 - relative.dot(self.up) * scale;
        (x.is_finite() && y.is_finite()).then_some((x, y))
    }

    /// Where the camera was put.
    #[inline]
    pub fn placement(&self) -> Placement {
        self.placement
    }

    /// How its rays leave it.
    #[inline]
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// Its lattice of rays.
    pub fn plane(&self) -> ImagePlane {
        self.plane
    }

    /// The unit vector to the right in the picture.
    #[inline]
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// The unit vector up in the picture.
    #[inline]
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// The unit vector along the view axis.
    #[inline]
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// From eye to target, in scene units.
    #[inline]
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// The vertical field of view in degrees; `None` for an orthographic camera.
    pub fn fov_degrees(&self) -> Option<f64> {
        (self.projection == Projection::Perspective)
            .then(|| frame_to_fov(self.plane.frame_height(), self.distance))
    }

    /// The same camera with another image plane.
    pub fn with_plane(&self, plane: ImagePlane) -> Self {
        Self { plane, ..*self }
    }
}

/// The height at distance `d` of a frame with this vertical field of view in degrees.
pub fn fov_to_frame(fov_degrees: f64, distance: f64) -> f64 {
    2.0 * distance * math::tan(fov_degrees.to_radians() * 0.5)
}

/// The vertical field of view in degrees of a frame this high at this distance.
pub fn frame_to_fov(frame_height: f64, distance: f64) -> f64 {
    2.0 * math::atan(frame_height * 0.5 / distance).to_degrees()
}
