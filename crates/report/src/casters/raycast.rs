//! RayCast's casters: packet traversal for a tile of a camera's rays, and single-ray traversal.

use super::caster::{Caster, Rays};
use raycast_core::camera::{Lattice, Ray};
use raycast_core::{Accel, Cull, Detail, Precision, PrimitiveHit};
use std::sync::Arc;

fn word(precision: Precision) -> &'static str {
    match precision {
        Precision::Exact => "exact",
        Precision::Fast => "fast",
    }
}

/// Packet traversal of tiles, which makes pictures.
pub(super) struct Tile {
    name: String,
    accel: Arc<Accel>,
    precision: Precision,
}

impl Tile {
    pub(super) fn new(accel: &Arc<Accel>, precision: Precision) -> Self {
        Self {
            name: format!("RayCast tiles, {}", word(precision)),
            accel: Arc::clone(accel),
            precision,
        }
    }

    pub(super) fn with_simd_in_name(accel: &Arc<Accel>, precision: Precision) -> Self {
        let name = format!(
            "RayCast tiles, {}, {}",
            word(precision),
            accel.simd().name()
        );
        Self {
            name,
            ..Self::new(accel, precision)
        }
    }
}

impl Caster for Tile {
    fn name(&self) -> &str {
        &self.name
    }

    fn rays(&self) -> Rays {
        Rays::Camera
    }

    /// Rays that are not a camera's are traced one by one.
    fn cast(&self, rays: &[Ray], hits: &mut Vec<PrimitiveHit>) {
        hits.clear();
        let cast = |ray| self.accel.cast_primitive(ray, Cull::None, self.precision);
        hits.extend(rays.iter().map(cast));
    }

    fn cast_lattice(&self, lattice: &Lattice, hits: &mut Vec<PrimitiveHit>) {
        self.accel
            .cast_lattice(lattice, Cull::None, self.precision, Detail::Full, hits);
    }

    fn find_lattice(&self, lattice: &Lattice, primitives: &mut Vec<u32>) {
        self.accel
            .find_closest(lattice, Cull::None, self.precision, primitives);
    }

    fn identify(&self, primitive: u32) -> (u32, u32) {
        self.accel.identify(primitive)
    }
}

/// Single-ray traversal, which picking and files of rays use.
pub(super) struct Single {
    name: String,
    accel: Arc<Accel>,
    precision: Precision,
}

impl Single {
    pub(super) fn new(accel: &Arc<Accel>, precision: Precision) -> Self {
        Self {
            name: format!("RayCast single rays, {}", word(precision)),
            accel: Arc::clone(accel),
            precision,
        }
    }
}

impl Caster for Single {
    fn name(&self) -> &str {
        &self.name
    }

    fn rays(&self) -> Rays {
        Rays::Double
    }

    fn cast(&self, rays: &[Ray], hits: &mut Vec<PrimitiveHit>) {
        hits.clear();
        let cast = |ray| self.accel.cast_primitive(ray, Cull::None, self.precision);
        hits.extend(rays.iter().map(cast));
    }

    fn cast_lattice(&self, lattice: &Lattice, hits: &mut Vec<PrimitiveHit>) {
        hits.clear();
        for row in 0..lattice.rows {
            hits.extend((0..lattice.columns).map(|column| {
                let ray = lattice.ray(column, row);
                self.accel.cast_primitive(&ray, Cull::None, self.precision)
            }));
        }
    }

    fn identify(&self, primitive: u32) -> (u32, u32) {
        self.accel.identify(primitive)
    }
}
