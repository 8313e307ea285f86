//! Numeric basics that anybody may use.

pub(crate) mod simd;
