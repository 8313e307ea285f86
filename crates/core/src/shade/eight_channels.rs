//! A picture's channels beside colours, eight samples of a row at once.

use super::TileShader;
use super::hit_rows::HitRows;
use super::smooth::Facets;
use crate::camera::Lattice;
use crate::hits::runs;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8, Work, dispatch};
use crate::{Hits, MISS};

/// Channels of samples that hit something, row by row; others stay as they are.
#[derive(Debug)]
pub(crate) struct Channels<'c> {
    pub(crate) depth: &'c mut [f32],
    pub(crate) object: &'c mut [u32],
    pub(crate) triangle: &'c mut [u32],
    pub(crate) normal: &'c mut [[f32; 3]],
    pub(crate) uv: &'c mut [[f32; 2]],
}

impl TileShader<'_> {
    /// The channels of the samples at a lattice's rays: what [`Shader::surface`](super::Shader::surface) says of their hits.
    pub(crate) fn channels(&mut self, lattice: &Lattice, hits: &Hits, channels: Channels<'_>) {
        let simd = self.shader().simd();
        let work = FillChannels {
            shader: self,
            lattice,
            hits,
            channels,
        };
        dispatch(simd, work);
    }
}

struct FillChannels<'t, 's, 'h, 'c> {
    shader: &'t mut TileShader<'s>,
    lattice: &'h Lattice,
    hits: &'h Hits,
    channels: Channels<'c>,
}

impl Work for FillChannels<'_, '_, '_, '_> {
    #[inline(always)]
    fn run(mut self, lanes: impl Lanes) {
        let columns = self.lattice.columns as usize;
        let has_many_eyes = self.shader.shader().has_many_eyes();
        let hits = HitRows::new(self.hits);
        for row in 0..self.lattice.rows as usize {
            let mut column = 0;
            while column + LANES <= columns && !has_many_eyes {
                self.eight(lanes, hits, row * columns + column);
                column += LANES;
            }
            for column in column..columns {
                self.one(column as u32, row as u32);
            }
        }
    }
}

impl FillChannels<'_, '_, '_, '_> {
    /// Those of one sample.
    fn one(&mut self, column: u32, row: u32) {
        let at = (row * self.lattice.columns + column) as usize;
        let hit = self.hits.get(at);
        if hit.is_miss() {
            return;
        }
        let (x, _) = self.lattice.place(column, row);
        let surface = self.shader.surface(hit.primitive, x);
        let (normal, uv) = surface.at(hit.u, hit.v);
        let channels = &mut self.channels;
        channels.depth[at] = hit.t;
        (channels.object[at], channels.triangle[at]) = (surface.object, surface.triangle);
        (channels.normal[at], channels.uv[at]) = (normal, uv);
    }

    /// Those of eight samples of a row, from a number on.
    #[inline(always)]
    fn eight(&mut self, lanes: impl Lanes, hits: HitRows<'_>, begin: usize) {
        let hits = hits.eight(begin);
        if *hits.primitives == [MISS; LANES] {
            return;
        }
        let zero = lanes.splat(0.0);
        let (mut objects, mut triangles) = ([0; LANES], [0; LANES]);
        let mut facets = Facets::none(lanes);
        let mut corners = [zero; 6];
        for run in runs(hits.primitives) {
            let surface = self.shader.surface(run.primitive, 0.0);
            let from = lanes.mask_from(run.first);
            from.store(surface.object, &mut objects);
            from.store(surface.triangle, &mut triangles);
            facets = facets.replaced(from, Facets::one(lanes, &surface.facet));
            let [a, b, c] = surface.facet.uvs.unwrap_or_default();
            let one = [a.x, b.x, c.x, a.y, b.y, c.y];
            for (corners, one) in corners.iter_mut().zip(one) {
                *corners = from.select(lanes.splat(one), *corners);
            }
        }
        let (u, v) = hits.load_weights(lanes);
        let w = lanes.splat(1.0) - u - v;
        let normal = facets.normal_at(lanes, u, v).store();
        let [ax, bx, cx, ay, by, cy] = corners;
        let (x, y) = (ax * w + bx * u + cx * v, ay * w + by * u + cy * v);
        let infinite = lanes.splat(f32::INFINITY);
        let is_finite = x.abs().lt(infinite) & y.abs().lt(infinite);
        let mut uv = [[0.0; LANES]; 2];
        for (uv, coordinate) in uv.iter_mut().zip([x, y]) {
            is_finite.select(coordinate, zero).store(uv);
        }
        let channels = &mut self.channels;
        for lane in 0..LANES {
            if hits.primitives[lane] != MISS {
                let at = begin + lane;
                channels.depth[at] = hits.t[lane];
                (channels.object[at], channels.triangle[at]) = (objects[lane], triangles[lane]);
                channels.normal[at] = normal.0.map(|row| row[lane]);
                channels.uv[at] = uv.map(|row| row[lane]);
            }
        }
    }
}
