//! Eight pixels of a row at once, of modes whose colours follow from the triangle and from t, u and v by few operations.
//!
//! Each lane does what [`Shader::color`](super::Shader::color) does for one sample, operation by operation, so that the bytes
//! are the same.

use super::eight_colors::EightColors;
use super::facet::Facet;
use super::reflection::Surfaces;
use super::smooth::{Facets, Row, Rows, Vectors};
use super::tile::{on, within};
use super::tile_rays::TileRays;
use super::{TileShader, srgb};
use crate::camera::Rect;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8, Work, dispatch};
use crate::{Hits, MISS, PrimitiveHit};
use glam::Vec3;

/// What eight rays of a row hit, and where.
struct EightHits<'h> {
    primitives: &'h [u32; LANES],
    t: &'h Row,
    u: &'h Row,
    v: &'h Row,
}

impl<'h> EightHits<'h> {
    /// Those from a number on; `None` where there are fewer.
    #[inline(always)]
    fn of(hits: &'h Hits, first: usize) -> Option<Self> {
        Some(Self {
            primitives: hits.primitives.get(first..)?.first_chunk()?,
            t: hits.t.get(first..)?.first_chunk()?,
            u: hits.u.get(first..)?.first_chunk()?,
            v: hits.v.get(first..)?.first_chunk()?,
        })
    }
}

impl TileShader<'_> {
    /// [`TileShader::shade`] by eight pixels at once.
    pub(super) fn shade_in_eights<'p>(
        &mut self,
        colors: EightColors,
        rect: Rect,
        hits: &Hits,
        mut rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        let simd = self.shader().simd();
        let work = ShadeEights {
            shader: self,
            colors,
            rect,
            hits,
            rows: &mut rows,
        };
        dispatch(simd, work);
    }

    /// A row in the smooth or the material mode of triangles that have no normals but their own.
    #[inline(always)]
    pub(super) fn shade_lit_row(
        &mut self,
        lanes: impl Lanes,
        colors: EightColors,
        tile: &TileRays,
        (mut left, y): (u32, u32),
        primitives: &[u32],
        pixels: &mut [[u8; 4]],
    ) {
        let (rows, rest) = primitives.as_chunks();
        let (pixel_rows, pixels) = pixels.as_chunks_mut();
        for (primitives, pixels) in rows.iter().zip(pixel_rows) {
            if *primitives == [MISS; LANES] {
                pixels.fill(self.shader().backdrop8(y));
            } else {
                let place = (left, y);
                if let EightColors::Material = colors {
                    let hits = (primitives, (&[0.0; LANES], &[0.0; LANES]));
                    self.shade_material(lanes, tile, place, hits, pixels);
                } else {
                    self.shade_smooth(lanes, tile, place, (primitives, None), pixels);
                }
                self.show_behind((left, y), primitives, pixels);
            }
            left += LANES as u32;
        }
        for (x, (&primitive, pixel)) in (left..).zip(rest.iter().zip(pixels)) {
            *pixel = self.pixel8(f64::from(x) + 0.5, f64::from(y) + 0.5, &on(primitive));
        }
    }

    /// Eight pixels of a row, of which one at least shows a triangle.
    #[inline(always)]
    fn shade_eight(
        &mut self,
        lanes: impl Lanes,
        colors: EightColors,
        rays: &TileRays,
        place: (u32, u32),
        hits: &EightHits<'_>,
        pixels: &mut [[u8; 4]; LANES],
    ) {
        let shader = self.shader();
        let &EightHits {
            primitives,
            t,
            u,
            v,
        } = hits;
        let (u8s, v8s) = (lanes.load(u), lanes.load(v));
        match colors {
            EightColors::Own => {
                let (_, colors) = self.surfaces(lanes, place, (primitives, Some((u, v))));
                shader.tables.encode_row(lanes, colors, pixels);
            }
            EightColors::Flat => {
                let (_, colors) = self.surfaces(lanes, place, (primitives, Some((u, v))));
                let light = self.flat_light(lanes, place.0, primitives);
                shader.tables.encode_row(lanes, colors.times(light), pixels);
            }
            EightColors::Smooth => {
                let hits = (primitives, Some((u, v)));
                self.shade_smooth(lanes, rays, place, hits, pixels);
            }
            EightColors::Material => {
                let hits = (primitives, (u, v));
                self.shade_material(lanes, rays, place, hits, pixels);
            }
            EightColors::Normals => {
                let facets = self.facets(lanes, place.0, primitives);
                let normal = facets.normal_at(lanes, u8s, v8s);
                let half = Vectors::splat(lanes, Vec3::splat(0.5));
                shader
                    .tables
                    .display_row(lanes, normal.times(half).plus(half), pixels);
            }
            EightColors::Depth => {
                let grey = shader.eight_greys(lanes, lanes.load(t));
                shader
                    .tables
                    .display_row(lanes, Vectors::all(lanes, grey), pixels);
            }
            EightColors::Barycentric => {
                let w = lanes.splat(1.0) - u8s - v8s;
                shader
                    .tables
                    .display_row(lanes, Vectors::new(lanes, [w, u8s, v8s]), pixels);
            }
            EightColors::Uv => {
                let uv = self.uvs(lanes, place.0, primitives, (u8s, v8s));
                let [x, y] = uv.map(|coordinate| coordinate - coordinate.floor());
                shader.tables.display_row(
                    lanes,
                    Vectors::new(lanes, [x, y, lanes.splat(0.25)]),
                    pixels,
                );
            }
        }
        if shader.needs().ground {
            self.show_ground(place, hits, pixels);
        }
        self.show_behind(place, primitives, pixels);
    }

    /// Eight pixels of a row, none of which shows a triangle.
    #[inline(always)]
    fn show_nothing(&self, (left, y): (u32, u32), pixels: &mut [[u8; 4]; LANES]) {
        if self.shader().has_overlay() {
            self.show_behind((left, y), &[MISS; LANES], pixels);
        } else {
            pixels.fill(self.shader().backdrop8(y));
        }
    }

    /// Of eight pixels, those that show no triangle show what lies behind.
    #[inline(always)]
    fn show_behind(
        &self,
        (left, y): (u32, u32),
        primitives: &[u32; LANES],
        pixels: &mut [[u8; 4]; LANES],
    ) {
        let mut is_full = true;
        for &primitive in primitives {
            is_full &= primitive != MISS;
        }
        if is_full {
            return;
        }
        let shader = self.shader();
        let backdrop = shader.backdrop8(y);
        for (x, (&primitive, pixel)) in (left..).zip(primitives.iter().zip(pixels)) {
            if primitive == MISS {
                *pixel = if shader.has_overlay() {
                    srgb::encode(shader.behind(f64::from(x) + 0.5, f64::from(y) + 0.5))
                } else {
                    backdrop
                };
            }
        }
    }

    /// Of eight pixels, those that show the ground before a triangle.
    fn show_ground(
        &mut self,
        (left, y): (u32, u32),
        hits: &EightHits<'_>,
        pixels: &mut [[u8; 4]; LANES],
    ) {
        for (lane, pixel) in pixels.iter_mut().enumerate() {
            let (x, primitive) = (f64::from(left) + lane as f64 + 0.5, hits.primitives[lane]);
            if primitive != MISS && self.facet(primitive, x).shows_ground {
                let hit = PrimitiveHit {
                    primitive,
                    t: hits.t[lane],
                    u: hits.u[lane],
                    v: hits.v[lane],
                };
                *pixel = self.pixel8(x, f64::from(y) + 0.5, &hit);
            }
        }
    }

    /// The normals of the triangles that eight pixels show.
    ///
    /// Triangles from left to right, each over all lanes from its first on: registers alone, where lanes stored one by one
    /// would have to reach memory before eight could be loaded as one.
    #[inline(always)]
    fn facets<L: Lanes>(&mut self, lanes: L, left: u32, primitives: &[u32; LANES]) -> Facets<L> {
        if *primitives == [primitives[0]; LANES] {
            return Facets::one(lanes, self.facet(primitives[0], f64::from(left)));
        }
        let mut facets = Facets::none(lanes);
        let mut lane = 0;
        while lane < LANES {
            let (first, primitive) = (lane, primitives[lane]);
            while lane < LANES && primitives[lane] == primitive {
                lane += 1;
            }
            if primitive != MISS {
                let facet = self.facet(primitive, f64::from(left));
                let from = lanes.mask_from(first);
                facets = facets.replaced(from, Facets::one(lanes, facet));
            }
        }
        facets
    }

    /// The light on the triangles that eight pixels show.
    #[inline(always)]
    fn flat_light<L: Lanes>(
        &mut self,
        lanes: L,
        left: u32,
        primitives: &[u32; LANES],
    ) -> Vectors<L> {
        let shader = self.shader();
        let mut light = Vectors::splat(lanes, Vec3::ZERO);
        let mut lane = 0;
        while lane < LANES {
            let (first, primitive) = (lane, primitives[lane]);
            while lane < LANES && primitives[lane] == primitive {
                lane += 1;
            }
            if primitive != MISS {
                let one = shader.flat_light(self.facet(primitive, f64::from(left)));
                light = light.replaced(lanes.mask_from(first), Vectors::splat(lanes, one));
            }
        }
        light
    }

    /// Texture coordinates where eight rays hit triangles, with these weights; zero where a mesh has none.
    #[inline(always)]
    fn uvs<L: Lanes>(
        &mut self,
        lanes: L,
        left: u32,
        primitives: &[u32; LANES],
        (u, v): (L::F32, L::F32),
    ) -> [L::F32; 2] {
        let mut corners = [lanes.splat(0.0); 6];
        let mut lane = 0;
        while lane < LANES {
            let (first, primitive) = (lane, primitives[lane]);
            while lane < LANES && primitives[lane] == primitive {
                lane += 1;
            }
            if primitive != MISS {
                let facet = self.facet(primitive, f64::from(left));
                let from = lanes.mask_from(first);
                let [a, b, c] = facet.uvs.unwrap_or_default();
                let one = [a.x, b.x, c.x, a.y, b.y, c.y];
                for (corners, one) in corners.iter_mut().zip(one) {
                    *corners = from.select(lanes.splat(one), *corners);
                }
            }
        }
        let w = lanes.splat(1.0) - u - v;
        let [ax, bx, cx, ay, by, cy] = corners;
        [ax * w + bx * u + cx * v, ay * w + by * u + cy * v]
    }

    /// Eight pixels of a row in the smooth mode, at barycentrics (u, v) of their triangles; `None` where
    /// no triangle has normals or a texture, to which they matter. Those that show no triangle get any colour.
    #[inline(always)]
    fn shade_smooth(
        &mut self,
        lanes: impl Lanes,
        rays: &TileRays,
        (left, y): (u32, u32),
        (primitives, weights): (&[u32; LANES], Option<(&Row, &Row)>),
        pixels: &mut [[u8; 4]; LANES],
    ) {
        let shader = self.shader();
        let (facets, colors) = self.surfaces(lanes, (left, y), (primitives, weights));
        let to_eye = rays.to_eye(lanes, shader, (left, y));
        let light = shader.light(lanes, &facets, weights, to_eye);
        shader.tables.encode_row(lanes, colors.times(light), pixels);
    }

    /// Normals and colours of the surfaces that eight pixels show.
    #[inline(always)]
    fn surfaces<L: Lanes>(
        &mut self,
        lanes: L,
        (left, y): (u32, u32),
        (primitives, weights): (&[u32; LANES], Option<(&Row, &Row)>),
    ) -> (Facets<L>, Vectors<L>) {
        let shader = self.shader();
        let needs = shader.needs();
        let varied = needs.texture || needs.varied;
        if *primitives == [primitives[0]; LANES] && !varied {
            let facet = self.facet(primitives[0], f64::from(left));
            let color = Vectors::splat(lanes, facet.color);
            return (Facets::one(lanes, facet), color);
        }
        let hit = |lane: usize| PrimitiveHit {
            primitive: primitives[lane],
            u: weights.map_or(0.0, |(u, _)| u[lane]),
            v: weights.map_or(0.0, |(_, v)| v[lane]),
            ..PrimitiveHit::NONE
        };
        let mut facets = Facets::none(lanes);
        let mut colors = Vectors::splat(lanes, Vec3::ZERO);
        let mut each = Rows::ZERO;
        let mut lane = 0;
        while lane < LANES {
            let (first, primitive) = (lane, primitives[lane]);
            while lane < LANES && primitives[lane] == primitive {
                lane += 1;
            }
            if primitive == MISS {
                continue;
            }
            let facet: &Facet = self.facet(primitive, f64::from(left));
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
        (facets, colors)
    }

    /// Eight pixels of a row in the material mode, of materials without images.
    #[inline(always)]
    fn shade_material(
        &mut self,
        lanes: impl Lanes,
        rays: &TileRays,
        place: (u32, u32),
        (primitives, weights): (&[u32; LANES], (&Row, &Row)),
        pixels: &mut [[u8; 4]; LANES],
    ) {
        let shader = self.shader();
        let (facets, base) = self.surfaces(lanes, place, (primitives, Some(weights)));
        let zero = lanes.splat(0.0);
        let (mut metallic, mut roughness, mut is_unlit) = (zero, zero, zero);
        let mut emission = Vectors::splat(lanes, Vec3::ZERO);
        let mut lane = 0;
        while lane < LANES {
            let (first, primitive) = (lane, primitives[lane]);
            while lane < LANES && primitives[lane] == primitive {
                lane += 1;
            }
            if primitive != MISS {
                let from = lanes.mask_from(first);
                let facet = self.facet(primitive, f64::from(place.0));
                let material = shader.plain_reflectance(facet);
                metallic = from.select(lanes.splat(material.factors[0]), metallic);
                roughness = from.select(lanes.splat(material.factors[1]), roughness);
                emission = emission.replaced(from, Vectors::splat(lanes, material.emission));
                let unlit = if material.is_unlit { 1.0 } else { 0.0 };
                is_unlit = from.select(lanes.splat(unlit), is_unlit);
            }
        }
        let surfaces = Surfaces {
            base,
            metallic,
            roughness,
        };
        let (u, v) = weights;
        let normal = facets.normal_at(lanes, lanes.load(u), lanes.load(v));
        let to_eye = rays.to_eye(lanes, shader, place);
        let lit = shader.eight_reflected(lanes, &surfaces, normal, to_eye);
        let colors = lit.plus(emission).replaced(zero.lt(is_unlit), base);
        shader.tables.encode_row(lanes, colors, pixels);
    }
}

/// What [`TileShader::shade`] is asked where it shades eight pixels at once.
struct ShadeEights<'t, 's, 'h, 'r, 'p> {
    shader: &'t mut TileShader<'s>,
    colors: EightColors,
    rect: Rect,
    hits: &'h Hits,
    /// Whatever they are, this is compiled once: it is long.
    rows: &'r mut dyn Iterator<Item = &'p mut [[u8; 4]]>,
}

impl Work for ShadeEights<'_, '_, '_, '_, '_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            shader,
            colors,
            rect,
            hits,
            rows,
        } = self;
        let columns = rect.width as usize;
        let rays = TileRays::new(shader.shader(), rect);
        for (y, pixels) in rows.enumerate().take(rect.height as usize) {
            let mut first = y * columns;
            let (mut left, y) = (rect.x, rect.y + y as u32);
            let pixels = within(pixels, columns);
            let (pixel_rows, rest) = pixels.as_chunks_mut();
            for pixels in pixel_rows {
                match EightHits::of(hits, first) {
                    None => shader.shade_hits(left, y, hits, first, pixels),
                    Some(hits) if *hits.primitives == [MISS; LANES] => {
                        shader.show_nothing((left, y), pixels);
                    }
                    Some(hits) => {
                        shader.shade_eight(lanes, colors, &rays, (left, y), &hits, pixels);
                    }
                }
                first += LANES;
                left += LANES as u32;
            }
            shader.shade_hits(left, y, hits, first, rest);
            shader.shader().clear_beyond(rect.x, y, pixels);
        }
    }
}
