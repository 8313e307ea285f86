use super::{Camera, Ray};

/// Rays of one camera at regular places: through every `stride`-th pixel of a rectangle, from its
/// top left, all at the same place in their pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Whose rays.
    pub camera: Camera,
    /// The first ray's column in the full picture.
    pub x: u32,
    /// The first ray's row in the full picture.
    pub y: u32,
    /// From one ray's pixel to the next one's, along both sides; at least 1.
    pub stride: u32,
    /// Rays in a row.
    pub columns: u32,
    /// Rows of rays.
    pub rows: u32,
    /// The rays' place in their pixels, from the top left: (½, ½) is the middle.
    pub offset: (f64, f64),
}

impl Lattice {
    /// Where a ray of the lattice goes through the full picture, in pixels.
    pub fn place(&self, column: u32, row: u32) -> (f64, f64) {
        (
            f64::from(self.x + column * self.stride) + self.offset.0,
            f64::from(self.y + row * self.stride) + self.offset.1,
        )
    }

    /// A ray of the lattice: the camera's at that place, or that of the eye whose pixel it is of.
    pub fn ray(&self, column: u32, row: u32) -> Ray {
        let (x, y) = self.place(column, row);
        if self.camera.stereo().is_some() {
            let pixel = |first: u32, count: u32| f64::from(first + count * self.stride);
            let (x_of_pixel, y_of_pixel) = (pixel(self.x, column), pixel(self.y, row));
            return self.camera.of_half(x_of_pixel, y_of_pixel).ray(x, y);
        }
        self.camera.ray(x, y)
    }

    /// How many rays it has.
    pub fn len(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.columns == 0 || self.rows == 0
    }
}
