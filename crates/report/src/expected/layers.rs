//! Layers of translucent surfaces, composited front to back by the formula of `docs/layers.md`, each ray's by itself.

use super::range::{Single, dot, plus, scaled};
use super::{Expected, Hit, light, mask};
use raycast_core::scene::Opacity;
use raycast_core::shade::Mode;
use raycast_oracle::Truth;

/// The transparency below which further layers are not added.
const SEEN: f64 = 1.0 / 4096.0;

/// The most layers.
const MOST: usize = 256;

impl Expected<'_> {
    /// Whether what lies behind a hit shows.
    pub(super) fn shows_through(&self, hit: &Hit<'_>) -> bool {
        match self.shading.mode {
            Mode::XRay => true,
            mode => mode.shows().surfaces && self.is_blended(hit),
        }
    }

    fn is_blended(&self, hit: &Hit<'_>) -> bool {
        matches!(hit.object.mesh.opacity(hit.triangle), Opacity::Blend(_))
    }

    /// The colour of the sample at (x, y) whose first surface lets through what lies behind it. Unknown where rounding decides
    /// which layers count, and with masks, which may reject any.
    pub(super) fn composited(&self, x: f64, y: f64) -> [Single; 4] {
        const UNKNOWN: [Single; 4] = [Single::UNKNOWN; 4];
        let hits = (self.stage).hits_in_order(&self.camera.ray(x, y), self.cull);
        if self.stage.has_masks() || self.have_copies(&hits) {
            return UNKNOWN;
        }
        let one = Single::exactly(1.0);
        let mut color = [Single::exactly(0.0); 3];
        let mut transmittance = one;
        for truth in hits.iter().take(MOST) {
            let Some(hit) = self.hit(truth) else {
                return UNKNOWN;
            };
            let opacity = self.opacity(&hit, truth, (x, y));
            let layer = self.shown(&hit, truth, (x, y));
            color = plus(color, scaled(layer, transmittance * opacity));
            transmittance = transmittance * (one - opacity);
            if transmittance.high < SEEN {
                transmittance = Single::exactly(0.0);
                break;
            }
            // Unknown numbers are not above it.
            let goes_on = transmittance.low > SEEN;
            if !goes_on {
                return UNKNOWN;
            }
        }
        let [r, g, b, a] = self.backdrop(y);
        let [r, g, b] = plus(color, scaled([r, g, b], transmittance * a));
        let alpha = one - transmittance * (one - a);
        [r / alpha, g / alpha, b / alpha, alpha]
    }

    fn opacity(&self, hit: &Hit<'_>, truth: &Truth, (x, y): (f64, f64)) -> Single {
        let one = Single::exactly(1.0);
        if self.shading.mode == Mode::XRay {
            let alpha = Single::exactly(self.shading.x_ray_opacity.clamp(0.0, 1.0).into());
            let to_eye = light::to_eye(&self.camera, x, y);
            let cosine = dot(self.shown_normal(hit), to_eye).abs().min(1.0);
            return alpha / (alpha + (one - alpha) * cosine);
        }
        match hit.object.mesh.opacity(hit.triangle) {
            Opacity::Blend(alpha) => {
                let alpha = mask::alpha(alpha, &hit.object.mesh, truth);
                alpha.unwrap_or(Single::UNKNOWN).max(0.0).min(1.0)
            }
            _ => one,
        }
    }

    /// Whether any two hits are of triangles with the same corners, of which the tree keeps one.
    fn have_copies(&self, hits: &[Truth]) -> bool {
        let corners = |truth: &Truth| {
            let triangle = self.stage.oracle.triangle(truth.object, truth.triangle);
            let mut corners = triangle.map(|triangle| triangle.corners.map(|c| c.to_array()))?;
            corners.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
            Some(corners)
        };
        let same =
            |pair: &[Truth]| pair[0].t == pair[1].t && corners(&pair[0]) == corners(&pair[1]);
        hits.windows(2).any(same)
    }
}
