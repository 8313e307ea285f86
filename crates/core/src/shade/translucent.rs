//! Surfaces that let through what lies behind them: layer over layer, from front to back.
//!
//! A sample's colour is the sum of aᵢ·tᵢ·cᵢ over the ray's hits i = 1, 2, … in exact order, and of t·background, with
//! t₁ = 1 and tᵢ₊₁ = tᵢ·(1 − aᵢ) (Porter and Duff, "Compositing Digital Images", 1984: over), in linear light. cᵢ is the
//! layer's own colour, lit by itself. The sum ends where t is below [`SEEN`], and after 256 layers.
//!
//! * **X-ray.** aᵢ = α / (α + (1 − α)·|cos θᵢ|), θᵢ between the ray and the shading normal, α the picture's: a thin shell
//!   covers α where it is seen from above, and ever more the longer the way through it.
//! * **Blended materials.** aᵢ is the material's alpha; other surfaces cover all. No refraction, and no thickness.

use super::hit_rows::HitRows;
use super::tile_rays::TileRays;
use super::{Mode, Shading, TileShader};
use crate::bvh::Accel;
use crate::camera::Lattice;
use crate::num::simd::{F32x8, LANES, Lanes, Work, dispatch};
use crate::scene::{Opacity, Scene};
use crate::{Hits, MISS};

/// The remaining transparency below which no further layer is searched: in an 8-bit picture it is at most a sixteenth
/// of a step of the lightest colours, and a step of black. With a smaller value more rays are cast for nothing
/// visible.
pub(crate) const SEEN: f32 = 1.0 / 4096.0;

/// The translucent surfaces of a picture, and their opacity.
#[derive(Clone, Debug)]
pub(crate) enum Translucent {
    /// All surfaces, with at least this opacity.
    All(f32),
    /// Surfaces with blended materials; for each object, whether it has any.
    Blended(Vec<bool>),
}

impl Translucent {
    /// `None` where all surfaces are opaque, and in modes that show properties of hits rather than surfaces.
    pub(super) fn of(scene: &Scene, shading: &Shading) -> Option<Self> {
        match shading.mode {
            Mode::XRay => Some(Self::All(shading.x_ray_opacity.clamp(0.0, 1.0))),
            mode if mode.shows().surfaces => scene
                .objects_whose(|opacity| matches!(opacity, Opacity::Blend(_)))
                .map(Self::Blended),
            _ => None,
        }
    }

    /// Whether a triangle lets what lies behind it show.
    pub(crate) fn shows_through(&self, scene: &Scene, accel: &Accel, primitive: u32) -> bool {
        let Self::Blended(has_any) = self else {
            return true;
        };
        let (object, triangle) = accel.identify(primitive);
        let number = object as usize;
        let mesh = &scene.objects[number].mesh;
        has_any[number] && matches!(mesh.opacity(triangle), Opacity::Blend(_))
    }
}

/// The opacity, at an angle with this cosine, of a thin shell whose opacity is `alpha` seen perpendicularly.
fn shell(alpha: f32, cosine: f32) -> f32 {
    if alpha == 0.0 {
        return 0.0;
    }
    alpha / (alpha + (1.0 - alpha) * cosine.min(1.0))
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shells_cover_more_the_longer_the_way_through_them() {
        assert_eq!(shell(0.25, 1.0), 0.25);
        assert_eq!(shell(0.25, 0.0), 1.0);
        assert_eq!((shell(0.0, 0.0), shell(1.0, 0.3)), (0.0, 1.0));
        let covers: Vec<f32> = (0..=10)
            .map(|tenth| shell(0.2, tenth as f32 / 10.0))
            .collect();
        assert!(covers.is_sorted_by(|near, far| near > far));
    }
}
