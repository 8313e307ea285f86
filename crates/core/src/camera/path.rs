use super::{Orbit, Pose};
use glam::DVec3;

/// A camera at one frame of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyframe {
    /// The frame's number.
    pub frame: u32,
    /// Eye, target, up.
    pub pose: Pose,
    /// Vertical field of view in degrees, or the orthographic frame's height in scene units; `None` for the camera's
    /// own.
    pub view: Option<f64>,
}

/// How keyframes are interpolated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curve {
    /// Straight lines.
    Linear,
    /// Cubic curves through the keyframes, with the slope of the line between each keyframe's neighbours (Catmull and
    /// Rom, "A class of local interpolating splines", 1974), measured a frame.
    #[default]
    CatmullRom,
}

/// The speed of a camera between keyframes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ease {
    /// As the curve gives it.
    #[default]
    None,
    /// From rest to rest: a fraction s of the frames covers 3 s² − 2 s³ of the way.
    Smooth,
}

/// A camera's path through an animation: keyframes in the order of their frames.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    keys: Vec<Keyframe>,
    curve: Curve,
    ease: Ease,
}

impl CameraPath {
    /// The path through keyframes; `None` if there are none, or if frame numbers do not ascend.
    pub fn new(keys: Vec<Keyframe>, curve: Curve, ease: Ease) -> Option<Self> {
        let rises = keys.windows(2).all(|pair| pair[0].frame < pair[1].frame);
        (!keys.is_empty() && rises).then_some(Self { keys, curve, ease })
    }

    /// A turntable: once around a pose's target, about +Y from left to right, in `frames` frames from 0; frame
    /// `frames` would be the first again.
    pub fn turntable(pose: &Pose, frames: u32, frame: u32) -> Pose {
        let from = Orbit::from_placement(pose);
        let mut orbit = from;
        orbit.turn(360.0 * f64::from(frame) / f64::from(frames.max(1)), 0.0);
        match frame % frames.max(1) {
            // Unchanged, to the last bit.
            0 => *pose,
            _ => Pose {
                up: turned(pose.up, orbit.yaw - from.yaw),
                ..orbit.pose()
            },
        }
    }

    /// The keyframes.
    pub fn keys(&self) -> &[Keyframe] {
        &self.keys
    }

    /// How keyframes are interpolated.
    pub fn curve(&self) -> Curve {
        self.curve
    }

    /// The speed of the camera between keyframes.
    pub fn ease(&self) -> Ease {
        self.ease
    }

    /// The first and the last frame.
    pub fn frames(&self) -> (u32, u32) {
        // There is at least one keyframe.
        let at = |index: usize| self.keys.get(index).map_or(0, |key| key.frame);
        (at(0), at(self.keys.len() - 1))
    }

    /// The camera at a frame. Before the first keyframe it stays there, and after the last one as well. A view that
    /// is set at only one end of a segment holds along all of it.
    pub fn at(&self, frame: u32) -> Keyframe {
        let after = self.keys.partition_point(|key| key.frame <= frame);
        let (Some(&from), Some(&to)) = (
            self.keys.get(after.saturating_sub(1)),
            self.keys.get(after.min(self.keys.len() - 1)),
        ) else {
            return self.keys[0];
        };
        if frame <= from.frame || from.frame == to.frame {
            return Keyframe { frame, ..from };
        }
        let length = f64::from(to.frame - from.frame);
        let share = f64::from(frame - from.frame) / length;
        let share = match self.ease {
            Ease::None => share,
            Ease::Smooth => share * share * (3.0 - 2.0 * share),
        };
        let index = after - 1;
        let vector = |of: fn(&Keyframe) -> DVec3| match self.curve {
            Curve::Linear => of(&from) + (of(&to) - of(&from)) * share,
            Curve::CatmullRom => {
                let slopes = [self.slope(index, of), self.slope(index + 1, of)];
                hermite(
                    [of(&from), of(&to)],
                    slopes.map(|slope| slope * length),
                    share,
                )
            }
        };
        let view = match (from.view, to.view) {
            (Some(from), Some(to)) => Some(from + (to - from) * share),
            (one, other) => one.or(other),
        };
        Keyframe {
            frame,
            pose: Pose {
                eye: vector(|key| key.pose.eye),
                target: vector(|key| key.pose.target),
                up: vector(|key| key.pose.up),
            },
            view,
        }
    }

    /// The change of a value a frame at a keyframe: as on the line between its neighbours; at an end, to its only
    /// neighbour.
    fn slope(&self, index: usize, of: fn(&Keyframe) -> DVec3) -> DVec3 {
        let before = &self.keys[index.saturating_sub(1)];
        let after = &self.keys[(index + 1).min(self.keys.len() - 1)];
        // Frames ascend, and there are at least two keyframes here.
        (of(after) - of(before)) / f64::from((after.frame - before.frame).max(1))
    }
}

/// The cubic between two values with these slopes at its ends (Hermite).
fn hermite([from, to]: [DVec3; 2], [leave, arrive]: [DVec3; 2], s: f64) -> DVec3 {
    let (s2, s3) = (s * s, s * s * s);
    from * (2.0 * s3 - 3.0 * s2 + 1.0)
        + leave * (s3 - 2.0 * s2 + s)
        + to * (3.0 * s2 - 2.0 * s3)
        + arrive * (s3 - s2)
}

/// A vector rotated about +Y by degrees.
fn turned(vector: DVec3, degrees: f64) -> DVec3 {
    let (sin, cos) = crate::math::sin_cos(degrees.to_radians());
    let DVec3 { x, y, z } = vector;
    DVec3::new(x * cos + z * sin, y, z * cos - x * sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(frame: u32, x: f64, view: Option<f64>) -> Keyframe {
        Keyframe {
            frame,
            pose: Pose {
                eye: DVec3::new(x, x * x, 5.0),
                target: DVec3::ZERO,
                up: DVec3::Y,
            },
            view,
        }
    }

    fn path(curve: Curve, ease: Ease) -> CameraPath {
        let keys = vec![
            key(2, 0.0, Some(30.0)),
            key(6, 4.0, None),
            key(7, 5.0, Some(50.0)),
        ];
        CameraPath::new(keys, curve, ease).expect("frames rise")
    }

    #[test]
    fn a_path_goes_through_its_keyframes_and_rests_beyond_them() {
        for curve in [Curve::Linear, Curve::CatmullRom] {
            for ease in [Ease::None, Ease::Smooth] {
                let path = path(curve, ease);
                for key in path.keys() {
                    assert_eq!(path.at(key.frame), *key);
                }
                assert_eq!(path.at(0).pose, path.keys()[0].pose);
                assert_eq!(path.at(99).pose, path.keys()[2].pose);
                assert_eq!(path.frames(), (2, 7));
            }
        }
        assert_eq!(CameraPath::new(vec![], Curve::Linear, Ease::None), None);
        let twice = vec![key(3, 0.0, None), key(3, 1.0, None)];
        assert_eq!(CameraPath::new(twice, Curve::Linear, Ease::None), None);
        let one = CameraPath::new(vec![key(3, 1.5, None)], Curve::CatmullRom, Ease::Smooth);
        assert_eq!(one.expect("a keyframe").at(9).pose.eye.x, 1.5);
    }

    #[test]
    fn keyframes_are_joined_by_lines_or_smooth_curves() {
        let eye = |curve, ease, frame| path(curve, ease).at(frame).pose.eye;
        assert_eq!(eye(Curve::Linear, Ease::None, 3), DVec3::new(1.0, 4.0, 5.0));
        // After a quarter of the frames it is at 10/64 of the way.
        assert_eq!(eye(Curve::Linear, Ease::Smooth, 3).x, 4.0 * 10.0 / 64.0);
        // x is linear in the frame, which a Catmull-Rom curve preserves.
        for frame in 2..=7 {
            let x = eye(Curve::CatmullRom, Ease::None, frame).x;
            assert!((x - f64::from(frame - 2)).abs() < 1e-12, "{frame}: {x}");
        }
        assert_eq!(path(Curve::Linear, Ease::None).at(4).view, Some(30.0));
    }

    #[test]
    fn a_turntable_is_a_circle_that_begins_where_it_stands() {
        let from = Pose {
            eye: DVec3::new(1.0, 2.0, 3.0),
            target: DVec3::new(0.5, -1.0, 0.0),
            up: DVec3::new(0.1, 1.0, 0.0),
        };
        assert_eq!(CameraPath::turntable(&from, 12, 0), from);
        assert_eq!(CameraPath::turntable(&from, 12, 12), from);
        let quarter = CameraPath::turntable(&from, 12, 3);
        // A rotation by +90 degrees about +Y takes (x, y, z) to (z, y, -x).
        let expected = from.target + DVec3::new(3.0, 3.0, -0.5);
        assert!(quarter.eye.distance(expected) < 1e-12, "{quarter:?}");
        assert!(quarter.up.distance(DVec3::new(0.0, 1.0, -0.1)) < 1e-12);
        assert_eq!(quarter.target, from.target);
    }
}
