use super::facet::Facet;
use super::{Shader, srgb};
use crate::accel::{MISS, SlotHit};
use crate::camera::Rect;

/// How many triangles' colours a tile remembers: most of what 64 × 64 pixels show of triangles a
/// few pixels wide, in two kilobytes.
const COLORS: usize = 256;

/// How many triangles a tile remembers: fewer, because one takes some 300 bytes.
const FACETS: usize = 64;

/// Pixels that are looked at together: most show one triangle, or none.
const RUN: usize = 8;

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
        } else {
            srgb::encode(self.color(x, y, hit))
        }
    }

    /// As [`Shader::shade_tile`].
    pub fn shade(&mut self, rect: Rect, hits: &[SlotHit], pixels: &mut [[u8; 4]]) {
        let columns = rect.width.max(1) as usize;
        let rows = hits.chunks(columns).zip(pixels.chunks_mut(columns));
        for (row, (hits, pixels)) in rows.enumerate() {
            let y = f64::from(rect.y) + row as f64 + 0.5;
            let backdrop = srgb::encode(self.shader.backdrop(y));
            for (column, (hit, pixel)) in hits.iter().zip(pixels).enumerate() {
                let x = f64::from(rect.x) + column as f64 + 0.5;
                *pixel = if hit.slot == MISS {
                    backdrop
                } else {
                    srgb::encode(self.color(x, y, hit))
                };
            }
        }
    }

    /// As [`Shader::shade_slots`].
    pub fn shade_slots(&mut self, rect: Rect, slots: &[u32], pixels: &mut [[u8; 4]]) {
        let columns = rect.width.max(1) as usize;
        let constant = self.shader.is_constant();
        let rows = slots.chunks(columns).zip(pixels.chunks_mut(columns));
        for (row, (slots, pixels)) in rows.enumerate() {
            let count = slots.len().min(pixels.len());
            let (slots, pixels) = (&slots[..count], &mut pixels[..count]);
            let y = f64::from(rect.y) + row as f64 + 0.5;
            let backdrop = srgb::encode(self.shader.backdrop(y));
            // A miss is one more triangle of one colour, which changes from row to row.
            self.colors[MISS as usize % COLORS] = (MISS, backdrop);
            let (runs, _) = slots.as_chunks::<RUN>();
            for (run, slots) in runs.iter().enumerate() {
                let pixels = &mut pixels[run * RUN..run * RUN + RUN];
                let mut differ = 0;
                for &slot in slots {
                    differ |= slot ^ slots[0];
                }
                if differ == 0 && (slots[0] == MISS || constant) {
                    let x = f64::from(rect.x) + (run * RUN) as f64 + 0.5;
                    pixels.fill(self.constant(x, y, slots[0], backdrop));
                } else {
                    self.shade_run(rect.x + (run * RUN) as u32, y, slots, pixels, backdrop);
                }
            }
            let done = runs.len() * RUN;
            let (slots, pixels) = (&slots[done..], &mut pixels[done..]);
            self.shade_run(rect.x + done as u32, y, slots, pixels, backdrop);
        }
    }

    /// Some pixels of a row, from column `left` on, one by one.
    #[inline(always)]
    fn shade_run(
        &mut self,
        left: u32,
        y: f64,
        slots: &[u32],
        pixels: &mut [[u8; 4]],
        backdrop: [u8; 4],
    ) {
        let constant = self.shader.is_constant();
        for (column, (&slot, pixel)) in slots.iter().zip(pixels).enumerate() {
            let x = f64::from(left) + column as f64 + 0.5;
            *pixel = if slot == MISS || constant {
                self.constant(x, y, slot, backdrop)
            } else {
                srgb::encode(self.color(x, y, &on(slot)))
            };
        }
    }

    /// The colour of a triangle that has but one, or of a miss.
    #[inline(always)]
    fn constant(&mut self, x: f64, y: f64, slot: u32, backdrop: [u8; 4]) -> [u8; 4] {
        let (known, color) = self.colors[slot as usize % COLORS];
        if known == slot {
            return color;
        }
        let color = if slot == MISS {
            backdrop
        } else {
            self.new_color(x, y, slot)
        };
        self.colors[slot as usize % COLORS] = (slot, color);
        color
    }

    #[inline(never)]
    fn new_color(&self, x: f64, y: f64, slot: u32) -> [u8; 4] {
        srgb::encode(self.shader.color(x, y, &on(slot)))
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

/// A hit of which nothing is known but the triangle.
fn on(slot: u32) -> SlotHit {
    SlotHit {
        slot,
        ..SlotHit::NONE
    }
}
