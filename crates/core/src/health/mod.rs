//! What is wrong with a mesh, and its area and volume.
//!
//! [`check`] examines how triangles join: open and non-manifold edges, flipped, degenerate and duplicate triangles,
//! unused vertices, shells. Vertices at exactly the same position count as one, however often a file lists them: a
//! seam of texture coordinates is no hole. [`size`] gives area, volume and bounding box. [`self_intersections`] lists
//! pairs of triangles that pass through one another.
//!
//! All of them take a [`GoOn`] callback for progress and cancelling.

mod adjacency;
mod box_tree;
mod edges;
mod intersections;
mod report;
mod shells;
mod size;
mod triangle_pair;

pub(crate) use adjacency::adjacency;
pub use intersections::{Intersections, self_intersections};
pub use report::{Health, check};
pub use size::{Size, size};

/// Called with the fraction done, from 0 to 1; returns whether to go on.
pub type GoOn<'a> = &'a (dyn Fn(f32) -> bool + Sync);
