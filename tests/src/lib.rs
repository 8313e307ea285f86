//! What the end-to-end tests share: the oracle, meshes, random numbers, the real binary, a screen.
//!
//! A failed expectation here is a failed test: helpers panic, and say what they expected.

pub mod binary;
pub mod check;
pub mod exact;
pub mod meshes;
pub mod models;
pub mod oracle;
pub mod random;
pub mod screen;
