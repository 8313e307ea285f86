use super::View;
use super::photographs::Photographs;
use crate::hit::MISS;
use crate::scene::Masks;
use crate::shade::{SEEN, TileShader, Translucent};
use crate::single::{Clipped, OrderedHits};
use glam::Vec3;

/// Composites the layers of rays whose closest hit is translucent.
#[derive(Debug)]
pub(super) struct Compositor<'s> {
    view: &'s View,
    translucent: &'s Translucent,
    clipped: Clipped<'s>,
    layers: OrderedHits,
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
            layers: OrderedHits::default(),
        }
    }

    /// The colour of the sample at (x, y) of the picture, whose ray hits `primitive` first: its layers from front to
    /// back, in linear light with straight alpha. `None` if the first hit is opaque, or the ray hits nothing.
    pub(super) fn color(
        &mut self,
        shader: &mut TileShader<'_>,
        photographs: Option<&Photographs<'_>>,
        (x, y): (f64, f64),
        primitive: u32,
    ) -> Option<[f32; 4]> {
        let View {
            scene,
            accel,
            camera,
            settings,
        } = self.view;
        let translucent = self.translucent;
        let shows_through = |primitive| translucent.shows_through(scene, accel, primitive);
        if primitive == MISS || !shows_through(primitive) {
            return None;
        }
        let ray = camera.ray(x, y);
        let options = (settings.cull, settings.precision);
        (self.layers).find(&self.clipped, &ray, options, |primitive| {
            !shows_through(primitive)
        });
        let along = ray.direction.normalize().as_vec3();
        let mut color = Vec3::ZERO;
        let mut transmittance = 1.0;
        for hit in self.layers.iter() {
            let (mut layer, opacity) = shader.layer((x, y), along, &hit);
            if let Some([r, g, b, _]) = photographs
                .and_then(|photographs| photographs.color_if_hidden(shader, (x, y), &hit))
            {
                layer = Vec3::new(r, g, b);
            }
            color += layer * (transmittance * opacity);
            transmittance *= 1.0 - opacity;
            if transmittance < SEEN {
                transmittance = 0.0;
                break;
            }
        }
        let [r, g, b, a] = shader.shader().behind(x, y);
        color += Vec3::new(r, g, b) * (transmittance * a);
        let alpha = 1.0 - transmittance * (1.0 - a);
        let color = if alpha > 0.0 {
            color / alpha
        } else {
            Vec3::ZERO
        };
        Some([color.x, color.y, color.z, alpha])
    }
}
