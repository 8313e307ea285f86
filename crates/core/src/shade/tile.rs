use super::facet::{Facet, SurfaceTriangle};
use super::flat_colors::{LightTriangles, TriangleColors};
use super::hit_rows::HitRows;
use super::plain_facets::{PlainFacet, PlainFacets, PreparePlainFacets};
use super::spans::within;
use super::{Shader, srgb};
use crate::camera::{Lattice, Rect};
use crate::num::simd::{LANES, Lanes, Mask8, Work, dispatch};
use crate::{Hits, MISS, PrimitiveHit};
use glam::DVec3;

/// Entries of the cache of shading triangles, some 300 bytes each. A small triangle comes back in the next row of
/// pixels; with fewer entries it would be prepared again.
const FACETS: usize = 256;

/// Pixels that are tested at once for showing one triangle, or none.
const RUN: usize = 16;

/// A [`Shader`] with caches of triangles, for neighbouring pixels. Its colours are those of the [`Shader`], bit for
/// bit.
#[derive(Debug)]
pub struct TileShader<'s> {
    shader: &'s Shader<'s>,
    /// Colours of triangles with one colour.
    colors: TriangleColors,
    /// Whether colours are computed eight at once, ahead of the samples that show them.
    looks_ahead: bool,
    /// Shading triangles, cached likewise; empty until one is needed.
    facets: Vec<(u32, Facet)>,
    /// What smooth pictures need of triangles without normals at their corners.
    plain_facets: PlainFacets,
    /// Shading triangles for channels beside colours, cached likewise.
    surfaces: Vec<(u32, SurfaceTriangle)>,
}

impl Shader<'_> {
    /// A shader with caches, for one thread.
    pub fn tile(&self) -> TileShader<'_> {
        TileShader::new(self)
    }
}

impl<'s> TileShader<'s> {
    pub(super) fn new(shader: &'s Shader<'s>) -> Self {
        Self {
            shader,
            colors: TriangleColors::new([0; 4]),
            looks_ahead: shader.has_flat_triangles(),
            facets: Vec::new(),
            plain_facets: PlainFacets::new(PlainFacet::ZERO),
            surfaces: Vec::new(),
        }
    }

    /// A shading triangle for channels beside colours, cached or prepared: for the pixels at `x` alone where columns
    /// have eyes of their own.
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

    /// The shader whose colours these are.
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

    /// The eye of the photograph that a hit shows if it is visible from there; `None` where it shows none.
    pub(crate) fn taken_from(&mut self, x: f64, hit: &PrimitiveHit) -> Option<DVec3> {
        let shader = self.shader;
        shader.taken_from(self.facet(hit.primitive, x), hit)
    }

    /// [`Shader::color`] of a hit on a triangle, without its texture.
    pub(crate) fn untextured(&mut self, x: f64, y: f64, hit: &PrimitiveHit) -> [f32; 4] {
        let shader = self.shader;
        let facet = Facet {
            texture: None,
            ..*self.facet(hit.primitive, x)
        };
        shader.color_on(&facet, x, y, hit)
    }

    /// Shades the pixels of `rect`, given as its rows, from the hits at their centres, row by row.
    ///
    /// Pixels without a hit show the background; pixels of `rows` beyond the rectangle stay as they are.
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

    /// Shades the pixels that a lattice's rays go through, row by row, from their hits.
    pub(crate) fn shade_lattice(
        &mut self,
        lattice: &Lattice,
        hits: &Hits,
        pixels: &mut Vec<[u8; 4]>,
    ) {
        pixels.resize(lattice.len(), [0; 4]);
        let is_constant = self.shader.is_constant() && !self.shader.has_overlay();
        let colors = self.shader.eight_colors();
        let colors = colors.filter(|_| !is_constant && lattice.camera.is_filled());
        if let Some(colors) = colors {
            return self.shade_lattice_in_eights(colors, *lattice, hits, pixels);
        }
        let rows = pixels.chunks_mut(lattice.columns.max(1) as usize);
        for (row, pixels) in (0..).zip(rows) {
            for (column, pixel) in (0..).zip(pixels) {
                let hit = hits.get((row * lattice.columns + column) as usize);
                let (x, y) = lattice.place(column, row);
                *pixel = match is_constant && hit.primitive != MISS {
                    true => self.constant(x, y, hit.primitive),
                    false => self.pixel8(x, y, &hit),
                };
            }
        }
    }

    /// Shades the samples of a lattice, row by row, from their hits: linear light, straight alpha.
    pub(crate) fn light(&mut self, lattice: &Lattice, hits: &Hits, light: &mut Vec<[f32; 4]>) {
        light.resize(lattice.len(), [0.0; 4]);
        if let Some(colors) = self.shader.eight_colors() {
            return self.light_in_eights(colors, *lattice, hits, light);
        }
        let rows = light.chunks_mut(lattice.columns.max(1) as usize);
        for (row, light) in (0..).zip(rows) {
            let (left, y) = lattice.place(0, row);
            let (right, _) = lattice.place(lattice.columns.saturating_sub(1), row);
            let behind = self.shader.backdrop_between(left, right, y);
            let behind = behind.filter(|_| !self.shader.has_overlay());
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

    /// [`TileShader::shade`] from the triangles alone, where [`Shader::detail`] needs no more.
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

    /// Shades pixels of a row, from column `left` on.
    #[inline(always)]
    fn shade_row(&mut self, left: u32, y: u32, primitives: &[u32], pixels: &mut [[u8; 4]]) {
        let backdrop = self.shader.backdrop8(y);
        let y = f64::from(y) + 0.5;
        let runs = primitives.chunks(RUN).zip(pixels.chunks_mut(RUN));
        for (run, (primitives, pixels)) in runs.enumerate() {
            if primitives.iter().all(|&primitive| primitive == MISS) {
                pixels.fill(backdrop);
                continue;
            }
            let left = f64::from(left) + (run * RUN) as f64 + 0.5;
            for (column, (&primitive, pixel)) in primitives.iter().zip(pixels).enumerate() {
                *pixel = match primitive {
                    MISS => backdrop,
                    _ => srgb::encode(self.color(left + column as f64, y, &on(primitive))),
                };
            }
        }
    }

    /// Shades pixels of a row, from column `left` on, where each triangle has one colour. `primitives` are those of the
    /// row and of the rows after it.
    #[inline(always)]
    fn shade_constant_row(
        &mut self,
        lanes: impl Lanes,
        (left, y): (u32, u32),
        primitives: &[u32],
        pixels: &mut [[u8; 4]],
    ) {
        // Misses are cached as a triangle of one colour, which changes from row to row.
        self.colors.set(MISS, self.shader.backdrop8(y));
        let count = primitives.len().min(pixels.len());
        let (row, pixels) = (&primitives[..count], &mut pixels[..count]);
        let (eights, rest) = row.as_chunks::<LANES>();
        let (pixel_eights, pixel_rest) = pixels.as_chunks_mut::<LANES>();
        for (eight, (of_eight, pixels)) in eights.iter().zip(pixel_eights).enumerate() {
            let first = eight * LANES;
            // Most eights show one triangle or two neighbours: one path for both, as which it is cannot be predicted.
            let [left_end, .., right_end] = *of_eight;
            let is_left = lanes.equal(of_eight, &[left_end; LANES]);
            let is_right = lanes.equal(of_eight, &[right_end; LANES]);
            if (is_left | is_right).bits() == 0xff {
                let left_color = self.constant_in_row((left, y), primitives, first);
                let right_color = self.constant_in_row((left, y), primitives, first + LANES - 1);
                let mut colors = [u32::from_ne_bytes(right_color); LANES];
                is_left.store(u32::from_ne_bytes(left_color), &mut colors);
                *pixels = colors.map(u32::to_ne_bytes);
            } else {
                for (at, pixel) in (first..).zip(pixels) {
                    *pixel = self.constant_in_row((left, y), primitives, at);
                }
            }
        }
        let first = eights.len() * LANES;
        for (at, pixel) in (first..first + rest.len()).zip(pixel_rest) {
            *pixel = self.constant_in_row((left, y), primitives, at);
        }
    }

    /// The colour of sample `at` of a row and the rows after it, which begins at a place.
    #[inline(always)]
    fn constant_in_row(&mut self, place: (u32, u32), all: &[u32], at: usize) -> [u8; 4] {
        match self.colors.knows(all[at]) {
            true => *self.colors.get(all[at]),
            false => self.unknown_color(place, all, at),
        }
    }

    /// The colour of sample `at` of `all`, which begin at a place, cached for others.
    #[cold]
    fn unknown_color(&mut self, (left, y): (u32, u32), all: &[u32], at: usize) -> [u8; 4] {
        let primitive = all[at];
        if self.looks_ahead && primitive != MISS {
            let work = LightTriangles {
                shader: self.shader,
                known: &mut self.colors,
                samples: &all[at..],
            };
            dispatch(self.shader.simd(), work);
            return *self.colors.get(primitive);
        }
        let x = f64::from(left) + at as f64 + 0.5;
        self.new_constant(x, f64::from(y) + 0.5, primitive)
    }

    /// The colour of a triangle with one colour, or of a miss.
    #[inline(always)]
    pub(super) fn constant(&mut self, x: f64, y: f64, primitive: u32) -> [u8; 4] {
        match self.colors.knows(primitive) {
            true => *self.colors.get(primitive),
            false => self.new_constant(x, y, primitive),
        }
    }

    #[inline(never)]
    fn new_constant(&mut self, x: f64, y: f64, primitive: u32) -> [u8; 4] {
        // Another triangle may have taken the cache entry of misses.
        let color = if primitive == MISS {
            self.shader.behind(x, y)
        } else {
            self.shader.constant_color(primitive)
        };
        let color = srgb::encode(color);
        self.colors.set(primitive, color);
        color
    }

    /// A shading triangle, cached or prepared: for the pixels at `x` alone where columns have eyes of their own.
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

    /// What smooth pictures need of the first sample's triangle, which has no normals at its corners: cached, or
    /// prepared with those of the samples after it.
    #[inline(always)]
    pub(super) fn plain_facet(&mut self, samples: &[u32]) -> &PlainFacet {
        if !self.plain_facets.knows(samples[0]) {
            self.prepare_plain_facets(samples);
        }
        self.plain_facets.get(samples[0])
    }

    #[cold]
    fn prepare_plain_facets(&mut self, samples: &[u32]) {
        let work = PreparePlainFacets {
            shader: self.shader,
            known: &mut self.plain_facets,
            samples,
        };
        dispatch(self.shader.simd(), work);
    }

    /// Whether a shading triangle is cached.
    #[inline(always)]
    pub(super) fn knows(&self, primitive: u32) -> bool {
        let known = self.facets.get(primitive as usize % FACETS);
        known.is_some_and(|(known, _)| *known == primitive)
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

/// The arguments of [`TileShader::shade_primitives`].
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
        let constant = shader.shader.is_constant();
        let has_overlay = shader.shader.has_overlay();
        let mut primitives = self.primitives;
        for (y, pixels) in (self.rect.y..).zip(self.rows) {
            let pixels = within(pixels, columns);
            if primitives.is_empty() {
                break;
            }
            if constant && !has_overlay {
                shader.shade_constant_row(lanes, (left, y), primitives, pixels);
            } else if !has_overlay {
                shader.shade_row(left, y, primitives, pixels);
            } else {
                for (x, (&primitive, pixel)) in (left..).zip(primitives.iter().zip(&mut *pixels)) {
                    let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                    *pixel = shader.pixel8(x, y, &on(primitive));
                }
            }
            shader.shader.clear_beyond(left, y, pixels);
            primitives = &primitives[columns.min(primitives.len())..];
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
