//! Unit roundoffs, by their letters in `docs/error-bounds.md`.

/// u: the unit roundoff of single precision, 2⁻²⁴.
pub(crate) const U: f64 = U32 as f64;

/// u in single precision.
pub(crate) const U32: f32 = f32::EPSILON / 2.0;

/// ε: the unit roundoff of double precision, 2⁻⁵³.
pub(crate) const EPSILON: f64 = f64::EPSILON / 2.0;
