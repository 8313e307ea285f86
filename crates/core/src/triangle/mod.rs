//! One triangle and rays: which meet it, where, and which of two triangles is nearer, decided exactly.

mod componentwise;
pub(crate) mod edge_on;
pub(crate) mod exact;
mod integer;
pub(crate) mod interpolate;
mod nearest;
mod watertight;
mod wide;

pub(crate) use nearest::Nearest;
pub(crate) use watertight::PreparedRay;
