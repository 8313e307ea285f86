use glam::DVec3;

/// The camera that an object's texture was taken with, in world space and in the scene's units: a perspective one.
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
    /// How far the frame was moved to the right and up off the view axis, in heights of the image.
    pub shift: [f64; 2],
    /// The lens's distortion, k1, k2, p1, p2, k3 of Brown and Conrady; `None` for a pinhole.
    pub lens: Option<[f64; 5]>,
}
