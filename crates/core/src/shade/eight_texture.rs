//! Textures on eight samples of a row at once.

use super::TileShader;
use super::facet::Mapping;
use super::hit_rows::EightHits;
use super::light_texels::read_eight;
use super::tile_rays::TileRays;
use super::triplanar::Triplanar;
use super::vectors::{Row, Vectors};
use crate::hits::runs;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use crate::scene::Texture;
use glam::Vec3;

/// What samples share whose textures are read at once.
#[derive(Clone, Copy)]
struct Shared<'a> {
    texture: &'a Texture,
    /// The mapping, unless it is by texture coordinates.
    triplanar: Option<&'a Triplanar>,
}

impl Shared<'_> {
    fn is(&self, other: Shared<'_>) -> bool {
        let is_same_mapping = match (self.triplanar, other.triplanar) {
            (None, None) => true,
            (Some(one), Some(other)) => std::ptr::eq(one, other),
            _ => false,
        };
        is_same_mapping && std::ptr::eq(self.texture, other.texture)
    }
}

/// Where eight samples read their texture: at one place each, or at one a side.
#[derive(Default)]
struct Sides {
    count: usize,
    weights: [Row; 3],
    uv: [[[f64; LANES]; 2]; 3],
}

impl Sides {
    /// Between texture coordinates at the corners.
    #[inline(always)]
    fn set_uv<F: F32x8>(&mut self, corners: &[F; 18], weights: (&Row, &Row)) {
        let mut all = [[0.0; LANES]; 6];
        for (all, corners) in all.iter_mut().zip(corners) {
            corners.store(all);
        }
        self.uv[0] = uvs_between(|corner, lane| all[corner][lane], weights);
        self.weights[0] = [1.0; LANES];
        self.count = 1;
    }

    /// [`Triplanar::sides`] between corners and normals.
    #[inline(always)]
    fn set_triplanar<L: Lanes>(
        &mut self,
        lanes: L,
        triplanar: &Triplanar,
        corners: &[L::F32; 18],
        (u, v): (&Row, &Row),
    ) {
        let [ax, ay, az, bx, by, bz, cx, cy, cz, rest @ ..] = *corners;
        let [dx, dy, dz, ex, ey, ez, fx, fy, fz] = rest;
        let (u, v) = (lanes.load(u), lanes.load(v));
        let corners = [[ax, ay, az], [bx, by, bz], [cx, cy, cz]];
        let normals = [[dx, dy, dz], [ex, ey, ez], [fx, fy, fz]];
        let point = Vectors::between(lanes, corners, u, v).store();
        let normal = Vectors::between(lanes, normals, u, v).unit_or_zero();
        let squared = normal.times(normal);
        let fourth = squared.times(squared);
        let [x, y, z] = fourth.xyz();
        let sum = x + y + z;
        let weights = fourth.divided(sum);
        let weights = Vectors::splat(lanes, Vec3::Z).replaced(lanes.splat(0.0).lt(sum), weights);
        self.weights = weights.store().0;
        self.uv = triplanar.eight_sides(&point.0, &normal.store().0);
        self.count = 3;
    }
}

/// Texture coordinates at eight hits, as [`Texturing::sampled`](super::texturing::Texturing::sampled) has them; `corner`
/// gives u and v at the first, second and third corner.
#[inline(always)]
fn uvs_between(corner: impl Fn(usize, usize) -> f32, (u, v): (&Row, &Row)) -> [[f64; LANES]; 2] {
    let mut uvs = [[0.0; LANES]; 2];
    for (axis, coordinates) in uvs.iter_mut().enumerate() {
        for lane in 0..LANES {
            let [a, b, c] = [axis, axis + 2, axis + 4].map(|at| f64::from(corner(at, lane)));
            let (u, v) = (f64::from(u[lane]), f64::from(v[lane]));
            coordinates[lane] = a + (b - a) * u + (c - a) * v;
        }
    }
    uvs
}

/// Texture coordinates of eight samples in the one texture that they show.
struct EightUvs<'a> {
    texture: &'a Texture,
    uv: [[f64; LANES]; 2],
    /// Whether the texture is multiplied by the surfaces' own colours.
    is_tinted: bool,
}

impl<'s> TileShader<'s> {
    /// Where eight samples read their texture, if all of them show one by texture coordinates and in one way, or none: the
    /// common cases. And the colours of their triangles.
    #[inline(always)]
    fn eight_uvs<L: Lanes>(
        &mut self,
        lanes: L,
        hits: &EightHits<'_>,
    ) -> Option<(Option<EightUvs<'s>>, Vectors<L>)> {
        let shader = self.shader();
        let weights = hits.weights.filter(|_| !shader.filter().has_footprint())?;
        let mut found: Option<(&Texture, bool)> = None;
        let mut corners = [lanes.splat(0.0); 6];
        let mut colors = Vectors::splat(lanes, Vec3::ZERO);
        let mut is_first = true;
        let is_one = *hits.primitives == [hits.primitives[0]; LANES];
        for run in runs(hits.primitives) {
            let facet = self.facet(run.primitive, 0.0);
            let from = lanes.mask_from(run.first);
            colors = colors.replaced(from, Vectors::splat(lanes, facet.color));
            let of_this = match &facet.texture {
                None => None,
                Some(Mapping::Uv(uvs)) if facet.blends.is_none() => {
                    let uvs = uvs.map(|uv| uv.to_array());
                    let uvs = uvs.as_flattened();
                    let (texture, is_tinted) = (shader.texture_on(facet)?, facet.is_tinted);
                    if is_one {
                        let uvs = EightUvs {
                            texture,
                            uv: uvs_between(|corner, _| uvs[corner], weights),
                            is_tinted,
                        };
                        return Some((Some(uvs), colors));
                    }
                    for (corners, &one) in corners.iter_mut().zip(uvs) {
                        *corners = from.select(lanes.splat(one), *corners);
                    }
                    Some((texture, is_tinted))
                }
                Some(_) => return None,
            };
            let is_same = match (found, of_this) {
                (None, None) => true,
                (Some(one), Some(other)) => std::ptr::eq(one.0, other.0) && one.1 == other.1,
                _ => false,
            };
            if !is_first && !is_same {
                return None;
            }
            is_first = false;
            found = of_this;
        }
        let uvs = found.map(|(texture, is_tinted)| {
            let mut all = [[0.0; LANES]; 6];
            for (all, corners) in all.iter_mut().zip(corners) {
                corners.store(all);
            }
            EightUvs {
                texture,
                uv: uvs_between(|corner, lane| all[corner][lane], weights),
                is_tinted,
            }
        });
        Some((uvs, colors))
    }

    /// The surfaces' own colours mixed with their textures, in linear light; `None` where samples show several textures, or
    /// one in another way than by texture coordinates. `own` are the colours, unless they are the triangles'.
    #[inline(always)]
    pub(super) fn textured_by_uvs<L: Lanes>(
        &mut self,
        lanes: L,
        hits: &EightHits<'_>,
        own: Option<Vectors<L>>,
    ) -> Option<Vectors<L>> {
        let shader = self.shader();
        let (uvs, colors) = self.eight_uvs(lanes, hits)?;
        let own = own.unwrap_or(colors);
        let Some(EightUvs {
            texture,
            uv,
            is_tinted,
        }) = uvs
        else {
            return Some(own);
        };
        let (texel, alpha) = read_eight(lanes, shader.tables, texture, &uv, shader.filter());
        let texel = if is_tinted { texel.times(own) } else { texel };
        let blend = lanes.splat(shader.blend());
        let rest = lanes.splat(1.0) - alpha * blend;
        Some(own.scaled(rest).plus(texel.scaled(blend)))
    }

    /// The surfaces' own colours mixed with their textures, in linear light.
    ///
    /// At once where all that have a texture have the same one and the same mapping, by texture coordinates or from three
    /// sides, and without a footprint; else sample by sample.
    #[inline(always)]
    pub(super) fn textured<L: Lanes>(
        &mut self,
        lanes: L,
        rays: &TileRays,
        place: (u32, u32),
        hits: &EightHits<'_>,
        own: Vectors<L>,
    ) -> Vectors<L> {
        let shader = self.shader();
        let zero = lanes.splat(0.0);
        let mut found: Option<Shared<'_>> = None;
        let mut is_shared = !shader.filter().has_footprint() && hits.weights.is_some();
        let (mut is_textured, mut is_tinted) = (zero, zero);
        let mut corners = [zero; 18];
        for run in runs(hits.primitives) {
            let facet = self.facet(run.primitive, 0.0);
            let from = lanes.mask_from(run.first);
            let mut textured = 0.0;
            if let (Some(mapping), Some(texture)) = (&facet.texture, shader.texture_on(facet)) {
                let one = Shared {
                    texture,
                    triplanar: shader.triplanar_of(facet, mapping),
                };
                is_shared &= found.is_none_or(|found| found.is(one)) & facet.blends.is_none();
                found = Some(one);
                textured = 1.0;
                match mapping {
                    Mapping::Uv(uvs) => {
                        let one = uvs.map(|uv| uv.to_array());
                        for (corners, one) in corners.iter_mut().zip(one.as_flattened()) {
                            *corners = from.select(lanes.splat(*one), *corners);
                        }
                    }
                    Mapping::Triplanar([a, b, c], [d, e, f]) => {
                        let one = [a, b, c, d, e, f].map(|vector| vector.to_array());
                        for (corners, one) in corners.iter_mut().zip(one.as_flattened()) {
                            *corners = from.select(lanes.splat(*one), *corners);
                        }
                    }
                    Mapping::Placed(_) | Mapping::Photographed(_) => is_shared = false,
                }
            }
            is_textured = from.select(lanes.splat(textured), is_textured);
            let tinted = if facet.is_tinted { 1.0 } else { 0.0 };
            is_tinted = from.select(lanes.splat(tinted), is_tinted);
        }
        let Some(found) = found else {
            return own;
        };
        let (true, Some(weights)) = (is_shared, hits.weights) else {
            let colors = self.one_by_one(rays, place, hits, |facet, place, hit| {
                shader.surface_color(facet, || place, hit)
            });
            return Vectors::load(lanes, &colors);
        };
        let mut sides = Sides::default();
        match found.triplanar {
            None => sides.set_uv(&corners, weights),
            Some(triplanar) => sides.set_triplanar(lanes, triplanar, &corners, weights),
        }
        let mut texel = Vectors::splat(lanes, Vec3::ZERO);
        let mut alpha = zero;
        for side in 0..sides.count {
            let uv = &sides.uv[side];
            let (color, opacity) =
                read_eight(lanes, shader.tables, found.texture, uv, shader.filter());
            let weight = lanes.load(&sides.weights[side]);
            texel = texel.plus(color.scaled(weight));
            alpha = alpha + opacity * weight;
        }
        let blend = lanes.splat(shader.blend());
        let texel = texel.replaced(zero.lt(is_tinted), texel.times(own));
        let rest = lanes.splat(1.0) - alpha * blend;
        let mixed = own.scaled(rest).plus(texel.scaled(blend));
        own.replaced(zero.lt(is_textured), mixed)
    }
}
