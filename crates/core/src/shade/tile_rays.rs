//! The rays of a tile's pixels, where colours depend on them.

use super::Shader;
use super::smooth::{Rows, Vectors};
use crate::camera::{PanoramaRays, Rect};
use crate::num::simd::{LANES, Lanes};

/// The rays of a tile's pixels, where they are worked out eight at a time.
pub(super) struct TileRays {
    /// Of a panorama in a mode whose colours depend on where the eye is.
    around: Option<PanoramaRays>,
    /// Column and row of the first pixel.
    first: (u32, u32),
}

impl TileRays {
    pub(super) fn new(shader: &Shader<'_>, rect: Rect) -> Self {
        Self {
            around: shader.looks_at_eyes().then(|| shader.rays(rect)).flatten(),
            first: (rect.x, rect.y),
        }
    }

    /// Unit vectors to the eye from what eight pixels of a row show.
    #[inline(always)]
    pub(super) fn to_eye<L: Lanes>(
        &self,
        lanes: L,
        shader: &Shader<'_>,
        (left, y): (u32, u32),
    ) -> Vectors<L> {
        match &self.around {
            Some(around) => {
                let to_eye = around.eight_to_eye(left - self.first.0, y - self.first.1);
                Vectors::load(lanes, &Rows(to_eye))
            }
            None => {
                let mut x = [0.0; LANES];
                for (lane, x) in x.iter_mut().enumerate() {
                    *x = left as f32 + lane as f32 + 0.5;
                }
                shader.eight_to_eye(lanes, (&x, y as f32 + 0.5))
            }
        }
    }
}
