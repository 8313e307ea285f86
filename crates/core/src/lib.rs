//! Exact ray casting of triangle meshes on the CPU.
//!
//! Every answer is that of exact arithmetic on the stored corners and the ray as given: of the triangles
//! that a ray hits, edges and vertices included, the nearest; at equal distances the lowest object, then
//! the lowest triangle. Pictures are the same byte for byte for any split into tiles, any number of
//! threads and any instruction set.
//!
//! # One ray
//!
//! ```
//! use raycast_core::glam::DVec3;
//! use raycast_core::scene::{Mesh, MeshData, Scene};
//! use raycast_core::{Accel, Cull, Ray};
//!
//! let mesh = Mesh::new(MeshData {
//!     positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
//!     triangles: vec![[0, 1, 2]],
//!     ..MeshData::default()
//! });
//! let accel = Accel::build(&Scene::from(mesh))?;
//! let ray = Ray::new(DVec3::new(0.25, 0.5, 4.0), DVec3::NEG_Z);
//! let hit = accel.cast(&ray, Cull::None).expect("the ray goes through the triangle");
//! assert_eq!((hit.triangle, hit.t, hit.u, hit.v), (0, 4.0, 0.25, 0.5));
//! # Ok::<(), raycast_core::scene::SceneError>(())
//! ```
//!
//! # A picture
//!
//! ```
//! use raycast_core::camera::Camera;
//! use raycast_core::glam::DVec3;
//! use raycast_core::picture::Format;
//! use raycast_core::scene::{Mesh, MeshData, Scene};
//!
//! let mesh = Mesh::new(MeshData {
//!     positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
//!     triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
//!     ..MeshData::default()
//! });
//! let scene = Scene::from(mesh);
//! let camera = Camera::fitting(&scene.bounds(), (22.0, 16.0), (64, 48))?;
//! let picture = raycast_core::render(&scene, &camera)?;
//! let png = picture.encode(Format::Png)?;
//! assert!(png.starts_with(b"\x89PNG"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The crate's `examples/` have more: a ray, a picture, tiles as they arrive, a scene made in code, a million rays.
//! [`formats::read_scene`] reads files.
//!
//! # The rooms
//!
//! A module uses only modules before it:
//!
//! [`math`], `num`, [`Ray`], [`Hit`] → [`scene`] → [`health`] → [`camera`] → `triangle` → `bvh` → `single` →
//! [`section`] → [`packet`] →
//! [`shade`] → [`picture`] → [`render`](mod@render) → [`formats`]
//!
//! The crate is pure: it has no window, no global state and no clock, and it never prints. Files are read
//! in [`formats`] alone; everything else takes values and returns values.

mod bvh;
pub mod camera;
pub mod digest;
pub mod formats;
pub mod health;
mod hit;
mod hits;
pub mod math;
mod num;
pub mod packet;
pub mod picture;
pub mod quote;
#[cfg(test)]
mod random;
pub mod ranges;
mod ray;
pub mod render;
pub mod scene;
pub mod section;
pub mod shade;
mod single;
mod triangle;

pub use bvh::Accel;
pub use glam;
pub use hit::{Cull, Detail, Hit, MISS, Precision, PrimitiveHit};
pub use hits::Hits;
pub use num::simd::Simd;
pub use ray::Ray;
pub use render::render;
pub use single::Clipped;
