//! Rays against one triangle: whether a ray hits it, where, and which of two triangles it hits first, decided exactly.

mod bounded_hit;
pub(crate) mod clip;
mod close_start;
mod componentwise;
pub(crate) mod coplanar;
mod corner_lanes;
pub(crate) mod edge_on;
mod edges;
pub(crate) mod exact;
mod eye_determinants;
mod eye_triangle;
pub(crate) mod interpolate;
pub(crate) mod linear;
pub(crate) mod plane;
#[cfg(test)]
pub(crate) mod row_tests;
mod shared_triangles;
mod watertight;
mod wide_determinants;
mod wide_vectors;

pub(crate) use bounded_hit::BoundedHit;
pub(crate) use componentwise::Determinant;
pub(crate) use corner_lanes::{CornerLanes, vectors_in_lane};
pub(crate) use eye_triangle::cross_from;
pub(crate) use shared_triangles::SharedTriangles;
pub(crate) use watertight::PreparedRay;
