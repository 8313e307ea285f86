//! A worker's buffers, and the colours that need more rays than those to the closest hits.

use super::compositor::Compositor;
use super::photographs::Photographs;
use super::view::View;
use crate::camera::Lattice;
use crate::hit::PrimitiveHit;
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
            compositor: shader.translucent().map(compositor),
            photographs: (shader.has_photographs()).then(|| Photographs::new(view, shader.masks())),
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
        light.clear();
        for at in 0..lattice.len() {
            let columns = lattice.columns as usize;
            let (x, y) = lattice.place((at % columns) as u32, (at / columns) as u32);
            let hit = self.hits.get(at);
            let secondary = self.secondary_color((x, y), &hit);
            light.push(secondary.unwrap_or_else(|| self.shader.color(x, y, &hit)));
        }
    }

    /// The colour of the sample at (x, y) (linear light, straight alpha) where that of its closest hit `hit` is not the
    /// answer: where further layers show, or the camera of a photograph does not see the hit. `None` elsewhere.
    pub(super) fn secondary_color(
        &mut self,
        place: (f64, f64),
        hit: &PrimitiveHit,
    ) -> Option<[f32; 4]> {
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
            None => photographs?.color_if_hidden(shader, place, hit),
            composited => composited,
        }
    }
}
