//! A tile, which the passes of progressive rendering refine.

use super::buffers::Buffers;
use super::tile_renderer::{TileRenderer, fill_with_background};
use super::view::{Clock, Settings, View};
use super::{Pass, Tile, TileStats};
use crate::camera::{Lattice, Rect, SamplePattern, SubCamera};
use crate::hit::Detail;
use crate::picture::{Layers, Strip};
use crate::shade::{self, Section};
use glam::Vec4;
use std::time::Duration;

/// A tile in its present state.
#[derive(Debug)]
pub(super) struct Job {
    sub_camera: SubCamera,
    pixels: Vec<[u8; 4]>,
    /// Weighted sums of the samples so far, in linear light with premultiplied alpha. Empty while pixels have one
    /// sample.
    sums: Vec<[f32; 4]>,
    layers: Option<Layers>,
    /// Samples a pixel cast so far.
    samples: usize,
}

impl Job {
    pub(super) fn new(sub_camera: SubCamera) -> Self {
        Self {
            sub_camera,
            pixels: Vec::new(),
            sums: Vec::new(),
            layers: None,
            samples: 0,
        }
    }

    /// Casts a sub-camera's rays, evaluates hits as `detail` says, and discards them.
    pub(super) fn cast(
        view: &View,
        sub_camera: SubCamera,
        detail: Detail,
        buffers: &mut Buffers<'_>,
    ) -> TileStats {
        let mut renderer = TileRenderer::new(view, &|| Duration::ZERO, buffers);
        let lattice = sub_camera.lattice();
        renderer.find(&lattice);
        if detail == Detail::Full {
            let Settings {
                cull, precision, ..
            } = view.settings;
            let hits = &mut renderer.buffers.hits;
            view.accel.interpolate(&lattice, cull, precision, hits);
        }
        renderer.stats
    }

    /// Renders a strip of neighbouring tiles into the picture, with one sample a pixel, and its layers if it has any; `sink`
    /// receives each tile's statistics.
    ///
    /// Adjacent tiles without hits are filled together: a picture exceeds the caches, and long rows are written to
    /// memory twice as fast as short ones. The time is added to the last of these tiles.
    pub(super) fn paint(
        view: &View,
        strip: &mut Strip<'_>,
        clock: Clock<'_>,
        buffers: &mut Buffers<'_>,
        sink: &dyn Fn(&TileStats),
    ) {
        let shader = buffers.shader.shader();
        let has_layers = view.settings.layers && !strip.layers.is_empty();
        let mut empty: Option<(Rect, TileStats)> = None;
        let fill = |strip: &mut Strip<'_>, (rect, mut stats): (Rect, TileStats)| {
            let begin = clock();
            match has_layers {
                true => fill_with_background(shader, rect, strip.layered_rows_of(rect)),
                false => shader.shade_nothing(rect, strip.rows_of(rect)),
            }
            stats.shade += clock().saturating_sub(begin);
            sink(&stats);
        };
        for tile in strip.tiles.clone() {
            let mut renderer = TileRenderer::new(view, clock, buffers);
            let lattice = view.camera.sub_camera(tile).lattice();
            renderer.find(&lattice);
            let is_empty = match has_layers {
                true => renderer.shows_background(),
                false => renderer.hits_nothing(),
            };
            if is_empty {
                let rect = match &empty {
                    Some((left, stats)) => {
                        sink(stats);
                        Rect {
                            width: left.width + tile.width,
                            ..*left
                        }
                    }
                    None => tile,
                };
                empty = Some((rect, renderer.stats));
                continue;
            }
            if let Some(empty) = empty.take() {
                fill(strip, empty);
            }
            match has_layers {
                true => renderer.shade_hits_with_layers(&lattice, strip.layered_rows_of(tile)),
                false => renderer.shade_hits(&lattice, tile, strip.rows_of(tile)),
            }
            sink(&renderer.stats);
        }
        if let Some(empty) = empty {
            fill(strip, empty);
        }
    }

    /// Renders a pass: casts the samples that earlier passes have not cast. `pattern` is that of the last pass; all
    /// passes take its samples in order.
    pub(super) fn advance(
        &mut self,
        view: &View,
        pass: Pass,
        pattern: &SamplePattern,
        clock: Clock<'_>,
        buffers: &mut Buffers<'_>,
    ) -> TileStats {
        let mut renderer = TileRenderer::new(view, clock, buffers);
        self.pixels.resize(self.sub_camera.rect.area(), [0; 4]);
        let stride = pass.stride.max(1);
        if pattern.samples().len() > 1 && (pass.samples > 1 || view.settings.layers) {
            self.accumulate(&mut renderer, pattern, pass.samples.max(1) as usize);
        } else if view.settings.layers {
            self.paint_layers(&mut renderer);
        } else {
            self.refine(&mut renderer, stride);
        }
        renderer.stats
    }

    /// Casts one sample of every `stride`-th pixel in both directions.
    ///
    /// A quarter of these rays were cast in the coarser pass before, and are cast again: without them the lattice would
    /// have gaps, and packets with gaps take longer than whole ones.
    fn refine(&mut self, renderer: &mut TileRenderer<'_, '_>, stride: u32) {
        if stride == 1 {
            let columns = self.sub_camera.rect.width.max(1) as usize;
            renderer.paint(self.sub_camera, self.pixels.chunks_mut(columns));
        } else {
            let lattice = self.sub_camera.sparse_lattice(stride, (0, 0));
            self.fill(renderer, &lattice, stride);
        }
        self.samples = 1;
    }

    /// Casts a lattice, and fills the block of pixels to the right of and below each ray.
    fn fill(&mut self, renderer: &mut TileRenderer<'_, '_>, lattice: &Lattice, block: u32) {
        if lattice.is_empty() {
            return;
        }
        renderer.find(lattice);
        renderer.interpolate(lattice, false);
        let rect = self.sub_camera.rect;
        let left = (lattice.x - rect.x) as usize;
        let section = renderer.section();
        let whole = &mut self.pixels;
        renderer.shade(|buffers| {
            let mut colors = std::mem::take(&mut buffers.pixels);
            (buffers.shader).shade_lattice(lattice, &buffers.hits, &mut colors);
            if buffers.casts_secondary_rays() {
                buffers.cast_secondary_rays(lattice);
                for (color, secondary) in colors.iter_mut().zip(&buffers.secondary) {
                    *color = secondary.map_or(*color, shade::encode);
                }
            }
            if let Some(section) = section {
                for (at, color) in colors.iter_mut().enumerate() {
                    let at = at as u32;
                    let (x, y) = lattice.place(at % lattice.columns, at / lattice.columns);
                    let primitive = buffers.hits.get(at as usize).primitive;
                    let shown = Section::shown(section.at(x, y, primitive), false);
                    *color = section.color8(shown).unwrap_or(*color);
                }
            }
            let width = rect.width as usize;
            let rows = colors.chunks(lattice.columns as usize);
            for (row, colors) in (0..).zip(rows) {
                let top = lattice.y - rect.y + row * lattice.stride;
                let begin = top as usize * width;
                let first = &mut whole[begin + left..begin + width];
                for (pixels, color) in first.chunks_mut(block as usize).zip(colors) {
                    pixels.fill(*color);
                }
                for y in top + 1..(top + block).min(rect.height) {
                    let to = y as usize * width + left;
                    whole.copy_within(begin + left..begin + width, to);
                }
            }
            buffers.pixels = colors;
        });
    }

    /// Casts the only sample of every pixel, and takes its layers.
    fn paint_layers(&mut self, renderer: &mut TileRenderer<'_, '_>) {
        let columns = self.sub_camera.rect.width.max(1) as usize;
        let layers = self.layers.get_or_insert_default();
        layers.resize(self.pixels.len());
        let rows = self.pixels.chunks_mut(columns).zip(layers.rows(columns));
        renderer.paint_with_layers(self.sub_camera, rows);
        self.samples = 1;
    }

    /// Casts samples until every pixel has `count` of them; with the first, layers if the settings ask for them.
    fn accumulate(
        &mut self,
        renderer: &mut TileRenderer<'_, '_>,
        pattern: &SamplePattern,
        count: usize,
    ) {
        // Passes of one sample keep 8-bit pixels alone, so the first sample is cast again. Keeping its sums as well
        // would cost every picture that never gets a second sample.
        let samples = pattern.samples();
        if self.sums.is_empty() {
            self.sums = vec![[0.0; 4]; self.sub_camera.rect.area()];
            self.samples = 0;
        }
        let count = count.min(samples.len());
        for (index, sample) in samples.iter().enumerate().take(count).skip(self.samples) {
            let mut lattice = self.sub_camera.lattice();
            lattice.offset = sample.offset;
            let weight = sample.weight;
            let has_layers = index == 0 && renderer.view.settings.layers;
            renderer.find(&lattice);
            let sums = &mut self.sums;
            if !has_layers
                && renderer.hits_nothing()
                && let Some(nothing) = renderer.nothing_in_rows(&lattice)
            {
                renderer.shade(|_| {
                    let rows = sums.chunks_exact_mut(lattice.columns.max(1) as usize);
                    for (row, light) in rows.zip(nothing) {
                        let sample = weighted(light, weight);
                        for sum in row {
                            *sum = (Vec4::from(*sum) + sample).into();
                        }
                    }
                });
                continue;
            }
            renderer.interpolate(&lattice, has_layers);
            renderer.light(&lattice);
            renderer.shade(|buffers| {
                for (sum, light) in sums.iter_mut().zip(&buffers.light) {
                    *sum = (Vec4::from(*sum) + weighted(*light, weight)).into();
                }
            });
            if has_layers {
                let mut layers = renderer.buffers.layers.take().unwrap_or_default();
                layers.resize(lattice.len());
                renderer.channels(&lattice, layers.rows(lattice.columns as usize));
                self.layers = Some(layers);
            }
        }
        self.samples = count;
        let share = pattern.share(count);
        let mean = |sum: &[f32; 4]| {
            let [r, g, b, a] = sum.map(|channel| channel * share);
            if !pattern.has_negative() {
                return [r, g, b, a];
            }
            // Negative weights overshoot at edges. No pixel may be more than opaque, or brighter than white.
            let alpha = a.clamp(0.0, 1.0);
            let [r, g, b] = [r, g, b].map(|light| light.clamp(0.0, alpha));
            [r, g, b, alpha]
        };
        let means = match &mut self.layers {
            Some(layers) => &mut layers.color,
            None => &mut renderer.buffers.light,
        };
        means.clear();
        means.extend(self.sums.iter().map(mean));
        let simd = renderer.view.accel.simd();
        shade::encode_all_premultiplied(simd, means, &mut self.pixels);
    }

    /// A copy of the tile in its present state.
    pub(super) fn tile(&self, stats: TileStats) -> Tile {
        Tile {
            rect: self.sub_camera.rect,
            pixels: self.pixels.clone(),
            layers: self.layers.clone(),
            stats,
        }
    }

    /// The finished tile, without a copy; the job is reset.
    pub(super) fn take_tile(&mut self, stats: TileStats) -> Tile {
        let Self {
            sub_camera,
            pixels,
            layers,
            ..
        } = std::mem::replace(self, Self::new(self.sub_camera));
        Tile {
            rect: sub_camera.rect,
            pixels,
            layers,
            stats,
        }
    }
}

/// A weighted sample with premultiplied alpha, from one of straight alpha.
#[inline(always)]
fn weighted(light: [f32; 4], weight: f32) -> Vec4 {
    Vec4::from(shade::premultiply(light)) * weight
}
