//! What rays from one eye share of a triangle.

use super::componentwise::{self, Determinant, EyeDeterminants};
use super::exact::{self, OffsetTriangle};
use super::plane::{LEAST_SURE, distance_of_eye};
use glam::{DVec3, Vec3};
use std::cell::OnceCell;

/// What the rays from one eye share of one triangle, each part computed when it is first asked for. A ray of its own has one
/// of its own.
#[derive(Clone, Debug, Default)]
pub(crate) struct EyeTriangle {
    pub(super) numerator: OnceCell<Option<Determinant>>,
    pub(super) determinants: OnceCell<Option<EyeDeterminants>>,
}

impl EyeTriangle {
    /// The numerator of the parameter where rays meet the triangle's plane, accurate to single precision. `None` where it is
    /// zero, or so small that it might be less than any double.
    pub(super) fn numerator(&self, eye: DVec3, triangle: &OffsetTriangle) -> Option<Determinant> {
        *self.numerator.get_or_init(|| {
            let numerator = distance_of_eye(eye, triangle);
            (numerator.value.abs() > LEAST_SURE).then_some(numerator)
        })
    }

    /// What all determinants share; `None` where they are not to be had.
    pub(super) fn determinants(
        &self,
        eye: DVec3,
        triangle: &OffsetTriangle,
    ) -> Option<&EyeDeterminants> {
        let new = || {
            let numerator = self.numerator(eye, triangle)?;
            EyeDeterminants::new(eye, triangle, numerator)
        };
        self.determinants.get_or_init(new).as_ref()
    }
}

/// The cross product of two corners relative to an eye, each component within 2.01ε of itself: in double-double arithmetic
/// where that suffices, else exactly.
pub(crate) fn cross_from(eye: DVec3, corners: [Vec3; 2]) -> DVec3 {
    componentwise::cross_from(eye, corners).unwrap_or_else(|| exact::cross_from(eye, corners))
}
