//! Rays against triangles: which are met, where, and which is nearest, decided exactly.

pub(crate) mod exact;
mod hit;

pub use hit::{Cull, Hit};
