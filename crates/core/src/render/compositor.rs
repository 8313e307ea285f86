use super::View;
use super::photographs::Photographs;
use crate::camera::{Lattice, Rect};
use crate::hit::{HitNumbers, MISS};
use crate::hits::Hits;
use crate::packet::{LARGE_SIDE, MultiHits};
use crate::scene::Masks;
use crate::shade::{SEEN, TileShader, Translucent};
use crate::single::Clipped;
use glam::Vec3;

/// Composites the layers of rays whose closest hit is translucent: a block of rays at a time, whose first layer is shaded as
/// a picture of closest hits is, then the second, and so on.
#[derive(Debug)]
pub(super) struct Compositor<'s> {
    view: &'s View,
    translucent: &'s Translucent,
    clipped: Clipped<'s>,
    /// The hits of the block's rays.
    all: MultiHits,
    /// Whether each ray of the block is composited.
    wanted: Vec<bool>,
    /// One layer: its hits, colours and opacities.
    layer: Hits,
    light: Vec<[f32; 4]>,
    opacities: Vec<f32>,
    /// What the layers so far give.
    sums: Vec<Sum>,
}

/// The layers of a ray, composited from the first to some later one.
#[derive(Clone, Copy, Debug)]
struct Sum {
    /// Linear light, multiplied by opacity.
    light: Vec3,
    /// What is left for the layers behind.
    transmittance: f32,
}

impl<'s> Compositor<'s> {
    pub(super) fn new(
        view: &'s View,
        translucent: &'s Translucent,
        masks: Option<&'s Masks<'s>>,
    ) -> Self {
        Self {
            view,
            translucent,
            clipped: view.accel.clipped(&view.settings.clip).masked(masks),
            all: MultiHits::default(),
            wanted: Vec::new(),
            layer: Hits::default(),
            light: Vec::new(),
            opacities: Vec::new(),
            sums: Vec::new(),
        }
    }

    /// The colours of a lattice's samples, whose rays hit the triangles `closest` first: their layers from front to back, in
    /// linear light with straight alpha. `None` where the first hit is opaque, or the ray hits nothing.
    pub(super) fn composite(
        &mut self,
        shader: &mut TileShader<'_>,
        photographs: Option<&Photographs<'_>>,
        lattice: &Lattice,
        closest: &[u32],
        colors: &mut [Option<[f32; 4]>],
    ) {
        let columns = lattice.columns as usize;
        for y in (0..lattice.rows).step_by(LARGE_SIDE as usize) {
            for x in (0..lattice.columns).step_by(LARGE_SIDE as usize) {
                let block = Rect {
                    x,
                    y,
                    width: LARGE_SIDE.min(lattice.columns - x),
                    height: LARGE_SIDE.min(lattice.rows - y),
                };
                let width = block.width as usize;
                let rows = (block.y..block.bottom())
                    .map(|row| row as usize * columns + block.x as usize)
                    .map(|first| first..first + width);
                self.want(rows.clone().flat_map(|row| &closest[row]));
                if !self.wanted.contains(&true) {
                    continue;
                }
                let block = lattice.part(block);
                self.find_all(&block);
                self.add_layers(shader, photographs, &block);
                for (row, pixels) in (0..).zip(rows) {
                    for (column, color) in (0..).zip(&mut colors[pixels]) {
                        let at = row as usize * width + column as usize;
                        if self.wanted[at] {
                            let (x, y) = block.place(column, row);
                            *color = Some(self.sums[at].before(shader.shader().behind(x, y)));
                        }
                    }
                }
            }
        }
    }

    /// Takes note of the rays to composite: those whose closest hit is translucent.
    fn want<'h>(&mut self, closest: impl Iterator<Item = &'h u32>) {
        let View { scene, accel, .. } = self.view;
        self.wanted.clear();
        // Neighbouring rays mostly hit the same triangle.
        let mut last = (MISS, false);
        self.wanted.extend(closest.map(|&primitive| {
            if primitive != last.0 {
                let shows_through = || self.translucent.shows_through(scene, accel, primitive);
                last = (primitive, primitive != MISS && shows_through());
            }
            last.1
        }));
    }

    /// Finds the hits of a block's wanted rays.
    fn find_all(&mut self, block: &Lattice) {
        let View {
            scene,
            accel,
            settings,
            ..
        } = self.view;
        let translucent = self.translucent;
        let options = (settings.cull, settings.precision);
        let is_opaque = |primitive| !translucent.shows_through(scene, accel, primitive);
        (self.all).find(&self.clipped, block, options, &self.wanted, &is_opaque);
        self.sums.clear();
        self.sums.resize(block.len(), Sum::NONE);
    }

    /// Composites the layers of a block's rays.
    fn add_layers(
        &mut self,
        shader: &mut TileShader<'_>,
        photographs: Option<&Photographs<'_>>,
        block: &Lattice,
    ) {
        let View {
            accel, settings, ..
        } = self.view;
        let (cull, precision) = (settings.cull, settings.precision);
        let mut rays = Rect {
            x: 0,
            y: 0,
            width: block.columns,
            height: block.rows,
        };
        for layer in 0.. {
            // Rays that have a layer have those before it.
            rays = self.rays_with(layer, rays, block.columns);
            if rays.area() == 0 {
                return;
            }
            let sums = indices(rays, block.columns);
            let mut primitives = std::mem::take(&mut self.layer.primitives);
            primitives.clear();
            primitives.extend((sums.clone()).map(|ray| self.hit(ray, layer).unwrap_or(MISS)));
            self.layer.primitives = primitives;
            let lattice = &block.part(rays);
            accel.interpolate_numbers(lattice, cull, precision, HitNumbers::All, &mut self.layer);
            shader.light(lattice, &self.layer, &mut self.light);
            shader.opacities(lattice, &self.layer, &mut self.opacities);
            if let Some(photographs) = photographs {
                for (at, light) in self.light.iter_mut().enumerate() {
                    let ray = at as u32;
                    let place = lattice.place(ray % lattice.columns, ray / lattice.columns);
                    let hit = self.layer.get(at);
                    *light = photographs
                        .color_if_hidden(shader, place, &hit)
                        .unwrap_or(*light);
                }
            }
            for (at, ray) in sums.enumerate() {
                if self.layer.primitives[at] != MISS {
                    self.sums[ray].add(self.light[at], self.opacities[at]);
                }
            }
        }
    }

    /// The hit of a block's ray with its layer of this number, counted from 0, if it has one and that is seen.
    fn hit(&self, ray: usize, layer: usize) -> Option<u32> {
        let is_seen = self.sums[ray].transmittance != 0.0;
        self.all.of(ray).get(layer).copied().filter(|_| is_seen)
    }

    /// The smallest rectangle that has all rays of another with a layer of this number.
    fn rays_with(&self, layer: usize, among: Rect, columns: u32) -> Rect {
        let (mut left, mut right, mut top, mut bottom) = (u32::MAX, 0, u32::MAX, 0);
        for y in among.y..among.bottom() {
            for x in among.x..among.right() {
                if self.hit((y * columns + x) as usize, layer).is_some() {
                    (left, right) = (left.min(x), right.max(x + 1));
                    (top, bottom) = (top.min(y), bottom.max(y + 1));
                }
            }
        }
        Rect {
            x: left,
            y: top,
            width: right.saturating_sub(left),
            height: bottom.saturating_sub(top),
        }
    }
}

/// The numbers of a rectangle's rays in a block of so many columns, row by row.
fn indices(rays: Rect, columns: u32) -> impl Iterator<Item = usize> + Clone {
    (rays.y..rays.bottom())
        .flat_map(move |y| (rays.x..rays.right()).map(move |x| (y * columns + x) as usize))
}

impl Sum {
    /// No layers.
    const NONE: Self = Self {
        light: Vec3::ZERO,
        transmittance: 1.0,
    };

    /// Adds a layer behind the others.
    fn add(&mut self, [r, g, b, _]: [f32; 4], opacity: f32) {
        if opacity != 0.0 {
            self.light += Vec3::new(r, g, b) * (self.transmittance * opacity);
        }
        self.transmittance *= 1.0 - opacity;
        if self.transmittance < SEEN {
            self.transmittance = 0.0;
        }
    }

    /// The layers before a colour, which has straight alpha: with straight alpha.
    fn before(self, [r, g, b, a]: [f32; 4]) -> [f32; 4] {
        let light = self.light + Vec3::new(r, g, b) * (self.transmittance * a);
        let alpha = 1.0 - self.transmittance * (1.0 - a);
        let color = if alpha > 0.0 {
            light / alpha
        } else {
            Vec3::ZERO
        };
        [color.x, color.y, color.z, alpha]
    }
}
