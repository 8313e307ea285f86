//! The places of a tile's samples, and directions from them to the eye.

use super::Shader;
use super::vectors::{Rows, Vectors};
use crate::camera::{Lattice, PanoramaRays};
use crate::num::simd::{LANES, Lanes};

/// The rays of a tile's samples.
pub(super) struct TileRays {
    lattice: Lattice,
    /// The rays of a panorama, in modes that depend on the direction to the eye.
    around: Option<PanoramaRays>,
}

impl TileRays {
    pub(super) fn new(shader: &Shader<'_>, lattice: Lattice) -> Self {
        let around = || PanoramaRays::new(&lattice);
        Self {
            around: shader.looks_at_eyes().then(around).flatten(),
            lattice,
        }
    }

    /// A ray's place in the picture, in pixels.
    pub(super) fn place(&self, column: u32, row: u32) -> (f64, f64) {
        self.lattice.place(column, row)
    }

    /// The x of the places of eight rays of a row.
    #[inline(always)]
    pub(super) fn eight_places(&self, column: u32, row: u32) -> [f64; LANES] {
        std::array::from_fn(|lane| self.lattice.place(column + lane as u32, row).0)
    }

    /// The y of a row's places.
    #[inline(always)]
    pub(super) fn row(&self, row: u32) -> f64 {
        self.lattice.place(0, row).1
    }

    /// The row of pixels in the picture that a row's samples belong to.
    #[inline(always)]
    pub(super) fn pixel_row(&self, row: u32) -> u32 {
        self.lattice.y + row * self.lattice.stride
    }

    /// The x of eight places, from a column on.
    #[inline(always)]
    pub(super) fn columns(&self, column: u32) -> [f64; LANES] {
        let stride = self.lattice.stride;
        let (first, step) = (
            f64::from(self.lattice.x + column * stride),
            f64::from(stride),
        );
        let mut all = [0.0; LANES];
        for (lane, x) in all.iter_mut().enumerate() {
            *x = first + lane as f64 * step + self.lattice.offset.0;
        }
        all
    }

    /// Unit vectors from eight samples of a row to the eye.
    #[inline(always)]
    pub(super) fn to_eye<L: Lanes>(
        &self,
        lanes: L,
        shader: &Shader<'_>,
        (column, row): (u32, u32),
    ) -> Vectors<L> {
        match &self.around {
            Some(around) => Vectors::load(lanes, &Rows(around.eight_to_eye(column, row))),
            None => {
                let places = self.columns(column);
                let mut x = [0.0; LANES];
                for (x, place) in x.iter_mut().zip(places) {
                    *x = place as f32;
                }
                shader.eight_to_eye(lanes, (&x, self.row(row) as f32))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, ImagePlane, Pose, Projection, Rect};
    use glam::DVec3;

    /// Adding the offset before the lane would round twice: at column 16,384 of a tile that begins below it.
    #[test]
    fn eight_places_are_those_of_their_columns() {
        let plane = ImagePlane::new(20_000, 100, 0.1).expect("a good plane");
        let pose = Pose::towards(DVec3::ZERO, DVec3::Z);
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let rect = Rect {
            x: 16_381,
            y: 7,
            width: 64,
            height: 2,
        };
        for sample in 0..256 {
            let mut lattice = camera.sub_camera(rect).lattice();
            lattice.offset = [257.0, 259.0]
                .map(|base| (f64::from(sample) + 0.5) / base)
                .into();
            lattice.stride = 1 << (sample % 4);
            let rays = TileRays {
                lattice,
                around: None,
            };
            for (lane, x) in (2..).zip(rays.columns(2)) {
                assert_eq!((x, rays.row(1)), lattice.place(lane, 1), "{sample} {lane}");
            }
        }
    }
}
