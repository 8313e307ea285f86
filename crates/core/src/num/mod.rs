//! Numeric basics that every module may use: exact and double-double arithmetic, and SIMD lanes.

pub(crate) mod accumulator;
pub(crate) mod choice;
pub(crate) mod double_double;
pub(crate) mod exact;
pub(crate) mod integer;
pub(crate) mod roundoff;
pub(crate) mod simd;
mod wide;
