//! Pictures for two eyes: each half is a view of its own, and tiles across the border between them are split there.

use super::buffers::Buffers;
use super::job::Job;
use super::view::{Cancel, Clock, View};
use super::workers::{center_first, in_parallel};
use super::{Pass, Tile, TileStats};
use crate::camera::{Rect, SamplePattern, SubCamera};
use crate::hit::Detail;
use crate::picture::Picture;
use crate::shade::Shader;
use std::sync::{Mutex, PoisonError};

/// The views of the two eyes, and their halves of the picture.
pub(super) struct EyeViews([(View, Rect); 2]);

/// The part of a tile in one eye's half.
#[derive(Clone, Copy)]
struct EyePart {
    eye: usize,
    rect: Rect,
}

impl EyeViews {
    /// `None` for a picture for one eye.
    pub(super) fn from_view(view: &View) -> Option<Self> {
        let halves = view.camera.halves()?;
        let eye_view = |(camera, rect)| {
            let view = View {
                camera,
                ..view.clone()
            };
            (view, rect)
        };
        Some(Self(halves.map(eye_view)))
    }

    /// The halves' shaders, with colours fitted to the whole picture.
    fn shaders<'s>(&'s self, whole: &View) -> [Shader<'s>; 2] {
        let [(left, _), (right, _)] = &self.0;
        [whole.shader_for(left), whole.shader_for(right)]
    }

    fn buffers<'s>(&'s self, shaders: &'s [Shader<'s>; 2]) -> [Buffers<'s>; 2] {
        let [(left, _), (right, _)] = &self.0;
        [
            Buffers::new(left, &shaders[0]),
            Buffers::new(right, &shaders[1]),
        ]
    }

    /// The non-empty parts of a rectangle in the two halves.
    fn parts_of(&self, rect: Rect) -> impl Iterator<Item = EyePart> + '_ {
        let parts = self.0.iter().enumerate().map(move |(eye, (_, half))| {
            let (x, y) = (rect.x.max(half.x), rect.y.max(half.y));
            let rect = Rect {
                x,
                y,
                width: rect.right().min(half.right()).saturating_sub(x),
                height: rect.bottom().min(half.bottom()).saturating_sub(y),
            };
            EyePart { eye, rect }
        });
        parts.filter(|part| part.rect.area() > 0)
    }

    fn parts_of_all<'r>(&self, tiles: impl Iterator<Item = &'r Rect>) -> Vec<EyePart> {
        tiles.flat_map(|&tile| self.parts_of(tile)).collect()
    }

    fn sub_camera(&self, part: EyePart) -> SubCamera {
        self.0[part.eye].0.camera.sub_camera(part.rect)
    }

    fn finish(
        &self,
        part: EyePart,
        pattern: &SamplePattern,
        clock: Clock<'_>,
        buffers: &mut [Buffers<'_>; 2],
    ) -> Tile {
        let view = &self.0[part.eye].0;
        view.finish(
            self.sub_camera(part),
            pattern,
            clock,
            &mut buffers[part.eye],
        )
    }

    /// As [`View::render_part_into`]; tiles are in pixels of the part.
    pub(super) fn render_into(
        &self,
        (whole, part): (&View, SubCamera),
        tiles: &[Rect],
        (clock, cancel): (Clock<'_>, &Cancel),
        sink: &(dyn Fn(&TileStats) + Sync),
        picture: &mut Picture,
    ) -> bool {
        let shaders = self.shaders(whole);
        let legend = whole.drawn_legend(&shaders[0]);
        let tiles: Vec<_> = tiles.iter().map(|&tile| part.part(tile).rect).collect();
        let parts = self.parts_of_all(tiles.iter());
        let pattern = whole.settings.sample_pattern();
        let picture = Mutex::new(picture);
        let buffers = || self.buffers(&shaders);
        in_parallel(parts.len(), cancel, buffers, |buffers, index| {
            let mut tile = self.finish(parts[index], &pattern, clock, buffers);
            tile.draw(legend.as_ref());
            let at = Rect {
                x: tile.rect.x - part.rect.x,
                y: tile.rect.y - part.rect.y,
                ..tile.rect
            };
            let mut picture = picture.lock().unwrap_or_else(PoisonError::into_inner);
            picture.paste(at, &tile.pixels, tile.layers.as_ref());
            drop(picture);
            sink(&tile.stats);
        })
    }

    /// As [`View::cast`].
    pub(super) fn cast(&self, whole: &View, tiles: &[Rect], detail: Detail) -> TileStats {
        let parts = self.parts_of_all(tiles.iter());
        let sum = Mutex::new(TileStats::default());
        let shaders = self.shaders(whole);
        let buffers = || self.buffers(&shaders);
        in_parallel(
            parts.len(),
            &Cancel::default(),
            buffers,
            |buffers, index| {
                let part = parts[index];
                let view = &self.0[part.eye].0;
                let stats = Job::cast(view, self.sub_camera(part), detail, &mut buffers[part.eye]);
                *sum.lock().unwrap_or_else(PoisonError::into_inner) += stats;
            },
        );
        sum.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// As [`View::render_sub_camera`].
    pub(super) fn render_sub_camera(&self, whole: &View, rect: Rect, clock: Clock<'_>) -> Tile {
        let shaders = self.shaders(whole);
        let mut buffers = self.buffers(&shaders);
        let pattern = whole.settings.sample_pattern();
        let mut picture = Picture::blank(rect.width, rect.height, whole.settings.layers);
        let mut stats = TileStats::default();
        for part in self.parts_of(rect) {
            let tile = self.finish(part, &pattern, clock, &mut buffers);
            let at = Rect {
                x: part.rect.x - rect.x,
                y: part.rect.y - rect.y,
                ..part.rect
            };
            picture.paste(at, &tile.pixels, tile.layers.as_ref());
            stats += tile.stats;
        }
        let mut tile = Tile {
            rect,
            pixels: picture.pixels,
            layers: picture.layers,
            stats,
        };
        tile.draw(whole.drawn_legend(&shaders[0]).as_ref());
        tile
    }

    /// As [`View::render_progressively`]; a tile across the border arrives in two parts.
    pub(super) fn render_progressively(
        &self,
        whole: &View,
        tiles: &[Rect],
        passes: &[Pass],
        (clock, cancel): (Clock<'_>, &Cancel),
        sink: &(dyn Fn(Pass, Tile) + Sync),
    ) -> bool {
        let order = center_first(tiles, whole.camera.plane());
        let job = |part: EyePart| (part.eye, Mutex::new(Job::new(self.sub_camera(part))));
        let jobs: Vec<_> = self
            .parts_of_all(order.iter())
            .into_iter()
            .map(job)
            .collect();
        let shaders = self.shaders(whole);
        let legend = whole.drawn_legend(&shaders[0]);
        let buffers = || self.buffers(&shaders);
        let last = passes.len().saturating_sub(1);
        let samples = passes.last().map_or(1, |pass| pass.samples);
        let pattern = SamplePattern::new(samples, whole.settings.pixel_filter);
        passes.iter().enumerate().all(|(number, &pass)| {
            in_parallel(jobs.len(), cancel, buffers, |buffers, index| {
                let (eye, job) = &jobs[index];
                let mut job = job.lock().unwrap_or_else(PoisonError::into_inner);
                let view = &self.0[*eye].0;
                let stats = job.advance(view, pass, &pattern, clock, &mut buffers[*eye]);
                let mut tile = match number == last {
                    true => job.take_tile(stats),
                    false => job.tile(stats),
                };
                drop(job);
                tile.draw(legend.as_ref());
                sink(pass, tile);
            })
        })
    }
}
