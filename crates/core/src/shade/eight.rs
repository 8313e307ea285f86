//! Eight samples of a row at once, in modes whose colours follow from the triangle and from t, u and v by few operations.
//!
//! Each lane does what [`Shader::color`](super::Shader::color) does for one sample, operation by operation, so that colours
//! are the same to the bit.

use super::eight_colors::{EightColors, EightSamples, Target, TargetRow};
use super::facet::Facet;
use super::hit_rows::{EightHits, EightNumbers, HitRows};
use super::reflection::Surfaces;
use super::scanlines::ShadeScanlines;
use super::tile_rays::TileRays;
use super::vectors::{Rows, Vectors};
use super::{TileShader, srgb};
use crate::camera::{Lattice, Rect};
use crate::hits::{any_misses, runs};
use crate::num::simd::{F32x8, LANES, Lanes, Mask8, Work, dispatch};
use crate::{Hits, MISS, PrimitiveHit};
use glam::Vec3;

impl TileShader<'_> {
    /// Colours the pixels of `rect`, given as its rows, eight at once.
    pub(super) fn shade_in_eights<'p>(
        &mut self,
        colors: EightColors,
        rect: Rect,
        hits: HitRows<'_>,
        mut rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        let lattice = self.shader().lattice(rect);
        self.shade_samples(colors, lattice, hits, Target::Bytes(&mut rows));
    }

    /// Colours of the samples at a lattice's rays, row by row, eight at once. With gaps between them the camera's picture must
    /// be filled.
    pub(super) fn shade_lattice_in_eights(
        &mut self,
        colors: EightColors,
        lattice: Lattice,
        hits: &Hits,
        pixels: &mut [[u8; 4]],
    ) {
        let mut rows = pixels.chunks_mut(lattice.columns.max(1) as usize);
        self.shade_samples(
            colors,
            lattice,
            HitRows::new(hits),
            Target::Bytes(&mut rows),
        );
    }

    /// Colours of the samples at a lattice's rays, eight at once: linear light, alpha not multiplied in.
    pub(super) fn light_in_eights(
        &mut self,
        colors: EightColors,
        lattice: Lattice,
        hits: &Hits,
        light: &mut [[f32; 4]],
    ) {
        self.shade_samples(colors, lattice, HitRows::new(hits), Target::Light(light));
    }

    /// Colours the samples at a lattice's rays.
    fn shade_samples<'t>(
        &'t mut self,
        colors: EightColors,
        lattice: Lattice,
        hits: HitRows<'_>,
        picture: Target<'t, '_>,
    ) {
        let simd = self.shader().simd();
        match self.shader().row_colors(colors) {
            Some((colors, planar)) => {
                let work = ShadeScanlines {
                    shader: self,
                    colors,
                    planar,
                    lattice,
                    hits,
                    picture,
                };
                dispatch(simd, work);
            }
            None => {
                let work = ShadeEights {
                    shader: self,
                    colors,
                    lattice,
                    hits,
                    picture,
                };
                dispatch(simd, work);
            }
        }
    }

    /// Colours of eight samples of a row, of which one at least shows a triangle. Those that show none get any colour.
    #[inline(always)]
    fn shade_eight<L: Lanes>(
        &mut self,
        lanes: L,
        colors: EightColors,
        rays: &TileRays,
        place: (u32, u32),
        hits: &EightHits<'_>,
    ) -> EightSamples<L> {
        let shader = self.shader();
        let mut numbers = EightNumbers::ZERO;
        let interpolated;
        let hits = match shader.planar() {
            None => hits,
            Some(planar) => {
                let primitives = hits.primitives;
                let of = (planar, rays, place);
                if !self.interpolate(lanes, colors, of, primitives, &mut numbers) {
                    return self.shade_eight_in_turn(lanes, rays, place, hits);
                }
                interpolated = numbers.with(primitives);
                &interpolated
            }
        };
        let (u, v) = hits.load_weights(lanes);
        let light = match colors {
            EightColors::Own => self.surface_colors(lanes, rays, place, hits, None),
            EightColors::Flat if !shader.needs().texture && !shader.needs().varied => {
                self.flat_colors(lanes, hits.primitives)
            }
            EightColors::Flat => {
                let surface = self.surface_colors(lanes, rays, place, hits, None);
                surface.times(self.flat_light(lanes, hits.primitives))
            }
            EightColors::Smooth | EightColors::Material => {
                let Some((normal, own)) = self.normals_and_colors(lanes, rays, place, hits) else {
                    return self.shade_eight_in_turn(lanes, rays, place, hits);
                };
                let surface = self.surface_colors(lanes, rays, place, hits, Some(own));
                let to_eye = rays.to_eye(lanes, shader, place);
                if matches!(colors, EightColors::Smooth) {
                    surface.times(shader.light(lanes, normal, to_eye))
                } else {
                    self.reflected(lanes, hits.primitives, surface, normal, to_eye)
                }
            }
            EightColors::Lines => {
                let [r, g, b, _] = shader.backdrop(rays.row(place.1));
                Vectors::splat(lanes, Vec3::new(r, g, b))
            }
            EightColors::Normals => {
                let Some((normal, _)) = self.normals_and_colors(lanes, rays, place, hits) else {
                    return self.shade_eight_in_turn(lanes, rays, place, hits);
                };
                let half = Vectors::splat(lanes, Vec3::splat(0.5));
                return EightSamples::Display(normal.times(half).plus(half));
            }
            EightColors::Depth => {
                let grey = shader.eight_greys(lanes, lanes.load(hits.t));
                return EightSamples::Display(Vectors::all(lanes, grey));
            }
            EightColors::Barycentric => {
                let w = lanes.splat(1.0) - u - v;
                return EightSamples::Display(Vectors::new(lanes, [w, u, v]));
            }
            EightColors::Uv => {
                let uv = self.uvs(lanes, hits.primitives, (u, v));
                let [x, y] = uv.map(|coordinate| coordinate - coordinate.floor());
                return EightSamples::Display(Vectors::new(lanes, [x, y, lanes.splat(0.25)]));
            }
        };
        EightSamples::Light(light)
    }

    /// [`TileShader::shade_eight`], one by one.
    #[inline(always)]
    fn shade_eight_in_turn<L: Lanes>(
        &mut self,
        lanes: L,
        rays: &TileRays,
        place: (u32, u32),
        hits: &EightHits<'_>,
    ) -> EightSamples<L> {
        let shader = self.shader();
        let colors = self.one_by_one(rays, place, hits, |facet, (x, y), hit| {
            let [r, g, b, _] = shader.inside(facet, x, y, hit);
            Vec3::new(r, g, b)
        });
        EightSamples::Light(Vectors::load(lanes, &colors))
    }

    /// A colour for each of eight hits, from its triangle and its place in the picture; zero for misses.
    #[inline(never)]
    pub(super) fn one_by_one(
        &mut self,
        rays: &TileRays,
        (column, row): (u32, u32),
        hits: &EightHits<'_>,
        color: impl Fn(&Facet, (f64, f64), &PrimitiveHit) -> Vec3,
    ) -> Rows {
        let mut colors = Rows::ZERO;
        for lane in 0..LANES {
            let hit = hits.get(lane);
            if hit.primitive != MISS {
                let place = rays.place(column + lane as u32, row);
                colors.set(lane, color(self.facet(hit.primitive, place.0), place, &hit));
            }
        }
        colors
    }

    /// Colours of eight surfaces with their textures; `own` are the triangles' colours where they are known.
    #[inline(always)]
    fn surface_colors<L: Lanes>(
        &mut self,
        lanes: L,
        rays: &TileRays,
        place: (u32, u32),
        hits: &EightHits<'_>,
        own: Option<Vectors<L>>,
    ) -> Vectors<L> {
        let needs = self.shader().needs();
        let own = match own {
            Some(own) if !needs.varied => own,
            _ => self.own_colors(lanes, rays, place, hits),
        };
        if needs.texture {
            self.textured(lanes, rays, place, hits, own)
        } else {
            own
        }
    }

    /// Of eight pixels, those that show a triangle show its one colour.
    #[inline(always)]
    fn show_constants(&mut self, primitives: &[u32; LANES], pixels: &mut [[u8; 4]; LANES]) {
        for (&primitive, pixel) in primitives.iter().zip(pixels) {
            if primitive != MISS {
                *pixel = self.constant(0.0, 0.0, primitive);
            }
        }
    }

    /// Of eight pixels, draws those that show no triangle, or lines of the overlay or the ground before one.
    #[inline(always)]
    fn show_others(
        &mut self,
        rays: &TileRays,
        (column, row): (u32, u32),
        hits: &EightHits<'_>,
        pixels: &mut [[u8; 4]; LANES],
    ) {
        let Some((xs, overlaid)) = self.overlaid(rays, (column, row), hits.primitives) else {
            return;
        };
        let backdrop = self.shader().backdrop8(rays.pixel_row(row));
        for (lane, pixel) in pixels.iter_mut().enumerate() {
            if overlaid[lane] {
                *pixel = self.pixel8(xs[lane], rays.row(row), &hits.get(lane));
            } else if hits.primitives[lane] == MISS {
                *pixel = backdrop;
            }
        }
    }

    /// The x of eight places of a row, and over which of what is seen there lines of the overlay or the ground may lie;
    /// `None` where all show triangles alone.
    #[inline(always)]
    fn overlaid(
        &mut self,
        rays: &TileRays,
        (column, row): (u32, u32),
        primitives: &[u32; LANES],
    ) -> Option<([f64; LANES], [bool; LANES])> {
        let shader = self.shader();
        let covered = match shader.has_overlay() {
            true => self.may_be_covered(primitives),
            false => [false; LANES],
        };
        if covered == [false; LANES] && !any_misses(primitives) {
            return None;
        }
        let xs = rays.eight_places(column, row);
        let mut overlaid = shader.may_overlay(&xs, rays.row(row));
        for (lane, overlaid) in overlaid.iter_mut().enumerate() {
            *overlaid &= primitives[lane] == MISS || covered[lane];
        }
        Some((xs, overlaid))
    }

    /// Before which of eight triangles lines of the overlay or the ground may lie.
    #[inline(never)]
    fn may_be_covered(&mut self, primitives: &[u32; LANES]) -> [bool; LANES] {
        let shader = self.shader();
        let has_lines = shader.lines.overlay.is_some();
        let has_ground = shader.needs().ground;
        primitives.map(|primitive| {
            primitive != MISS
                && (has_lines || has_ground && self.facet(primitive, 0.0).shows_ground)
        })
    }

    /// Colours of the triangles that eight samples show, each under the light on it.
    #[inline(always)]
    fn flat_colors<L: Lanes>(&mut self, lanes: L, primitives: &[u32; LANES]) -> Vectors<L> {
        let mut colors = Vectors::splat(lanes, Vec3::ZERO);
        for run in runs(lanes, primitives) {
            let facet = self.facet(run.primitive, 0.0);
            let one = Vectors::splat(lanes, facet.color * facet.light);
            colors = colors.replaced(lanes.mask_from(run.first), one);
        }
        colors
    }

    /// The light on the triangles that eight samples show.
    #[inline(always)]
    fn flat_light<L: Lanes>(&mut self, lanes: L, primitives: &[u32; LANES]) -> Vectors<L> {
        let mut light = Vectors::splat(lanes, Vec3::ZERO);
        for run in runs(lanes, primitives) {
            let one = self.facet(run.primitive, 0.0).light;
            let from = lanes.mask_from(run.first);
            light = light.replaced(from, Vectors::splat(lanes, one));
        }
        light
    }

    /// Texture coordinates where eight rays hit triangles, with these weights; zero where a mesh has none.
    #[inline(always)]
    fn uvs<L: Lanes>(
        &mut self,
        lanes: L,
        primitives: &[u32; LANES],
        (u, v): (L::F32, L::F32),
    ) -> [L::F32; 2] {
        let mut corners = [lanes.splat(0.0); 6];
        for run in runs(lanes, primitives) {
            let facet = self.facet(run.primitive, 0.0);
            let from = lanes.mask_from(run.first);
            let [a, b, c] = facet.uvs.unwrap_or_default();
            let one = [a.x, b.x, c.x, a.y, b.y, c.y];
            for (corners, one) in corners.iter_mut().zip(one) {
                *corners = from.select(lanes.splat(one), *corners);
            }
        }
        let w = lanes.splat(1.0) - u - v;
        let [ax, bx, cx, ay, by, cy] = corners;
        [ax * w + bx * u + cx * v, ay * w + by * u + cy * v]
    }

    /// Colours of the surfaces that eight samples show, without textures.
    #[inline(always)]
    fn own_colors<L: Lanes>(
        &mut self,
        lanes: L,
        rays: &TileRays,
        place: (u32, u32),
        hits: &EightHits<'_>,
    ) -> Vectors<L> {
        let shader = self.shader();
        if shader.needs().varied {
            let own = |facet: &Facet, _, hit: &PrimitiveHit| shader.own_color(facet, hit.u, hit.v);
            return Vectors::load(lanes, &self.one_by_one(rays, place, hits, own));
        }
        let mut colors = Vectors::splat(lanes, Vec3::ZERO);
        for run in runs(lanes, hits.primitives) {
            let color = self.facet(run.primitive, 0.0).color;
            let from = lanes.mask_from(run.first);
            colors = colors.replaced(from, Vectors::splat(lanes, color));
        }
        colors
    }

    /// What the materials of eight samples reflect, where they have no images.
    #[inline(always)]
    fn reflected<L: Lanes>(
        &mut self,
        lanes: L,
        primitives: &[u32; LANES],
        base: Vectors<L>,
        normal: Vectors<L>,
        to_eye: Vectors<L>,
    ) -> Vectors<L> {
        let shader = self.shader();
        let zero = lanes.splat(0.0);
        let (mut metallic, mut roughness, mut is_unlit) = (zero, zero, zero);
        let mut emission = Vectors::splat(lanes, Vec3::ZERO);
        for run in runs(lanes, primitives) {
            let from = lanes.mask_from(run.first);
            let material = shader.plain_reflectance(self.facet(run.primitive, 0.0));
            metallic = from.select(lanes.splat(material.factors[0]), metallic);
            roughness = from.select(lanes.splat(material.factors[1]), roughness);
            emission = emission.replaced(from, Vectors::splat(lanes, material.emission));
            let unlit = if material.is_unlit { 1.0 } else { 0.0 };
            is_unlit = from.select(lanes.splat(unlit), is_unlit);
        }
        let surfaces = Surfaces {
            base,
            metallic,
            roughness,
        };
        let lit = shader.eight_reflected(lanes, &surfaces, normal, to_eye);
        lit.plus(emission).replaced(zero.lt(is_unlit), base)
    }
}

/// The samples at a lattice's rays, eight at once.
struct ShadeEights<'t, 's, 'h, 'p> {
    shader: &'t mut TileShader<'s>,
    colors: EightColors,
    lattice: Lattice,
    hits: HitRows<'h>,
    picture: Target<'t, 'p>,
}

impl Work for ShadeEights<'_, '_, '_, '_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            shader: tile,
            colors,
            lattice,
            hits,
            mut picture,
        } = self;
        let shader = tile.shader();
        let rays = TileRays::new(shader, lattice);
        let columns = lattice.columns as usize;
        let has_lines = shader.needs().edges;
        let is_plain = !shader.has_overlay();
        let is_planar = shader.planar().is_some();
        let is_constant = shader.has_constant_surfaces() && has_lines && is_plain;
        for row in 0..lattice.rows {
            let begin = row as usize * columns;
            shader.prefetch(lanes, hits.row(begin, columns));
            let Some(TargetRow { pixels, light }) = picture.row(row, columns) else {
                break;
            };
            let (left, y) = rays.place(0, row);
            let (right, _) = rays.place(lattice.columns.saturating_sub(1), row);
            let behind = shader.backdrop_between(left, right, y);
            let backdrop = shader.backdrop8(rays.pixel_row(row));
            let count = pixels.len().max(light.len()) as u32;
            let mut column = 0;
            while column + LANES as u32 <= count {
                let place = (column, row);
                let at = column as usize..column as usize + LANES;
                column += LANES as u32;
                // Not looked for where they are not used.
                let hits = match is_planar {
                    true => EightNumbers::ZERO.with(hits.eight_primitives(begin + at.start)),
                    false => hits.eight(begin + at.start),
                };
                let is_empty = *hits.primitives == [MISS; LANES];
                if is_empty {
                    if let Some(pixels) = pixels.get_mut(at.clone()) {
                        pixels.fill(backdrop);
                        if !is_plain {
                            let xs = rays.eight_places(place.0, row);
                            shader.overlay((&xs, rays.row(row)), pixels, srgb::encode);
                        }
                        continue;
                    }
                    if let Some(behind) = behind {
                        let light = &mut light[at];
                        light.fill(behind);
                        if !is_plain {
                            let xs = rays.eight_places(place.0, row);
                            shader.overlay((&xs, rays.row(row)), light, |behind| behind);
                        }
                        continue;
                    }
                }
                let mut lines = None;
                if has_lines && !is_empty {
                    let found = tile.eight_lines(lanes, &rays, place, hits.primitives);
                    if found.are_seen(lanes) {
                        lines = Some(found);
                    }
                }
                let out = pixels.get_mut(at.clone()).and_then(<[_]>::first_chunk_mut);
                if let (true, None, Some(out)) = (is_constant, &lines, out) {
                    tile.show_constants(hits.primitives, out);
                    tile.show_others(&rays, place, &hits, out);
                    continue;
                }
                let mut eight = if is_empty {
                    EightSamples::Light(Vectors::splat(lanes, Vec3::ZERO))
                } else {
                    tile.shade_eight(lanes, colors, &rays, place, &hits)
                };
                if let Some(lines) = lines {
                    let under = eight.light(lanes, shader.tables);
                    eight = EightSamples::Light(lines.over(lanes, under));
                }
                if let Some(pixels) = pixels.get_mut(at.clone()).and_then(<[_]>::first_chunk_mut) {
                    tile.show_eight(lanes, eight, &rays, place, &hits, pixels);
                    continue;
                }
                store_opaque(eight.light(lanes, shader.tables), &mut light[at]);
                let light = &mut light[place.0 as usize..];
                if any_misses(hits.primitives) || !is_plain {
                    tile.light_others(&rays, place, behind, &hits, light);
                }
            }
            for column in column..count {
                let (x, y) = rays.place(column, row);
                let hit = hits.get(begin + column as usize);
                if let Some(pixel) = pixels.get_mut(column as usize) {
                    *pixel = tile.pixel8(x, y, &hit);
                } else {
                    light[column as usize] = tile.color(x, y, &hit);
                }
            }
            if lattice.stride == 1 {
                shader.clear_beyond(lattice.x, rays.pixel_row(row), pixels);
            }
        }
    }
}

/// Stores eight colours of linear light, opaque.
#[inline(always)]
fn store_opaque<L: Lanes>(colors: Vectors<L>, light: &mut [[f32; 4]]) {
    let Rows([r, g, b]) = colors.store();
    for (lane, light) in light.iter_mut().enumerate() {
        *light = [r[lane], g[lane], b[lane], 1.0];
    }
}

impl TileShader<'_> {
    /// Writes eight samples as pixels, with the ground before triangles and what is seen beside them.
    #[inline(always)]
    fn show_eight<L: Lanes>(
        &mut self,
        lanes: L,
        eight: EightSamples<L>,
        rays: &TileRays,
        place: (u32, u32),
        hits: &EightHits<'_>,
        pixels: &mut [[u8; 4]; LANES],
    ) {
        let shader = self.shader();
        match eight {
            EightSamples::Light(light) => shader.tables.encode_row(lanes, light, pixels),
            EightSamples::Display(values) => shader.tables.display_row(lanes, values, pixels),
        }
        self.show_others(rays, place, hits, pixels);
    }

    /// [`TileShader::show_others`] in linear light. `behind`: what all that show no triangle, line or ground show.
    #[inline(never)]
    fn light_others(
        &mut self,
        rays: &TileRays,
        (column, row): (u32, u32),
        behind: Option<[f32; 4]>,
        hits: &EightHits<'_>,
        light: &mut [[f32; 4]],
    ) {
        let Some((xs, overlaid)) = self.overlaid(rays, (column, row), hits.primitives) else {
            return;
        };
        let y = rays.row(row);
        for (lane, light) in light.iter_mut().take(LANES).enumerate() {
            if overlaid[lane] {
                *light = self.color(xs[lane], y, &hits.get(lane));
            } else if hits.primitives[lane] == MISS {
                *light = behind.unwrap_or_else(|| self.shader().behind(xs[lane], y));
            }
        }
    }
}
