//! Rays against triangles: which are met, where, and which is nearest, decided exactly.

pub(crate) mod block;
mod componentwise;
pub(crate) mod edge_on;
pub(crate) mod exact;
pub(crate) mod footprint;
mod hit;
mod integer;
mod nearest;
pub(crate) mod row;
pub(crate) mod setup;
#[cfg(test)]
mod setup_tests;
mod sides;
mod spans;
mod triangle;
mod wide;

pub use hit::{Cull, Detail, Hit, Precision};
pub(crate) use nearest::Nearest;
pub(crate) use triangle::PreparedRay;
