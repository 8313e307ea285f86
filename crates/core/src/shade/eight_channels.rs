//! A picture's channels beside colours, eight samples of a row at once.

use super::TileShader;
use super::facet::SurfaceTriangle;
use super::hit_rows::HitRows;
use super::smooth::Facets;
use super::spans::{COLUMNS, spans, store_eight};
use super::vectors::{Row, Rows};
use crate::camera::Lattice;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8, Work, dispatch};
use crate::{Hits, MISS, PrimitiveHit};
use std::ops::Range;

/// Channels of a row's samples.
#[derive(Debug)]
pub(crate) struct Channels<'c> {
    pub(crate) depth: &'c mut [f32],
    pub(crate) object: &'c mut [u32],
    pub(crate) triangle: &'c mut [u32],
    pub(crate) normal: &'c mut [[f32; 3]],
    pub(crate) uv: &'c mut [[f32; 2]],
}

impl Channels<'_> {
    /// Those of samples that hit nothing.
    pub(crate) fn fill_with_misses(&mut self) {
        self.depth.fill(PrimitiveHit::NONE.t);
        self.misses(0..self.object.len());
    }

    /// Those of some samples that hit nothing, but for depths.
    #[inline(always)]
    fn misses(&mut self, samples: Range<usize>) {
        self.object[samples.clone()].fill(u32::MAX);
        self.triangle[samples.clone()].fill(u32::MAX);
        self.normal[samples.clone()].fill([0.0; 3]);
        self.uv[samples].fill([0.0; 2]);
    }

    /// One sample's, but for its depth.
    fn one(&mut self, at: usize, surface: &SurfaceTriangle, hit: &PrimitiveHit) {
        (self.object[at], self.triangle[at]) = (surface.object, surface.triangle);
        (self.normal[at], self.uv[at]) = surface.at(hit.u, hit.v);
    }

    /// Those of samples of one triangle, but for depths, eight at a time: `weights` are u and v of the row's samples. The
    /// last eight may reach beyond them, into samples that are still to come.
    #[inline(always)]
    fn span(
        &mut self,
        lanes: impl Lanes,
        surface: &SurfaceTriangle,
        weights: [&[f32]; 2],
        samples: Range<usize>,
    ) {
        let facet = &surface.facet;
        let facets = Facets::one(lanes, facet);
        for at in samples.step_by(LANES) {
            store_eight(self.object, at, &[surface.object; LANES]);
            store_eight(self.triangle, at, &[surface.triangle; LANES]);
            if facet.normals.is_none() {
                store_eight(self.normal, at, &[facet.normal.to_array(); LANES]);
            }
            if facet.uvs.is_none() {
                store_eight(self.uv, at, &[[0.0; 2]; LANES]);
            }
            if facet.normals.is_none() && facet.uvs.is_none() {
                continue;
            }
            let [u, v] = weights;
            let (u, v) = (lanes.load(&eight_of(u, at)), lanes.load(&eight_of(v, at)));
            if facet.normals.is_some() {
                let Rows([x, y, z]) = facets.normal_at(lanes, u, v).store();
                let mut all = [[0.0; 3]; LANES];
                for (lane, normal) in all.iter_mut().enumerate() {
                    *normal = [x[lane], y[lane], z[lane]];
                }
                store_eight(self.normal, at, &all);
            }
            if let Some([a, b, c]) = facet.uvs {
                let w = lanes.splat(1.0) - u - v;
                let (ax, bx, cx) = (lanes.splat(a.x), lanes.splat(b.x), lanes.splat(c.x));
                let (ay, by, cy) = (lanes.splat(a.y), lanes.splat(b.y), lanes.splat(c.y));
                let (x, y) = (ax * w + bx * u + cx * v, ay * w + by * u + cy * v);
                let infinite = lanes.splat(f32::INFINITY);
                let is_finite = x.abs().lt(infinite) & y.abs().lt(infinite);
                let [mut xs, mut ys] = [[0.0; LANES]; 2];
                is_finite.select(x, lanes.splat(0.0)).store(&mut xs);
                is_finite.select(y, lanes.splat(0.0)).store(&mut ys);
                let mut all = [[0.0; 2]; LANES];
                for (lane, uv) in all.iter_mut().enumerate() {
                    *uv = [xs[lane], ys[lane]];
                }
                store_eight(self.uv, at, &all);
            }
        }
    }
}

impl TileShader<'_> {
    /// The channels of the samples at a lattice's rays, whose rows `rows` gives: what
    /// [`Shader::surface`](super::Shader::surface) says of their hits.
    pub(crate) fn channels<'c>(
        &mut self,
        lattice: &Lattice,
        hits: &Hits,
        rows: impl Iterator<Item = Channels<'c>>,
    ) {
        let simd = self.shader().simd();
        let work = FillChannels {
            shader: self,
            lattice,
            hits: HitRows::new(hits),
            rows,
        };
        dispatch(simd, work);
    }
}

struct FillChannels<'t, 's, 'h, R> {
    shader: &'t mut TileShader<'s>,
    lattice: &'h Lattice,
    hits: HitRows<'h>,
    rows: R,
}

impl<'c, R: Iterator<Item = Channels<'c>>> Work for FillChannels<'_, '_, '_, R> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            shader,
            lattice,
            hits,
            rows,
        } = self;
        let width = lattice.columns as usize;
        let has_many_eyes = shader.shader().has_many_eyes();
        for (row, mut channels) in (0..lattice.rows as usize).zip(rows) {
            let begin = row * width;
            channels
                .depth
                .copy_from_slice(&hits.t[begin..begin + width]);
            for left in (0..width).step_by(COLUMNS) {
                let primitives = hits.row(begin + left, COLUMNS.min(width - left));
                for span in spans(lanes, primitives) {
                    let samples = left + span.first..left + span.end;
                    if span.primitive == MISS {
                        channels.misses(samples);
                    } else if has_many_eyes {
                        for at in samples {
                            let (x, _) = lattice.place(at as u32, 0);
                            let surface = shader.surface(span.primitive, x);
                            channels.one(at, surface, &hits.get(begin + at));
                        }
                    } else {
                        let surface = shader.surface(span.primitive, 0.0);
                        let weights = [&hits.u[begin..], &hits.v[begin..]];
                        channels.span(lanes, surface, weights, samples);
                    }
                }
            }
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
