//! Projective textures: an image on the surfaces that the camera saw that took it (Segal, Korobkin, van Widenfelt,
//! Foran and Haeberli, "Fast Shadows and Lighting Effects Using Texture Mapping", 1992).

use crate::camera::{
    BrownConrady, Camera, ImagePlane, LensError, PlaneError, Pose, PoseError, Projection,
};
use crate::ranges::OutOfRange;
use crate::scene::{Photograph, Texture};
use glam::{DVec2, DVec3};

/// Why a [`Photograph`] is invalid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PhotographError {
    /// A pose without a view direction, or without an up direction.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// A lens with a coefficient that is not finite.
    #[error(transparent)]
    Lens(#[from] LensError),
    /// A field of view out of range for a plane.
    #[error(transparent)]
    Fov(#[from] OutOfRange),
    /// An eye too close to its target.
    #[error(transparent)]
    Plane(#[from] PlaneError),
}

impl Photograph {
    /// Checks the camera of a photograph.
    ///
    /// # Errors
    /// What is wrong with it, in one line.
    pub fn check(&self) -> Result<(), PhotographError> {
        self.camera().map(|_| ())
    }

    /// Its camera, with an image plane of [`SIDE`] × [`SIDE`] pixels.
    fn camera(&self) -> Result<Camera, PhotographError> {
        let Self {
            eye,
            target,
            up,
            fov,
            shift,
            lens,
        } = *self;
        let pose = Pose { eye, target, up };
        pose.check()?;
        let projection = match lens {
            Some(lens) => Projection::through(BrownConrady::new(lens)?),
            None => Projection::Perspective,
        };
        let fov = projection.check_fov(fov)?;
        let frame = projection.frame(fov, eye.distance(target));
        let plane = ImagePlane::new(SIDE, SIDE, frame / f64::from(SIDE))?;
        Ok(Camera::new(pose, projection, plane).shifted(shift))
    }
}

/// Columns and rows of the camera's image plane. Images have any size; the middle of each is the middle of this
/// plane.
const SIDE: u32 = 2;

/// The map from points of the scene to texture coordinates in a photograph.
#[derive(Clone, Copy, Debug)]
pub(in crate::shade) struct Photographed {
    camera: Camera,
    /// The point that points are relative to, in world space.
    origin: DVec3,
}

impl Photographed {
    /// For points relative to `origin`; `None` where the photograph is invalid.
    pub(in crate::shade) fn new(photograph: &Photograph, origin: DVec3) -> Option<Self> {
        let camera = photograph.camera().ok()?;
        Some(Self { camera, origin })
    }

    /// The camera's eye, in world space.
    pub(in crate::shade) fn eye(&self) -> DVec3 {
        self.camera.pose().eye
    }

    /// The texture coordinates of a point, inside or outside the frame; `None` behind the eye, and where the lens
    /// sees nothing.
    pub(in crate::shade) fn project(&self, point: DVec3, texture: &Texture) -> Option<DVec2> {
        let (x, y) = self.camera.project(self.origin + point)?;
        let side = f64::from(SIDE);
        Some(DVec2::new(
            (x / side - 0.5) / aspect(texture) + 0.5,
            1.0 - y / side,
        ))
    }

    /// The texture coordinates of a point in the frame, clamped to half a texel from the frame's border so that
    /// nothing beyond the image is read. `None` outside the frame.
    pub(in crate::shade) fn within(&self, point: DVec3, texture: &Texture) -> Option<DVec2> {
        let at = self.project(point, texture)?;
        let is_within = (0.0..=1.0).contains(&at.x) && (0.0..=1.0).contains(&at.y);
        let half = DVec2::new(
            0.5 / f64::from(texture.width()),
            0.5 / f64::from(texture.height()),
        );
        is_within.then(|| at.clamp(half, 1.0 - half))
    }

    /// The derivative of [`Photographed::project`] along a step; infinite or NaN where it is undefined.
    ///
    /// The point is λ·D from the eye, with D the direction through its pixel (x, y). As D changes by r from a pixel
    /// to the next on the right and by s to the one below, a step is λ·(r·dx + s·dy) + D·dλ; its products with s × D
    /// and D × r isolate dx and dy.
    pub(in crate::shade) fn along(&self, point: DVec3, step: DVec3, texture: &Texture) -> DVec2 {
        let point = self.origin + point;
        let Some((x, y)) = self.camera.project(point) else {
            return DVec2::NAN;
        };
        let direction = self.camera.direction(x, y);
        let [right, down] = self.camera.direction_slopes(x, y);
        let forward = self.camera.forward();
        let times = (point - self.eye()).dot(forward) / direction.dot(forward);
        let (for_x, for_y) = (down.cross(direction), direction.cross(right));
        let dx = step.dot(for_x) / (right.dot(for_x) * times);
        let dy = step.dot(for_y) / (down.dot(for_y) * times);
        DVec2::new(dx / aspect(texture), -dy) / f64::from(SIDE)
    }
}

/// Width by height.
fn aspect(texture: &Texture) -> f64 {
    f64::from(texture.width()) / f64::from(texture.height())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    const PHOTOGRAPH: Photograph = Photograph {
        eye: DVec3::new(3.0, 2.0, 4.0),
        target: DVec3::new(0.1, 0.2, 0.3),
        up: DVec3::Y,
        fov: 40.0,
        shift: [0.25, -0.125],
        lens: None,
    };

    const LENS: Option<[f64; 5]> = Some([-0.2, 0.05, 0.01, -0.02, 0.0]);

    fn texture() -> Texture {
        Texture::new(32, 16, vec![[255; 4]; 512]).expect("a good texture")
    }

    fn taken(photograph: &Photograph) -> Photographed {
        Photographed::new(photograph, DVec3::new(1.0, 0.0, -1.0)).expect("a camera")
    }

    /// The truth is a camera with the image's own pixels.
    #[test]
    fn points_lie_where_a_camera_shows_them() {
        let mut random = Random(3);
        for lens in [None, LENS] {
            let photograph = Photograph { lens, ..PHOTOGRAPH };
            let Photograph {
                eye, target, up, ..
            } = photograph;
            let projection = match lens {
                None => Projection::Perspective,
                Some(lens) => Projection::through(BrownConrady::new(lens).expect("a lens")),
            };
            let frame = projection.frame(40.0, eye.distance(target));
            let plane = ImagePlane::new(32, 16, frame / 16.0).expect("a plane");
            let pose = Pose { eye, target, up };
            let camera = Camera::new(pose, projection, plane).shifted(photograph.shift);
            let (taken, texture) = (taken(&photograph), texture());
            let mut seen = 0;
            for _ in 0..2000 {
                let point = random.point() * 3.0;
                let found = taken.project(point, &texture);
                let truth = camera.project(taken.origin + point);
                let Some((x, y)) = truth else {
                    assert_eq!(found, None);
                    continue;
                };
                let found = found.expect("coordinates");
                let truth = DVec2::new(x / 32.0, 1.0 - y / 16.0);
                // The shift is rounded to 2⁻²⁴ pixels; one picture has sixteen pixels a side and the other two.
                assert!(
                    (found - truth).length() < 1e-7 * truth.length().max(1.0),
                    "{found} {truth}"
                );
                let is_within = truth.clamp(DVec2::ZERO, DVec2::ONE) == truth;
                assert_eq!(taken.within(point, &texture).is_some(), is_within);
                seen += u32::from(is_within);
            }
            assert!(seen > 100, "{seen}");
        }
    }

    /// The truth is a difference over a millionth of a step in both directions.
    #[test]
    fn derivatives_are_differences() {
        let mut random = Random(5);
        for lens in [None, LENS] {
            let (taken, texture) = (taken(&Photograph { lens, ..PHOTOGRAPH }), texture());
            let mut compared = 0;
            for _ in 0..500 {
                let (point, step) = (random.point(), random.point());
                let by = 1e-6;
                let sides =
                    [1.0, -1.0].map(|side| taken.project(point + step * (side * by), &texture));
                let [Some(after), Some(before)] = sides else {
                    continue;
                };
                let truth = (after - before) / (2.0 * by);
                let found = taken.along(point, step, &texture);
                assert!(
                    (found - truth).length() < 1e-6 * truth.length().max(1.0),
                    "{found} {truth}"
                );
                compared += 1;
            }
            assert!(compared > 400, "{compared}");
        }
    }

    #[test]
    fn invalid_photograph_cameras_are_refused() {
        let told = |photograph: Photograph| photograph.check().expect_err("refused").to_string();
        let nowhere = told(Photograph {
            target: PHOTOGRAPH.eye,
            ..PHOTOGRAPH
        });
        assert!(
            nowhere.contains("expected a target away from the eye"),
            "{nowhere}"
        );
        let wide = told(Photograph {
            fov: 180.0,
            ..PHOTOGRAPH
        });
        assert!(wide.contains("180"), "{wide}");
        let lens = told(Photograph {
            lens: Some([f64::NAN; 5]),
            ..PHOTOGRAPH
        });
        assert!(lens.contains("lens coefficients"), "{lens}");
        assert_eq!(PHOTOGRAPH.check(), Ok(()));
    }
}
