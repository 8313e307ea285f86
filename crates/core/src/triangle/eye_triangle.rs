//! What rays from one eye share of a triangle.

use super::componentwise::Determinant;
use super::exact::{self, OffsetTriangle};
use super::eye_determinants::EyeDeterminants;
use super::plane::{LEAST_SURE, distance_of_eye};
use super::wide_determinants::{self, WideDeterminants};
use glam::{DVec3, Vec3};
use std::cell::{Cell, OnceCell};
use std::fmt;

/// Triangles in the cache, 32 kB while it is empty: as many as those whose planes are cached
/// ([`Coplanar`](super::coplanar::Coplanar)).
const CACHED: usize = 4096;

/// What the rays from one eye share of one triangle, each part computed when it is first asked for. A ray of its own
/// has one of its own.
#[derive(Clone, Debug, Default)]
pub(crate) struct EyeTriangle {
    pub(super) numerator: OnceCell<Option<Determinant>>,
    pub(super) wide: OnceCell<Option<WideDeterminants>>,
    pub(super) determinants: OnceCell<Option<EyeDeterminants>>,
    pub(super) closest: OnceCell<Option<EyeDeterminants>>,
}

impl EyeTriangle {
    /// The numerator of the parameter where rays meet the triangle's plane, accurate to single precision. `None` where
    /// it is so small that it might be less than any double.
    pub(super) fn numerator(&self, eye: DVec3, triangle: &OffsetTriangle) -> Option<Determinant> {
        *self.numerator.get_or_init(|| {
            let numerator = distance_of_eye(eye, triangle);
            let is_sure = numerator.value.abs() > LEAST_SURE
                || numerator.value == 0.0 && exact::plane_contains(eye, triangle);
            is_sure.then_some(numerator)
        })
    }

    /// What all determinants share in double-double arithmetic; `None` where a factor is out of range.
    pub(super) fn wide_determinants(
        &self,
        eye: DVec3,
        triangle: &OffsetTriangle,
    ) -> Option<&WideDeterminants> {
        let new = || WideDeterminants::new(eye, triangle);
        self.wide.get_or_init(new).as_ref()
    }

    /// The same, rounded to double precision; `None` where they are not to be had.
    pub(super) fn determinants(
        &self,
        eye: DVec3,
        triangle: &OffsetTriangle,
    ) -> Option<&EyeDeterminants> {
        let new = || {
            let numerator = self.numerator(eye, triangle)?;
            let wide = self.wide_determinants(eye, triangle)?;
            Some(EyeDeterminants::new(wide, numerator))
        };
        self.determinants.get_or_init(new).as_ref()
    }

    /// [`EyeTriangle::determinants`] or, where double-double arithmetic does not suffice, those from exact cross
    /// products: worth computing for many rays.
    pub(super) fn closest_determinants(
        &self,
        eye: DVec3,
        triangle: &OffsetTriangle,
    ) -> Option<&EyeDeterminants> {
        let new = || {
            let determinants = self.determinants(eye, triangle)?;
            Some(match determinants.are_accurate() {
                true => *determinants,
                false => EyeDeterminants::exact(eye, triangle, self.numerator(eye, triangle)?),
            })
        };
        self.closest.get_or_init(new).as_ref()
    }
}

/// What the rays from one eye share of the triangles asked for last.
#[derive(Default)]
pub(crate) struct EyeTriangles {
    /// Indexed by the low bits of the primitive index; empty before the first use.
    cached: Cell<Vec<Option<Box<CachedTriangle>>>>,
}

/// A triangle's primitive index, and what rays share of it.
type CachedTriangle = (u32, EyeTriangle);

impl fmt::Debug for EyeTriangles {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("EyeTriangles")
            .finish_non_exhaustive()
    }
}

impl EyeTriangles {
    /// Calls a function with what the rays share of the triangle of this primitive index.
    pub(crate) fn with<T>(&self, primitive: u32, function: impl FnOnce(&EyeTriangle) -> T) -> T {
        let mut cached = self.cached.take();
        cached.resize_with(CACHED, || None);
        let entry = &mut cached[primitive as usize % CACHED];
        let entry = match entry {
            Some(entry) if entry.0 == primitive => entry,
            _ => entry.insert(Box::new((primitive, EyeTriangle::default()))),
        };
        let result = function(&entry.1);
        self.cached.set(cached);
        result
    }
}

/// The cross product of two corners relative to an eye, each component within 2.01ε of itself: in double-double
/// arithmetic where that suffices, else exactly.
pub(crate) fn cross_from(eye: DVec3, corners: [Vec3; 2]) -> DVec3 {
    wide_determinants::cross_from(eye, corners).unwrap_or_else(|| exact::cross_from(eye, corners))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_of_one_entry_are_told_apart() {
        let triangle = |z: f32| OffsetTriangle {
            corners: [Vec3::X, Vec3::Y, Vec3::ZERO].map(|corner| corner + Vec3::Z * z),
            origin: DVec3::ZERO,
        };
        let shared = EyeTriangles::default();
        let distance = |primitive: u32, z: f32| {
            let numerator = shared.with(primitive, |known| {
                known.numerator(DVec3::ZERO, &triangle(z))
            });
            numerator.map(|numerator| numerator.value)
        };
        let other = 7 + CACHED as u32;
        assert_eq!(
            [distance(7, 1.0), distance(other, 2.0)],
            [Some(1.0), Some(2.0)]
        );
        // What is known is kept, until another triangle takes its place.
        assert_eq!(distance(other, 3.0), Some(2.0));
        assert_eq!(distance(7, 3.0), Some(3.0));
        // A plane that contains the eye.
        assert_eq!(distance(8, 0.0), Some(0.0));
    }
}
