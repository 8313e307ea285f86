//! Arithmetic on lanes that several files share.

use crate::num::simd::F32x8;

/// Adding this to a number of magnitude at most 2²² rounds it to an integer, which is then in the low bits of the
/// mantissa.
pub(super) const ROUNDER: f32 = 12_582_912.0;

/// One number for each of three corners or edges.
pub(super) type Three<F> = (F, F, F);

/// The least of three.
#[inline(always)]
pub(super) fn least<F: F32x8>((a, b, c): Three<F>) -> F {
    a.min(b).min(c)
}

/// The greatest of three.
#[inline(always)]
pub(super) fn most<F: F32x8>((a, b, c): Three<F>) -> F {
    a.max(b).max(c)
}

/// The nearest integers to numbers of magnitude at most 2²².
#[inline(always)]
pub(super) fn round<F: F32x8>(x: F) -> F {
    x + ROUNDER - ROUNDER
}

/// Subtracts one number from three.
#[inline(always)]
pub(super) fn relative_to<F: F32x8>((a, b, c): Three<F>, origin: F) -> Three<F> {
    (a - origin, b - origin, c - origin)
}

/// The cross product of two vectors of a plane.
#[inline(always)]
pub(super) fn cross<F: F32x8>((px, py): (F, F), (qx, qy): (F, F)) -> F {
    px * qy - py * qx
}
