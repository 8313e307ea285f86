//! Lattices on pictures that are no plane: one ray after another.

use super::counts::CastCounts;
use crate::bvh::Accel;
use crate::camera::Lattice;
use crate::hit::{Cull, MISS, Precision, PrimitiveHit};
use crate::hits::Hits;
use crate::single;
use crate::triangle::PreparedRay;
use crate::triangle::clip::Clip;

impl Accel {
    /// [`Accel::find`] for any lattice; `primitives` has a place for each of its rays.
    pub(super) fn find_each(
        &self,
        clip: &Clip,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        primitives: &mut [u32],
    ) -> CastCounts {
        let mut counts = CastCounts::default();
        for (primitive, (column, row)) in primitives.iter_mut().zip(places(lattice)) {
            let ray = lattice.ray(column, row);
            let Some(ray) = PreparedRay::new(&ray, self.origin, cull, precision) else {
                continue;
            };
            *primitive = single::nearest(self, clip, &ray).primitive;
            counts.hits += u64::from(*primitive != MISS);
            *(if ray.was_exact() {
                &mut counts.exact_rays
            } else {
                &mut counts.double_rays
            }) += 1;
        }
        counts
    }

    /// [`Accel::evaluate`] for any lattice; `hits` has a place for each of its rays.
    pub(super) fn evaluate_each(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        hits: &mut Hits,
    ) {
        let surfaces = (hits.t.iter_mut()).zip(hits.u.iter_mut().zip(hits.v.iter_mut()));
        let rays = hits.primitives.iter_mut().zip(places(lattice));
        for ((primitive, (column, row)), (t, (u, v))) in rays.zip(surfaces) {
            let mut hit = PrimitiveHit::NONE;
            if *primitive != MISS {
                let ray = lattice.ray(column, row);
                if let Some(ray) = PreparedRay::new(&ray, self.origin, cull, precision) {
                    let nearest = ray.evaluate(*primitive, self.corners(*primitive));
                    hit = nearest.to_primitive_hit();
                }
            }
            *primitive = hit.primitive;
            (*t, *u, *v) = (hit.t, hit.u, hit.v);
        }
    }
}

/// Columns and rows of a lattice's rays, row by row.
fn places(lattice: &Lattice) -> impl Iterator<Item = (u32, u32)> {
    let (columns, rows) = (lattice.columns, lattice.rows);
    (0..rows).flat_map(move |row| (0..columns).map(move |column| (column, row)))
}
