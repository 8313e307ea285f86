//! RayCast's core: exact ray casting of triangle meshes on the CPU.
//!
//! A module uses only modules listed before it:
//!
//! `num`, [`Ray`], [`Hit`] → [`scene`] → [`camera`] → `triangle` → [`bvh`] → `single` → [`packet`] →
//! [`shade`] → [`picture`] → [`render`] → [`formats`]
//!
//! The core is pure: it has no window, no global state and no clock, and it never prints. Files
//! are read in [`formats`] alone; everything else takes values and returns values.

pub mod bvh;
pub mod camera;
pub mod formats;
mod hit;
mod hits;
mod num;
pub mod packet;
pub mod picture;
#[cfg(test)]
mod random;
mod ray;
pub mod render;
pub mod scene;
pub mod shade;
mod single;
mod triangle;

pub use glam;
pub use hit::{Cull, Detail, Hit, MISS, Precision, SlotHit};
pub use hits::Hits;
pub use num::simd::Simd;
pub use ray::Ray;

pub use picture as image;

#[doc(hidden)]
pub mod accel {
    pub use crate::bvh::Accel;
    pub use crate::packet::{CastCounts, EntryPoint, LargeTrace, PacketTrace};
    pub use crate::{Hits, MISS, Simd, SlotHit};
}

#[doc(hidden)]
pub mod intersect {
    pub use crate::{Cull, Detail, Hit, Precision};
}
