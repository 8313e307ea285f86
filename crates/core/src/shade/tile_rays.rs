//! The rays of a tile's samples, where colours depend on them.

use super::Shader;
use super::smooth::{Rows, Vectors};
use crate::camera::{Lattice, PanoramaRays};
use crate::num::simd::{LANES, Lanes};

/// The rays of a tile's samples, one a pixel.
pub(super) struct TileRays {
    lattice: Lattice,
    /// Of a panorama in a mode whose colours depend on where the eye is.
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

    /// The distance of a row's places from the picture's top.
    #[inline(always)]
    pub(super) fn row(&self, row: u32) -> f64 {
        self.lattice.place(0, row).1
    }

    /// The row of the picture's pixels that a row's rays belong to.
    #[inline(always)]
    pub(super) fn pixel_row(&self, row: u32) -> u32 {
        self.lattice.y + row
    }

    /// The distances from the picture's left of eight places, from a column on.
    #[inline(always)]
    pub(super) fn columns(&self, column: u32) -> [f64; LANES] {
        let first = f64::from(self.lattice.x + column);
        let mut all = [0.0; LANES];
        for (lane, x) in all.iter_mut().enumerate() {
            *x = first + lane as f64 + self.lattice.offset.0;
        }
        all
    }

    /// Unit vectors to the eye from what eight rays of a row hit.
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
