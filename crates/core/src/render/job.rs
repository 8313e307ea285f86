//! A tile, which the passes of progressive rendering refine.

use super::compositor::Compositor;
use super::photographs::Photographs;
use super::view::{Clock, Settings, View};
use super::{Pass, Tile, TileStats};
use crate::camera::{Lattice, Rect, SamplePattern, SubCamera};
use crate::hit::{Detail, HitNumbers, MISS, PrimitiveHit};
use crate::hits::Hits;
use crate::picture::{Layers, Strip};
use crate::shade::{self, Channels, Cut, Section, Shader, Shown, TileShader};
use std::time::Duration;

/// A tile in its present state.
#[derive(Debug)]
pub(super) struct Job {
    sub_camera: SubCamera,
    pixels: Vec<[u8; 4]>,
    /// Weighted sums of the samples so far, in linear light with premultiplied alpha. Empty while pixels have one
    /// sample and no layers.
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
        let mut work = Work::new(view, &|| Duration::ZERO, buffers);
        let lattice = sub_camera.lattice();
        work.find(&lattice);
        if detail == Detail::Full {
            let Settings {
                cull, precision, ..
            } = view.settings;
            let hits = &mut work.buffers.hits;
            view.accel.evaluate(&lattice, cull, precision, hits);
        }
        work.stats
    }

    /// Renders a strip of neighbouring tiles into the picture, with one sample a pixel; `sink` receives each tile's
    /// statistics.
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
        let mut empty: Option<(Rect, TileStats)> = None;
        let fill = |strip: &mut Strip<'_>, (rect, mut stats): (Rect, TileStats)| {
            let begin = clock();
            shader.shade_nothing(rect, strip.rows_of(rect));
            stats.shade += clock().saturating_sub(begin);
            sink(&stats);
        };
        for tile in strip.tiles.clone() {
            let mut work = Work::new(view, clock, buffers);
            let lattice = view.camera.sub_camera(tile).lattice();
            work.find(&lattice);
            if work.shows_nothing() {
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
                empty = Some((rect, work.stats));
                continue;
            }
            if let Some(empty) = empty.take() {
                fill(strip, empty);
            }
            work.shade_found(&lattice, tile, strip.rows_of(tile));
            sink(&work.stats);
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
        let mut work = Work::new(view, clock, buffers);
        self.pixels.resize(self.sub_camera.rect.area(), [0; 4]);
        let stride = pass.stride.max(1);
        if pass.samples <= 1 && !view.settings.layers {
            self.refine(&mut work, stride);
        } else {
            self.accumulate(&mut work, pattern, pass.samples.max(1) as usize);
        }
        work.stats
    }

    /// Casts one sample of every `stride`-th pixel in both directions.
    ///
    /// A quarter of these rays were cast in the coarser pass before, and are cast again: without them the lattice would
    /// have gaps, and packets with gaps take longer than whole ones.
    fn refine(&mut self, work: &mut Work<'_, '_>, stride: u32) {
        if stride == 1 {
            let columns = self.sub_camera.rect.width.max(1) as usize;
            work.paint(self.sub_camera, self.pixels.chunks_mut(columns));
        } else {
            let lattice = self.sub_camera.sparse_lattice(stride, (0, 0));
            self.fill(work, &lattice, stride);
        }
        self.samples = 1;
    }

    /// Casts a lattice, and fills the block of pixels to the right of and below each ray.
    fn fill(&mut self, work: &mut Work<'_, '_>, lattice: &Lattice, block: u32) {
        if lattice.is_empty() {
            return;
        }
        work.find(lattice);
        work.evaluate(lattice);
        let rect = self.sub_camera.rect;
        let pixels = &mut self.pixels;
        let section = work.section();
        work.shade(|buffers| {
            for row in 0..lattice.rows {
                for column in 0..lattice.columns {
                    let (x, y) = lattice.place(column, row);
                    let at = (row * lattice.columns + column) as usize;
                    let hit = buffers.hits.get(at);
                    let cut = section
                        .and_then(|s| s.color8(Section::shown(s.at(x, y, hit.primitive), false)));
                    let color = match cut {
                        Some(color) => color,
                        None => match buffers.beyond_the_nearest((x, y), &hit) {
                            Some(color) => shade::encode(color),
                            None => buffers.shader.pixel8(x, y, &hit),
                        },
                    };
                    let (left, top) = (
                        lattice.x - rect.x + column * lattice.stride,
                        lattice.y - rect.y + row * lattice.stride,
                    );
                    let right = (left + block).min(rect.width) as usize;
                    for y in top..(top + block).min(rect.height) {
                        let start = y as usize * rect.width as usize;
                        pixels[start + left as usize..start + right].fill(color);
                    }
                }
            }
        });
    }

    /// Casts samples until every pixel has `count` of them; with the first, layers if the settings ask for them.
    fn accumulate(&mut self, work: &mut Work<'_, '_>, pattern: &SamplePattern, count: usize) {
        // Passes of one sample keep 8-bit pixels alone, so the first sample is cast again. Keeping its sums as well
        // would cost every picture that never gets a second sample.
        if self.sums.is_empty() {
            self.sums = vec![[0.0; 4]; self.sub_camera.rect.area()];
            self.samples = 0;
        }
        let samples = pattern.samples();
        let count = count.min(samples.len());
        for (index, sample) in samples.iter().enumerate().take(count).skip(self.samples) {
            let mut lattice = self.sub_camera.lattice();
            lattice.offset = sample.offset;
            let weight = sample.weight;
            work.find(&lattice);
            work.evaluate(&lattice);
            let sums = &mut self.sums;
            let cut = work.cut(&lattice);
            work.shade(|buffers| {
                let mut light = std::mem::take(&mut buffers.light);
                if buffers.takes_other_rays() {
                    buffers.light_of_other_rays(&lattice, &mut light);
                } else {
                    buffers.shader.light(&lattice, &buffers.hits, &mut light);
                }
                if let Some((section, shown)) = &cut {
                    for (light, &shown) in light.iter_mut().zip(shown) {
                        *light = section.color(shown).unwrap_or(*light);
                    }
                }
                for (sum, &[r, g, b, a]) in sums.iter_mut().zip(&light) {
                    let light = [r * a, g * a, b * a, a];
                    *sum = std::array::from_fn(|channel| sum[channel] + light[channel] * weight);
                }
                buffers.light = light;
            });
            if index == 0 && work.view.settings.layers {
                let layers = work.layers(&lattice);
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
            None => &mut work.buffers.light,
        };
        means.clear();
        means.extend(self.sums.iter().map(mean));
        let simd = work.view.accel.simd();
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

/// A worker's buffers, reused from tile to tile.
#[derive(Debug)]
pub(super) struct Buffers<'s> {
    hits: Hits,
    /// The colours of one sample a pixel: linear light, straight alpha.
    light: Vec<[f32; 4]>,
    shader: TileShader<'s>,
    /// `None` where no surface is translucent.
    compositor: Option<Compositor<'s>>,
    /// `None` where no texture is a photograph.
    photographs: Option<Photographs<'s>>,
}

impl<'s> Buffers<'s> {
    pub(super) fn new(view: &'s View, shader: &'s Shader<'s>) -> Self {
        let compositor = |translucent| Compositor::new(view, translucent, shader.masks());
        Self {
            hits: Hits::default(),
            light: Vec::new(),
            shader: shader.tile(),
            compositor: shader.translucent().map(compositor),
            photographs: (shader.has_photographs()).then(|| Photographs::new(view, shader.masks())),
        }
    }

    /// Whether colours may need rays besides the one to the closest hit: for further layers, or for visibility from a
    /// photograph's camera.
    fn takes_other_rays(&self) -> bool {
        self.compositor.is_some() || self.photographs.is_some()
    }

    /// [`TileShader::light`] with these additional rays.
    fn light_of_other_rays(&mut self, lattice: &Lattice, light: &mut Vec<[f32; 4]>) {
        light.clear();
        for at in 0..lattice.len() {
            let columns = lattice.columns as usize;
            let (x, y) = lattice.place((at % columns) as u32, (at / columns) as u32);
            let hit = self.hits.get(at);
            let beyond = self.beyond_the_nearest((x, y), &hit);
            light.push(beyond.unwrap_or_else(|| self.shader.color(x, y, &hit)));
        }
    }

    /// The colour of the sample at (x, y) (linear light, straight alpha) where that of its closest hit `hit` is not the
    /// answer: where further layers show, or the camera of a photograph does not see the hit. `None` elsewhere.
    fn beyond_the_nearest(&mut self, place: (f64, f64), hit: &PrimitiveHit) -> Option<[f32; 4]> {
        let Self {
            shader,
            compositor,
            photographs,
            ..
        } = self;
        let photographs = photographs.as_ref();
        let composited = |compositor: &mut Compositor<'s>| {
            compositor.color(shader, photographs, place, hit.primitive)
        };
        match compositor.as_mut().and_then(composited) {
            None => photographs?.hidden(shader, place, hit),
            composited => composited,
        }
    }
}

/// A tile's casting and shading, and their statistics.
struct Work<'a, 's> {
    view: &'a View,
    clock: Clock<'a>,
    buffers: &'a mut Buffers<'s>,
    stats: TileStats,
}

impl<'a, 's> Work<'a, 's> {
    fn new(view: &'a View, clock: Clock<'a>, buffers: &'a mut Buffers<'s>) -> Self {
        let worker = rayon::current_thread_index().unwrap_or(0) as u32;
        Self {
            view,
            clock,
            buffers,
            stats: TileStats {
                worker,
                ..TileStats::default()
            },
        }
    }

    /// Renders a sub-camera with one sample a pixel into the rows of its rectangle.
    fn paint<'p>(&mut self, sub_camera: SubCamera, rows: impl Iterator<Item = &'p mut [[u8; 4]]>) {
        let (lattice, rect) = (sub_camera.lattice(), sub_camera.rect);
        self.find(&lattice);
        if self.shows_nothing() {
            self.shade(|buffers| buffers.shader.shader().shade_nothing(rect, rows));
        } else {
            self.shade_found(&lattice, rect, rows);
        }
    }

    /// Shades a rectangle whose rays have just been cast.
    fn shade_found<'p>(
        &mut self,
        lattice: &Lattice,
        rect: Rect,
        rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        let Some((section, shown)) = self.cut(lattice) else {
            return self.shade_layers(lattice, rect, rows);
        };
        // Hits behind a section are not shaded.
        for (primitive, shown) in self.buffers.hits.primitives.iter_mut().zip(&shown) {
            if *shown != Shown::NONE {
                *primitive = MISS;
            }
        }
        let mut rows: Vec<_> = rows.collect();
        self.shade_layers(lattice, rect, rows.iter_mut().map(|row| &mut **row));
        for (row, shown) in rows.iter_mut().zip(shown.chunks(lattice.columns as usize)) {
            for (pixel, shown) in row.iter_mut().zip(shown) {
                if let Some(color) = section.color8(*shown) {
                    *pixel = color;
                }
            }
        }
    }

    /// What each ray of the lattice that was just cast shows of sections; `None` if no ray shows any.
    fn cut(&mut self, lattice: &Lattice) -> Option<(&'s Section<'s>, Vec<Shown>)> {
        let section = self.section()?;
        let begin = (self.clock)();
        let cuts = |lattice: &Lattice, primitives: &[u32]| -> Vec<Cut> {
            let place = |at: u32| lattice.place(at % lattice.columns, at / lattice.columns);
            let all = (0..).zip(primitives);
            all.map(|(at, &primitive)| section.at(place(at).0, place(at).1, primitive))
                .collect()
        };
        let inner = cuts(lattice, &self.buffers.hits.primitives);
        if inner.iter().all(Option::is_none) {
            self.stats.shade += self.since(begin);
            return None;
        }
        let (columns, rows) = (lattice.columns as usize, lattice.rows as usize);
        let plane = self.view.camera.plane();
        // A section's outline depends on neighbouring rays. Those next to the lattice are cast here; outside the
        // picture there are none.
        let View {
            accel, settings, ..
        } = self.view;
        let accel = accel.clipped(&settings.clip).masked(self.shader().masks());
        let beside = |is_inside: bool, lattice: Lattice| {
            let mut primitives = Vec::new();
            if is_inside {
                accel.find(&lattice, settings.cull, settings.precision, &mut primitives);
            }
            cuts(&lattice, &primitives)
        };
        let row = |y| Lattice {
            y,
            rows: 1,
            ..*lattice
        };
        let column = |x| Lattice {
            x,
            columns: 1,
            ..*lattice
        };
        let (right, bottom) = (lattice.x + lattice.columns, lattice.y + lattice.rows);
        let above = beside(lattice.y > 0, row(lattice.y.saturating_sub(1)));
        let below = beside(bottom < plane.rows, row(bottom.min(plane.rows - 1)));
        let before = beside(lattice.x > 0, column(lattice.x.saturating_sub(1)));
        let behind = beside(right < plane.columns, column(right.min(plane.columns - 1)));
        let shown = inner.iter().enumerate().map(|(at, &cut)| {
            let (x, y) = (at % columns, at / columns);
            let next = |is_inside: bool, to: usize, outside: Option<&Cut>| match is_inside {
                true => inner[to],
                false => outside.copied().unwrap_or(cut),
            };
            let neighbours = [
                next(x > 0, at.wrapping_sub(1), before.get(y)),
                next(x + 1 < columns, at + 1, behind.get(y)),
                next(y > 0, at.wrapping_sub(columns), above.get(x)),
                next(y + 1 < rows, at + columns, below.get(x)),
            ];
            Section::shown(cut, neighbours.iter().any(|&next| next != cut))
        });
        let shown = shown.collect();
        self.stats.shade += self.since(begin);
        Some((section, shown))
    }

    /// The section of the clipping planes, if any is visible.
    fn section(&self) -> Option<&'s Section<'s>> {
        self.buffers.shader.shader().section()
    }

    /// Whether no ray that was just cast shows a surface or a section.
    fn shows_nothing(&self) -> bool {
        self.stats.counts.hits == 0 && !self.section().is_some_and(Section::is_seen_by_misses)
    }

    /// [`Work::shade_found`] without sections.
    fn shade_layers<'p>(
        &mut self,
        lattice: &Lattice,
        rect: Rect,
        rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        if !self.buffers.takes_other_rays() {
            return self.shade_nearest(lattice, rect, rows);
        }
        let mut rows: Vec<_> = rows.collect();
        self.shade_nearest(lattice, rect, rows.iter_mut().map(|row| &mut **row));
        self.shade(|buffers| {
            for (y, row) in (0..lattice.rows).zip(&mut rows) {
                for (x, pixel) in (0..lattice.columns).zip(row.iter_mut()) {
                    let hit = buffers.hits.get((y * lattice.columns + x) as usize);
                    if let Some(color) = buffers.beyond_the_nearest(lattice.place(x, y), &hit) {
                        *pixel = shade::encode(color);
                    }
                }
            }
        });
    }

    /// [`Work::shade_found`] by the closest hits alone.
    fn shade_nearest<'p>(
        &mut self,
        lattice: &Lattice,
        rect: Rect,
        rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        if self.shader().detail() == Detail::Triangle {
            self.shade(|Buffers { shader, hits, .. }| {
                shader.shade_primitives(rect, &hits.primitives, rows)
            });
        } else {
            self.evaluate(lattice);
            self.shade(|Buffers { shader, hits, .. }| shader.shade(rect, hits, rows));
        }
    }

    /// Finds the triangle that each ray of a lattice hits first.
    fn find(&mut self, lattice: &Lattice) {
        let Settings {
            cull,
            precision,
            clip,
            ..
        } = &self.view.settings;
        let begin = (self.clock)();
        let primitives = &mut self.buffers.hits.primitives;
        let masks = self.buffers.shader.shader().masks();
        let accel = self.view.accel.clipped(clip).masked(masks);
        let counts = accel.find(lattice, *cull, *precision, primitives);
        self.stats.cast += self.since(begin);
        self.stats.counts += counts;
        self.stats.rays += self.buffers.hits.len() as u64;
    }

    /// Computes t, u and v of the hits, as far as the picture needs them.
    fn evaluate(&mut self, lattice: &Lattice) {
        let begin = (self.clock)();
        let Settings {
            cull,
            precision,
            layers,
            ..
        } = self.view.settings;
        let full = layers || self.shader().detail() == Detail::Full;
        let hits = &mut self.buffers.hits;
        if full {
            let numbers = match layers {
                true => HitNumbers::All,
                false => self.buffers.shader.shader().hit_numbers(),
            };
            (self.view.accel).evaluate_numbers(lattice, cull, precision, numbers, hits);
        } else {
            hits.clear_tuv();
        }
        self.stats.shade += self.since(begin);
    }

    fn shader(&self) -> &'s Shader<'s> {
        self.buffers.shader.shader()
    }

    fn shade(&mut self, shade: impl FnOnce(&mut Buffers<'s>)) {
        let begin = (self.clock)();
        shade(self.buffers);
        self.stats.shade += self.since(begin);
    }

    fn since(&self, begin: Duration) -> Duration {
        (self.clock)().saturating_sub(begin)
    }

    /// The layers of the lattice that was just cast, without the colours.
    fn layers(&mut self, lattice: &Lattice) -> Layers {
        let begin = (self.clock)();
        let Buffers { hits, shader, .. } = &mut *self.buffers;
        let mut layers = Layers::blank(hits.len());
        let channels = Channels {
            depth: &mut layers.depth,
            object: &mut layers.object,
            triangle: &mut layers.triangle,
            normal: &mut layers.normal,
            uv: &mut layers.uv,
        };
        shader.channels(lattice, hits, channels);
        self.stats.shade += self.since(begin);
        layers
    }
}
