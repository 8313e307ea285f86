//! Casting and shading of a tile's rays.

use super::TileStats;
use super::buffers::Buffers;
use super::view::{Clock, Settings, View};
use crate::camera::{Lattice, Rect, SubCamera};
use crate::hit::{Detail, MISS};
use crate::picture::LayerRow;
use crate::shade::{self, Channels, Cut, Section, Shader, Shown};
use std::time::Duration;

/// A tile's casting and shading, and their statistics.
pub(super) struct TileRenderer<'a, 's> {
    pub(super) view: &'a View,
    clock: Clock<'a>,
    pub(super) buffers: &'a mut Buffers<'s>,
    pub(super) stats: TileStats,
}

impl<'a, 's> TileRenderer<'a, 's> {
    pub(super) fn new(view: &'a View, clock: Clock<'a>, buffers: &'a mut Buffers<'s>) -> Self {
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
    pub(super) fn paint<'p>(
        &mut self,
        sub_camera: SubCamera,
        rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        let (lattice, rect) = (sub_camera.lattice(), sub_camera.rect);
        self.find(&lattice);
        if self.hits_nothing() {
            self.shade(|buffers| buffers.shader.shader().shade_nothing(rect, rows));
        } else {
            self.shade_hits(&lattice, rect, rows);
        }
    }

    /// Shades a rectangle whose rays have just been cast.
    pub(super) fn shade_hits<'p>(
        &mut self,
        lattice: &Lattice,
        rect: Rect,
        rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        let Some((section, shown)) = self.section_samples(lattice) else {
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
    pub(super) fn section_samples(
        &mut self,
        lattice: &Lattice,
    ) -> Option<(&'s Section<'s>, Vec<Shown>)> {
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
            self.stats.shade += self.elapsed_since(begin);
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
                accel.find_closest(&lattice, settings.cull, settings.precision, &mut primitives);
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
        self.stats.shade += self.elapsed_since(begin);
        Some((section, shown))
    }

    /// The section of the clipping planes, if any is visible.
    pub(super) fn section(&self) -> Option<&'s Section<'s>> {
        self.buffers.shader.shader().section()
    }

    /// Whether no ray that was just cast shows a surface or a section.
    pub(super) fn hits_nothing(&self) -> bool {
        self.stats.counts.hits == 0 && !self.section().is_some_and(Section::is_seen_by_misses)
    }

    /// Whether the rays that were just cast show the background alone: nothing is hit, and no ground or lines show.
    pub(super) fn shows_background(&self) -> bool {
        self.hits_nothing() && !self.shader().has_overlay()
    }

    /// [`TileRenderer::shade_hits`] without sections.
    fn shade_layers<'p>(
        &mut self,
        lattice: &Lattice,
        rect: Rect,
        rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        if self.shader().detail() == Detail::Full {
            self.interpolate(lattice, false);
        }
        if !self.buffers.casts_secondary_rays() {
            return self.shade(|buffers| buffers.shade_closest(rect, rows));
        }
        self.shade(|buffers| {
            buffers.cast_secondary_rays(lattice);
            let Buffers {
                hits, secondary, ..
            } = &mut *buffers;
            // Where another colour is the answer, that of the closest hit is not computed.
            for (primitive, secondary) in hits.primitives.iter_mut().zip(secondary) {
                if secondary.is_some() {
                    *primitive = MISS;
                }
            }
            let mut rows: Vec<_> = rows.collect();
            buffers.shade_closest(rect, rows.iter_mut().map(|row| &mut **row));
            let columns = lattice.columns.max(1) as usize;
            for (row, secondary) in rows.iter_mut().zip(buffers.secondary.chunks(columns)) {
                for (pixel, secondary) in row.iter_mut().zip(secondary) {
                    *pixel = secondary.map_or(*pixel, shade::encode);
                }
            }
        });
    }

    /// Finds the triangle that each ray of a lattice hits first.
    pub(super) fn find(&mut self, lattice: &Lattice) {
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
        let counts = accel.find_closest(lattice, *cull, *precision, primitives);
        self.stats.cast += self.elapsed_since(begin);
        self.stats.counts += counts;
        self.stats.rays += self.buffers.hits.len() as u64;
    }

    /// Computes t, u and v of the hits, as far as colours need them, or layers as well.
    pub(super) fn interpolate(&mut self, lattice: &Lattice, for_layers: bool) {
        let begin = (self.clock)();
        let Settings {
            cull, precision, ..
        } = self.view.settings;
        let shader = self.shader();
        let numbers = match for_layers {
            true => Some(shader.layer_numbers()),
            false => (shader.detail() == Detail::Full).then(|| shader.hit_numbers()),
        };
        let hits = &mut self.buffers.hits;
        if let Some(numbers) = numbers {
            (self.view.accel).interpolate_numbers(lattice, cull, precision, numbers, hits);
        } else {
            hits.clear_tuv();
        }
        self.stats.shade += self.elapsed_since(begin);
    }

    fn shader(&self) -> &'s Shader<'s> {
        self.buffers.shader.shader()
    }

    pub(super) fn shade(&mut self, shade: impl FnOnce(&mut Buffers<'s>)) {
        let begin = (self.clock)();
        shade(self.buffers);
        self.stats.shade += self.elapsed_since(begin);
    }

    fn elapsed_since(&self, begin: Duration) -> Duration {
        (self.clock)().saturating_sub(begin)
    }

    /// [`TileRenderer::paint`], with the layers of the pixels.
    pub(super) fn paint_with_layers<'p>(
        &mut self,
        sub_camera: SubCamera,
        rows: impl Iterator<Item = LayeredRow<'p>>,
    ) {
        let (lattice, rect) = (sub_camera.lattice(), sub_camera.rect);
        self.find(&lattice);
        if self.shows_background() {
            self.shade(|buffers| fill_with_background(buffers.shader.shader(), rect, rows));
        } else {
            self.shade_hits_with_layers(&lattice, rows);
        }
    }

    /// Shades the pixels of a lattice whose rays have just been cast, and writes their layers.
    pub(super) fn shade_hits_with_layers<'p>(
        &mut self,
        lattice: &Lattice,
        rows: impl Iterator<Item = LayeredRow<'p>>,
    ) {
        self.interpolate(lattice, true);
        self.light(lattice);
        let simd = self.view.accel.simd();
        let columns = lattice.columns.max(1) as usize;
        let mut layers = Vec::with_capacity(lattice.rows as usize);
        self.shade(|buffers| {
            for (light, (pixels, row)) in buffers.light.chunks_exact(columns).zip(rows) {
                for (color, light) in row.color.iter_mut().zip(light) {
                    *color = shade::premultiply(*light);
                }
                shade::encode_all_premultiplied(simd, row.color, pixels);
                layers.push(row);
            }
        });
        self.channels(lattice, layers.into_iter());
    }

    /// The colours of the lattice that was just cast, with those of sections and of secondary rays: linear light, straight
    /// alpha.
    pub(super) fn light(&mut self, lattice: &Lattice) {
        let sections = self.section_samples(lattice);
        self.shade(|buffers| {
            let mut light = std::mem::take(&mut buffers.light);
            if buffers.casts_secondary_rays() {
                buffers.light_with_secondary_rays(lattice, &mut light);
            } else {
                buffers.shader.light(lattice, &buffers.hits, &mut light);
            }
            if let Some((section, shown)) = &sections {
                for (light, &shown) in light.iter_mut().zip(shown) {
                    *light = section.color(shown).unwrap_or(*light);
                }
            }
            buffers.light = light;
        });
    }

    /// What each row of a lattice shows where no ray hits anything: linear light, straight alpha. `None` where a row may
    /// have several colours.
    pub(super) fn nothing_in_rows(&self, lattice: &Lattice) -> Option<Vec<[f32; 4]>> {
        let last = lattice.columns.saturating_sub(1);
        let in_row = |row| {
            let ((left, y), (right, _)) = (lattice.place(0, row), lattice.place(last, row));
            self.shader().nothing_between(left, right, y)
        };
        (0..lattice.rows).map(in_row).collect()
    }

    /// Writes the layers beside colours of the lattice that was just cast.
    pub(super) fn channels<'p>(
        &mut self,
        lattice: &Lattice,
        rows: impl Iterator<Item = LayerRow<'p>>,
    ) {
        self.shade(|buffers| {
            let Buffers { hits, shader, .. } = buffers;
            shader.channels(lattice, hits, rows.map(Channels::from));
        });
    }
}

/// A row of pixels, and their layers.
pub(super) type LayeredRow<'p> = (&'p mut [[u8; 4]], LayerRow<'p>);

/// Fills the pixels of a rectangle whose rays show the background alone, and their layers.
pub(super) fn fill_with_background<'p>(
    shader: &Shader<'_>,
    rect: Rect,
    rows: impl Iterator<Item = LayeredRow<'p>>,
) {
    let [left, right] = [rect.x, rect.right().saturating_sub(1)].map(|x| f64::from(x) + 0.5);
    for (y, (pixels, row)) in (rect.y..).zip(rows) {
        let y = f64::from(y) + 0.5;
        if let Some(behind) = shader.nothing_between(left, right, y) {
            let color = shade::premultiply(behind);
            pixels.fill(shade::encode_premultiplied(color));
            row.color.fill(color);
        } else {
            for ((x, pixel), color) in (rect.x..).zip(pixels).zip(&mut *row.color) {
                let behind = shader.behind(f64::from(x) + 0.5, y);
                *color = shade::premultiply(behind);
                *pixel = shade::encode_premultiplied(*color);
            }
        }
        Channels::from(row).fill_with_misses();
    }
}

impl<'p> From<LayerRow<'p>> for Channels<'p> {
    fn from(row: LayerRow<'p>) -> Self {
        let LayerRow {
            depth,
            object,
            triangle,
            normal,
            uv,
            ..
        } = row;
        Self {
            depth,
            object,
            triangle,
            normal,
            uv,
        }
    }
}
