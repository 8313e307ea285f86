//! Rays against triangles: which are met, where, and which is nearest, decided exactly.

pub(crate) mod block;
pub(crate) mod exact;
pub(crate) mod footprint;
mod hit;
mod nearest;
pub(crate) mod row;
pub(crate) mod setup;
mod sides;
mod spans;
mod triangle;

pub use hit::{Cull, Detail, Hit, Precision};
pub(crate) use nearest::Nearest;
pub(crate) use triangle::PreparedRay;
