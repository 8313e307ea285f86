//! Normals and colours of triangles without normals at their corners, eight at once.
//!
//! A [`Facet`](super::facet::Facet) is of 300 bytes, and one is prepared at a time. Where smooth pictures show a
//! triangle's own normal, this is all they need of it, with the bits of its facet.

use super::Shader;
use super::flat_colors::Directions;
use super::triangle_cache::TriangleCache;
use crate::num::simd::{LANES, Lanes, Work};
use glam::Vec3;

/// Entries of the cache, 28 kilobytes: several for each triangle that 64 × 64 pixels show where triangles are a few
/// pixels wide.
const ENTRIES: usize = 1024;

/// A triangle of one normal and one colour.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlainFacet {
    /// The unit normal in world space, towards the eye.
    pub(super) normal: Vec3,
    /// Linear light.
    pub(super) color: Vec3,
}

impl PlainFacet {
    /// All zero.
    pub(super) const ZERO: Self = Self {
        normal: Vec3::ZERO,
        color: Vec3::ZERO,
    };
}

/// The triangles that neighbouring samples show.
pub(super) type PlainFacets = TriangleCache<PlainFacet, ENTRIES>;

/// Caches the first sample's triangle and up to seven others that are not cached.
pub(super) struct PreparePlainFacets<'t, 's> {
    pub(super) shader: &'s Shader<'s>,
    pub(super) known: &'t mut PlainFacets,
    /// Samples of a tile, from the first on that shows a triangle that is not cached.
    pub(super) samples: &'t [u32],
}

impl Work for PreparePlainFacets<'_, '_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self { shader, known, .. } = self;
        let unknown = known.unknown(lanes, self.samples);
        let corners = shader
            .accel()
            .eight_corners::<true>(lanes, &unknown.primitives);
        let Directions { normals, .. } = Directions::of(shader, &corners);
        let mut facets = [PlainFacet::ZERO; LANES];
        for (lane, facet) in facets.iter_mut().enumerate() {
            facet.normal = normals.get(lane);
        }
        match shader.only_color() {
            Some(color) => facets.iter_mut().for_each(|facet| facet.color = color),
            None => {
                for (facet, &primitive) in facets.iter_mut().zip(&unknown.primitives) {
                    let (object, number) = shader.accel().identify(primitive);
                    facet.color = shader.triangle_color(object, number, primitive);
                }
            }
        }
        known.set_all(&unknown, &facets);
    }
}
