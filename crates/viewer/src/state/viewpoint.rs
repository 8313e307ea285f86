//! The viewpoint: where a scene is seen from.

pub use raycast_core::camera::DEFAULT_FOV;
use raycast_core::camera::{Orbit, Panorama, Pose, Projection, fov_to_frame, frame_to_fov};
use raycast_core::formats::CameraFile;
use raycast_core::glam::DVec3;
use raycast_core::math;

/// The narrowest and the widest field of view of a projection, in degrees.
pub fn fov_range(projection: Projection) -> (f64, f64) {
    (0.1, projection.panorama().map_or(170.0, Panorama::most_fov))
}

/// The margin around a fitted scene, as a share of the frame.
const MARGIN: f64 = 1.05;

/// Where a scene is seen from, and how: all that navigation changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// Where the camera is.
    pub orbit: Orbit,
    /// Degrees that the camera is rolled to the right about its view axis.
    pub roll: f64,
    /// The projection.
    pub projection: Projection,
    /// The vertical field of view in degrees. An orthographic frame is as high as this makes it at
    /// the orbit's distance, so that switching the projection keeps the picture.
    pub fov: f64,
}

/// A standard view: +Y is up, and the front view looks along −Z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StandardView {
    /// From +Z.
    Front,
    /// From −Z.
    Back,
    /// From −X.
    Left,
    /// From +X.
    Right,
    /// From +Y.
    Top,
    /// From −Y.
    Bottom,
    /// From (1, 1, 1): the three axes are equally long.
    Isometric,
}

impl StandardView {
    /// Yaw and pitch in degrees.
    pub fn angles(self) -> (f64, f64) {
        match self {
            Self::Front => (0.0, 0.0),
            Self::Back => (180.0, 0.0),
            Self::Left => (-90.0, 0.0),
            Self::Right => (90.0, 0.0),
            Self::Top => (0.0, 90.0),
            Self::Bottom => (0.0, -90.0),
            // The elevation of a cube's diagonal: atan(1 / √2).
            Self::Isometric => (45.0, math::atan(0.5_f64.sqrt()).to_degrees()),
        }
    }
}

impl Default for Viewpoint {
    fn default() -> Self {
        let (yaw, pitch) = Orbit::DEFAULT_ANGLES;
        Self {
            orbit: Orbit {
                pivot: DVec3::ZERO,
                yaw,
                pitch,
                distance: 1.0,
            },
            roll: 0.0,
            projection: Projection::Perspective,
            fov: DEFAULT_FOV,
        }
    }
}

impl Viewpoint {
    /// The viewpoint of a scene file's camera.
    pub fn of(camera: &CameraFile) -> Self {
        let orbit = Orbit::from_placement(&camera.pose);
        let up = camera.pose.up;
        let roll = math::atan2(up.dot(orbit.right()), up.dot(orbit.up())).to_degrees();
        let fov = match camera.projection {
            Projection::Perspective | Projection::Panoramic(_) => camera.frame,
            Projection::Orthographic => frame_to_fov(camera.frame, orbit.distance),
        };
        let (narrowest, widest) = fov_range(camera.projection);
        let mut viewpoint = Self {
            orbit,
            // A roll of the size of rounding errors is none.
            roll: if roll.abs() < 1e-6 || !roll.is_finite() {
                0.0
            } else {
                roll
            },
            projection: camera.projection,
            fov: fov.clamp(narrowest, widest),
        };
        if camera.projection == Projection::Orthographic {
            // No field of view in range gives this frame from this distance: another distance does.
            let frame = fov_to_frame(viewpoint.fov, viewpoint.orbit.distance);
            viewpoint.orbit.distance *= camera.frame / frame;
        }
        viewpoint
    }

    /// The camera as scene files hold it.
    pub fn to_file(self) -> CameraFile {
        CameraFile {
            pose: self.pose(),
            projection: self.projection,
            frame: match self.projection {
                Projection::Perspective | Projection::Panoramic(_) => self.fov,
                Projection::Orthographic => self.frame_height(),
            },
        }
    }

    /// Eye, target and up.
    pub fn pose(&self) -> Pose {
        Pose {
            up: self.up(),
            ..self.orbit.pose()
        }
    }

    /// The unit vector up in the picture.
    pub fn up(&self) -> DVec3 {
        if self.roll == 0.0 {
            return self.orbit.up();
        }
        let (sin, cos) = math::sin_cos(self.roll.to_radians());
        self.orbit.up() * cos + self.orbit.right() * sin
    }

    /// The unit vector to the right in the picture.
    pub fn right(&self) -> DVec3 {
        self.up().cross(self.orbit.back())
    }

    /// The frame's height at the target, in scene units.
    pub fn frame_height(&self) -> f64 {
        self.projection.frame(self.fov, self.orbit.distance)
    }

    /// Half the height, one unit in front of the eye, of the part of the frame that a fitted scene fills.
    pub fn slope(&self) -> f64 {
        let fov = self.projection.fitting_fov(self.fov);
        math::tan(fov.to_radians() * 0.5)
    }

    /// The same viewpoint without roll, seen from a direction.
    pub fn turned_to(mut self, (yaw, pitch): (f64, f64)) -> Self {
        (self.orbit.yaw, self.orbit.pitch) = (yaw, pitch);
        self.roll = 0.0;
        self
    }

    /// The nearest viewpoint with this direction and lens that looks at `center` and has the whole scene in view.
    /// `support` is the scene's support function: the largest dot product of a point with a direction.
    /// `aspect` is the picture's width over its height.
    ///
    /// The fit is tight: some point is as near to a side of the frame as the margin allows. An empty scene, or one that
    /// is a point, is seen from one unit away.
    pub fn fitted(
        mut self,
        center: DVec3,
        aspect: f64,
        support: impl Fn(DVec3) -> Option<f64>,
    ) -> Self {
        let (right, up, back) = (self.right(), self.up(), self.orbit.back());
        let slope = self.slope() / MARGIN;
        // How far the eye must be for one side of the frame. Perspective: a point is within the side where
        // x ≤ slope · depth, depth being how far it lies before the eye; that is x + slope · z ≤ slope · distance,
        // x and z counted from the centre. Orthographic: x alone must be within the frame.
        let needed = |side: DVec3, slope: f64| {
            let normal = match self.projection {
                Projection::Orthographic => side,
                Projection::Perspective | Projection::Panoramic(_) => side + back * slope,
            };
            Some((support(normal)? - center.dot(normal)) / slope)
        };
        let sides = [
            (right, slope * aspect),
            (-right, slope * aspect),
            (up, slope),
            (-up, slope),
        ];
        let distances = sides.map(|(side, slope)| needed(side, slope).unwrap_or(0.0));
        let distance = distances.into_iter().fold(0.0, f64::max);
        self.orbit.pivot = center;
        self.orbit.distance = if distance.is_normal() { distance } else { 1.0 };
        self
    }

    /// Interpolates from this viewpoint (0) to another (1): angles the short way round, distances by their logarithm.
    /// At 1 the result is exactly the other.
    pub fn towards(&self, other: &Self, share: f64) -> Self {
        if share >= 1.0 {
            return *other;
        }
        let between = |from: f64, to: f64| from + (to - from) * share;
        let turned = |from: f64, to: f64| from + shortest(to - from) * share;
        let (from, to) = (&self.orbit, &other.orbit);
        let ratio = to.distance / from.distance;
        Self {
            orbit: Orbit {
                pivot: from.pivot + (to.pivot - from.pivot) * share,
                yaw: turned(from.yaw, to.yaw),
                pitch: between(from.pitch, to.pitch),
                distance: from.distance * math::pow(ratio, share),
            },
            roll: turned(self.roll, other.roll),
            projection: other.projection,
            // A field of view of one projection may be out of range in another.
            fov: match self.projection.panorama() == other.projection.panorama() {
                true => between(self.fov, other.fov),
                false => other.fov,
            },
        }
    }
}

/// The equivalent angle within half a turn.
fn shortest(degrees: f64) -> f64 {
    (degrees + 180.0).rem_euclid(360.0) - 180.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::camera::{Camera, ImagePlane, Panorama};

    #[test]
    fn a_fit_shows_every_point_and_one_at_the_margin() {
        let points: Vec<DVec3> = (0..40)
            .map(|i| {
                let t = f64::from(i);
                DVec3::new((t * 1.7) % 3.0, (t * 0.37) % 1.0, (t * 2.3) % 5.0) + DVec3::X * 40.0
            })
            .collect();
        let center = DVec3::new(41.5, 0.5, 2.5);
        let support = |direction: DVec3| points.iter().map(|p| p.dot(direction)).reduce(f64::max);
        for projection in [Projection::Perspective, Projection::Orthographic] {
            for (yaw, pitch, roll) in [(0.0, 0.0, 0.0), (70.0, 30.0, 0.0), (200.0, -80.0, 25.0)] {
                let start = Viewpoint {
                    roll,
                    projection,
                    ..Viewpoint::default().turned_to((yaw, pitch))
                };
                let start = Viewpoint { roll, ..start };
                let fitted = start.fitted(center, 2.0, support);
                let step = fitted.frame_height() / 100.0;
                let plane = ImagePlane::new(200, 100, step).expect("a good plane");
                let camera = Camera::new(fitted.pose(), projection, plane);
                let mut box_ = (f64::MAX, f64::MIN, f64::MAX, f64::MIN);
                for &point in &points {
                    let (x, y) = camera.project(point).expect("in front");
                    box_ = (box_.0.min(x), box_.1.max(x), box_.2.min(y), box_.3.max(y));
                }
                let (left, right, top, bottom) = (box_.0, 200.0 - box_.1, box_.2, 100.0 - box_.3);
                let margins = [left, right, top, bottom];
                assert!(
                    margins.iter().all(|&m| m > 0.0),
                    "{projection:?} {margins:?}"
                );
                let least = margins.iter().copied().fold(f64::MAX, f64::min);
                assert!(least < 6.0, "{projection:?} {margins:?}");
            }
        }
    }

    #[test]
    fn a_view_on_its_way_to_another_kind_of_picture_has_a_possible_fov() {
        let view = |projection: Projection, fov| Viewpoint {
            projection,
            fov,
            ..Viewpoint::default()
        };
        let fisheye = Projection::Panoramic(Panorama::Equidistant);
        let (wide, plane) = (view(fisheye, 360.0), view(Projection::Perspective, 45.0));
        for share in [0.0, 0.3, 0.9, 1.0] {
            assert_eq!(wide.towards(&plane, share).fov, 45.0);
            assert_eq!(plane.towards(&wide, share).fov, 360.0);
        }
        let narrow = view(Projection::Perspective, 25.0);
        assert_eq!(plane.towards(&narrow, 0.5).fov, 35.0);
    }

    #[test]
    fn a_scene_files_camera_comes_back_as_it_was() {
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = CameraFile {
                pose: Pose {
                    eye: DVec3::new(3.0, 2.0, 5.0),
                    target: DVec3::new(0.5, 0.0, 0.0),
                    up: DVec3::new(0.3, 1.0, 0.0),
                },
                projection,
                frame: 25.0,
            };
            let file = Viewpoint::of(&camera).to_file();
            assert!((file.frame - 25.0).abs() < 1e-9, "{file:?}");
            let sight = |p: &Pose| (p.eye - p.target).normalize();
            assert!(sight(&file.pose).distance(sight(&camera.pose)) < 1e-12);
            // The part of the given up that lies across the view.
            let back = sight(&camera.pose);
            let across = camera.pose.up - back * camera.pose.up.dot(back);
            assert!(file.pose.up.distance(across.normalize()) < 1e-9);
        }
    }

    #[test]
    fn between_two_viewpoints_angles_go_the_short_way() {
        let at = |yaw| Viewpoint::default().turned_to((yaw, 0.0));
        let half = at(170.0).towards(&at(-170.0), 0.5);
        assert!((half.orbit.yaw - 180.0).abs() < 1e-12, "{half:?}");
        assert_eq!(at(170.0).towards(&at(-170.0), 1.0), at(-170.0));
    }
}
