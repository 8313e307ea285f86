//! Rays against one triangle: whether a ray hits it, where, and which of two triangles it hits first, decided exactly.

pub(crate) mod clip;
mod componentwise;
pub(crate) mod coplanar;
pub(crate) mod edge_on;
mod edges;
pub(crate) mod exact;
pub(crate) mod interpolate;
pub(crate) mod linear;
mod nearest;
pub(crate) mod plane;
#[cfg(test)]
pub(crate) mod row_tests;
mod watertight;

pub(crate) use nearest::Nearest;
pub(crate) use watertight::PreparedRay;
