use super::{Camera, Lattice, Ray, Rect};
use crate::math;

/// A camera over one rectangle of the full camera's image plane: same eye, same orientation, same
/// focal length, and a field of view of its own, off the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubCamera {
    /// The full camera.
    pub camera: Camera,
    /// Its rectangle of the full picture.
    pub rect: Rect,
}

impl Camera {
    /// The sub-camera over a rectangle of the full picture.
    pub fn sub_camera(self, rect: Rect) -> SubCamera {
        SubCamera { camera: self, rect }
    }

    /// The camera as a sub-camera over the whole picture.
    pub fn whole(self) -> SubCamera {
        let plane = self.plane();
        self.sub_camera(Rect {
            x: 0,
            y: 0,
            width: plane.columns,
            height: plane.rows,
        })
    }
}

impl SubCamera {
    /// A part of it, by the part's rectangle of its own pixels: the full camera's rays still.
    pub fn part(&self, rect: Rect) -> Self {
        let rect = Rect {
            x: self.rect.x + rect.x,
            y: self.rect.y + rect.y,
            ..rect
        };
        Self { rect, ..*self }
    }

    /// The rays through the middles of its pixels.
    pub fn lattice(&self) -> Lattice {
        self.sparse_lattice(1, (0, 0))
    }

    /// The rays through the middles of every `stride`-th pixel along both sides, beginning `phase` pixels
    /// from its top left corner. A stride of zero counts as one.
    pub fn sparse_lattice(&self, stride: u32, phase: (u32, u32)) -> Lattice {
        let stride = stride.max(1);
        let count = |length: u32, phase: u32| length.saturating_sub(phase).div_ceil(stride);
        Lattice {
            camera: self.camera,
            x: self.rect.x + phase.0,
            y: self.rect.y + phase.1,
            stride,
            columns: count(self.rect.width, phase.0),
            rows: count(self.rect.height, phase.1),
            offset: (0.5, 0.5),
        }
    }

    /// The ray through (x, y) of its own rectangle: the full camera's ray at that place.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        self.camera
            .ray(x + f64::from(self.rect.x), y + f64::from(self.rect.y))
    }

    /// The angles in degrees from the view axis to its left, right, bottom and top edges,
    /// positive to the right and up: the off-axis field of view. Zero for orthographic cameras.
    pub fn field_of_view(&self) -> [f64; 4] {
        let plane = self.camera.plane();
        if self.camera.fov_degrees().is_none() {
            return [0.0; 4];
        }
        let angle =
            |pixels: f64| math::atan(pixels * plane.step / self.camera.distance()).to_degrees();
        let (half_width, half_height) =
            (f64::from(plane.columns) * 0.5, f64::from(plane.rows) * 0.5);
        [
            angle(f64::from(self.rect.x) - half_width),
            angle(f64::from(self.rect.right()) - half_width),
            angle(half_height - f64::from(self.rect.bottom())),
            angle(half_height - f64::from(self.rect.y)),
        ]
    }
}
