use glam::DVec3;

/// The camera that took an object's texture, in world space and scene units: a perspective camera, possibly with a
/// distorting lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photograph {
    /// Where it stood.
    pub eye: DVec3,
    /// What it looked at.
    pub target: DVec3,
    /// Which way is up in the image; need not be perpendicular to the view axis.
    pub up: DVec3,
    /// The image's vertical field of view in degrees.
    pub fov: f64,
    /// The shift of the frame to the right and up off the view axis, in heights of the image.
    pub shift: [f64; 2],
    /// Brown-Conrady coefficients k1, k2, p1, p2, k3 of the lens's distortion; `None` for a pinhole.
    pub lens: Option<[f64; 5]>,
}
