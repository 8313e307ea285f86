//! Numeric basics that every room may use: exact arithmetic, lanes of single-precision numbers.

pub(crate) mod double_double;
pub(crate) mod exact;
pub(crate) mod integer;
pub(crate) mod simd;
mod wide;
