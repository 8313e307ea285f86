//! Packets: tiles of rays that share an eye, or a direction, through the tree.
//!
//! A lattice of rays is cut into **large packets** of 64 × 64 rays, each into **packets** of 32 × 32, each
//! of these into **cells** of 8 × 8. What happens to them, in order:
//!
//! 1. `traversal`: the large packet's frustum finds its entry points, a short list of subtrees (Reshetov,
//!    Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", 2005). Each packet starts from them and
//!    descends to leaves, near to far; what begins behind all that its rays have hit is skipped.
//! 2. `ray_bounds`: eight triangles at once are projected into the packet in single precision, which
//!    bounds the rays that may hit each. Most triangles smaller than the ray spacing are culled here.
//! 3. `small_triangles`, `slivers`: triangles that bound few rays are tested against those alone; long
//!    thin ones have their bounds shrunk to what their rows span.
//! 4. `setup`: what is left is set up as linear functions of a ray's place: three edge functions and an
//!    inverse depth, with bounds on their errors (Pineda 1988; Olano and Greer 1997). Where the bounds say little,
//!    `componentwise_setup` does it again with bounds of its own. Of what is thin beside its distance, depths are
//!    relative to a `depth_reference`.
//! 5. `interval_zbuffer`: triangles are rasterised into an interval of depth a ray, in single precision.
//!    What the intervals cannot decide is marked undecided, its rivals are recorded, and `cast` lets the single
//!    ray decide between them. What is the same for all rays is decided once (`decisions`).
//!
//! Where there are clipping planes, boxes and triangles of which they keep nothing are skipped on the way, and those
//! that they cut get an edge more (`interval_zbuffer::cut_triangles`).
//!
//! The rays of a panorama are no lattice on any plane. Each of their packets (`cast::around`) has a plane of its own, square to
//! its mean direction, on which its rays lie at `places` that are worked out one by one; triangles are set up there as
//! for a perspective packet, and their functions are evaluated at those places
//! (`setup::place_bounds`, `traversal::placed_packets`, `interval_zbuffer::at_places`). What sees too wide for a plane is split.
//! The faces of a cube map are planes: each is cast as a perspective lattice, whose bounds have room for what the picture's own
//! rays are beside that lattice's.
//!
//! `observer` and `trace` record the way for pictures and tables. No decision here is final unless a
//! derived bound says so: the answers are those of exact arithmetic.

#[cfg(test)]
mod around_tests;
mod cast;
#[cfg(test)]
mod cast_tests;
#[cfg(test)]
mod clip_tests;
mod componentwise_setup;
mod counts;
mod decisions;
mod depth_reference;
mod frustum;
#[cfg(test)]
mod hostile_panorama_tests;
#[cfg(test)]
mod instance_tests;
mod interval_zbuffer;
mod lane_math;
mod observer;
mod params;
mod place_box;
mod places;
mod ray_bounds;
#[cfg(test)]
mod ray_bounds_tests;
mod ray_box;
mod ray_rect;
mod rivals;
mod setup;
#[cfg(test)]
mod setup_term_tests;
#[cfg(test)]
mod setup_tests;
mod slivers;
mod small_triangles;
mod sparse;
mod trace;
mod traversal;

pub use counts::CastCounts;
pub use trace::{EntryPoint, LargeTrace, PacketTrace};
