//! Vectors of eight lanes.

use crate::num::simd::{F32x8, LANES, Lanes, Mask8};
use glam::Vec3;

/// Eight numbers in memory.
pub(super) type Row = [f32; LANES];

/// Eight vectors in memory, in structure-of-arrays order. Aligned: a load cannot be forwarded from a store that crosses
/// a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(super) struct Rows(pub(super) [Row; 3]);

impl Rows {
    /// Zero vectors.
    pub(super) const ZERO: Self = Self([[0.0; LANES]; 3]);

    /// The same vector in all lanes.
    pub(super) fn all(vector: Vec3) -> Self {
        Self(vector.to_array().map(|coordinate| [coordinate; LANES]))
    }

    /// The vector of a lane.
    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> Vec3 {
        let [x, y, z] = &self.0;
        Vec3::new(x[lane], y[lane], z[lane])
    }

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
    pub(super) fn with(self, other: Self, each: impl Fn(L::F32, L::F32) -> L::F32) -> Self {
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

    /// Divided by their lengths: infinite or NaN where those are zero.
    #[inline(always)]
    pub(super) fn unit(self) -> Self {
        self.scaled(self.lanes.splat(1.0) / self.length())
    }

    /// Lengths.
    #[inline(always)]
    pub(super) fn length(self) -> L::F32 {
        self.dot(self).sqrt()
    }
}
