//! Vectors of eight lanes, and lighting of eight samples with interpolated normals.
//!
//! Each lane computes what [`Shader::color`](super::Shader::color) computes for one sample, operation by operation, so that
//! the bits are the same.

use super::facet::Facet;
use super::light::{GROUND, KEY, Lights, RIM, SKY, Source, WRAP};
use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use glam::Vec3;

/// Eight numbers in memory.
pub(super) type Row = [f32; LANES];

/// Eight vectors in memory, in structure-of-arrays order. Aligned: a load cannot be forwarded from a store that crosses a
/// cache line.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(super) struct Rows(pub(super) [Row; 3]);

impl Rows {
    /// Zero vectors.
    pub(super) const ZERO: Self = Self([[0.0; LANES]; 3]);

    /// Sets the vector of a lane.
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, vector: Vec3) {
        for (row, coordinate) in self.0.iter_mut().zip(vector.to_array()) {
            row[lane] = coordinate;
        }
    }
}

/// Eight vectors in lanes.
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

    /// From the lanes of x, y and z.
    #[inline(always)]
    pub(super) fn new(lanes: L, xyz: [L::F32; 3]) -> Self {
        Self { lanes, xyz }
    }

    /// Loads eight from memory.
    #[inline(always)]
    pub(super) fn load(lanes: L, rows: &Rows) -> Self {
        let [x, y, z] = &rows.0;
        let xyz = [lanes.load(x), lanes.load(y), lanes.load(z)];
        Self { lanes, xyz }
    }

    /// The lanes of x, y and z.
    #[inline(always)]
    pub(super) fn xyz(self) -> [L::F32; 3] {
        self.xyz
    }

    /// Stores the eight to memory.
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

    /// Vectors with x = y = z.
    #[inline(always)]
    pub(super) fn all(lanes: L, number: L::F32) -> Self {
        let xyz = [number; 3];
        Self { lanes, xyz }
    }

    /// `others` where the mask is true, these elsewhere.
    #[inline(always)]
    pub(super) fn replaced(self, mask: L::Mask, others: Self) -> Self {
        self.with(others, |mine, theirs| mask.select(theirs, mine))
    }

    /// Sums.
    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }

    /// The lesser of each coordinate; `other`'s where either is NaN.
    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        self.with(other, F32x8::min)
    }

    /// The greater of each coordinate; `other`'s where either is NaN.
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

    /// Products with a number a lane.
    #[inline(always)]
    pub(super) fn scaled(self, factor: L::F32) -> Self {
        self.times(Self::all(self.lanes, factor))
    }

    /// Quotients by a number a lane.
    #[inline(always)]
    pub(super) fn divided(self, divisor: L::F32) -> Self {
        self.with(Self::all(self.lanes, divisor), |a, b| a / b)
    }

    /// Interpolates vectors at triangles' corners at barycentrics (u, v): [`blend`](super::facet::blend).
    #[inline(always)]
    pub(super) fn between(lanes: L, [a, b, c]: [[L::F32; 3]; 3], u: L::F32, v: L::F32) -> Self {
        let w = lanes.splat(1.0) - u - v;
        let [a, b, c] = [
            Self::new(lanes, a),
            Self::new(lanes, b),
            Self::new(lanes, c),
        ];
        a.scaled(w).plus(b.scaled(u)).plus(c.scaled(v))
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

    /// Unit vectors; zero for zero vectors: [`Vec3::normalize_or_zero`].
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
            & (lanes.splat(1e-6).lt(length) & length.lt(lanes.splat(f32::INFINITY)));
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
    to_eye.scaled(lanes.splat(1.0) / to_eye.length())
}

/// [`Lights::on`] for eight samples with these shading triangles and barycentrics (u, v); without barycentrics the
/// triangles' own normals are lit.
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
