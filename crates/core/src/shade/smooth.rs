//! Lighting of eight samples with interpolated normals.
//!
//! Each lane computes what [`Shader::color`](super::Shader::color) computes for one sample, operation by operation, so that
//! the bits are the same.

use super::facet::{Facet, SHORTEST_NORMAL};
use super::light::{Lights, RIM, Source, WRAP, WRAPPED_KEY};
use super::vectors::{Row, Rows, Vectors};
use crate::num::simd::{F32x8, Lanes, Mask8};
use glam::Vec3;

/// Normals of the shading triangles of eight samples.
#[derive(Clone, Copy)]
pub(super) struct Facets<L: Lanes> {
    /// The triangles' unit normals, on the side of the eye.
    flat: Vectors<L>,
    /// The mesh's normals at the corners.
    corners: [Vectors<L>; 3],
    /// 1 where the mesh has normals, else 0.
    smooth: L::F32,
}

impl<L: Lanes> Facets<L> {
    /// Those of no triangle.
    #[inline(always)]
    pub(super) fn none(lanes: L) -> Self {
        let zero = Vectors::splat(lanes, Vec3::ZERO);
        Self {
            flat: zero,
            corners: [zero; 3],
            smooth: lanes.splat(0.0),
        }
    }

    /// Those of one triangle, in all lanes.
    #[inline(always)]
    pub(super) fn one(lanes: L, facet: &Facet) -> Self {
        let [a, b, c] = facet.normals.unwrap_or_default();
        let splat = |normal| Vectors::splat(lanes, normal);
        Self {
            flat: splat(facet.normal),
            corners: [splat(a), splat(b), splat(c)],
            smooth: lanes.splat(if facet.normals.is_some() { 1.0 } else { 0.0 }),
        }
    }

    /// `others` where the mask is true, these elsewhere.
    #[inline(always)]
    pub(super) fn replaced(self, mask: L::Mask, others: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.corners, others.corners);
        Self {
            flat: self.flat.replaced(mask, others.flat),
            corners: [
                a.replaced(mask, d),
                b.replaced(mask, e),
                c.replaced(mask, f),
            ],
            smooth: mask.select(others.smooth, self.smooth),
        }
    }

    /// [`Facet::normal_at`].
    #[inline(always)]
    pub(super) fn normal_at(&self, lanes: L, u: L::F32, v: L::F32) -> Vectors<L> {
        let [a, b, c] = self.corners;
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        let w = one - u - v;
        let blended = a.scaled(w).plus(b.scaled(u)).plus(c.scaled(v));
        let length = blended.length();
        let turned = blended.dot(self.flat).lt(zero);
        let side = turned.select(zero - length, length);
        let unit = blended.with(Vectors::all(lanes, side), |a, b| a / b);
        let good = zero.lt(self.smooth)
            & (lanes.splat(SHORTEST_NORMAL).lt(length) & length.lt(lanes.splat(f32::INFINITY)));
        unit.with(self.flat, |unit, flat| good.select(unit, flat))
    }
}

/// Unit vectors from eight samples at (x, y) of a planar picture to the eye; `to_eye` is the direction at the picture's top
/// left corner and its derivatives along x and y, as [`Shader`](super::Shader) has it.
#[inline(always)]
pub(super) fn to_eye<L: Lanes>(lanes: L, to_eye: &[Vec3; 3], (x, y): (&Row, f32)) -> Vectors<L> {
    let splat = |vector| Vectors::splat(lanes, vector);
    let [corner, right, down] = to_eye;
    let to_eye = splat(*corner)
        .plus(splat(*right).scaled(lanes.load(x)))
        .plus(splat(*down).scaled(lanes.splat(y)));
    to_eye.unit()
}

/// [`Lights`], with each number in eight lanes: operands of instructions, where copying a number to all lanes takes an
/// instruction of its own, and registers are too few to keep the copies.
#[derive(Clone, Debug)]
pub(super) struct EightLights {
    is_soft: bool,
    /// Directions, `None` for the eye's, and colours.
    sources: [(Option<Rows>, Rows); 3],
    up: Rows,
    ground: Rows,
    /// The difference of the ambient lights from above and from below.
    sky_less_ground: Rows,
    /// [`WRAP`], [`WRAPPED_KEY`] and [`RIM`].
    soft: Rows,
}

impl EightLights {
    pub(super) fn new(lights: &Lights) -> Self {
        let source = |source: Source| (source.direction.map(Rows::all), Rows::all(source.color));
        Self {
            is_soft: lights.is_soft,
            sources: lights.sources.map(source),
            up: Rows::all(lights.up),
            ground: Rows::all(lights.ground),
            sky_less_ground: Rows::all(lights.sky - lights.ground),
            soft: Rows::all(Vec3::new(WRAP, WRAPPED_KEY, RIM)),
        }
    }

    /// [`Lights::on`] for eight surfaces with these unit normals.
    #[inline(always)]
    pub(super) fn on<L: Lanes>(
        &self,
        lanes: L,
        normal: Vectors<L>,
        to_eye: Vectors<L>,
    ) -> Vectors<L> {
        let (zero, one, half) = (lanes.splat(0.0), lanes.splat(1.0), lanes.splat(0.5));
        let load = |rows| Vectors::load(lanes, rows);
        let above = half + half * normal.dot(load(&self.up));
        let around = load(&self.ground).plus(load(&self.sky_less_ground).scaled(above));
        if !self.is_soft {
            let mut light = around;
            for (direction, color) in &self.sources {
                let direction = direction.as_ref().map_or(to_eye, load);
                light = light.plus(load(color).scaled(normal.dot(direction).max(zero)));
            }
            return light;
        }
        let [wrap, wrapped_key, rim_brightness] = load(&self.soft).xyz();
        let (direction, _) = &self.sources[0];
        let to_key = direction.as_ref().map_or(to_eye, load);
        let key = (normal.dot(to_key) + wrap).max(zero);
        let facing = normal.dot(to_eye);
        let facing = facing.max(zero - facing);
        let away = one - facing.min(one);
        let rim = away * away * away * above;
        around.plus(Vectors::all(
            lanes,
            wrapped_key * key + rim_brightness * rim,
        ))
    }
}
