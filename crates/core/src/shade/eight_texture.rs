//! Textures on eight samples of a row at once.

use super::TileShader;
use super::eight::EightHits;
use super::facet::Mapping;
use super::sample::sample_eight;
use super::smooth::{Rows, Vectors};
use super::tile_rays::TileRays;
use crate::MISS;
use crate::hits::runs;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use crate::scene::Texture;

impl TileShader<'_> {
    /// The surfaces' own colours mixed with their textures, in linear light.
    ///
    /// At once where all that have a texture have the same one, mapped by texture coordinates, and without a footprint;
    /// else sample by sample.
    #[inline(always)]
    pub(super) fn textured<L: Lanes>(
        &mut self,
        lanes: L,
        rays: &TileRays,
        place: (u32, u32),
        hits: &EightHits<'_>,
        own: Vectors<L>,
    ) -> Vectors<L> {
        let shader = self.shader();
        let filter = shader.filter();
        let mut texture: Option<&Texture> = None;
        let mut alone = filter.has_footprint() || hits.weights.is_none();
        let zero = lanes.splat(0.0);
        let (mut is_textured, mut is_tinted) = (zero, zero);
        let mut corners = [zero; 6];
        for run in runs(hits.primitives) {
            let facet = self.facet(run.primitive, 0.0);
            let from = lanes.mask_from(run.first);
            let mut textured = 0.0;
            if let (Some(mapping), Some(its)) = (&facet.texture, shader.texture_on(facet)) {
                alone |= texture.is_some_and(|texture| !std::ptr::eq(texture, its));
                texture = Some(its);
                textured = 1.0;
                match mapping {
                    Mapping::Uv([a, b, c]) if facet.blends.is_none() => {
                        let one = [a.x, a.y, b.x, b.y, c.x, c.y];
                        for (corners, one) in corners.iter_mut().zip(one) {
                            *corners = from.select(lanes.splat(one), *corners);
                        }
                    }
                    _ => alone = true,
                }
            }
            is_textured = from.select(lanes.splat(textured), is_textured);
            let tinted = if facet.is_tinted { 1.0 } else { 0.0 };
            is_tinted = from.select(lanes.splat(tinted), is_tinted);
        }
        let Some(texture) = texture else {
            return own;
        };
        let (false, Some((u, v))) = (alone, hits.weights) else {
            return self.textured_one_by_one(lanes, rays, place, hits);
        };
        let mut all = [[0.0; LANES]; 6];
        for (all, corners) in all.iter_mut().zip(corners) {
            corners.store(all);
        }
        let [ax, ay, bx, by, cx, cy] = all.map(|all| all.map(f64::from));
        let mut uv = [[0.0; LANES]; 2];
        for lane in 0..LANES {
            let (u, v) = (f64::from(u[lane]), f64::from(v[lane]));
            uv[0][lane] = ax[lane] + (bx[lane] - ax[lane]) * u + (cx[lane] - ax[lane]) * v;
            uv[1][lane] = ay[lane] + (by[lane] - ay[lane]) * u + (cy[lane] - ay[lane]) * v;
        }
        let (texel, alpha) = sample_eight(lanes, shader.tables, texture, &uv, filter);
        let blend = lanes.splat(shader.blend());
        let texel = texel.replaced(zero.lt(is_tinted), texel.times(own));
        let mixed = own
            .scaled(lanes.splat(1.0) - alpha * blend)
            .plus(texel.scaled(blend));
        own.replaced(zero.lt(is_textured), mixed)
    }

    /// [`TileShader::textured`] of any textures.
    #[inline(always)]
    fn textured_one_by_one<L: Lanes>(
        &mut self,
        lanes: L,
        rays: &TileRays,
        (column, row): (u32, u32),
        hits: &EightHits<'_>,
    ) -> Vectors<L> {
        let mut each = Rows::ZERO;
        self.each_surface_color(rays, (column, row), hits, &mut each);
        Vectors::load(lanes, &each)
    }

    #[inline(never)]
    fn each_surface_color(
        &mut self,
        rays: &TileRays,
        (column, row): (u32, u32),
        hits: &EightHits<'_>,
        each: &mut Rows,
    ) {
        let shader = self.shader();
        for lane in 0..LANES {
            let hit = hits.get(lane);
            if hit.primitive != MISS {
                let facet = self.facet(hit.primitive, 0.0);
                let place = || rays.place(column + lane as u32, row);
                each.set(lane, shader.surface_color(facet, place, &hit));
            }
        }
    }
}
