//! Embree's own tree and triangle tests: a ray, eight, or sixteen at a time.

use super::one_ray::RowOfRays;
use super::{Rays, Way};
use crate::embree::{EmbreeScene, NONE, Packet};
use raycast_core::accel::{Accel, SlotHit};
use raycast_core::camera::{Lattice, Ray};
use raycast_core::glam::Vec3;
use std::sync::Arc;

/// Rays through Embree, `N` at a time.
pub(super) struct Embree<const N: usize> {
    name: String,
    accel: Arc<Accel>,
    scene: Arc<EmbreeScene>,
}

impl<const N: usize> Embree<N> {
    /// `scene` holds the triangles of `accel` in the order of their slots.
    pub(super) fn new(accel: &Arc<Accel>, scene: &Arc<EmbreeScene>, robust: bool) -> Self {
        let rays = match N {
            1 => "single rays".to_owned(),
            n => format!("packets of {n}"),
        };
        let robust = if robust { ", robust" } else { "" };
        Self {
            name: format!("Embree {rays}{robust}, f32"),
            accel: Arc::clone(accel),
            scene: Arc::clone(scene),
        }
    }
}

/// Casts the `N` rays of a packet.
trait Cast {
    fn cast(&mut self, scene: &EmbreeScene, coherent: bool);
}

impl Cast for Packet<1> {
    #[inline(always)]
    fn cast(&mut self, scene: &EmbreeScene, coherent: bool) {
        scene.cast_1(self, coherent);
    }
}

impl Cast for Packet<8> {
    #[inline(always)]
    fn cast(&mut self, scene: &EmbreeScene, coherent: bool) {
        scene.cast_8(self, coherent);
    }
}

impl Cast for Packet<16> {
    #[inline(always)]
    fn cast(&mut self, scene: &EmbreeScene, coherent: bool) {
        scene.cast_16(self, coherent);
    }
}

/// A ray's place in a packet.
#[inline(always)]
fn set<const N: usize>(packet: &mut Packet<N>, lane: usize, origin: Vec3, direction: Vec3) {
    for axis in 0..3 {
        packet.origin[axis][lane] = origin[axis];
        packet.direction[axis][lane] = direction[axis];
    }
}

/// What a lane of a packet met.
#[inline(always)]
fn hit<const N: usize>(packet: &Packet<N>, lane: usize) -> SlotHit {
    if packet.geometry[lane] == NONE {
        return SlotHit::NONE;
    }
    SlotHit {
        slot: packet.triangle[lane],
        t: packet.t_far[lane],
        u: packet.u[lane],
        v: packet.v[lane],
    }
}

impl<const N: usize> Way for Embree<N>
where
    Packet<N>: Cast,
{
    fn name(&self) -> &str {
        &self.name
    }

    fn rays(&self) -> Rays {
        Rays::Single
    }

    fn cast(&self, rays: &[Ray], hits: &mut Vec<SlotHit>) {
        hits.clear();
        let mut packet = Packet::<N>::NEW;
        for group in rays.chunks(N) {
            packet.reset();
            for lane in 0..N {
                // A packet that is not full repeats its last ray.
                let ray = &group[lane.min(group.len() - 1)];
                let origin = (ray.origin - self.accel.origin()).as_vec3();
                set(&mut packet, lane, origin, ray.direction.as_vec3());
                packet.t_near[lane] = ray.t_min as f32;
                packet.t_far[lane] = ray.t_max.min(f64::from(f32::MAX)) as f32;
            }
            packet.cast(&self.scene, false);
            hits.extend((0..group.len()).map(|lane| hit(&packet, lane)));
        }
    }

    /// In packets of neighbours, as square as their number allows, and Embree is told that they are.
    fn cast_lattice(&self, lattice: &Lattice, hits: &mut Vec<SlotHit>) {
        let (width, height) = match N {
            1 => (1, 1),
            8 => (4, 2),
            _ => (4, N as u32 / 4),
        };
        hits.clear();
        hits.resize(lattice.len(), SlotHit::NONE);
        let mut packet = Packet::<N>::NEW;
        for top in (0..lattice.rows).step_by(height as usize) {
            // A packet that is not full repeats its last rays.
            let row_of = |lane: u32| (top + lane / width).min(lattice.rows - 1);
            let rows: [_; 4] = std::array::from_fn(|row| {
                let row = row_of(row as u32 * width);
                RowOfRays::<Vec3>::new(lattice, row, self.accel.origin())
            });
            for left in (0..lattice.columns).step_by(width as usize) {
                let column_of = |lane: u32| (left + lane % width).min(lattice.columns - 1);
                packet.reset();
                for lane in 0..N as u32 {
                    let ray = rows[(lane / width) as usize].ray(column_of(lane));
                    set(&mut packet, lane as usize, ray.origin, ray.direction);
                }
                packet.cast(&self.scene, true);
                for lane in 0..N as u32 {
                    let at = row_of(lane) * lattice.columns + column_of(lane);
                    hits[at as usize] = hit(&packet, lane as usize);
                }
            }
        }
    }

    fn identify(&self, slot: u32) -> (u32, u32) {
        self.accel.identify(slot)
    }
}
