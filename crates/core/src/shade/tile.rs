use super::facet::Facet;
use super::smooth::{Facets, Row, Rows, Vectors};
use super::translucent::{Translucent, shell};
use super::{Shader, srgb};
use crate::camera::{PanoramaRays, Rect};
use crate::num::simd::{LANES, Lanes, Work, dispatch};
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
        }
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
        if self.shader.is_smooth() {
            dispatch(
                self.shader.simd(),
                ShadeSmooth {
                    shader: self,
                    rect,
                    hits,
                    rows,
                },
            );
            return;
        }
        let columns = rect.width as usize;
        for (y, pixels) in rows.enumerate().take(rect.height as usize) {
            let pixels = within(pixels, columns);
            let row = rect.y + y as u32;
            self.shade_hits(rect.x, row, hits, y * columns, pixels);
            self.shader.clear_beyond(rect.x, row, pixels);
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

    /// Eight pixels of a row in the smooth mode, at barycentrics (u, v) of their triangles; `None` where
    /// no triangle has normals or a texture, to which they matter.
    #[inline(always)]
    fn shade_smooth(
        &mut self,
        lanes: impl Lanes,
        rays: &TileRays,
        (left, y): (u32, u32),
        primitives: &[u32; LANES],
        weights: Option<(&Row, &Row)>,
        pixels: &mut [[u8; 4]; LANES],
    ) {
        let shader = self.shader;
        let one = *primitives == [primitives[0]; LANES];
        if one && primitives[0] == MISS {
            pixels.fill(shader.backdrop8(y));
            return;
        }
        let hit = |lane: usize| PrimitiveHit {
            primitive: primitives[lane],
            u: weights.map_or(0.0, |(u, _)| u[lane]),
            v: weights.map_or(0.0, |(_, v)| v[lane]),
            ..PrimitiveHit::NONE
        };
        // Triangles from left to right, each over all lanes from its first on: registers alone, where
        // lanes stored one by one would have to reach memory before eight could be loaded as one.
        let mut facets = Facets::none(lanes);
        let mut colors = Vectors::splat(lanes, Vec3::ZERO);
        let mut each = Rows::ZERO;
        let needs = shader.needs();
        let varied = needs.texture || needs.varied;
        let mut lane = 0;
        while lane < LANES {
            let primitive = primitives[lane];
            let first = lane;
            while lane < LANES && primitives[lane] == primitive {
                lane += 1;
            }
            if primitive == MISS {
                continue;
            }
            let facet = self.facet(primitive, f64::from(left));
            let from = lanes.mask_from(first);
            if varied {
                for lane in first..lane {
                    let place = || (f64::from(left) + lane as f64 + 0.5, f64::from(y) + 0.5);
                    each.set(lane, shader.surface_color(facet, place, &hit(lane)));
                }
            } else {
                colors = colors.replaced(from, Vectors::splat(lanes, facet.color));
            }
            facets = facets.replaced(from, Facets::one(lanes, facet));
        }
        if varied {
            colors = Vectors::load(lanes, &each);
        }
        let to_eye = match &rays.around {
            Some(around) => {
                let to_eye = around.eight_to_eye(left - rays.first.0, y - rays.first.1);
                Vectors::load(lanes, &Rows(to_eye))
            }
            None => {
                let x = std::array::from_fn(|lane| left as f32 + lane as f32 + 0.5);
                shader.eight_to_eye(lanes, (&x, y as f32 + 0.5))
            }
        };
        let light = shader.light(lanes, &facets, weights, to_eye);
        shader.tables.encode_row(lanes, colors.times(light), pixels);
        if !one {
            let backdrop = shader.backdrop8(y);
            for (&primitive, pixel) in primitives.iter().zip(pixels) {
                if primitive == MISS {
                    *pixel = backdrop;
                }
            }
        }
    }

    /// A row in the smooth mode of triangles that have no normals but their own.
    #[inline(always)]
    fn shade_smooth_row(
        &mut self,
        lanes: impl Lanes,
        tile: &TileRays,
        (mut left, y): (u32, u32),
        primitives: &[u32],
        pixels: &mut [[u8; 4]],
    ) {
        let (rows, rest) = primitives.as_chunks();
        let (pixel_rows, pixels) = pixels.as_chunks_mut();
        for (primitives, pixels) in rows.iter().zip(pixel_rows) {
            self.shade_smooth(lanes, tile, (left, y), primitives, None, pixels);
            left += LANES as u32;
        }
        for (x, (&primitive, pixel)) in (left..).zip(rest.iter().zip(pixels)) {
            *pixel = self.pixel8(f64::from(x) + 0.5, f64::from(y) + 0.5, &on(primitive));
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

/// The rays of a tile's pixels, where they are worked out eight at a time.
struct TileRays {
    /// Of a panorama in the smooth mode.
    around: Option<PanoramaRays>,
    /// Column and row of the first pixel.
    first: (u32, u32),
}

impl TileRays {
    fn new(shader: &Shader<'_>, rect: Rect) -> Self {
        Self {
            around: shader.is_smooth().then(|| shader.rays(rect)).flatten(),
            first: (rect.x, rect.y),
        }
    }
}

/// What [`TileShader::shade`] is asked where it shades by the mesh's normals.
struct ShadeSmooth<'t, 's, 'h, R> {
    shader: &'t mut TileShader<'s>,
    rect: Rect,
    hits: &'h Hits,
    rows: R,
}

impl<'p, R: Iterator<Item = &'p mut [[u8; 4]]>> Work for ShadeSmooth<'_, '_, '_, R> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            shader,
            rect,
            hits,
            rows,
        } = self;
        let columns = rect.width as usize;
        let rays = TileRays::new(shader.shader, rect);
        for (y, pixels) in rows.enumerate().take(rect.height as usize) {
            let mut first = y * columns;
            let (mut left, y) = (rect.x, rect.y + y as u32);
            let pixels = within(pixels, columns);
            let (pixel_rows, rest) = pixels.as_chunks_mut();
            for pixels in pixel_rows {
                let weights = eight(&hits.u, first).zip(eight(&hits.v, first));
                if let (Some(primitives), Some(weights)) = (eight(&hits.primitives, first), weights)
                {
                    let weights = Some(weights);
                    shader.shade_smooth(lanes, &rays, (left, y), primitives, weights, pixels);
                }
                first += LANES;
                left += LANES as u32;
            }
            shader.shade_hits(left, y, hits, first, rest);
            shader.shader.clear_beyond(rect.x, y, pixels);
        }
    }
}

/// The pixels of a row that are within a rectangle of so many columns.
#[inline(always)]
fn within(pixels: &mut [[u8; 4]], columns: usize) -> &mut [[u8; 4]] {
    let count = pixels.len().min(columns);
    &mut pixels[..count]
}

/// Eight of a kind.
#[inline(always)]
fn eight<T>(all: &[T], first: usize) -> Option<&[T; LANES]> {
    all.get(first..)?.first_chunk()
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
    fn run(self, lanes: impl Lanes) {
        let columns = self.rect.width.max(1) as usize;
        let left = self.rect.x;
        let shader = self.shader;
        let (constant, smooth) = (shader.shader.is_constant(), shader.shader.is_smooth());
        let has_overlay = shader.shader.has_overlay();
        let rays = TileRays::new(shader.shader, self.rect);
        let primitives = self.primitives.chunks(columns);
        for ((y, primitives), pixels) in (self.rect.y..).zip(primitives).zip(self.rows) {
            if has_overlay {
                for (x, (&primitive, pixel)) in (left..).zip(primitives.iter().zip(&mut *pixels)) {
                    let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                    *pixel = shader.pixel8(x, y, &on(primitive));
                }
            } else if smooth {
                shader.shade_smooth_row(lanes, &rays, (left, y), primitives, pixels);
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
