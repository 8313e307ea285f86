//! RayCast's core: exact ray casting of triangle meshes on the CPU.
//!
//! Data flows one way, a module a station:
//!
//! [`formats`] → [`scene`] → [`accel`] → [`camera`] → [`render`] (over [`intersect`] and
//! [`shade`]) → [`image`]
//!
//! The core is pure: it has no window, no global state and no clock, and it never prints. Files
//! are read in [`formats`] alone; everything else takes values and returns values.

pub mod accel;
pub mod camera;
pub mod formats;
pub mod image;
pub mod intersect;
mod quote;
#[cfg(test)]
mod random;
pub mod ranges;
pub mod render;
pub mod scene;
pub mod shade;

pub use glam;
