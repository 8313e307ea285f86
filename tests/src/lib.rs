//! What the end-to-end tests share: checks against the oracle, real meshes, the real binary, a screen.
//!
//! A failed expectation here is a failed test: helpers panic, and say what they expected.

pub mod binary;
pub mod check;
pub mod files;
pub mod fuzz;
pub mod models;
pub mod process;
pub mod screen;
pub mod soak_files;
