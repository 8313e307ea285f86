//! Opacities of translucent surfaces at the hits of many rays.

use super::TileShader;
use super::hit_rows::HitRows;
use super::tile_rays::TileRays;
use super::translucent::{Translucent, shell};
use crate::camera::Lattice;
use crate::num::simd::{F32x8, LANES, Lanes, Work, dispatch};
use crate::{Hits, MISS};

impl TileShader<'_> {
    /// The opacities of the surfaces that a lattice's rays hit, row by row; those of misses may be anything.
    pub(crate) fn opacities(&mut self, lattice: &Lattice, hits: &Hits, opacities: &mut Vec<f32>) {
        opacities.clear();
        opacities.resize(lattice.len(), 1.0);
        let shader = self.shader();
        match shader.translucent() {
            Some(&Translucent::All(alpha)) if shader.eight_colors().is_some() => {
                let work = Shells {
                    tile: self,
                    alpha,
                    lattice,
                    hits,
                    opacities,
                };
                dispatch(shader.simd(), work);
            }
            Some(&Translucent::All(alpha)) => {
                for (at, opacity) in opacities.iter_mut().enumerate() {
                    *opacity = self.shell_at(alpha, lattice, hits, at);
                }
            }
            Some(Translucent::Blended(_)) => {
                for (hit, opacity) in hits.iter().zip(opacities) {
                    if hit.primitive != MISS {
                        *opacity = shader.alpha(&hit);
                    }
                }
            }
            None => {}
        }
    }

    /// The opacity of a shell at the hit of one of a lattice's rays.
    fn shell_at(&mut self, alpha: f32, lattice: &Lattice, hits: &Hits, at: usize) -> f32 {
        let hit = hits.get(at);
        if hit.primitive == MISS {
            return 1.0;
        }
        let at = at as u32;
        let (x, y) = lattice.place(at % lattice.columns, at / lattice.columns);
        let to_eye = self.shader().to_eye_at(x, y);
        let normal = self.facet(hit.primitive, x).normal_at(hit.u, hit.v);
        shell(alpha, normal.dot(to_eye).abs())
    }
}

/// The opacities of shells, eight at once: each lane computes what [`TileShader::shell_at`] does.
struct Shells<'t, 's, 'h> {
    tile: &'t mut TileShader<'s>,
    alpha: f32,
    lattice: &'h Lattice,
    hits: &'h Hits,
    opacities: &'h mut [f32],
}

impl Work for Shells<'_, '_, '_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            tile,
            alpha,
            lattice,
            hits,
            opacities,
        } = self;
        if alpha == 0.0 {
            return opacities.fill(0.0);
        }
        let shader = tile.shader();
        let rays = TileRays::new(shader, *lattice);
        let columns = lattice.columns as usize;
        let rows = HitRows::new(hits);
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        for row in 0..lattice.rows {
            let begin = row as usize * columns;
            let mut column = 0;
            while column + LANES <= columns {
                let (place, at) = ((column as u32, row), begin + column);
                let eight = rows.eight(at);
                column += LANES;
                if *eight.primitives == [MISS; LANES] {
                    continue;
                }
                let Some(out) = opacities.get_mut(at..).and_then(<[_]>::first_chunk_mut) else {
                    return;
                };
                let Some((normal, _)) = tile.normals_and_colors(lanes, &rays, place, &eight) else {
                    for (lane, out) in out.iter_mut().enumerate() {
                        *out = tile.shell_at(alpha, lattice, hits, at + lane);
                    }
                    continue;
                };
                let cosine = normal.dot(rays.to_eye(lanes, shader, place));
                let cosine = cosine.max(zero - cosine).min(one);
                let below = lanes.splat(alpha) + lanes.splat(1.0 - alpha) * cosine;
                (lanes.splat(alpha) / below).store(out);
            }
            let (rest, end) = (begin + column, begin + columns);
            for (at, opacity) in (rest..).zip(&mut opacities[rest..end]) {
                *opacity = tile.shell_at(alpha, lattice, hits, at);
            }
        }
    }
}
