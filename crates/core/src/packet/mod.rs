//! Tiles of rays that share an eye, or a direction, through the tree.

mod cast;
#[cfg(test)]
mod cast_tests;
mod counts;
mod frustum;
mod interval_zbuffer;
mod lane_math;
mod observer;
mod params;
mod ray_bounds;
mod ray_box;
mod setup;
mod slivers;
mod small_triangles;
mod trace;
mod traversal;

pub use counts::CastCounts;
pub use trace::{BlockLevel, Levels, Listed};
