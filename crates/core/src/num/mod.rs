//! Numeric basics that every module may use: exact arithmetic, and SIMD lanes in single precision.

pub(crate) mod accumulator;
pub(crate) mod choice;
pub(crate) mod double_double;
pub(crate) mod exact;
pub(crate) mod integer;
pub(crate) mod roundoff;
pub(crate) mod simd;
mod wide;
