//! Colours of distances.

use super::own_color::distance_range;
use super::ramp::{Ramp, RampRange};
use super::srgb::Tables;
use crate::camera::Camera;
use crate::num::simd::{F32x8, Lanes, Mask8};
use crate::scene::{ColorScale, Scene};
use glam::Vec3;

/// How the depth mode shows distances.
#[derive(Debug)]
pub(super) enum DepthColors {
    /// In greys: distances below this are lightest, and one over how far the greys reach; zero if it has no
    /// length.
    Greys { near: f32, per_unit: f32 },
    /// Through a colour map.
    Map(Box<Ramp>, RampRange),
}

impl DepthColors {
    /// sRGB grey at the near and the far end.
    const NEAR_GREY: f32 = 0.96;
    const FAR_GREY: f32 = 0.08;

    /// Greys over no distance at all.
    pub(super) const NONE: Self = Self::Greys {
        near: 0.0,
        per_unit: 0.0,
    };

    pub(super) fn new(scene: &Scene, camera: &Camera, scale: Option<ColorScale>) -> Self {
        let range = distance_range(&scene.bounds(), camera, None);
        match scale {
            Some(scale) => Self::Map(
                Box::new(Ramp::new(scale.map)),
                RampRange::of(scale.range.or(range)),
            ),
            None => match range {
                None => Self::NONE,
                Some([near, far]) => Self::Greys {
                    near: near as f32,
                    per_unit: if far > near {
                        (1.0 / (far - near)) as f32
                    } else {
                        0.0
                    },
                },
            },
        }
    }

    /// Linear light.
    pub(super) fn at(&self, t: f32, tables: &Tables) -> Vec3 {
        match self {
            Self::Greys { near, per_unit } => {
                let share = ((t - near) * per_unit).clamp(0.0, 1.0);
                let grey = Self::NEAR_GREY + (Self::FAR_GREY - Self::NEAR_GREY) * share;
                Vec3::splat(tables.display(grey))
            }
            Self::Map(ramp, span) => ramp.at(span.share(t.into())),
        }
    }

    /// Whether distances are greys, and [`DepthColors::eight_greys`] has them.
    pub(super) fn are_grey(&self) -> bool {
        matches!(self, Self::Greys { .. })
    }

    /// sRGB greys of eight distances, 0 to 1.
    #[inline(always)]
    pub(super) fn eight_greys<L: Lanes>(&self, lanes: L, t: L::F32) -> L::F32 {
        let Self::Greys { near, per_unit } = *self else {
            return lanes.splat(0.0);
        };
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        let share = (t - near) * per_unit;
        // What is no number stays none.
        let share = share.lt(zero).select(zero, share);
        let share = one.lt(share).select(one, share);
        share * (Self::FAR_GREY - Self::NEAR_GREY) + Self::NEAR_GREY
    }
}
