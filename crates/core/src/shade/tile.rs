use super::facet::Facet;
use super::{Shader, srgb};
use crate::accel::{MISS, SlotHit};
use crate::camera::Rect;

/// How many triangles' colours a tile remembers: most of what 64 × 64 pixels show of triangles a
/// few pixels wide, in two kilobytes.
const COLORS: usize = 256;

/// How many triangles a tile remembers: fewer, because one takes some 300 bytes.
const FACETS: usize = 64;

/// A [`Shader`] for many pixels near each other, which mostly show triangles already met.
///
/// What it remembers changes nothing but the time: every answer is that of the [`Shader`].
#[derive(Debug)]
pub struct TileShader<'s> {
    shader: &'s Shader<'s>,
    /// Colours of triangles that have but one, by the low bits of their slot.
    colors: [(u32, [u8; 4]); COLORS],
    /// The triangles themselves, where every pixel has a colour of its own.
    facets: Vec<(u32, Facet)>,
}

impl<'s> TileShader<'s> {
    pub(super) fn new(shader: &'s Shader<'s>) -> Self {
        Self {
            shader,
            colors: [(MISS, [0; 4]); COLORS],
            facets: Vec::new(),
        }
    }

    /// As [`Shader::color`].
    pub fn color(&mut self, x: f64, y: f64, hit: &SlotHit) -> [f32; 4] {
        if hit.slot == MISS {
            return self.shader.backdrop(y);
        }
        let shader = self.shader;
        shader.color_on(self.facet(hit.slot), x, y, hit)
    }

    /// As [`Shader::shade_pixel8`].
    pub fn pixel8(&mut self, x: f64, y: f64, hit: &SlotHit) -> [u8; 4] {
        if hit.slot == MISS {
            srgb::encode(self.shader.backdrop(y))
        } else if self.shader.is_constant() {
            self.constant(x, y, hit)
        } else {
            srgb::encode(self.color(x, y, hit))
        }
    }

    /// As [`Shader::shade_tile`].
    pub fn shade(&mut self, rect: Rect, hits: &[SlotHit], pixels: &mut [[u8; 4]]) {
        let columns = rect.width.max(1) as usize;
        let constant = self.shader.is_constant();
        let rows = hits.chunks(columns).zip(pixels.chunks_mut(columns));
        for (row, (hits, pixels)) in rows.enumerate() {
            let y = f64::from(rect.y) + row as f64 + 0.5;
            let backdrop = srgb::encode(self.shader.backdrop(y));
            for (column, (hit, pixel)) in hits.iter().zip(pixels).enumerate() {
                let x = f64::from(rect.x) + column as f64 + 0.5;
                *pixel = if hit.slot == MISS {
                    backdrop
                } else if constant {
                    self.constant(x, y, hit)
                } else {
                    srgb::encode(self.color(x, y, hit))
                };
            }
        }
    }

    /// The colour of a triangle that has but one.
    #[inline]
    fn constant(&mut self, x: f64, y: f64, hit: &SlotHit) -> [u8; 4] {
        let (slot, color) = self.colors[hit.slot as usize % COLORS];
        if slot == hit.slot {
            return color;
        }
        let color = srgb::encode(self.shader.color(x, y, hit));
        self.colors[hit.slot as usize % COLORS] = (hit.slot, color);
        color
    }

    /// A triangle, remembered or made.
    #[inline]
    fn facet(&mut self, slot: u32) -> &Facet {
        let shader = self.shader;
        let needs = shader.needs();
        if self.facets.is_empty() {
            let first = shader.facet(slot, needs);
            self.facets = vec![(slot, first); FACETS];
        }
        let place = slot as usize % FACETS;
        if self.facets[place].0 != slot {
            self.facets[place] = (slot, shader.facet(slot, needs));
        }
        &self.facets[place].1
    }
}
