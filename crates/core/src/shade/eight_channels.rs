//! A picture's channels beside colours, eight samples of a row at once.

use super::TileShader;
use super::hit_rows::HitRows;
use super::smooth::Facets;
use super::spans::{COLUMNS, spans, store_eight};
use super::vectors::{Row, Rows};
use crate::camera::Lattice;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8, Work, dispatch};
use crate::{Hits, MISS};
use std::ops::Range;

/// Channels of samples, row by row.
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
        let width = self.lattice.columns as usize;
        let has_many_eyes = self.shader.shader().has_many_eyes();
        let hits = HitRows::new(self.hits);
        self.channels.depth.copy_from_slice(hits.t);
        for row in 0..self.lattice.rows as usize {
            for left in (0..width).step_by(COLUMNS) {
                let begin = row * width + left;
                let primitives = hits.row(begin, COLUMNS.min(width - left));
                for span in spans(primitives) {
                    let samples = begin + span.first..begin + span.end;
                    if span.primitive == MISS {
                        self.misses(samples);
                    } else if has_many_eyes {
                        self.one_by_one(samples);
                    } else {
                        self.span(lanes, span.primitive, samples);
                    }
                }
            }
        }
    }
}

impl FillChannels<'_, '_, '_, '_> {
    /// Samples that hit nothing.
    #[inline(always)]
    fn misses(&mut self, samples: Range<usize>) {
        let channels = &mut self.channels;
        channels.object[samples.clone()].fill(u32::MAX);
        channels.triangle[samples.clone()].fill(u32::MAX);
        channels.normal[samples.clone()].fill([0.0; 3]);
        channels.uv[samples].fill([0.0; 2]);
    }

    /// Samples of one triangle, where each column has an eye of its own.
    fn one_by_one(&mut self, samples: Range<usize>) {
        for at in samples {
            let hit = self.hits.get(at);
            let column = at as u32 % self.lattice.columns;
            let (x, _) = self.lattice.place(column, 0);
            let surface = self.shader.surface(hit.primitive, x);
            let (normal, uv) = surface.at(hit.u, hit.v);
            let channels = &mut self.channels;
            (channels.object[at], channels.triangle[at]) = (surface.object, surface.triangle);
            (channels.normal[at], channels.uv[at]) = (normal, uv);
        }
    }

    /// Samples of one triangle, eight at a time. The last eight may reach beyond them, into samples that are still to
    /// come.
    #[inline(always)]
    fn span(&mut self, lanes: impl Lanes, primitive: u32, samples: Range<usize>) {
        let surface = self.shader.surface(primitive, 0.0);
        let channels = &mut self.channels;
        channels.object[samples.clone()].fill(surface.object);
        channels.triangle[samples.clone()].fill(surface.triangle);
        let facet = &surface.facet;
        if facet.normals.is_none() {
            channels.normal[samples.clone()].fill(facet.normal.to_array());
        }
        if facet.uvs.is_none() {
            channels.uv[samples.clone()].fill([0.0; 2]);
        }
        if facet.normals.is_none() && facet.uvs.is_none() {
            return;
        }
        let facets = Facets::one(lanes, facet);
        let infinite = lanes.splat(f32::INFINITY);
        let mut at = samples.start;
        while at < samples.end {
            let (u, v) = (eight_of(&self.hits.u, at), eight_of(&self.hits.v, at));
            let (u, v) = (lanes.load(&u), lanes.load(&v));
            if facet.normals.is_some() {
                let Rows([x, y, z]) = facets.normal_at(lanes, u, v).store();
                let mut all = [[0.0; 3]; LANES];
                for (lane, normal) in all.iter_mut().enumerate() {
                    *normal = [x[lane], y[lane], z[lane]];
                }
                store_eight(channels.normal, at, &all);
            }
            if let Some([a, b, c]) = facet.uvs {
                let w = lanes.splat(1.0) - u - v;
                let (ax, bx, cx) = (lanes.splat(a.x), lanes.splat(b.x), lanes.splat(c.x));
                let (ay, by, cy) = (lanes.splat(a.y), lanes.splat(b.y), lanes.splat(c.y));
                let (x, y) = (ax * w + bx * u + cx * v, ay * w + by * u + cy * v);
                let is_finite = x.abs().lt(infinite) & y.abs().lt(infinite);
                let [mut xs, mut ys] = [[0.0; LANES]; 2];
                is_finite.select(x, lanes.splat(0.0)).store(&mut xs);
                is_finite.select(y, lanes.splat(0.0)).store(&mut ys);
                let mut all = [[0.0; 2]; LANES];
                for (lane, uv) in all.iter_mut().enumerate() {
                    *uv = [xs[lane], ys[lane]];
                }
                store_eight(channels.uv, at, &all);
            }
            at += LANES;
        }
    }
}

/// Eight numbers from a place on; zeros beyond the last.
#[inline(always)]
fn eight_of(numbers: &[f32], at: usize) -> Row {
    match numbers.get(at..).and_then(<[f32]>::first_chunk) {
        Some(eight) => *eight,
        None => {
            let mut eight = [0.0; LANES];
            for (one, number) in eight.iter_mut().zip(numbers.iter().skip(at)) {
                *one = *number;
            }
            eight
        }
    }
}
