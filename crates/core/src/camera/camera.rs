use super::stereo::Eyes;
use super::{ImagePlane, Panorama, Pose, Projection, Ray, Rect};
use crate::num::simd::LANES;
use crate::ranges::LEAST_EYE;
use glam::DVec3;

/// A pose, a projection and an image plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub(super) pose: Pose,
    pub(super) projection: Projection,
    pub(super) plane: ImagePlane,
    pub(super) right: DVec3,
    pub(super) up: DVec3,
    pub(super) forward: DVec3,
    distance: f64,
    shift: [f64; 2],
    /// The principal point: where the view axis meets the picture, in pixels.
    pub(super) center: [f64; 2],
    pub(super) eyes: Eyes,
}

impl Camera {
    /// A camera at `pose`.
    ///
    /// If eye and target coincide, it looks along −Z at a target one unit away; if `up` is zero or parallel to the
    /// view axis, −Z or +Y replaces it. [`Pose::check`] reports both. An eye's coordinate nearer to zero than
    /// [`LEAST_EYE`] is zero.
    pub fn new(mut pose: Pose, projection: Projection, plane: ImagePlane) -> Self {
        let is_zero = pose.eye.abs().cmplt(DVec3::splat(LEAST_EYE));
        pose.eye = DVec3::select(is_zero, DVec3::ZERO.copysign(pose.eye), pose.eye);
        let sight = pose.target - pose.eye;
        let length = sight.length();
        let (forward, distance) = if length.is_finite() && length > 0.0 {
            (sight / length, length)
        } else {
            (DVec3::NEG_Z, 1.0)
        };
        let sideways = |up: DVec3| forward.cross(up.normalize_or_zero());
        let right = [pose.up, DVec3::NEG_Z, DVec3::Y]
            .into_iter()
            .map(sideways)
            .find(|right| right.length() > Pose::LEAST_SINE)
            .unwrap_or(DVec3::X)
            .normalize();
        Self {
            pose,
            projection,
            plane,
            right,
            up: right.cross(forward),
            forward,
            distance,
            shift: [0.0; 2],
            center: center(&plane, [0.0; 2]),
            eyes: Eyes::One,
        }
    }

    /// A perspective camera that looks along `axis` from the origin, at a target one unit away.
    pub(crate) fn along(axis: DVec3) -> Self {
        Self::upright(axis, axis.any_orthonormal_vector())
    }

    /// The same, with `up` made orthogonal to the view axis.
    pub(crate) fn upright(axis: DVec3, up: DVec3) -> Self {
        let pose = Pose {
            eye: DVec3::ZERO,
            target: axis,
            up,
        };
        let plane = ImagePlane {
            columns: 2,
            rows: 2,
            step: 1.0,
        };
        Self::new(pose, Projection::Perspective, plane)
    }

    /// A perspective camera at the origin with the same axes, whose target is one unit away.
    pub(crate) fn unit_perspective(&self) -> Self {
        let pose = Pose {
            eye: DVec3::ZERO,
            target: self.forward,
            up: self.up,
        };
        let plane = ImagePlane {
            columns: 2,
            rows: 2,
            step: 1.0,
        };
        Self {
            pose,
            projection: Projection::Perspective,
            distance: 1.0,
            eyes: Eyes::One,
            ..self.shifted([0.0; 2]).with_plane(plane)
        }
    }

    /// The ray through the point (x, y) of the picture, in pixels from its top left corner.
    ///
    /// This is the only definition of a pixel's ray: the pixel in column c and row r has its centre at
    /// (c + ½, r + ½). The direction has unit length, so that `t` is the distance from the eye, or from the image
    /// plane of an orthographic camera. It is zero where the picture has no ray ([`Camera::has_place`]).
    #[inline(always)]
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        if self.eyes != Eyes::One {
            return self.ray_of_eyes(x, y);
        }
        let on_plane = self.on_plane(x, y);
        match self.projection {
            Projection::Perspective => {
                let direction = on_plane + self.forward * self.distance;
                Ray::new(self.pose.eye, direction / direction.length())
            }
            Projection::Orthographic => Ray::new(self.pose.eye + on_plane, self.forward),
            Projection::Panoramic(panorama) => self.panoramic_ray(panorama, x, y),
        }
    }

    #[inline(never)]
    fn panoramic_ray(&self, panorama: Panorama, x: f64, y: f64) -> Ray {
        let direction = self.panoramic_direction(panorama, x, y);
        let length = direction.length();
        let unit = if length > 0.0 {
            direction / length
        } else {
            DVec3::ZERO
        };
        Ray::new(self.pose.eye, unit)
    }

    fn panoramic_direction(&self, panorama: Panorama, x: f64, y: f64) -> DVec3 {
        let (a, b) = self.panoramic_place(x, y);
        let direction = panorama.direction(a, b).unwrap_or(DVec3::ZERO);
        self.in_world(direction)
    }

    /// The coordinates of (x, y) in the unit of [`Panorama`].
    pub(super) fn panoramic_place(&self, x: f64, y: f64) -> (f64, f64) {
        let (across, along) = self.across_and_along(x, y);
        (across / self.distance, along / self.distance)
    }

    /// Transforms a vector from camera coordinates (right, up, forward) to world coordinates.
    pub(super) fn in_world(&self, vector: DVec3) -> DVec3 {
        self.right * vector.x + self.up * vector.y + self.forward * vector.z
    }

    /// Whether (x, y) is inside the picture's domain. That of many panoramas is bounded, such as
    /// a fisheye's disc. Outside, the ray has a zero direction and misses everything, and pixels are transparent.
    pub fn has_place(&self, x: f64, y: f64) -> bool {
        if self.stereo().is_some() {
            return self.of_half(x, y).has_place(x, y);
        }
        self.projection.panorama().is_none_or(|panorama| {
            let (a, b) = self.panoramic_place(x, y);
            panorama.has_place(a, b)
        })
    }

    /// For eight places of a row, one pixel apart, whether each is inside the picture's domain.
    pub(crate) fn has_eight_places(&self, x: f64, y: f64) -> [bool; LANES] {
        let all: [f64; LANES] = std::array::from_fn(|pixel| x + pixel as f64);
        match self.projection.lens() {
            // Newton's iteration for eight lanes takes little longer than for one.
            Some(lens) if !self.has_all_between(all[0], all[LANES - 1], y) => {
                let (_, b) = self.panoramic_place(x, y);
                lens.has_places(all.map(|x| self.panoramic_place(x, y).0), b)
            }
            Some(_) => [true; LANES],
            None => all.map(|x| self.has_place(x, y)),
        }
    }

    /// Whether all places of a row between two are inside the picture's domain; through a lens `false`
    /// may mean that this is not certain.
    pub(crate) fn has_all_between(&self, left: f64, right: f64, y: f64) -> bool {
        self.projection.panorama().is_none_or(|panorama| {
            let (first, b) = self.panoramic_place(left, y);
            let (last, _) = self.panoramic_place(right, y);
            panorama.has_all_between((first, last), b)
        })
    }

    /// Whether the whole picture is inside its domain.
    pub fn is_filled(&self) -> bool {
        // The corner pixels decide: the domain of every panorama but the cross is convex, and no rectangle around
        // the middle of the cross has its corners inside and other places outside.
        let whole = |camera: &Self, rect: Rect| {
            let middle = |pixel: u32| f64::from(pixel) + 0.5;
            let rows = [rect.y, rect.bottom().saturating_sub(1)].map(middle);
            let columns = [rect.x, rect.right().saturating_sub(1)].map(middle);
            let mut places = rows.into_iter().flat_map(|y| columns.map(|x| (x, y)));
            places.all(|(x, y)| camera.has_place(x, y))
        };
        match self.halves() {
            Some(halves) => halves.iter().all(|(camera, half)| whole(camera, *half)),
            None => whole(self, self.whole().rect),
        }
    }

    /// The derivatives of [`Camera::direction`] at (x, y), for a step of one pixel to the right and one down.
    pub(crate) fn direction_slopes(&self, x: f64, y: f64) -> [DVec3; 2] {
        let step = self.plane.step;
        match self.projection {
            Projection::Perspective => [self.right * step, self.up * -step],
            Projection::Orthographic => [DVec3::ZERO; 2],
            Projection::Panoramic(panorama) => {
                let (a, b) = self.panoramic_place(x, y);
                let [along_a, along_b] = panorama.derivatives(a, b);
                let pixel = step / self.distance;
                [
                    self.in_world(along_a) * pixel,
                    self.in_world(along_b) * -pixel,
                ]
            }
        }
    }

    /// The principal point: where the view axis meets the picture, in pixels.
    pub(crate) fn principal_point(&self) -> [f64; 2] {
        self.center
    }

    /// The offset of (x, y) from the view axis, to the right and up, in scene units at the target's distance.
    #[inline(always)]
    pub(crate) fn across_and_along(&self, x: f64, y: f64) -> (f64, f64) {
        let across = (x - self.center[0]) * self.plane.step;
        let along = (self.center[1] - y) * self.plane.step;
        (across, along)
    }

    /// The vector from the view axis to (x, y) on the plane through the target.
    #[inline(always)]
    pub(crate) fn on_plane(&self, x: f64, y: f64) -> DVec3 {
        let (across, along) = self.across_and_along(x, y);
        self.right * across + self.up * along
    }

    /// The direction through (x, y) before normalisation: affine in x and y if the picture is a plane.
    ///
    /// Perspective: from the eye to the point on the plane through the target. Orthographic: the view axis.
    /// Panoramic: that of [`Panorama::direction`] in world coordinates, or zero.
    pub fn direction(&self, x: f64, y: f64) -> DVec3 {
        if self.stereo().is_some() {
            return self.of_half(x, y).direction(x, y);
        }
        match self.projection {
            Projection::Perspective => self.on_plane(x, y) + self.forward * self.distance,
            Projection::Orthographic => self.forward,
            Projection::Panoramic(panorama) => self.panoramic_direction(panorama, x, y),
        }
    }

    /// The greatest magnitudes of the terms that a perspective camera's [`Camera::direction`] is the sum of, by component,
    /// within `reach` pixels from (x, y): of the view axis, which is the same for all rays, and of all others, those of the
    /// place's own coordinates included.
    pub(crate) fn greatest_terms(&self, (x, y): (f64, f64), reach: f64) -> [DVec3; 2] {
        let [right, down] = self.center;
        let across = (x.abs() + right.abs() + reach) * self.plane.step;
        let along = (y.abs() + down.abs() + reach) * self.plane.step;
        [
            self.forward.abs() * self.distance,
            self.right.abs() * across + self.up.abs() * along,
        ]
    }

    /// Projects a world point to the picture, in pixels. `None` at or behind the eye's plane of a perspective
    /// camera, where [`Panorama::place`] has none, and for stereo pairs, whose two [`Camera::halves`] have a
    /// projection each.
    pub fn project(&self, point_in_world: DVec3) -> Option<(f64, f64)> {
        if self.eyes != Eyes::One {
            return None;
        }
        let relative = point_in_world - self.pose.eye;
        if let Projection::Panoramic(panorama) = self.projection {
            let in_camera = DVec3::new(
                relative.dot(self.right),
                relative.dot(self.up),
                relative.dot(self.forward),
            );
            let (a, b) = panorama.place(in_camera)?;
            let pixels = self.distance / self.plane.step;
            let x = self.center[0] + a * pixels;
            let y = self.center[1] - b * pixels;
            return (x.is_finite() && y.is_finite()).then_some((x, y));
        }
        let depth = relative.dot(self.forward);
        let scale = match self.projection {
            Projection::Perspective if depth > 0.0 => self.distance / depth,
            Projection::Orthographic => 1.0,
            Projection::Perspective | Projection::Panoramic(_) => return None,
        } / self.plane.step;
        let x = self.center[0] + relative.dot(self.right) * scale;
        let y = self.center[1] - relative.dot(self.up) * scale;
        (x.is_finite() && y.is_finite()).then_some((x, y))
    }

    /// Eye, target and up vector.
    #[inline]
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// How pixels map to rays.
    #[inline]
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// Number and spacing of pixels.
    pub fn plane(&self) -> ImagePlane {
        self.plane
    }

    /// The unit vector that points to the right in the picture.
    #[inline]
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// The unit vector that points up in the picture.
    #[inline]
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// The unit vector along the view axis.
    #[inline]
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// The distance from eye to target, in scene units.
    #[inline]
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// The vertical field of view in degrees; `None` for an orthographic camera.
    pub fn fov_degrees(&self) -> Option<f64> {
        let height = self.plane.frame_height() / self.pictures_down();
        let fov = || self.projection.fov_degrees(height, self.distance);
        (!self.projection.is_parallel()).then(fov)
    }

    /// The same camera with another image plane.
    pub fn with_plane(&self, plane: ImagePlane) -> Self {
        Self {
            plane,
            center: center(&plane, self.shift),
            ..*self
        }
    }

    /// The same camera with its frame moved to the right and up (lens shift), in units of the frame's height. Eye,
    /// view axis and pixel size stay, and so rays still form a lattice.
    pub fn shifted(&self, shift: [f64; 2]) -> Self {
        Self {
            shift,
            center: center(&self.plane, shift),
            ..*self
        }
    }

    /// The frame's offset from the view axis, to the right and up, in units of its height. For one eye of a stereo
    /// pair ([`Camera::halves`]) it is that of the whole picture.
    pub fn shift(&self) -> [f64; 2] {
        self.shift
    }
}

/// The principal point in pixels. It is a multiple of 2⁻²⁴, as sample positions are, so that their differences are
/// exact.
fn center(plane: &ImagePlane, [right, up]: [f64; 2]) -> [f64; 2] {
    let (columns, rows) = (f64::from(plane.columns), f64::from(plane.rows));
    [
        columns * 0.5 - rounded(right * rows),
        rows * 0.5 + rounded(up * rows),
    ]
}

/// Rounds pixels to a multiple of 2⁻²⁴.
pub(super) fn rounded(pixels: f64) -> f64 {
    (pixels * 16_777_216.0).round_ties_even() / 16_777_216.0
}
