//! Arithmetic on lanes for several files.

use crate::num::simd::F32x8;

/// Adding this to a number of at most 2²² rounds it to a whole number, which then is in the low
/// bits.
pub(super) const ROUNDER: f32 = 12_582_912.0;

/// A number for each of three corners, or edges.
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

/// The nearest whole numbers, of numbers of at most 2²².
#[inline(always)]
pub(super) fn round<F: F32x8>(x: F) -> F {
    x + ROUNDER - ROUNDER
}

/// Three numbers less one.
#[inline(always)]
pub(super) fn relative_to<F: F32x8>((a, b, c): Three<F>, origin: F) -> Three<F> {
    (a - origin, b - origin, c - origin)
}

/// The cross product of two vectors of the plane.
#[inline(always)]
pub(super) fn cross<F: F32x8>((px, py): (F, F), (qx, qy): (F, F)) -> F {
    px * qy - py * qx
}
