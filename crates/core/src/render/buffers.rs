//! A worker's buffers, and the colours that need more rays than those to the closest hits.

use super::compositor::Compositor;
use super::photographs::Photographs;
use super::view::View;
use crate::camera::{Lattice, Rect};
use crate::hit::Detail;
use crate::hits::Hits;
use crate::picture::Layers;
use crate::shade::{Shader, TileShader};

/// A worker's buffers, reused from tile to tile.
#[derive(Debug)]
pub(super) struct Buffers<'s> {
    pub(super) hits: Hits,
    /// The colours of one sample a pixel: linear light, straight alpha.
    pub(super) light: Vec<[f32; 4]>,
    /// The colours of a sparse lattice.
    pub(super) pixels: Vec<[u8; 4]>,
    /// The layers of a tile that is done: new memory for each tile would have to be given by the system each time.
    pub(super) layers: Option<Layers>,
    pub(super) shader: TileShader<'s>,
    /// What [`Buffers::cast_secondary_rays`] found.
    pub(super) secondary: Vec<Option<[f32; 4]>>,
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
            pixels: Vec::new(),
            layers: None,
            shader: shader.tile(),
            secondary: Vec::new(),
            compositor: shader.translucent().map(compositor),
            photographs: (shader.has_photographs()).then(|| Photographs::new(view, shader.masks())),
        }
    }

    /// Shades a rectangle by its closest hits alone; t, u and v must be interpolated where colours depend on them.
    pub(super) fn shade_closest<'p>(
        &mut self,
        rect: Rect,
        rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        let Self { shader, hits, .. } = self;
        match shader.shader().detail() {
            Detail::Triangle => shader.shade_primitives(rect, &hits.primitives, rows),
            Detail::Full => shader.shade(rect, hits, rows),
        }
    }

    /// Whether colours may need rays besides the one to the closest hit: for further layers, or for visibility from a
    /// photograph's camera.
    pub(super) fn casts_secondary_rays(&self) -> bool {
        self.compositor.is_some() || self.photographs.is_some()
    }

    /// [`TileShader::light`] with these additional rays.
    pub(super) fn light_with_secondary_rays(
        &mut self,
        lattice: &Lattice,
        light: &mut Vec<[f32; 4]>,
    ) {
        self.shader.light(lattice, &self.hits, light);
        self.cast_secondary_rays(lattice);
        for (light, secondary) in light.iter_mut().zip(&self.secondary) {
            *light = secondary.unwrap_or(*light);
        }
    }

    /// Computes the colours of a lattice's samples (linear light, straight alpha) where that of the closest hit is not the
    /// answer: where further layers show, or the camera of a photograph does not see the hit. `None` elsewhere.
    pub(super) fn cast_secondary_rays(&mut self, lattice: &Lattice) {
        let Self {
            hits,
            shader,
            compositor,
            photographs,
            secondary,
            ..
        } = self;
        secondary.clear();
        secondary.resize(lattice.len(), None);
        let photographs = photographs.as_ref();
        if let Some(compositor) = compositor {
            compositor.composite(shader, photographs, lattice, &hits.primitives, secondary);
        }
        let Some(photographs) = photographs else {
            return;
        };
        for (at, secondary) in secondary.iter_mut().enumerate() {
            let ray = at as u32;
            let place = lattice.place(ray % lattice.columns, ray / lattice.columns);
            let hit = hits.get(at);
            let hidden = || photographs.color_if_hidden(shader, place, &hit);
            *secondary = secondary.or_else(hidden);
        }
    }
}
