//! Rendering a view's tiles on many threads.

use super::buffers::Buffers;
use super::eyes::EyeViews;
use super::job::Job;
use super::view::{Cancel, Clock, Settings, View};
use super::workers::{center_first, in_parallel};
use super::{Pass, Tile, TileStats};
use crate::camera::{Grid, Rect, SamplePattern, SubCamera};
use crate::hit::Detail;
use crate::hits::Hits;
use crate::picture::Picture;
use crate::scene::{ColorRule, Masks, Object};
use crate::shade::{DrawnLegend, Legend, Mode, Shader};
use std::sync::{Mutex, PoisonError};

/// The distance in pixels between the rays that the colours of depth are fitted to: some thousands of rays in a usual
/// picture, which take a hundredth of its time. With a smaller distance fitting takes longer; with a larger one small
/// near and far objects are missed.
const DEPTH_STRIDE: u32 = 16;

/// The most of these rays along a side. Every band of a large picture casts all of them; the limit keeps them few
/// compared with the band's own rays.
const DEPTH_RAYS: u32 = 256;

impl View {
    /// Renders the whole picture, tile by tile, in parallel on rayon's current pool.
    ///
    /// `sink` is called from the workers once for each tile, with its statistics. The picture is the same, byte for
    /// byte, for every grid and thread count. `None` if cancelled.
    pub fn render(
        &self,
        grid: Grid,
        clock: Clock<'_>,
        cancel: &Cancel,
        sink: &(dyn Fn(&TileStats) + Sync),
    ) -> Option<Picture> {
        let plane = self.camera.plane();
        let mut picture = Picture::blank(plane.columns, plane.rows, self.settings.layers);
        self.render_into(grid, clock, cancel, sink, &mut picture)
            .then_some(picture)
    }

    /// As [`View::render`], into an existing picture of the camera's size, with layers if the settings ask for them:
    /// reusing memory takes less time than allocating it. Returns whether it ran to the end; otherwise only some
    /// tiles of the picture are new.
    pub fn render_into(
        &self,
        grid: Grid,
        clock: Clock<'_>,
        cancel: &Cancel,
        sink: &(dyn Fn(&TileStats) + Sync),
        picture: &mut Picture,
    ) -> bool {
        self.render_part_into(self.camera.whole(), grid, clock, cancel, sink, picture)
    }

    /// As [`View::render_into`], for a sub-camera's rectangle; the picture has the size of that, and `grid` splits
    /// it.
    pub fn render_part_into(
        &self,
        part: SubCamera,
        grid: Grid,
        clock: Clock<'_>,
        cancel: &Cancel,
        sink: &(dyn Fn(&TileStats) + Sync),
        picture: &mut Picture,
    ) -> bool {
        let rect = part.rect;
        if let Some(eyes) = EyeViews::from_view(self) {
            let tiles = grid.tiles(rect.width, rect.height);
            return eyes.render_into((self, part), &tiles, (clock, cancel), sink, picture);
        }
        let shader = self.shader();
        let legend = self.drawn_legend(&shader);
        let buffers = || Buffers::new(self, &shader);
        if self.settings.samples <= 1 {
            // Long strips first, for long rows of pixels, and short ones at the end, so that no worker waits long for
            // the others (Polychronopoulos and Kuck, "Guided Self-Scheduling", 1987).
            let share = 4 * rayon::current_num_threads();
            let mut strips = picture.strips(grid, |left| left / share);
            for tile in strips.iter_mut().flat_map(|strip| &mut strip.tiles) {
                *tile = part.part(*tile).rect;
            }
            let strips: Vec<_> = strips.into_iter().map(Mutex::new).collect();
            let is_done = in_parallel(strips.len(), cancel, buffers, |buffers, index| {
                let mut strip = strips[index].lock().unwrap_or_else(PoisonError::into_inner);
                Job::paint(self, &mut strip, clock, buffers, sink);
            });
            drop(strips);
            if let Some(legend) = legend {
                let colors = picture.layers.as_mut().map(|layers| &mut *layers.color);
                legend.over(rect, &mut picture.pixels, colors);
            }
            return is_done;
        }
        let strips = picture.strips(grid, |_| 1);
        let strips: Vec<_> = strips.into_iter().map(Mutex::new).collect();
        let pattern = self.settings.sample_pattern();
        in_parallel(strips.len(), cancel, buffers, |buffers, index| {
            let mut strip = strips[index].lock().unwrap_or_else(PoisonError::into_inner);
            for rect in strip.tiles.clone() {
                let mut tile = self.finish(part.part(rect), &pattern, clock, buffers);
                tile.draw(legend.as_ref());
                strip.paste(rect, &tile.pixels, tile.layers.as_ref());
                buffers.layers = tile.layers;
                sink(&tile.stats);
            }
        })
    }

    /// Casts every ray of the picture, a tile at a time, and discards the hits, for measuring: visibility alone, or
    /// with t, u and v of every hit. Only the counts of the result are set; measure the time of the call.
    pub fn cast(&self, grid: Grid, detail: Detail) -> TileStats {
        let plane = self.camera.plane();
        let tiles = grid.tiles(plane.columns, plane.rows);
        if let Some(eyes) = EyeViews::from_view(self) {
            return eyes.cast(self, &tiles, detail);
        }
        let sum = Mutex::new(TileStats::default());
        let shader = self.shader();
        let buffers = || Buffers::new(self, &shader);
        in_parallel(
            tiles.len(),
            &Cancel::default(),
            buffers,
            |buffers, index| {
                let sub_camera = self.camera.sub_camera(tiles[index]);
                let stats = Job::cast(self, sub_camera, detail, buffers);
                *sum.lock().unwrap_or_else(PoisonError::into_inner) += stats;
            },
        );
        sum.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Renders what a sub-camera of the view's camera sees, on this thread.
    pub fn render_sub_camera(&self, sub_camera: SubCamera, clock: Clock<'_>) -> Tile {
        if let Some(eyes) = EyeViews::from_view(self) {
            return eyes.render_sub_camera(self, sub_camera.rect, clock);
        }
        let shader = self.shader();
        let pattern = self.settings.sample_pattern();
        let mut tile = self.finish(
            sub_camera,
            &pattern,
            clock,
            &mut Buffers::new(self, &shader),
        );
        tile.draw(self.drawn_legend(&shader).as_ref());
        tile
    }

    /// Renders `passes` one after another. Each finished tile of each pass is handed to `sink`, by the worker that
    /// rendered it; within a pass tiles come from the middle of the view outwards.
    ///
    /// Strides must fall, and samples rise, from pass to pass. A tile of a coarse pass has every pixel filled: pixels
    /// between its rays take the colour of the ray above and to the left. After the last pass the tiles are those of
    /// [`View::render`]. Returns whether it ran to the end.
    pub fn render_progressively(
        &self,
        tiles: &[Rect],
        passes: &[Pass],
        clock: Clock<'_>,
        cancel: &Cancel,
        sink: &(dyn Fn(Pass, Tile) + Sync),
    ) -> bool {
        if let Some(eyes) = EyeViews::from_view(self) {
            return eyes.render_progressively(self, tiles, passes, (clock, cancel), sink);
        }
        let plane = self.camera.plane();
        let order = center_first(tiles, plane);
        let jobs: Vec<_> = order
            .into_iter()
            .map(|rect| Mutex::new(Job::new(self.camera.sub_camera(rect))))
            .collect();
        let shader = self.shader();
        let legend = self.drawn_legend(&shader);
        let buffers = || Buffers::new(self, &shader);
        let last = passes.len().saturating_sub(1);
        let samples = passes.last().map_or(1, |pass| pass.samples);
        let pattern = SamplePattern::new(samples, self.settings.pixel_filter);
        passes.iter().enumerate().all(|(number, &pass)| {
            in_parallel(jobs.len(), cancel, buffers, |buffers, index| {
                let mut job = jobs[index].lock().unwrap_or_else(PoisonError::into_inner);
                let stats = job.advance(self, pass, &pattern, clock, buffers);
                let mut tile = if number == last {
                    job.take_tile(stats)
                } else {
                    job.tile(stats)
                };
                drop(job);
                tile.draw(legend.as_ref());
                sink(pass, tile);
            })
        })
    }

    /// The legend of the view's colour scale; `None` where its pictures show no numbers as colours.
    pub fn legend(&self) -> Option<Legend> {
        let shows_values = |object: &Object| matches!(object.color, ColorRule::Value(_));
        let shading = &self.settings.shading;
        let shows_depth = shading.mode == Mode::Depth && shading.scale.is_some();
        (shows_depth || self.scene.objects.iter().any(shows_values))
            .then(|| self.shader().legend())
            .flatten()
    }

    /// The legend as it is drawn into the picture, if the picture has one.
    pub(super) fn drawn_legend(&self, shader: &Shader<'_>) -> Option<DrawnLegend> {
        let scale = self.settings.shading.scale?;
        let plane = self.camera.plane();
        let legend = scale.legend.then(|| shader.legend()).flatten()?;
        DrawnLegend::new(&legend, plane.columns, plane.rows)
    }

    fn shader(&self) -> Shader<'_> {
        self.shader_for(self)
    }

    /// The shader of a view that is part of this view's picture, with the colours of the whole.
    pub(super) fn shader_for<'s>(&self, view: &'s Self) -> Shader<'s> {
        let Settings {
            shading,
            samples,
            ref clip,
            cull,
            ..
        } = view.settings;
        let shader = Shader::new(&view.scene, &view.accel, view.camera, shading)
            .with_samples(samples)
            .with_sections(clip, cull)
            .with_overlay(clip);
        match shader
            .fits_depth()
            .then(|| self.visible_depths(shader.masks()))
            .flatten()
        {
            Some(seen) => shader.with_depths(seen),
            None => shader,
        }
    }

    /// The depths of the nearest and the farthest hit of a sparse lattice over the whole picture, the same for every
    /// part of it. `None` if no ray hits anything.
    fn visible_depths(&self, masks: Option<&Masks<'_>>) -> Option<[f32; 2]> {
        let plane = self.camera.plane();
        let stride = DEPTH_STRIDE.max(plane.columns.max(plane.rows).div_ceil(DEPTH_RAYS));
        let lattice = self.camera.whole().sparse_lattice(stride, (0, 0));
        let Settings {
            cull,
            precision,
            ref clip,
            ..
        } = self.settings;
        let mut hits = Hits::default();
        let primitives = &mut hits.primitives;
        (self.accel.clipped(clip).masked(masks))
            .find_closest(&lattice, cull, precision, primitives);
        self.accel.interpolate(&lattice, cull, precision, &mut hits);
        let depths = hits.iter().filter(|hit| !hit.is_miss()).map(|hit| hit.t);
        depths.fold(None, |seen, t| {
            let [near, far] = seen.unwrap_or([t; 2]);
            Some([near.min(t), far.max(t)])
        })
    }

    /// Renders a tile with all its samples in one pass.
    pub(super) fn finish(
        &self,
        sub_camera: SubCamera,
        pattern: &SamplePattern,
        clock: Clock<'_>,
        buffers: &mut Buffers<'_>,
    ) -> Tile {
        let mut job = Job::new(sub_camera);
        let pass = Pass {
            stride: 1,
            samples: self.settings.samples.max(1),
        };
        let stats = job.advance(self, pass, pattern, clock, buffers);
        job.take_tile(stats)
    }
}
