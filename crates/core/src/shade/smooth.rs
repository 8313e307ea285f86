//! Smooth shading of eight pixels of a row side by side.
//!
//! Each lane does what [`Shader::color`](super::Shader::color) does for one sample, operation by
//! operation, so that the bytes are the same.

use super::facet::Facet;
use super::light::{GROUND, KEY, Lights, RIM, SKY, Source, WRAP};
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use glam::Vec3;

/// Eight numbers in memory.
pub(super) type Row = [f32; LANES];

/// Eight vectors in memory, coordinates side by side. Aligned, since a lane that is read back from a
/// store across two cache lines waits for it to leave.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(super) struct Rows(pub(super) [Row; 3]);

impl Rows {
    /// Eight times zero.
    pub(super) const ZERO: Self = Self([[0.0; LANES]; 3]);

    /// Gives a lane its vector.
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, vector: Vec3) {
        for (row, coordinate) in self.0.iter_mut().zip(vector.to_array()) {
            row[lane] = coordinate;
        }
    }
}

/// Eight vectors side by side.
#[derive(Clone, Copy)]
pub(super) struct Vectors<L: Lanes> {
    lanes: L,
    xyz: [L::F32; 3],
}

impl<L: Lanes> Vectors<L> {
    /// The same vector in each lane.
    #[inline(always)]
    pub(super) fn splat(lanes: L, vector: Vec3) -> Self {
        let [x, y, z] = vector.to_array();
        let xyz = [lanes.splat(x), lanes.splat(y), lanes.splat(z)];
        Self { lanes, xyz }
    }

    /// Of coordinates side by side.
    #[inline(always)]
    pub(super) fn new(lanes: L, xyz: [L::F32; 3]) -> Self {
        Self { lanes, xyz }
    }

    /// From memory.
    #[inline(always)]
    pub(super) fn load(lanes: L, rows: &Rows) -> Self {
        let [x, y, z] = &rows.0;
        let xyz = [lanes.load(x), lanes.load(y), lanes.load(z)];
        Self { lanes, xyz }
    }

    /// Coordinates side by side.
    #[inline(always)]
    pub(super) fn xyz(self) -> [L::F32; 3] {
        self.xyz
    }

    /// To memory.
    #[inline(always)]
    pub(super) fn store(self) -> Rows {
        let mut rows = Rows::ZERO;
        for (row, coordinates) in rows.0.iter_mut().zip(self.xyz) {
            coordinates.store(row);
        }
        rows
    }

    #[inline(always)]
    fn with(self, other: Self, each: impl Fn(L::F32, L::F32) -> L::F32) -> Self {
        let ([a, b, c], [x, y, z]) = (self.xyz, other.xyz);
        let lanes = self.lanes;
        let xyz = [each(a, x), each(b, y), each(c, z)];
        Self { lanes, xyz }
    }

    /// Vectors whose coordinates are all the same number.
    #[inline(always)]
    pub(super) fn all(lanes: L, number: L::F32) -> Self {
        let xyz = [number; 3];
        Self { lanes, xyz }
    }

    /// These, and others where the mask says so.
    #[inline(always)]
    pub(super) fn replaced(self, mask: L::Mask, others: Self) -> Self {
        self.with(others, |mine, theirs| mask.select(theirs, mine))
    }

    /// Sums.
    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }

    /// The lesser coordinates; where either is not a number, those of `other`.
    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        self.with(other, F32x8::min)
    }

    /// The greater coordinates; where either is not a number, those of `other`.
    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        self.with(other, F32x8::max)
    }

    /// Products, coordinate by coordinate.
    #[inline(always)]
    pub(super) fn times(self, other: Self) -> Self {
        self.with(other, |a, b| a * b)
    }

    /// Differences.
    #[inline(always)]
    pub(super) fn minus(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }

    /// Multiples.
    #[inline(always)]
    pub(super) fn scaled(self, factor: L::F32) -> Self {
        self.times(Self::all(self.lanes, factor))
    }

    /// Dot products.
    #[inline(always)]
    pub(super) fn dot(self, other: Self) -> L::F32 {
        let [x, y, z] = self.times(other).xyz;
        x + y + z
    }

    /// Cross products.
    #[inline(always)]
    pub(super) fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.xyz, other.xyz);
        let xyz = [b * z - y * c, c * x - z * a, a * y - x * b];
        Self { xyz, ..self }
    }

    /// Unit vectors; zero where there is no direction: [`Vec3::normalize_or_zero`].
    #[inline(always)]
    pub(super) fn unit_or_zero(self) -> Self {
        let lanes = self.lanes;
        let (zero, one) = (lanes.splat(0.0), lanes.splat(1.0));
        let inverse = one / self.length();
        let is_good = zero.lt(inverse) & inverse.lt(lanes.splat(f32::INFINITY));
        Vectors::splat(lanes, Vec3::ZERO).replaced(is_good, self.scaled(inverse))
    }

    #[inline(always)]
    fn length(self) -> L::F32 {
        self.dot(self).sqrt()
    }
}

/// The normals of the triangles that eight pixels show.
#[derive(Clone, Copy)]
pub(super) struct Facets<L: Lanes> {
    /// The triangles' own, towards the eye.
    flat: Vectors<L>,
    /// The mesh's at the corners.
    corners: [Vectors<L>; 3],
    /// Above zero where the mesh has them.
    smooth: L::F32,
}

impl<L: Lanes> Facets<L> {
    /// Of no triangles.
    #[inline(always)]
    pub(super) fn none(lanes: L) -> Self {
        let zero = Vectors::splat(lanes, Vec3::ZERO);
        Self {
            flat: zero,
            corners: [zero; 3],
            smooth: lanes.splat(0.0),
        }
    }

    /// Of one triangle that all pixels show.
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

    /// These, and others where the mask says so.
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
            & (lanes.splat(1e-6).lt(length) & length.lt(lanes.splat(f32::INFINITY)));
        unit.with(self.flat, |unit, flat| good.select(unit, flat))
    }
}

/// Unit vectors to the eye from what eight pixels of a planar picture show: `to_eye` is the
/// [`Shader`](super::Shader)'s; the pixels are `x` to the right in the picture and `y` down.
#[inline(always)]
pub(super) fn to_eye<L: Lanes>(lanes: L, to_eye: &[Vec3; 3], (x, y): (&Row, f32)) -> Vectors<L> {
    let splat = |vector| Vectors::splat(lanes, vector);
    let [corner, right, down] = to_eye;
    let to_eye = splat(*corner)
        .plus(splat(*right).scaled(lanes.load(x)))
        .plus(splat(*down).scaled(lanes.splat(y)));
    to_eye.scaled(lanes.splat(1.0) / to_eye.length())
}

/// The light on eight pixels at barycentrics (u, v) of their triangles: what
/// [`Lights::on`](super::light::Lights::on) says; without weights the triangles' own normals count.
#[inline(always)]
pub(super) fn light<L: Lanes>(
    lanes: L,
    facets: &Facets<L>,
    lights: &Lights,
    weights: Option<(&Row, &Row)>,
    to_eye: Vectors<L>,
) -> Vectors<L> {
    let normal = match weights {
        Some((u, v)) => facets.normal_at(lanes, lanes.load(u), lanes.load(v)),
        None => facets.flat,
    };
    on(lanes, lights, normal, to_eye)
}

/// [`Lights::on`] for eight surfaces.
#[inline(always)]
fn on<L: Lanes>(lanes: L, lights: &Lights, normal: Vectors<L>, to_eye: Vectors<L>) -> Vectors<L> {
    let splat = |vector| Vectors::splat(lanes, vector);
    let (zero, one, half) = (lanes.splat(0.0), lanes.splat(1.0), lanes.splat(0.5));
    if !lights.is_soft {
        let above = half + half * normal.dot(splat(lights.up));
        let mut light = splat(lights.ground).plus(splat(lights.sky - lights.ground).scaled(above));
        for Source { direction, color } in lights.sources {
            let direction = direction.map_or(to_eye, splat);
            light = light.plus(splat(color).scaled(normal.dot(direction).max(zero)));
        }
        return light;
    }
    let to_key = lights.sources[0].direction.map_or(to_eye, splat);
    let key = normal.dot(to_key) + WRAP;
    let key = (key / (1.0 + WRAP)).max(zero);
    let above = half + half * normal.dot(splat(lights.up));
    let facing = normal.dot(to_eye);
    let facing = facing.max(zero - facing);
    let away = one - facing.min(one);
    let rim = away * away * away * above;
    let white = lanes.splat(KEY) * key + lanes.splat(RIM) * rim;
    splat(GROUND)
        .plus(splat(SKY - GROUND).scaled(above))
        .plus(Vectors::all(lanes, white))
}
