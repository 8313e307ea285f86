//! Colours of triangles under flat light, eight at once.
//!
//! Where triangles are some pixels wide, a picture under flat light meets a new one every few samples, and its normal and
//! its light take longer than the samples. Here eight triangles get theirs in loops that the compiler vectorises, with the
//! bits of [`Shader::constant_color`].

use super::Shader;
use super::facet::{middle_to_eye, visible_normal};
use super::vectors::{Rows, Vectors};
use crate::num::simd::{LANES, Lanes, Work};
use crate::triangle::{CornerLanes, vectors_in_lane};
use glam::DVec3;

/// The colours of eight triangles, as [`Shader::constant_color`] gives them where [`Shader::has_flat_triangles`].
pub(super) struct FlatColors<'c, 's> {
    pub(super) shader: &'c Shader<'s>,
    pub(super) primitives: &'c [u32; LANES],
    pub(super) colors: &'c mut [[u8; 4]; LANES],
}

impl Work for FlatColors<'_, '_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            shader,
            primitives,
            colors,
        } = self;
        let corners = shader.accel().eight_corners::<true>(lanes, primitives);
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
                for (lane, &primitive) in primitives.iter().enumerate() {
                    let (object, number) = shader.accel().identify(primitive);
                    own.set(lane, shader.triangle_color(object, number, primitive));
                }
                Vectors::load(lanes, &own)
            }
        };
        let lit = own.times(light);
        shader.tables.encode_row(lanes, lit, colors);
    }
}

/// The unit normals of eight triangles, on the side of the eye, and the unit vectors to the eye.
struct Directions {
    normals: Rows,
    to_eye: Rows,
}

impl Directions {
    #[inline(always)]
    fn of(shader: &Shader<'_>, corners: &CornerLanes) -> Self {
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
