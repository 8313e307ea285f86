use super::eight::HitRows;
use super::facet::{Facet, SurfaceTriangle};
use super::translucent::{Translucent, shell};
use super::{Shader, srgb};
use crate::camera::{Lattice, Rect};
use crate::num::simd::{Lanes, Work, dispatch};
use crate::{Hits, MISS, PrimitiveHit};
use glam::{DVec3, Vec3};

/// How many triangles' colours are remembered: most of what 64 × 64 pixels show of triangles a few
/// pixels wide, in two kilobytes.
const COLORS: usize = 256;

/// How many triangles are remembered: as many, though one takes some 300 bytes. They are worth it: a
/// small triangle comes back in the next row.
const FACETS: usize = 256;

/// Pixels that are looked at together: most show one triangle, or none.
const RUN: usize = 16;

/// A [`Shader`] for many pixels near each other, which mostly show triangles already seen.
///
/// What it remembers changes nothing but the time: every answer is that of the [`Shader`].
#[derive(Debug)]
pub struct TileShader<'s> {
    shader: &'s Shader<'s>,
    /// Colours of triangles that have but one, by the low bits of their primitive index.
    colors: [(u32, [u8; 4]); COLORS],
    /// The triangles themselves, where every pixel has a colour of its own.
    facets: Vec<(u32, Facet)>,
    /// The triangles as channels beside colours have them.
    surfaces: Vec<(u32, SurfaceTriangle)>,
}

impl Shader<'_> {
    /// A shader for many pixels, on one thread: it remembers the triangles that it has shaded.
    pub fn tile(&self) -> TileShader<'_> {
        TileShader::new(self)
    }
}

impl<'s> TileShader<'s> {
    pub(super) fn new(shader: &'s Shader<'s>) -> Self {
        Self {
            shader,
            colors: [(MISS, [0; 4]); COLORS],
            facets: Vec::new(),
            surfaces: Vec::new(),
        }
    }

    /// A triangle as channels beside colours have it, cached or made ready: for the pixels at `x` alone, if they have an
    /// eye of their own.
    #[inline(always)]
    pub(super) fn surface(&mut self, primitive: u32, x: f64) -> &SurfaceTriangle {
        let place = primitive as usize % FACETS;
        let known = self.surfaces.get(place);
        if known.is_none_or(|(known, _)| *known != primitive) || self.shader.has_many_eyes() {
            self.new_surface(primitive, x);
        }
        &self.surfaces[place].1
    }

    #[inline(never)]
    fn new_surface(&mut self, primitive: u32, x: f64) {
        let surface = (primitive, self.shader.surface_triangle(primitive, x));
        if self.surfaces.is_empty() {
            self.surfaces = vec![surface; FACETS];
        }
        self.surfaces[primitive as usize % FACETS] = surface;
    }

    /// What it shades as.
    pub fn shader(&self) -> &'s Shader<'s> {
        self.shader
    }

    /// As [`Shader::color`].
    pub fn color(&mut self, x: f64, y: f64, hit: &PrimitiveHit) -> [f32; 4] {
        if hit.primitive == MISS {
            return self.shader.behind(x, y);
        }
        let shader = self.shader;
        shader.color_on(self.facet(hit.primitive, x), x, y, hit)
    }

    /// As [`Shader::shade_pixel8`].
    pub fn pixel8(&mut self, x: f64, y: f64, hit: &PrimitiveHit) -> [u8; 4] {
        if hit.primitive == MISS {
            srgb::encode(self.shader.behind(x, y))
        } else {
            srgb::encode(self.color(x, y, hit))
        }
    }

    /// Where the texture was taken that a hit shows if it is seen from there; `None` where its colour does not depend on
    /// that.
    pub(crate) fn taken_from(&mut self, x: f64, hit: &PrimitiveHit) -> Option<DVec3> {
        let shader = self.shader;
        shader.taken_from(self.facet(hit.primitive, x), hit)
    }

    /// As [`Shader::color`] of a hit on a triangle, without its texture.
    pub(crate) fn untextured(&mut self, x: f64, y: f64, hit: &PrimitiveHit) -> [f32; 4] {
        let shader = self.shader;
        let facet = Facet {
            texture: None,
            ..*self.facet(hit.primitive, x)
        };
        shader.color_on(&facet, x, y, hit)
    }

    /// A layer's colour, linear light, and how much of what lies behind it covers: `along` is the unit vector of the ray.
    pub(crate) fn layer(
        &mut self,
        (x, y): (f64, f64),
        along: Vec3,
        hit: &PrimitiveHit,
    ) -> (Vec3, f32) {
        let shader = self.shader();
        let covers = match shader.translucent() {
            Some(Translucent::All(alpha)) => {
                let normal = self.facet(hit.primitive, x).normal_at(hit.u, hit.v);
                shell(*alpha, normal.dot(along).abs())
            }
            Some(Translucent::Blended(_)) => shader.alpha(hit),
            None => 1.0,
        };
        if covers == 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        let [r, g, b, _] = self.color(x, y, hit);
        (Vec3::new(r, g, b), covers)
    }

    /// Colours the pixels of `rect`, given as its rows, from hits at their centres, row by row.
    ///
    /// Pixels without a hit show what is behind everything; those beyond the rectangle are left alone.
    pub fn shade<'p>(
        &mut self,
        rect: Rect,
        hits: &Hits,
        rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        if let Some(colors) = self.shader.eight_colors() {
            return self.shade_in_eights(colors, rect, HitRows::new(hits), rows);
        }
        let columns = rect.width as usize;
        for (y, pixels) in rows.enumerate().take(rect.height as usize) {
            let pixels = within(pixels, columns);
            let row = rect.y + y as u32;
            self.shade_hits(rect.x, row, hits, y * columns, pixels);
            self.shader.clear_beyond(rect.x, row, pixels);
        }
    }

    /// The colours of the samples at a lattice's rays, row by row, from their hits: linear light, alpha not multiplied in.
    pub(crate) fn light(&mut self, lattice: &Lattice, hits: &Hits, light: &mut Vec<[f32; 4]>) {
        light.resize(lattice.len(), [0.0; 4]);
        if let Some(colors) = self.shader.eight_colors() {
            return self.light_in_eights(colors, *lattice, hits, light);
        }
        let rows = light.chunks_mut(lattice.columns.max(1) as usize);
        for (row, light) in (0..).zip(rows) {
            let behind = self.shader.behind_row(lattice.place(0, row).1);
            for (column, light) in (0..).zip(light) {
                let hit = hits.get((row * lattice.columns + column) as usize);
                let (x, y) = lattice.place(column, row);
                *light = match behind {
                    Some(behind) if hit.is_miss() => behind,
                    _ => self.color(x, y, &hit),
                };
            }
        }
    }

    /// Some pixels of a row, one by one: the hits from `first` on.
    fn shade_hits(&mut self, left: u32, y: u32, hits: &Hits, first: usize, pixels: &mut [[u8; 4]]) {
        let backdrop = self.shader.backdrop8(y);
        let y = f64::from(y) + 0.5;
        for (column, pixel) in pixels.iter_mut().enumerate() {
            let hit = hits.get(first + column);
            let x = f64::from(left) + column as f64 + 0.5;
            *pixel = if hit.primitive == MISS && !self.shader.has_overlay() {
                backdrop
            } else {
                srgb::encode(self.color(x, y, &hit))
            };
        }
    }

    /// As [`TileShader::shade`] where the triangles alone are known: for pictures whose
    /// [`Shader::detail`] asks for no more.
    pub fn shade_primitives<'p>(
        &mut self,
        rect: Rect,
        primitives: &[u32],
        rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        let is_constant = self.shader.is_constant() && !self.shader.has_overlay();
        if let (false, Some(colors)) = (is_constant, self.shader.eight_colors()) {
            let hits = HitRows::of_primitives(primitives);
            return self.shade_in_eights(colors, rect, hits, rows);
        }
        dispatch(
            self.shader.simd(),
            ShadePrimitives {
                shader: self,
                rect,
                primitives,
                rows,
            },
        );
    }

    /// Pixels of a row, from column `left` on. `CONSTANT` says whether triangles have but one colour.
    #[inline(always)]
    fn shade_row<const CONSTANT: bool>(
        &mut self,
        left: u32,
        y: u32,
        primitives: &[u32],
        pixels: &mut [[u8; 4]],
    ) {
        let count = primitives.len().min(pixels.len());
        let (primitives, pixels) = (&primitives[..count], &mut pixels[..count]);
        let backdrop = self.shader.backdrop8(y);
        let y = f64::from(y) + 0.5;
        // A miss is one more triangle of one colour, which changes from row to row.
        self.colors[MISS as usize % COLORS] = (MISS, backdrop);
        let (runs, _) = primitives.as_chunks::<RUN>();
        for (run, primitives) in runs.iter().enumerate() {
            let pixels = &mut pixels[run * RUN..run * RUN + RUN];
            let left = left + (run * RUN) as u32;
            if *primitives == [primitives[0]; RUN] && (CONSTANT || primitives[0] == MISS) {
                pixels.fill(self.constant(f64::from(left) + 0.5, y, primitives[0]));
            } else {
                self.shade_each::<CONSTANT>(left, y, primitives, pixels);
            }
        }
        let done = runs.len() * RUN;
        let left = left + done as u32;
        self.shade_each::<CONSTANT>(left, y, &primitives[done..], &mut pixels[done..]);
    }

    /// Some pixels of a row, one by one.
    #[inline(always)]
    fn shade_each<const CONSTANT: bool>(
        &mut self,
        left: u32,
        y: f64,
        primitives: &[u32],
        pixels: &mut [[u8; 4]],
    ) {
        for (column, (&primitive, pixel)) in primitives.iter().zip(pixels).enumerate() {
            let x = f64::from(left) + column as f64 + 0.5;
            *pixel = if CONSTANT || primitive == MISS {
                self.constant(x, y, primitive)
            } else {
                srgb::encode(self.color(x, y, &on(primitive)))
            };
        }
    }

    /// The colour of a triangle that has but one, or of a miss.
    #[inline(always)]
    fn constant(&mut self, x: f64, y: f64, primitive: u32) -> [u8; 4] {
        let (known, color) = self.colors[primitive as usize % COLORS];
        if known == primitive {
            color
        } else {
            self.new_constant(x, y, primitive)
        }
    }

    #[inline(never)]
    fn new_constant(&mut self, x: f64, y: f64, primitive: u32) -> [u8; 4] {
        // Another triangle may have taken the place of the miss.
        let color = if primitive != MISS && self.shader.is_constant() {
            self.shader.constant_color(primitive)
        } else {
            self.shader.color(x, y, &on(primitive))
        };
        let color = srgb::encode(color);
        self.colors[primitive as usize % COLORS] = (primitive, color);
        color
    }

    /// A triangle, remembered or made ready: for the pixels at `x` alone, if they have an eye of their own.
    #[inline(always)]
    pub(super) fn facet(&mut self, primitive: u32, x: f64) -> &Facet {
        let place = primitive as usize % FACETS;
        if self
            .facets
            .get(place)
            .is_none_or(|(known, _)| *known != primitive)
            || self.shader.has_many_eyes()
        {
            self.remember(primitive, x);
        }
        &self.facets[place].1
    }

    #[inline(never)]
    fn remember(&mut self, primitive: u32, x: f64) {
        if self.facets.is_empty() {
            self.facets = vec![(MISS, Facet::NONE); FACETS];
        }
        let (known, facet) = &mut self.facets[primitive as usize % FACETS];
        *known = primitive;
        self.shader
            .make_ready(facet, primitive, self.shader.needs(), x);
    }
}

/// The pixels of a row that are within a rectangle of so many columns.
#[inline(always)]
pub(super) fn within(pixels: &mut [[u8; 4]], columns: usize) -> &mut [[u8; 4]] {
    let count = pixels.len().min(columns);
    &mut pixels[..count]
}

/// What [`TileShader::shade_primitives`] is asked.
struct ShadePrimitives<'t, 's, 'h, R> {
    shader: &'t mut TileShader<'s>,
    rect: Rect,
    primitives: &'h [u32],
    rows: R,
}

impl<'p, R: Iterator<Item = &'p mut [[u8; 4]]>> Work for ShadePrimitives<'_, '_, '_, R> {
    #[inline(always)]
    fn run(self, _: impl Lanes) {
        let columns = self.rect.width.max(1) as usize;
        let left = self.rect.x;
        let shader = self.shader;
        let constant = shader.shader.is_constant();
        let has_overlay = shader.shader.has_overlay();
        let primitives = self.primitives.chunks(columns);
        for ((y, primitives), pixels) in (self.rect.y..).zip(primitives).zip(self.rows) {
            if has_overlay {
                for (x, (&primitive, pixel)) in (left..).zip(primitives.iter().zip(&mut *pixels)) {
                    let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                    *pixel = shader.pixel8(x, y, &on(primitive));
                }
            } else if constant {
                shader.shade_row::<true>(left, y, primitives, pixels);
            } else {
                shader.shade_row::<false>(left, y, primitives, pixels);
            }
            shader.shader.clear_beyond(left, y, within(pixels, columns));
        }
    }
}

/// A hit of which nothing is known but the triangle.
fn on(primitive: u32) -> PrimitiveHit {
    PrimitiveHit {
        primitive,
        ..PrimitiveHit::NONE
    }
}
