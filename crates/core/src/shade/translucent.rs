//! Surfaces that let through what lies behind them: layer over layer, from front to back.
//!
//! A sample's colour is the sum of aᵢ·tᵢ·cᵢ over the ray's hits i = 1, 2, … in exact order, and of t·background, with
//! t₁ = 1 and tᵢ₊₁ = tᵢ·(1 − aᵢ) (Porter and Duff, "Compositing Digital Images", 1984: over), in linear light. cᵢ is the
//! layer's own colour, lit by itself. The sum ends where t is below [`SEEN`], and after 256 layers.
//!
//! * **X-ray.** aᵢ = α / (α + (1 − α)·|cos θᵢ|), θᵢ between the ray and the shading normal, α the picture's: a thin shell
//!   covers α where it is seen from above, and ever more the longer the way through it.
//! * **Blended materials.** aᵢ is the material's alpha; other surfaces cover all. No refraction, and no thickness.

use super::{Mode, Shading};
use crate::bvh::Accel;
use crate::scene::{Opacity, Scene};

/// The remaining transparency below which no further layer is searched: in an 8-bit picture it is at most a sixteenth
/// of a step of the lightest colours, and a step of black. With a smaller value more rays are cast for nothing
/// visible.
pub(crate) const SEEN: f32 = 1.0 / 4096.0;

/// The translucent surfaces of a picture, and their opacity.
#[derive(Clone, Debug)]
pub(crate) enum Translucent {
    /// All surfaces, with at least this opacity.
    All(f32),
    /// Surfaces with blended materials; for each object, whether it has any.
    Blended(Vec<bool>),
}

impl Translucent {
    /// `None` where all surfaces are opaque, and in modes that show properties of hits rather than surfaces.
    pub(super) fn of(scene: &Scene, shading: &Shading) -> Option<Self> {
        match shading.mode {
            Mode::XRay => Some(Self::All(shading.x_ray_opacity.clamp(0.0, 1.0))),
            mode if mode.shows().surfaces => scene
                .objects_whose(|opacity| matches!(opacity, Opacity::Blend(_)))
                .map(Self::Blended),
            _ => None,
        }
    }

    /// Whether a triangle lets what lies behind it show.
    pub(crate) fn shows_through(&self, scene: &Scene, accel: &Accel, primitive: u32) -> bool {
        let Self::Blended(has_any) = self else {
            return true;
        };
        let (object, triangle) = accel.identify(primitive);
        let number = object as usize;
        let mesh = &scene.objects[number].mesh;
        has_any[number] && matches!(mesh.opacity(triangle), Opacity::Blend(_))
    }
}

/// The opacity, at an angle with this cosine, of a thin shell whose opacity is `alpha` seen perpendicularly.
pub(super) fn shell(alpha: f32, cosine: f32) -> f32 {
    if alpha == 0.0 {
        return 0.0;
    }
    alpha / (alpha + (1.0 - alpha) * cosine.min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shells_cover_more_the_longer_the_way_through_them() {
        assert_eq!(shell(0.25, 1.0), 0.25);
        assert_eq!(shell(0.25, 0.0), 1.0);
        assert_eq!((shell(0.0, 0.0), shell(1.0, 0.3)), (0.0, 1.0));
        let covers: Vec<f32> = (0..=10)
            .map(|tenth| shell(0.2, tenth as f32 / 10.0))
            .collect();
        assert!(covers.is_sorted_by(|near, far| near > far));
    }
}
