//! Textures on eight samples of a row at once.

use super::TileShader;
use super::facet::Mapping;
use super::hit_rows::EightHits;
use super::row_textures::Textured;
use super::sample::sample_eight;
use super::texture::triplanar::Triplanar;
use super::tile_rays::TileRays;
use super::vectors::{Row, Vectors};
use crate::hits::runs;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use glam::Vec3;

/// Where eight samples read their texture: at one place each, or at one a side.
#[derive(Default)]
struct TexturePoints {
    count: usize,
    weights: [Row; 3],
    uv: [[[f64; LANES]; 2]; 3],
}

impl TexturePoints {
    /// Between texture coordinates at the corners, as [`Texturing::sampled`](super::texture::texturing::Texturing::sampled) has it.
    #[inline(always)]
    fn set_uv<F: F32x8>(&mut self, corners: &[F; 18], (u, v): (&Row, &Row)) {
        let mut all = [[0.0; LANES]; 6];
        for (all, corners) in all.iter_mut().zip(corners) {
            corners.store(all);
        }
        let [ax, ay, bx, by, cx, cy] = all;
        for (coordinates, [a, b, c]) in self.uv[0].iter_mut().zip([[ax, bx, cx], [ay, by, cy]]) {
            for lane in 0..LANES {
                let [a, b, c] = [a[lane], b[lane], c[lane]].map(f64::from);
                let (u, v) = (f64::from(u[lane]), f64::from(v[lane]));
                coordinates[lane] = a + (b - a) * u + (c - a) * v;
            }
        }
        self.weights[0] = [1.0; LANES];
        self.count = 1;
    }

    /// [`Triplanar::sides`] between corners and normals.
    #[inline(always)]
    fn set_triplanar<L: Lanes>(
        &mut self,
        lanes: L,
        triplanar: &Triplanar,
        corners: &[L::F32; 18],
        (u, v): (&Row, &Row),
    ) {
        let [ax, ay, az, bx, by, bz, cx, cy, cz, rest @ ..] = *corners;
        let [dx, dy, dz, ex, ey, ez, fx, fy, fz] = rest;
        let corners = [[ax, ay, az], [bx, by, bz], [cx, cy, cz]];
        let normals = [[dx, dy, dz], [ex, ey, ez], [fx, fy, fz]];
        let weights = [lanes.load(u), lanes.load(v)];
        let (weights, sides) = triplanar.eight_sides(lanes, corners, normals, weights);
        self.weights = weights.store().0;
        self.uv = sides;
        self.count = 3;
    }
}

impl TileShader<'_> {
    /// The surfaces' own colours mixed with their textures, in linear light.
    ///
    /// At once where all that have a texture have the same one, shown and mapped in the same way, by texture coordinates or from three
    /// sides, and without a footprint; else sample by sample.
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
        let zero = lanes.splat(0.0);
        let mut found = None;
        let mut is_shared = !shader.filter().has_footprint() && hits.weights.is_some();
        let mut is_textured = zero;
        let mut corners = [zero; 18];
        for run in runs(lanes, hits.primitives) {
            let facet = self.facet(run.primitive, 0.0);
            let from = lanes.mask_from(run.first);
            let mut textured = 0.0;
            let one = Textured::of(shader, facet);
            if let (Some(mapping), Some(_)) = (&facet.texture, one) {
                is_shared &= found.is_none() | Textured::are_same(found, one);
                is_shared &= facet.blends.is_none();
                found = one;
                textured = 1.0;
                match mapping {
                    Mapping::Uv(uvs) => {
                        let one = uvs.map(|uv| uv.to_array());
                        for (corners, one) in corners.iter_mut().zip(one.as_flattened()) {
                            *corners = from.select(lanes.splat(*one), *corners);
                        }
                    }
                    Mapping::Triplanar([a, b, c], [d, e, f]) => {
                        let one = [a, b, c, d, e, f].map(|vector| vector.to_array());
                        for (corners, one) in corners.iter_mut().zip(one.as_flattened()) {
                            *corners = from.select(lanes.splat(*one), *corners);
                        }
                    }
                    Mapping::Placed(_) | Mapping::Photographed(_) => is_shared = false,
                }
            }
            is_textured = from.select(lanes.splat(textured), is_textured);
        }
        let Some(found) = found else {
            return own;
        };
        let (true, Some(weights)) = (is_shared, hits.weights) else {
            let colors = self.one_by_one(rays, place, hits, |facet, place, hit| {
                shader.surface_color(facet, || place, hit)
            });
            return Vectors::load(lanes, &colors);
        };
        let mut sides = TexturePoints::default();
        match found.triplanar {
            None => sides.set_uv(&corners, weights),
            Some(triplanar) => sides.set_triplanar(lanes, triplanar, &corners, weights),
        }
        let mut texel = Vectors::splat(lanes, Vec3::ZERO);
        let mut alpha = zero;
        for side in 0..sides.count {
            let weight = lanes.load(&sides.weights[side]);
            if zero.lt(weight).bits() == 0 {
                continue;
            }
            let uv = &sides.uv[side];
            let (color, opacity) =
                sample_eight(lanes, shader.tables, found.texture, uv, shader.filter());
            texel = texel.plus(color.scaled(weight));
            alpha = alpha + opacity * weight;
        }
        let blend = lanes.splat(shader.blend());
        let texel = match found.is_tinted {
            true => texel.times(own),
            false => texel,
        };
        let rest = lanes.splat(1.0) - alpha * blend;
        let mixed = own.scaled(rest).plus(texel.scaled(blend));
        own.replaced(zero.lt(is_textured), mixed)
    }
}
