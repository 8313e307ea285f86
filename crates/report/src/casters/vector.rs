//! Vectors in single or double precision, so that a caster can be written once for both.

use num_traits::Float;
use raycast_core::glam::{DVec3, Vec3};
use std::ops::{Add, Mul, Sub};

/// A vector of single or double precision.
pub(super) trait Vector:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Self::Real, Output = Self>
    + Send
    + Sync
    + 'static
{
    /// Its coordinates.
    type Real: Float + Send + Sync;

    /// A corner, exactly.
    fn corner(corner: Vec3) -> Self;

    /// The nearest vector to one in double precision.
    fn rounded(vector: DVec3) -> Self;

    /// In double precision.
    fn to_double(self) -> DVec3;

    /// The nearest number to one in double precision; the largest finite one instead of infinity.
    fn number(number: f64) -> Self::Real;

    fn cross(self, other: Self) -> Self;

    fn dot(self, other: Self) -> Self::Real;

    fn normalized(self) -> Self;
}

impl Vector for Vec3 {
    type Real = f32;

    fn corner(corner: Vec3) -> Self {
        corner
    }

    fn rounded(vector: DVec3) -> Self {
        vector.as_vec3()
    }

    fn to_double(self) -> DVec3 {
        self.as_dvec3()
    }

    fn number(number: f64) -> f32 {
        number.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
    }

    #[inline(always)]
    fn cross(self, other: Self) -> Self {
        self.cross(other)
    }

    #[inline(always)]
    fn dot(self, other: Self) -> f32 {
        self.dot(other)
    }

    #[inline(always)]
    fn normalized(self) -> Self {
        self.normalize()
    }
}

impl Vector for DVec3 {
    type Real = f64;

    fn corner(corner: Vec3) -> Self {
        corner.as_dvec3()
    }

    fn rounded(vector: DVec3) -> Self {
        vector
    }

    fn to_double(self) -> DVec3 {
        self
    }

    fn number(number: f64) -> f64 {
        number
    }

    #[inline(always)]
    fn cross(self, other: Self) -> Self {
        self.cross(other)
    }

    #[inline(always)]
    fn dot(self, other: Self) -> f64 {
        self.dot(other)
    }

    #[inline(always)]
    fn normalized(self) -> Self {
        self.normalize()
    }
}
