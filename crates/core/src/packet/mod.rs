//! Packet traversal: tiles of rays that share an eye, or a direction, through the tree.
//!
//! A lattice of rays is cut into **large packets** of 64 × 64 rays, each of these into **packets** of 32 × 32, and
//! each of those into **cells** of 8 × 8. A packet is cast in these steps:
//!
//! 1. `traversal`: the large packet's frustum finds its entry points, a short list of subtrees (Reshetov,
//!    Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", 2005). Each packet starts from them and
//!    descends to leaves, front to back; boxes behind all hits so far are skipped.
//! 2. `ray_bounds`: eight triangles at once are projected into the packet in single precision, which
//!    bounds the rays that may hit each. Most triangles smaller than the ray spacing are culled here. Triangles that
//!    pass the eye have no bounds; most of those that no ray hits are culled by `beside_rays`.
//! 3. `small_triangles`, `slivers`: triangles that bound few rays are tested against those alone; the bounds
//!    of long thin ones are shrunk to the spans of their rows.
//! 4. `setup`: the remaining triangles become linear functions of a ray's place: three edge functions and an
//!    inverse depth, with bounds on their errors (Pineda 1988; Olano and Greer 1997). Where the bounds decide
//!    little, `componentwise_setup` repeats the set-up with tighter bounds. For scenes that are thin compared with
//!    their distance, depths are relative to a `depth_reference`.
//! 5. `interval_zbuffer`: triangles are rasterised into one interval of depth per ray, in single precision.
//!    A ray that bounds leave undecided is marked so and its rivals are recorded; `cast` tests it against these as
//!    a single ray. Where bounds decide next to nothing, all rays of the packet are cast so. Decisions that hold for
//!    all rays are made once (`decisions`), and whether parallel rays start in front of triangles that they nearly
//!    start on, once a plane (`ray_starts`).
//!
//! Before that, the plane of one triangle and the corners of the other order the two for eight rays or a whole cell
//! (`plane_order`); only rays for which that is not sure either are left undecided. Of layers too close together for
//! single precision, most are behind triangles that a cell's rays surely hit (`interval_zbuffer::sure_hits`), and are
//! not merged. Where many orders are left undecided, the packet is cast again with depths relative to the plane of one
//! of the layers (`plane_keys`), and triangles behind that plane are skipped before set-up.
//!
//! With clipping planes, boxes and triangles that the planes remove are skipped on the way, and triangles that they
//! cut get an additional edge (`interval_zbuffer::cut_triangles`).
//!
//! The rays of a panorama form no lattice on any plane. Each of their packets (`cast::around`) has a plane of its
//! own, perpendicular to its mean direction, on which its rays lie at irregular `places`. Triangles are set up as for
//! a perspective packet, and their functions are evaluated at those places (`setup::place_bounds`,
//! `traversal::at_places`, `interval_zbuffer::at_places`); small ones without set-up (`triangles_at_places`). A packet
//! that sees too wide for a plane is split.
//! The faces of a cube map are planes: each is cast as a perspective lattice, whose bounds include how far the
//! picture's own rays are from that lattice's.
//!
//! From far away, rays are closer together than their roundings, and corners relative to their eye are rounded by more
//! than triangles' sizes. Packets of such lattices (`cast::far`) see the scene from an eye close to it
//! (`places::near_eye`), which their rays pass at places of their own.
//!
//! Where surfaces are translucent, all hits of a ray count: `multi_hit` gathers them from the same traversal
//! (`traversal::gather`) in a `hit_buffer`, and orders them ray by ray.
//!
//! `observer` and `trace` record the traversal for pictures and tables. *Invariant*: no decision is final unless a
//! derived bound proves it, so the answers are those of exact arithmetic.

#[cfg(test)]
mod around_tests;
mod beside_rays;
mod cast;
#[cfg(test)]
mod cast_tests;
#[cfg(test)]
mod clip_tests;
#[cfg(test)]
mod close_planes_tests;
#[cfg(test)]
mod close_rays_tests;
mod componentwise_setup;
mod counts;
mod decisions;
mod depth_reference;
mod frustum;
#[cfg(test)]
mod hidden_group_tests;
mod hit_buffer;
#[cfg(test)]
mod hostile_panorama_tests;
#[cfg(test)]
mod instance_tests;
mod interval_zbuffer;
mod lane_math;
mod linear;
mod multi_hit;
#[cfg(test)]
mod multi_hit_tests;
mod observer;
mod occlusion;
mod params;
mod place_box;
mod places;
mod plane_along_rays;
mod plane_key_setup;
mod plane_keys;
mod plane_order;
mod ray_bounds;
#[cfg(test)]
mod ray_bounds_tests;
mod ray_box;
mod ray_rect;
mod ray_starts;
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
mod triangles_at_places;
#[cfg(test)]
mod triangles_at_places_tests;

pub use counts::CastCounts;
pub use multi_hit::MultiHits;
pub(crate) use params::LARGE_SIDE;
pub use trace::{EntryPoint, LargeTrace, PacketTrace};
