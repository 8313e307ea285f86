//! What is wrong with a mesh, and how much there is of it.
//!
//! [`check`] looks at how triangles join: open and non-manifold edges, flipped, degenerate and duplicate
//! triangles, unused vertices, shells. Vertices at exactly one place are one, however often a file has them: a
//! seam of texture coordinates is no hole. [`size`] is area, volume and bounding box.
//! [`self_intersections`] are pairs of triangles that pass through one another.
//!
//! All look at triangles one after another, and ask their caller whether to go on.

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

/// Takes the share that is done, from 0 to 1, and says whether to go on.
pub type GoOn<'a> = &'a (dyn Fn(f32) -> bool + Sync);
