//! Where a row's colours go: to a picture's pixels, or to samples in linear light.

use crate::num::simd::{F32x8, LANES, Lanes};
use crate::shade::eight_colors::EightSamples;
use crate::shade::numbers::Numbers;
use crate::shade::spans::store_eight;
use crate::shade::srgb;
use crate::shade::vectors::{Rows, Vectors};

/// Where colours of a row go.
pub(super) trait Out {
    /// Eight samples' colours, as far as the row reaches.
    fn eight<L: Lanes>(&mut self, lanes: L, at: usize, colors: EightSamples<L>);

    /// What is left to do once all eights of these samples are there.
    fn finish<L: Lanes>(&mut self, lanes: L, samples: (usize, usize));

    /// Samples that show no triangle.
    fn misses(&mut self, first: usize, end: usize);

    /// One sample's colour.
    fn one(&mut self, at: usize, color: [f32; 4]);
}

/// Colours in linear light that are not encoded yet, and their buckets in the tables of [`srgb`].
pub(super) struct Unencoded {
    colors: [Numbers<f32>; 3],
    buckets: [Numbers<u16>; 3],
    /// Whether there are any.
    is_used: bool,
}

impl Unencoded {
    pub(super) fn new() -> Self {
        Self {
            colors: [Numbers::all(0.0); 3],
            buckets: [Numbers::all(0); 3],
            is_used: false,
        }
    }
}

/// A picture's pixels.
pub(super) struct Bytes<'r, 'p> {
    pub(super) tables: &'static srgb::Tables,
    pub(super) unencoded: &'r mut Unencoded,
    pub(super) pixels: &'p mut [[u8; 4]],
    pub(super) behind: [u8; 4],
}

impl Out for Bytes<'_, '_> {
    #[inline(always)]
    fn eight<L: Lanes>(&mut self, lanes: L, at: usize, colors: EightSamples<L>) {
        match colors {
            EightSamples::Light(light) => {
                let light = srgb::within(lanes, light);
                let unencoded = &mut *self.unencoded;
                unencoded.is_used = true;
                let rows = unencoded.colors.iter_mut().zip(&mut unencoded.buckets);
                for ((colors, buckets), light) in rows.zip(light.xyz()) {
                    light.store(colors.eight_mut(at));
                    *buckets.eight_mut(at) = light.upper_halves();
                }
            }
            EightSamples::Display(values) => {
                let mut bytes = [[0; 4]; LANES];
                self.tables.display_row(lanes, values, &mut bytes);
                store_eight(self.pixels, at, &bytes);
            }
        }
    }

    #[inline(always)]
    fn finish<L: Lanes>(&mut self, lanes: L, (first, end): (usize, usize)) {
        if !self.unencoded.is_used {
            return;
        }
        let Unencoded {
            colors: [r, g, b],
            buckets: [r_buckets, g_buckets, b_buckets],
            ..
        } = &*self.unencoded;
        let mut at = first;
        while at < end {
            let colors = [
                lanes.load(r.eight(at)),
                lanes.load(g.eight(at)),
                lanes.load(b.eight(at)),
            ];
            let colors = Vectors::new(lanes, colors);
            let buckets = [
                r_buckets.eight(at),
                g_buckets.eight(at),
                b_buckets.eight(at),
            ];
            let mut bytes = [[0; 4]; LANES];
            self.tables.encode_buckets(colors, buckets, &mut bytes);
            store_eight(self.pixels, at, &bytes);
            at += LANES;
        }
    }

    #[inline(always)]
    fn misses(&mut self, first: usize, end: usize) {
        if let Some(pixels) = self.pixels.get_mut(first..end) {
            pixels.fill(self.behind);
        }
    }

    fn one(&mut self, at: usize, color: [f32; 4]) {
        if let Some(pixel) = self.pixels.get_mut(at) {
            *pixel = srgb::encode(color);
        }
    }
}

/// Samples in linear light.
pub(super) struct Light<'p> {
    pub(super) tables: &'static srgb::Tables,
    pub(super) light: &'p mut [[f32; 4]],
    pub(super) behind: [f32; 4],
}

impl Out for Light<'_> {
    #[inline(always)]
    fn eight<L: Lanes>(&mut self, lanes: L, at: usize, colors: EightSamples<L>) {
        let Rows([r, g, b]) = colors.light(lanes, self.tables).store();
        let mut all = [[1.0; 4]; LANES];
        for (lane, light) in all.iter_mut().enumerate() {
            *light = [r[lane], g[lane], b[lane], 1.0];
        }
        store_eight(self.light, at, &all);
    }

    #[inline(always)]
    fn finish<L: Lanes>(&mut self, _: L, _: (usize, usize)) {}

    #[inline(always)]
    fn misses(&mut self, first: usize, end: usize) {
        if let Some(light) = self.light.get_mut(first..end) {
            light.fill(self.behind);
        }
    }

    fn one(&mut self, at: usize, color: [f32; 4]) {
        if let Some(light) = self.light.get_mut(at) {
            *light = color;
        }
    }
}
