use super::{Camera, Ray, Rect};

/// Rays of one camera at regular places: through every `stride`-th pixel of a rectangle, from its top left, all at
/// the same offset within their pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// The camera of the rays.
    pub camera: Camera,
    /// The first ray's column in the full picture.
    pub x: u32,
    /// The first ray's row in the full picture.
    pub y: u32,
    /// The distance between the pixels of neighbouring rays, in both directions; at least 1.
    pub stride: u32,
    /// Rays in a row.
    pub columns: u32,
    /// Rows of rays.
    pub rows: u32,
    /// The offset of the rays within their pixels, from the top left: (½, ½) is the centre.
    pub offset: (f64, f64),
}

impl Lattice {
    /// The place of a ray in the full picture, in pixels. Meaningless for a ray so far beyond the lattice that
    /// its pixel does not fit 32 bits.
    pub fn place(&self, column: u32, row: u32) -> (f64, f64) {
        (
            self.pixel(self.x, column) + self.offset.0,
            self.pixel(self.y, row) + self.offset.1,
        )
    }

    /// The pixel of a column or row. Rows are filled up to a multiple of eight rays; with a great stride, columns
    /// that fill them do not fit 32 bits.
    #[inline(always)]
    fn pixel(&self, first: u32, count: u32) -> f64 {
        f64::from(first.wrapping_add(count.wrapping_mul(self.stride)))
    }

    /// A ray of the lattice: the camera's ray at that place; in a picture for two eyes, of the eye that the pixel
    /// belongs to.
    pub fn ray(&self, column: u32, row: u32) -> Ray {
        let (x, y) = self.place(column, row);
        if self.camera.stereo().is_some() {
            let (x_of_pixel, y_of_pixel) = (self.pixel(self.x, column), self.pixel(self.y, row));
            return self.camera.of_half(x_of_pixel, y_of_pixel).ray(x, y);
        }
        self.camera.ray(x, y)
    }

    /// The number of rays.
    pub fn len(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// The rays of a rectangle of it, given as its columns and rows.
    pub(crate) fn part(&self, rays: Rect) -> Self {
        Self {
            x: self.x + rays.x * self.stride,
            y: self.y + rays.y * self.stride,
            columns: rays.width,
            rows: rays.height,
            ..*self
        }
    }

    /// Whether it has no rays.
    pub fn is_empty(&self) -> bool {
        self.columns == 0 || self.rows == 0
    }
}
