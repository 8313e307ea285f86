use super::{Camera, Lattice, Rect};

/// A camera over one rectangle of the full camera's image plane: the same eye, orientation and focal length, with an
/// off-axis field of view of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubCamera {
    /// The full camera.
    pub camera: Camera,
    /// Its rectangle in the full picture.
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
    /// A part of it, given by a rectangle of its own pixels; the rays remain the full camera's.
    pub fn part(&self, rect: Rect) -> Self {
        let rect = Rect {
            x: self.rect.x + rect.x,
            y: self.rect.y + rect.y,
            ..rect
        };
        Self { rect, ..*self }
    }

    /// The rays through the centres of its pixels.
    pub fn lattice(&self) -> Lattice {
        self.sparse_lattice(1, (0, 0))
    }

    /// The rays through the centres of every `stride`-th pixel in both directions, starting `phase` pixels from its
    /// top left corner. A stride of zero counts as one.
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
}
