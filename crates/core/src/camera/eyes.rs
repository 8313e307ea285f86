//! The cameras of pictures for two eyes.

use super::stereo::Eyes;
use super::{
    Camera, ImagePlane, Lattice, Panorama, Projection, Ray, Rect, Stereo, StereoError, StereoKind,
};
use crate::math;
use glam::DVec3;

/// The furthest in pixels that the frames of a pair are moved towards each other: as far as a shift can move the
/// frame of the largest picture. Places are still exact to 2⁻²⁴ there.
const FURTHEST: f64 = (1u64 << 28) as f64;

impl Stereo {
    /// Whether a camera with this projection can make such pictures, given its plane if that is known.
    ///
    /// # Errors
    /// Distances out of range; a projection without an eye, or without all directions where these are needed, or
    /// whose frame cannot be shifted; a picture whose halves are not whole pixels.
    pub fn check(
        &self,
        projection: Projection,
        plane: Option<ImagePlane>,
    ) -> Result<(), StereoError> {
        let is_planar = projection.panorama().is_none() || projection.lens().is_some();
        let all_around = Projection::Panoramic(Panorama::Equirectangular);
        self.check_distances()?;
        let converges = self.convergence.is_some_and(f64::is_finite);
        let (columns, rows) = plane.map_or((2, 2), |plane| (plane.columns, plane.rows));
        match self.kind {
            StereoKind::Pair if projection.is_parallel() => Err(StereoError::Orthographic),
            StereoKind::Pair if converges && !is_planar => Err(StereoError::CannotConverge),
            StereoKind::Pair if columns % 2 != 0 => Err(StereoError::OddColumns),
            StereoKind::Ods if projection != all_around => Err(StereoError::NotEquirectangular),
            StereoKind::Ods if converges => Err(StereoError::CannotConverge),
            StereoKind::Ods if rows % 2 != 0 => Err(StereoError::OddRows),
            StereoKind::Pair | StereoKind::Ods => Ok(()),
        }
    }
}

impl Camera {
    /// The same camera with pictures for two eyes, or for one. [`Stereo::check`] says whether it can make them.
    pub fn in_stereo(self, stereo: Option<Stereo>) -> Self {
        let mut camera = self;
        camera.eyes = stereo.map_or(Eyes::One, Eyes::Two);
        camera
    }

    /// How its pictures serve two eyes, if they do.
    pub fn stereo(&self) -> Option<Stereo> {
        match self.eyes {
            Eyes::Two(stereo) => Some(stereo),
            Eyes::One | Eyes::Circle(_) => None,
        }
    }

    /// For a picture for two eyes, the camera and the half of each eye, the left eye first. Pixels still count in the
    /// whole picture. The camera of a half continues beyond it: a sample belongs to the eye of its pixel.
    pub fn halves(&self) -> Option<[(Self, Rect); 2]> {
        let stereo = self.stereo()?;
        let plane = self.plane();
        let (across, down) = stereo.pictures();
        Some([0, 1].map(|which| {
            let (width, height) = (plane.columns / across, plane.rows / down);
            let (x, y) = (which * (across - 1) * width, which * (down - 1) * height);
            let last = which == 1;
            let rect = Rect {
                x,
                y,
                // The last half of an odd number has one more.
                width: if last { plane.columns - x } else { width },
                height: if last { plane.rows - y } else { height },
            };
            (self.half(&stereo, last), rect)
        }))
    }

    /// The camera of one eye.
    fn half(&self, stereo: &Stereo, is_right: bool) -> Self {
        let plane = self.plane();
        let (columns, rows) = (f64::from(plane.columns), f64::from(plane.rows));
        let side = if is_right { 0.5 } else { -0.5 };
        let aside = stereo.eye_distance * side;
        let [x, y] = self.principal_point();
        match stereo.kind {
            StereoKind::Pair => {
                let is_planar =
                    self.projection().panorama().is_none() || self.projection().lens().is_some();
                let usual = if is_planar {
                    self.distance()
                } else {
                    f64::INFINITY
                };
                let convergence = stereo.convergence.unwrap_or(usual);
                // The point straight ahead of the middle at this distance is in the middle of both pictures.
                let pixels = aside * (self.distance() / convergence) / plane.step;
                let center = [
                    x + columns * 0.5 * side
                        + super::camera::rounded(pixels.clamp(-FURTHEST, FURTHEST)),
                    y,
                ];
                self.moved(self.right() * aside, center, Eyes::One)
            }
            StereoKind::Ods => {
                self.moved(DVec3::ZERO, [x, y + rows * 0.5 * side], Eyes::Circle(aside))
            }
        }
    }

    /// The same camera with eye and target translated, and the view axis through another place of the picture.
    fn moved(&self, by: DVec3, center: [f64; 2], eyes: Eyes) -> Self {
        let mut moved = *self;
        moved.pose.eye += by;
        moved.pose.target += by;
        moved.center = center;
        moved.eyes = eyes;
        moved
    }

    /// A camera with one eye that has the ray of a place, and of all places above and below it in its half of the
    /// picture.
    pub fn seen_at(&self, x: f64, y: f64) -> Self {
        match self.eyes {
            Eyes::One => *self,
            Eyes::Circle(radius) => {
                let (a, _) = self.panoramic_place(x, y);
                // A place beyond the panorama has no ray.
                let a = if a.is_finite() { a } else { 0.0 };
                let (sin, cos) = math::sin_cos(a);
                let by = (self.right() * cos - self.forward() * sin) * radius;
                self.moved(by, self.principal_point(), Eyes::One)
            }
            Eyes::Two(_) => self.of_half(x, y).seen_at(x, y),
        }
    }

    /// The camera of the half that contains a place; the camera itself where there is one eye.
    pub fn of_half(&self, x: f64, y: f64) -> Self {
        let plane = self.plane();
        let is_right = |stereo: &Stereo| match stereo.kind {
            StereoKind::Pair => x >= f64::from(plane.columns / 2),
            StereoKind::Ods => y >= f64::from(plane.rows / 2),
        };
        match &self.eyes {
            Eyes::Two(stereo) => self.half(stereo, is_right(stereo)),
            Eyes::One | Eyes::Circle(_) => *self,
        }
    }

    /// Whether the rays of each column have an eye of their own.
    pub(crate) fn has_an_eye_a_column(&self) -> bool {
        matches!(self.eyes, Eyes::Circle(_))
    }

    #[inline(never)]
    pub(super) fn ray_of_eyes(&self, x: f64, y: f64) -> Ray {
        self.seen_at(x, y).ray(x, y)
    }

    /// The first row of its own picture in the whole one, and its height in rows.
    pub(crate) fn own_rows(&self) -> (f64, f64) {
        let rows = f64::from(self.plane().rows);
        match self.eyes {
            Eyes::One | Eyes::Two(_) => (0.0, rows),
            Eyes::Circle(_) => (self.principal_point()[1] - rows * 0.25, rows * 0.5),
        }
    }

    /// How many pictures are stacked.
    pub(super) fn pictures_down(&self) -> f64 {
        match self.eyes {
            Eyes::One => 1.0,
            Eyes::Circle(_) => 2.0,
            Eyes::Two(stereo) => stereo.pictures().1.into(),
        }
    }
}

impl Lattice {
    /// For a picture for two eyes, the rays of each eye's pixels, and the column and row of the first; `None`
    /// otherwise.
    pub(crate) fn halves(&self) -> Option<[(Self, (u32, u32)); 2]> {
        let stride = self.stride.max(1);
        // The index of the first ray at or beyond a pixel.
        let beyond = |pixel: u32, first: u32, count: u32| {
            pixel.saturating_sub(first).div_ceil(stride).min(count)
        };
        let halves = self.camera.halves()?;
        Some(halves.map(|(camera, rect)| {
            let (left, right) = (
                beyond(rect.x, self.x, self.columns),
                beyond(rect.right(), self.x, self.columns),
            );
            let (top, bottom) = (
                beyond(rect.y, self.y, self.rows),
                beyond(rect.bottom(), self.y, self.rows),
            );
            let half = Self {
                camera,
                x: self.x + left * stride,
                y: self.y + top * stride,
                columns: right - left,
                rows: bottom - top,
                ..*self
            };
            (half, (left, top))
        }))
    }
}

#[cfg(test)]
#[path = "eyes_tests.rs"]
mod tests;
