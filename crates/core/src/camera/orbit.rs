use super::Pose;
use crate::math;
use glam::DVec3;

/// A camera on an orbit: around a pivot, at a distance, by two angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// The point in the middle of the picture.
    pub pivot: DVec3,
    /// Degrees about +Y; zero looks along −Z, 90 has the eye on +X.
    pub yaw: f64,
    /// Degrees above the horizon, −90 to 90.
    pub pitch: f64,
    /// The distance from pivot to eye, in scene units.
    pub distance: f64,
}

impl Orbit {
    /// The yaw and pitch from which a scene is first shown.
    pub const DEFAULT_ANGLES: (f64, f64) = (22.0, 16.0);

    /// The orbit of a pose: its angles follow from eye and target; `up` is ignored.
    pub fn from_placement(pose: &Pose) -> Self {
        let back = pose.eye - pose.target;
        let distance = back.length();
        if !(distance.is_finite() && distance > 0.0) {
            return Self {
                pivot: pose.target,
                yaw: 0.0,
                pitch: 0.0,
                distance: 1.0,
            };
        }
        Self {
            pivot: pose.target,
            yaw: math::atan2(back.x, back.z).to_degrees(),
            pitch: math::asin((back.y / distance).clamp(-1.0, 1.0)).to_degrees(),
            distance,
        }
    }

    /// The unit vector from the pivot to the eye.
    pub fn back(&self) -> DVec3 {
        let (yaw_sin, yaw_cos) = math::sin_cos(self.yaw.to_radians());
        let (pitch_sin, pitch_cos) = math::sin_cos(self.pitch.to_radians());
        DVec3::new(yaw_sin * pitch_cos, pitch_sin, yaw_cos * pitch_cos)
    }

    /// The unit vector up in the picture; also defined at the poles, where +Y lies along the view axis.
    pub fn up(&self) -> DVec3 {
        let (yaw_sin, yaw_cos) = math::sin_cos(self.yaw.to_radians());
        let (pitch_sin, pitch_cos) = math::sin_cos(self.pitch.to_radians());
        DVec3::new(-yaw_sin * pitch_sin, pitch_cos, -yaw_cos * pitch_sin)
    }

    /// The unit vector to the right in the picture.
    pub fn right(&self) -> DVec3 {
        self.up().cross(self.back())
    }

    /// The pose of the camera.
    pub fn pose(&self) -> Pose {
        Pose {
            eye: self.pivot + self.back() * self.distance,
            target: self.pivot,
            up: self.up(),
        }
    }

    /// Turns by angles in degrees; the pitch is clamped at the poles.
    pub fn turn(&mut self, yaw: f64, pitch: f64) {
        self.yaw = (self.yaw + yaw).rem_euclid(360.0);
        self.pitch = (self.pitch + pitch).clamp(-90.0, 90.0);
    }

    /// Moves the pivot, and the eye with it, to the right and up in the picture, in scene units.
    pub fn pan(&mut self, right: f64, up: f64) {
        self.pivot += self.right() * right + self.up() * up;
    }

    /// Moves the eye nearer (a factor below one) or away, such that `anchor` keeps its place in a perspective
    /// picture.
    pub fn dolly(&mut self, factor: f64, anchor: DVec3) {
        let distance = self.distance * factor;
        if distance.is_normal() && distance < 1e30 {
            self.distance = distance;
            self.pivot = anchor + (self.pivot - anchor) * factor;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, ImagePlane, Projection};

    #[test]
    fn placement_and_back_again() {
        let orbit = Orbit {
            pivot: DVec3::new(1.0, 2.0, 3.0),
            yaw: 130.0,
            pitch: -35.0,
            distance: 7.0,
        };
        let again = Orbit::from_placement(&orbit.pose());
        assert!((again.yaw - orbit.yaw).abs() < 1e-9 && (again.pitch - orbit.pitch).abs() < 1e-9);
        assert!((again.distance - 7.0).abs() < 1e-12);
    }

    #[test]
    fn dolly_keeps_the_anchor_in_place() {
        let mut orbit = Orbit {
            pivot: DVec3::ZERO,
            yaw: 30.0,
            pitch: 20.0,
            distance: 5.0,
        };
        let plane = ImagePlane::new(640, 480, 0.01).expect("a good plane");
        let anchor = DVec3::new(0.3, -0.4, 0.9);
        let before = Camera::new(orbit.pose(), Projection::Perspective, plane).project(anchor);
        orbit.dolly(0.5, anchor);
        let nearer = plane.step * 0.5;
        let plane = ImagePlane {
            step: nearer,
            ..plane
        };
        let after = Camera::new(orbit.pose(), Projection::Perspective, plane).project(anchor);
        let (before, after) = (before.expect("in front"), after.expect("in front"));
        assert!((before.0 - after.0).abs() < 1e-6 && (before.1 - after.1).abs() < 1e-6);
    }
}
