//! Embree with its own BVH and triangle tests, for packets of 1, 8 or 16 rays.

use super::caster::{Caster, Rays};
use crate::embree::{EmbreeScene, NONE, Packet};
use raycast_core::camera::{Lattice, Projection, Ray};
use raycast_core::glam::Vec3;
use raycast_core::{Accel, MISS, PrimitiveHit};
use std::sync::Arc;

/// Casts rays with Embree in packets of `N`.
pub(super) struct Embree<const N: usize> {
    name: String,
    accel: Arc<Accel>,
    scene: Arc<EmbreeScene>,
}

impl<const N: usize> Embree<N> {
    /// `scene` must hold the triangles of `accel` in the order of their primitive indices.
    pub(super) fn new(accel: &Arc<Accel>, scene: &Arc<EmbreeScene>, robust: bool) -> Self {
        let robust = if robust { " robust" } else { "" };
        Self {
            name: format!("Embree {N}{robust}, f32"),
            accel: Arc::clone(accel),
            scene: Arc::clone(scene),
        }
    }
}

/// Intersects the `N` rays of a packet.
pub(super) trait CastPacket {
    fn cast(&mut self, scene: &EmbreeScene, coherent: bool);
}

impl CastPacket for Packet<1> {
    #[inline(always)]
    fn cast(&mut self, scene: &EmbreeScene, coherent: bool) {
        scene.cast_1(self, coherent);
    }
}

impl CastPacket for Packet<8> {
    #[inline(always)]
    fn cast(&mut self, scene: &EmbreeScene, coherent: bool) {
        scene.cast_8(self, coherent);
    }
}

impl CastPacket for Packet<16> {
    #[inline(always)]
    fn cast(&mut self, scene: &EmbreeScene, coherent: bool) {
        scene.cast_16(self, coherent);
    }
}

/// Sets the ray of one lane.
#[inline(always)]
fn set<const N: usize>(packet: &mut Packet<N>, lane: usize, origin: Vec3, direction: Vec3) {
    for axis in 0..3 {
        packet.origin[axis][lane] = origin[axis];
        packet.direction[axis][lane] = direction[axis];
    }
}

/// The hit of one lane.
#[inline(always)]
fn hit<const N: usize>(packet: &Packet<N>, lane: usize) -> PrimitiveHit {
    if packet.geometry[lane] == NONE {
        return PrimitiveHit::NONE;
    }
    PrimitiveHit {
        primitive: packet.triangle[lane],
        t: packet.t_far[lane],
        u: packet.u[lane],
        v: packet.v[lane],
    }
}

impl<const N: usize> Embree<N>
where
    Packet<N>: CastPacket,
{
    /// Casts a camera's rays in packets of neighbours, as square as `N` allows, with Embree's flag for coherent
    /// rays. Calls `keep` with the packet, the lane, and the ray's index in the lattice.
    ///
    /// Plain loops over lanes set rays up, which the compiler can vectorise.
    #[allow(
        clippy::needless_range_loop,
        reason = "a lane is an index into all the arrays at once"
    )]
    #[inline(always)]
    fn for_each(&self, lattice: &Lattice, mut keep: impl FnMut(&Packet<N>, usize, usize)) {
        let (width, height) = match N {
            1 => (1, 1),
            8 => (4, 2),
            _ => (4, N / 4),
        };
        let camera = &lattice.camera;
        let step = camera.plane().step * f64::from(lattice.stride);
        let (x, y) = lattice.place(0, 0);
        let first = camera.ray(x, y).origin - self.accel.origin();
        let perspective = camera.projection() == Projection::Perspective;
        // Perspective rays share the origin, orthographic ones the direction; the other one varies.
        let (shared, start) = if perspective {
            (first, camera.direction(x, y))
        } else {
            (camera.forward(), first)
        };
        let [shared, start] = [shared, start].map(|v| v.as_vec3().to_array());
        let along = (camera.right() * step).as_vec3().to_array();
        let down = (camera.up() * -step).as_vec3().to_array();
        let mut packet = Packet::<N>::NEW;
        for axis in 0..3 {
            if perspective {
                packet.origin[axis] = [shared[axis]; N];
            } else {
                packet.direction[axis] = [shared[axis]; N];
            }
        }
        let (columns, rows) = (lattice.columns as usize, lattice.rows as usize);
        for top in (0..rows).step_by(height) {
            for left in (0..columns).step_by(width) {
                let mut moving = [[0.0; N]; 3];
                for axis in 0..3 {
                    for lane in 0..N {
                        let (i, j) = ((left + lane % width) as f32, (top + lane / width) as f32);
                        moving[axis][lane] = start[axis] + along[axis] * i + down[axis] * j;
                    }
                }
                if perspective {
                    let [x, y, z] = &mut moving;
                    for lane in 0..N {
                        let (a, b, c) = (x[lane], y[lane], z[lane]);
                        let scale = 1.0 / (a * a + b * b + c * c).sqrt();
                        x[lane] = a * scale;
                        y[lane] = b * scale;
                        z[lane] = c * scale;
                    }
                    packet.direction = moving;
                } else {
                    packet.origin = moving;
                }
                packet.reset();
                packet.cast(&self.scene, true);
                // Rays outside the lattice only fill the packet: their hits are not kept.
                let across = width;
                for row in 0..height.min(rows - top) {
                    for column in 0..width.min(columns - left) {
                        let lane = row * across + column;
                        keep(&packet, lane, (top + row) * columns + left + column);
                    }
                }
            }
        }
    }
}

impl<const N: usize> Caster for Embree<N>
where
    Packet<N>: CastPacket,
{
    fn name(&self) -> &str {
        &self.name
    }

    fn rays(&self) -> Rays {
        Rays::Single
    }

    fn cast(&self, rays: &[Ray], hits: &mut Vec<PrimitiveHit>) {
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

    fn cast_lattice(&self, lattice: &Lattice, hits: &mut Vec<PrimitiveHit>) {
        hits.clear();
        hits.resize(lattice.len(), PrimitiveHit::NONE);
        self.for_each(lattice, |packet, lane, at| hits[at] = hit(packet, lane));
    }

    fn find_lattice(&self, lattice: &Lattice, primitives: &mut Vec<u32>) {
        primitives.clear();
        primitives.resize(lattice.len(), MISS);
        // Embree's invalid id is equal to a miss's primitive index.
        self.for_each(lattice, |packet, lane, at| {
            primitives[at] = packet.triangle[lane]
        });
    }

    fn identify(&self, primitive: u32) -> (u32, u32) {
        self.accel.identify(primitive)
    }
}
