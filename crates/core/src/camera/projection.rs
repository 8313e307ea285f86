use super::stereo::Eyes;
use super::{BrownConrady, ImagePlane, Panorama, Placement, Ray, Rect};
use crate::math;
use crate::num::simd::LANES;
use crate::ranges::{self, OutOfRange};
use glam::DVec3;
use std::fmt;
use std::str::FromStr;

/// The vertical field of view in degrees of a planar picture where nobody says another.
pub const DEFAULT_FOV: f64 = 45.0;

/// How rays leave the camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Projection {
    /// All from the eye, through the image plane.
    #[default]
    Perspective,
    /// Side by side along the view axis, from the plane through the eye.
    Orthographic,
    /// All from the eye, in the directions of a picture that is no plane.
    Panoramic(Panorama),
}

impl Projection {
    /// Every projection, and its name.
    pub fn all() -> impl Iterator<Item = (&'static str, Self)> {
        let planar = [
            ("perspective", Self::Perspective),
            ("orthographic", Self::Orthographic),
        ];
        let panoramas = Panorama::ALL.map(|(name, panorama)| (name, Self::Panoramic(panorama)));
        planar.into_iter().chain(panoramas)
    }

    /// Its name, as in [`Projection::all`]: through a lens that of perspective.
    pub fn name(self) -> &'static str {
        if self.lens().is_some() {
            return Self::Perspective.name();
        }
        let mut all = Self::all();
        all.find(|(_, it)| *it == self).map_or("", |(name, _)| name)
    }

    /// Whether rays are parallel; else they share the eye.
    #[inline]
    pub fn is_parallel(self) -> bool {
        self == Self::Orthographic
    }

    /// The kind of picture, where that is no plane.
    #[inline]
    pub fn panorama(self) -> Option<Panorama> {
        match self {
            Self::Panoramic(panorama) => Some(panorama),
            Self::Perspective | Self::Orthographic => None,
        }
    }

    /// The lens that a perspective picture is seen through, where there is one.
    pub fn lens(self) -> Option<BrownConrady> {
        match self {
            Self::Panoramic(Panorama::Lens(lens)) => Some(lens),
            _ => None,
        }
    }

    /// A perspective picture through a lens.
    pub fn through(lens: BrownConrady) -> Self {
        Self::Panoramic(Panorama::Lens(lens))
    }

    /// The height at distance `d` of a frame with this vertical field of view in degrees: what an orthographic frame
    /// has there too, so that switching the projection keeps the picture.
    pub fn frame(self, fov_degrees: f64, distance: f64) -> f64 {
        match self {
            Self::Perspective | Self::Orthographic => fov_to_frame(fov_degrees, distance),
            Self::Panoramic(panorama) => panorama.height(fov_degrees) * distance,
        }
    }

    /// The vertical field of view in degrees of a frame this high at this distance.
    pub fn fov_degrees(self, frame_height: f64, distance: f64) -> f64 {
        match self {
            Self::Perspective | Self::Orthographic => frame_to_fov(frame_height, distance),
            Self::Panoramic(panorama) => panorama.fov_degrees(frame_height / distance),
        }
    }

    /// A vertical field of view in degrees, checked: what the projection can have.
    ///
    /// # Errors
    /// Any other number.
    pub fn check_fov(self, degrees: f64) -> Result<f64, OutOfRange> {
        match self {
            Self::Perspective | Self::Orthographic => ranges::fov(degrees),
            Self::Panoramic(panorama) => {
                let most = panorama.most_fov();
                if (ranges::NARROWEST_FOV..=most).contains(&degrees) {
                    Ok(degrees)
                } else {
                    let name = self.name();
                    Err(OutOfRange::WideFov {
                        name,
                        most,
                        found: degrees,
                    })
                }
            }
        }
    }

    /// The part of a vertical field of view in degrees that a scene is to fill: of a panorama the quarter of a turn in its
    /// middle, which is much like a perspective picture.
    pub fn fitting_fov(self, fov_degrees: f64) -> f64 {
        match self {
            Self::Perspective | Self::Orthographic => fov_degrees,
            Self::Panoramic(_) => fov_degrees.min(90.0),
        }
    }

    /// The vertical field of view in degrees where nobody says another.
    pub fn default_fov(self) -> f64 {
        let panorama = self.panorama().filter(|_| self.lens().is_none());
        panorama.map_or(DEFAULT_FOV, Panorama::default_fov)
    }
}

impl fmt::Display for Projection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Projection {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::all().find(|(name, _)| *name == text);
        found.map(|(_, projection)| projection).ok_or_else(|| {
            let names: Vec<_> = Self::all().map(|(name, _)| name).collect();
            let found = crate::quote::quote(text);
            format!("expected one of {}, found {found}", names.join(", "))
        })
    }
}

/// An eye, an orientation and an image plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub(super) placement: Placement,
    pub(super) projection: Projection,
    pub(super) plane: ImagePlane,
    pub(super) right: DVec3,
    pub(super) up: DVec3,
    pub(super) forward: DVec3,
    distance: f64,
    shift: [f64; 2],
    /// Where the view axis goes through the picture, in pixels.
    pub(super) center: [f64; 2],
    pub(super) eyes: Eyes,
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
            shift: [0.0; 2],
            center: center(&plane, [0.0; 2]),
            eyes: Eyes::One,
        }
    }

    /// A perspective camera that looks along `axis` from the origin, at a target one unit away.
    pub(crate) fn along(axis: DVec3) -> Self {
        Self::upright(axis, axis.any_orthonormal_vector())
    }

    /// The same with `up` for its up axis, as near as that is square to the view axis.
    pub(crate) fn upright(axis: DVec3, up: DVec3) -> Self {
        let placement = Placement {
            eye: DVec3::ZERO,
            target: axis,
            up,
        };
        let plane = ImagePlane {
            columns: 2,
            rows: 2,
            step: 1.0,
        };
        Self::new(placement, Projection::Perspective, plane)
    }

    /// A perspective camera with the same axes in the origin, whose target is one unit away.
    pub(crate) fn unit_perspective(&self) -> Self {
        let placement = Placement {
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
            placement,
            projection: Projection::Perspective,
            distance: 1.0,
            eyes: Eyes::One,
            ..self.shifted([0.0; 2]).with_plane(plane)
        }
    }

    /// The ray through the point (x, y) of the picture, in pixels from its top left corner.
    ///
    /// This is the one definition of a pixel's ray: the pixel in column c and row r has its centre
    /// at (c + ½, r + ½). The direction is of unit length, so `t` is the distance from the eye, or
    /// from the image plane of an orthographic camera. Where the picture has no such place
    /// ([`Camera::has_place`]) it is zero.
    #[inline(always)]
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        if self.eyes != Eyes::One {
            return self.ray_of_eyes(x, y);
        }
        let on_plane = self.on_plane(x, y);
        match self.projection {
            Projection::Perspective => {
                let direction = on_plane + self.forward * self.distance;
                Ray::new(self.placement.eye, direction / direction.length())
            }
            Projection::Orthographic => Ray::new(self.placement.eye + on_plane, self.forward),
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
        Ray::new(self.placement.eye, unit)
    }

    fn panoramic_direction(&self, panorama: Panorama, x: f64, y: f64) -> DVec3 {
        let (a, b) = self.panoramic_place(x, y);
        let direction = panorama.direction(a, b).unwrap_or(DVec3::ZERO);
        self.in_world(direction)
    }

    /// (x, y) of the picture as [`Panorama`] counts places.
    pub(super) fn panoramic_place(&self, x: f64, y: f64) -> (f64, f64) {
        let (across, along) = self.across_and_along(x, y);
        (across / self.distance, along / self.distance)
    }

    /// A vector given to the right, up and forward.
    pub(super) fn in_world(&self, vector: DVec3) -> DVec3 {
        self.right * vector.x + self.up * vector.y + self.forward * vector.z
    }

    /// Whether the picture has the place (x, y): one of no plane has an end. A place that it does not have has no ray,
    /// but one without direction, which misses everything; pixels there are transparent.
    pub fn has_place(&self, x: f64, y: f64) -> bool {
        if self.stereo().is_some() {
            return self.of_half(x, y).has_place(x, y);
        }
        self.projection.panorama().is_none_or(|panorama| {
            let (a, b) = self.panoramic_place(x, y);
            panorama.has_place(a, b)
        })
    }

    /// Which of eight places of a row, a pixel apart, the picture has.
    pub(crate) fn has_eight_places(&self, x: f64, y: f64) -> [bool; LANES] {
        let all: [f64; LANES] = std::array::from_fn(|pixel| x + pixel as f64);
        match self.projection.lens() {
            // Newton's steps take little longer for eight than for one.
            Some(lens) if !self.has_all_between(all[0], all[LANES - 1], y) => {
                let (_, b) = self.panoramic_place(x, y);
                lens.has_places(all.map(|x| self.panoramic_place(x, y).0), b)
            }
            Some(_) => [true; LANES],
            None => all.map(|x| self.has_place(x, y)),
        }
    }

    /// Whether the picture surely has all places between two of a row.
    pub(crate) fn has_all_between(&self, left: f64, right: f64, y: f64) -> bool {
        self.projection.panorama().is_none_or(|panorama| {
            let (first, b) = self.panoramic_place(left, y);
            let (last, _) = self.panoramic_place(right, y);
            panorama.has_all_between((first, last), b)
        })
    }

    /// Whether the picture has all of its pixels' places.
    pub fn is_filled(&self) -> bool {
        // What a panorama has is convex but for the cross, and no rectangle about the cross's middle has its corners in
        // there and leaves it between them.
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

    /// How [`Camera::direction`] changes from (x, y) to a pixel further to the right, and a pixel further down: the
    /// derivatives.
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

    /// The principal point: where the view axis goes through the picture, in pixels.
    pub(crate) fn principal_point(&self) -> [f64; 2] {
        self.center
    }

    /// How far (x, y) of the picture is to the right of and above the view axis, in scene units at
    /// the target.
    #[inline(always)]
    pub(crate) fn across_and_along(&self, x: f64, y: f64) -> (f64, f64) {
        let across = (x - self.center[0]) * self.plane.step;
        let along = (self.center[1] - y) * self.plane.step;
        (across, along)
    }

    /// From the view axis to (x, y) of the picture, on the plane through the target.
    #[inline(always)]
    pub(crate) fn on_plane(&self, x: f64, y: f64) -> DVec3 {
        let (across, along) = self.across_and_along(x, y);
        self.right * across + self.up * along
    }

    /// The direction through (x, y) before it is made unit length: linear in x and y where the picture is a plane.
    ///
    /// Perspective: from the eye to the point on the plane through the target.
    /// Orthographic: the view axis. Panoramic: that of [`Panorama::direction`], or zero.
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

    /// Where a world point falls in the picture, in pixels; `None` at or behind the eye's plane, where
    /// [`Panorama::place`] has none, and where there are two eyes: a pair's [`Camera::halves`] have a place each.
    pub fn project(&self, point_in_world: DVec3) -> Option<(f64, f64)> {
        if self.eyes != Eyes::One {
            return None;
        }
        let relative = point_in_world - self.placement.eye;
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

    /// The same camera with its frame moved to the right and up, in heights of the frame: the eye, the view axis and
    /// the step stay, as with a lens that is shifted. Rays stay a lattice.
    pub fn shifted(&self, shift: [f64; 2]) -> Self {
        Self {
            shift,
            center: center(&self.plane, shift),
            ..*self
        }
    }

    /// How far the frame is off the view axis, to the right and up, in heights of the frame. Of one eye's camera
    /// ([`Camera::halves`]) that of the whole picture's.
    pub fn shift(&self) -> [f64; 2] {
        self.shift
    }
}

/// Where the view axis goes through a picture, in pixels: whole numbers of 2⁻²⁴, as the places of samples are, so that
/// differences from them are exact.
fn center(plane: &ImagePlane, [right, up]: [f64; 2]) -> [f64; 2] {
    let (columns, rows) = (f64::from(plane.columns), f64::from(plane.rows));
    [
        columns * 0.5 - rounded(right * rows),
        rows * 0.5 + rounded(up * rows),
    ]
}

/// Pixels as a whole number of 2⁻²⁴.
pub(super) fn rounded(pixels: f64) -> f64 {
    (pixels * 16_777_216.0).round_ties_even() / 16_777_216.0
}

/// The height at distance `d` of a frame with this vertical field of view in degrees.
pub fn fov_to_frame(fov_degrees: f64, distance: f64) -> f64 {
    2.0 * distance * math::tan(fov_degrees.to_radians() * 0.5)
}

/// The vertical field of view in degrees of a frame this high at this distance.
pub fn frame_to_fov(frame_height: f64, distance: f64) -> f64 {
    2.0 * math::atan(frame_height * 0.5 / distance).to_degrees()
}
