//! Colours of triangles under flat light, eight at once.
//!
//! Where triangles are some pixels wide, a picture under flat light meets a new one every few samples, and its normal
//! and its light take longer than the samples. Here eight triangles get theirs in loops that the compiler vectorises,
//! with the bits of [`Shader::constant_color`].

use super::Shader;
use super::facet::{middle_to_eye, visible_normal};
use super::triangle_cache::TriangleCache;
use super::vectors::{Rows, Vectors};
use crate::num::simd::{LANES, Lanes, Work};
use crate::triangle::{CornerLanes, vectors_in_lane};
use glam::DVec3;

/// Entries of the cache, 16 kilobytes: several for each triangle that 64 × 64 pixels show where triangles are a few
/// pixels wide. With 512 half of those that are computed ahead take the entries of others that come back.
const ENTRIES: usize = 2048;

/// The colours of triangles that neighbouring samples show.
pub(super) type TriangleColors = TriangleCache<[u8; 4], ENTRIES>;

/// Caches the colours of the first sample's triangle and of up to seven others that are not cached, where
/// [`Shader::has_flat_triangles`].
pub(super) struct LightTriangles<'t, 's> {
    pub(super) shader: &'s Shader<'s>,
    pub(super) known: &'t mut TriangleColors,
    /// Samples of a tile, from the first on that shows a triangle that is not cached.
    pub(super) samples: &'t [u32],
}

impl Work for LightTriangles<'_, '_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self { shader, known, .. } = self;
        let unknown = known.unknown(lanes, self.samples);
        let corners = (shader.accel()).eight_corners::<true>(lanes, &unknown.primitives);
        let Directions { normals, to_eye } = Directions::of(shader, &corners);
        let light = shader.light(
            lanes,
            Vectors::load(lanes, &normals),
            Vectors::load(lanes, &to_eye),
        );
        let own = match shader.only_color() {
            Some(color) => Vectors::splat(lanes, color),
            None => {
                let mut own = Rows::ZERO;
                for (lane, &primitive) in unknown.primitives.iter().enumerate() {
                    let (object, number) = shader.accel().identify(primitive);
                    own.set(lane, shader.triangle_color(object, number, primitive));
                }
                Vectors::load(lanes, &own)
            }
        };
        let mut colors = [[0; 4]; LANES];
        (shader.tables).encode_row(lanes, own.times(light), &mut colors);
        known.set_all(&unknown, &colors);
    }
}

/// The unit normals of eight triangles, on the side of the eye, and the unit vectors to the eye.
pub(super) struct Directions {
    pub(super) normals: Rows,
    to_eye: Rows,
}

impl Directions {
    #[inline(always)]
    pub(super) fn of(shader: &Shader<'_>, corners: &CornerLanes) -> Self {
        let mut directions = Self {
            normals: Rows::ZERO,
            to_eye: Rows::ZERO,
        };
        let (eye, forward) = (shader.eye(), shader.forward());
        // A loop for each kind of rays, so that neither has a branch.
        match shader.parallel() {
            None => {
                for lane in 0..LANES {
                    directions.set(corners, eye, (forward, None), lane);
                }
            }
            Some(_) => {
                for lane in 0..LANES {
                    directions.set(corners, eye, (forward, Some(forward)), lane);
                }
            }
        }
        directions
    }

    #[inline(always)]
    fn set(
        &mut self,
        corners: &CornerLanes,
        eye: DVec3,
        (forward, parallel): (DVec3, Option<DVec3>),
        lane: usize,
    ) {
        let [a, b, c] = vectors_in_lane(corners, lane);
        let from_eye = [a.as_dvec3() - eye, b.as_dvec3() - eye, c.as_dvec3() - eye];
        self.normals
            .set(lane, visible_normal(from_eye, forward, parallel));
        self.to_eye.set(lane, middle_to_eye(from_eye, parallel));
    }
}
