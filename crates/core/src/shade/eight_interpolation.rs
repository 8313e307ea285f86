//! t, u, v and normals of eight samples of a row at once.

use super::TileShader;
use super::eight_colors::EightColors;
use super::facet::Interpolation;
use super::hit_rows::{EightHits, EightNumbers};
use super::interpolants::{PlanarRays, eight_weights_of};
use super::smooth::Facets;
use super::tile_rays::TileRays;
use super::vectors::Vectors;
use crate::hits::runs;
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use glam::Vec3;

impl TileShader<'_> {
    /// t, u and v of eight samples of a row from their triangles' linear functions, as far as colours depend on them.
    /// False where a triangle has none.
    #[inline(always)]
    pub(super) fn interpolate<L: Lanes>(
        &mut self,
        lanes: L,
        colors: EightColors,
        (planar, rays, (column, row)): (&PlanarRays, &TileRays, (u32, u32)),
        primitives: &[u32; LANES],
        numbers: &mut EightNumbers,
    ) -> bool {
        let needs = self.shader().needs();
        let weighs_all = needs.uvs || needs.varied;
        let (wants_t, wants_all) = match colors {
            EightColors::Depth => (true, true),
            EightColors::Barycentric => (false, true),
            _ => (false, weighs_all),
        };
        if !(wants_all || needs.texture) {
            return true;
        }
        let (xs, y) = (rays.columns(column), rays.row(row));
        // Divided once, and not once a run. Lanes of misses hold anything.
        let mut weights = [lanes.splat(0.0); 3];
        let mut distances = [lanes.splat(0.0); 2];
        let mut is_wanted = false;
        for run in runs(lanes, primitives) {
            let facet = self.facet(run.primitive, 0.0);
            // Of a scene with textures few triangles may have one.
            if !wants_all && facet.texture.is_none() {
                continue;
            }
            is_wanted = true;
            let Interpolation::Linear(interpolants) = &facet.interpolation else {
                return false;
            };
            let from = lanes.mask_from(run.first);
            if wants_t {
                let one = interpolants.eight_distances(lanes, &xs, y);
                for (all, one) in distances.iter_mut().zip(one) {
                    *all = from.select(one, *all);
                }
            } else {
                let one = interpolants.eight_weights(lanes, &xs, y);
                for (all, one) in weights.iter_mut().zip(one) {
                    *all = from.select(one, *all);
                }
            }
        }
        if !is_wanted {
            return true;
        }
        if wants_t {
            let t = planar.eight_distances_of(lanes, (&xs, y), distances);
            t.store(&mut numbers.t);
        } else {
            let [u, v] = eight_weights_of(lanes, weights);
            u.store(&mut numbers.u);
            v.store(&mut numbers.v);
        }
        true
    }

    /// Unit normals of eight samples, and the colours of the triangles that they show, as if those did not vary. `None`
    /// where samples want to be shaded one by one.
    #[inline(always)]
    pub(super) fn normals_and_colors<L: Lanes>(
        &mut self,
        lanes: L,
        rays: &TileRays,
        (column, row): (u32, u32),
        hits: &EightHits<'_>,
    ) -> Option<(Vectors<L>, Vectors<L>)> {
        let zero = Vectors::splat(lanes, Vec3::ZERO);
        if self.shader().planar().is_none() {
            if !self.shader().needs().smooth {
                return Some(self.flat_normals_and_colors(lanes, hits.primitives));
            }
            let (facets, colors) = self.facets_and_colors(lanes, hits.primitives);
            let (u, v) = hits.load_weights(lanes);
            return Some((facets.normal_at(lanes, u, v), colors));
        }
        let (xs, y) = (rays.columns(column), rays.row(row));
        let (mut normal, mut colors) = (zero, zero);
        let mut turns = false;
        for run in runs(lanes, hits.primitives) {
            let facet = self.facet(run.primitive, 0.0);
            let linear = facet.linear_normal.as_ref()?;
            turns |= linear.turns();
            let from = lanes.mask_from(run.first);
            normal = normal.replaced(from, linear.eight(lanes, &xs, y));
            colors = colors.replaced(from, Vectors::splat(lanes, facet.color));
        }
        let (none, one) = (lanes.splat(0.0), lanes.splat(1.0));
        let mut inverse = one / normal.length();
        if turns {
            let (mut flat, mut may_turn) = (zero, none);
            for run in runs(lanes, hits.primitives) {
                let facet = self.facet(run.primitive, 0.0);
                let from = lanes.mask_from(run.first);
                flat = flat.replaced(from, Vectors::splat(lanes, facet.normal));
                let turns = facet.linear_normal.is_some_and(|linear| linear.turns());
                may_turn = from.select(lanes.splat(if turns { 1.0 } else { 0.0 }), may_turn);
            }
            let away = normal.dot(flat).lt(none) & none.lt(may_turn);
            inverse = away.select(none - inverse, inverse);
        }
        Some((normal.scaled(inverse), colors))
    }

    /// Normals and colours of the triangles that eight samples show, where no mesh has normals of its own.
    #[inline(always)]
    fn flat_normals_and_colors<L: Lanes>(
        &mut self,
        lanes: L,
        primitives: &[u32; LANES],
    ) -> (Vectors<L>, Vectors<L>) {
        let mut normals = Vectors::splat(lanes, Vec3::ZERO);
        let mut colors = normals;
        for run in runs(lanes, primitives) {
            let facet = self.facet(run.primitive, 0.0);
            let from = lanes.mask_from(run.first);
            normals = normals.replaced(from, Vectors::splat(lanes, facet.normal));
            colors = colors.replaced(from, Vectors::splat(lanes, facet.color));
        }
        (normals, colors)
    }

    /// Normals and colours of the triangles that eight samples show, in pictures where no triangle's colours vary.
    #[inline(always)]
    fn facets_and_colors<L: Lanes>(
        &mut self,
        lanes: L,
        primitives: &[u32; LANES],
    ) -> (Facets<L>, Vectors<L>) {
        if *primitives == [primitives[0]; LANES] {
            let facet = self.facet(primitives[0], 0.0);
            let color = Vectors::splat(lanes, facet.color);
            return (Facets::one(lanes, facet), color);
        }
        let mut facets = Facets::none(lanes);
        let mut colors = Vectors::splat(lanes, Vec3::ZERO);
        for run in runs(lanes, primitives) {
            let facet = self.facet(run.primitive, 0.0);
            let from = lanes.mask_from(run.first);
            facets = facets.replaced(from, Facets::one(lanes, facet));
            colors = colors.replaced(from, Vectors::splat(lanes, facet.color));
        }
        (facets, colors)
    }
}
