use super::View;
use crate::hit::{Cull, MISS, PrimitiveHit};
use crate::scene::Masks;
use crate::shade::TileShader;
use crate::single::Clipped;

/// Tests whether hits are visible from the cameras of photographs that are projected onto them. Hits that are not show
/// their object's own colours.
///
/// These rays hit what the picture's rays can hit, and are always cast exactly.
#[derive(Debug)]
pub(super) struct Photographs<'s> {
    clipped: Clipped<'s>,
    cull: Cull,
}

impl<'s> Photographs<'s> {
    pub(super) fn new(view: &'s View, masks: Option<&'s Masks<'s>>) -> Self {
        Self {
            clipped: view.accel.clipped(&view.settings.clip).masked(masks),
            cull: view.settings.cull,
        }
    }

    /// The colour of the sample at (x, y) of the picture (linear light, straight alpha) if its hit has a photograph
    /// whose camera does not see the hit; `None` otherwise.
    pub(super) fn color_if_hidden(
        &self,
        shader: &mut TileShader<'_>,
        (x, y): (f64, f64),
        hit: &PrimitiveHit,
    ) -> Option<[f32; 4]> {
        if hit.primitive == MISS {
            return None;
        }
        let eye = shader.taken_from(x, hit)?;
        let is_seen = self.clipped.is_seen_from(eye, hit, self.cull);
        (!is_seen).then(|| shader.untextured(x, y, hit))
    }
}
