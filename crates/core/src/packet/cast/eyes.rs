//! Lattices of pictures for two eyes. A side-by-side or stacked pair is two lattices, one an eye; in other pictures
//! rays share no eye and are cast one by one.

use super::Find;
use crate::bvh::Accel;
use crate::camera::Lattice;
use crate::hit::{Cull, MISS, Precision, PrimitiveHit};
use crate::hits::Hits;
use crate::packet::counts::CastCounts;
use crate::packet::ray_rect::RayRect;
use crate::triangle::SharedTriangles;
use crate::triangle::clip::Clip;
use std::rc::Rc;

/// Halves of a lattice, and the column and row of each half's first ray.
type Halves = [(Lattice, (u32, u32)); 2];

impl Accel {
    /// [`Accel::find_closest`] for halves of a lattice, each given with the position of its first ray.
    pub(super) fn find_halves(
        &self,
        clip: &Clip,
        (lattice, halves): (&Lattice, Halves),
        cull: Cull,
        precision: Precision,
        primitives: &mut [u32],
    ) -> CastCounts {
        let mut counts = CastCounts::default();
        let mut found = Vec::new();
        for (half, first) in halves.iter().filter(|(half, _)| !half.is_empty()) {
            counts += self.find_clipped(clip, half, cull, precision, &mut found);
            for (row, found) in found.chunks(half.columns as usize).enumerate() {
                let at = index(lattice, *first, row);
                primitives[at..at + found.len()].copy_from_slice(found);
            }
        }
        counts
    }

    /// [`Accel::interpolate`] for halves of a lattice.
    pub(super) fn interpolate_halves(
        &self,
        (lattice, halves): (&Lattice, Halves),
        cull: Cull,
        precision: Precision,
        hits: &mut Hits,
    ) {
        for (half, first) in halves.iter().filter(|(half, _)| !half.is_empty()) {
            let columns = half.columns as usize;
            let rows = 0..half.rows as usize;
            let mut found = Hits::default();
            for at in rows.clone().map(|row| index(lattice, *first, row)) {
                let row = &hits.primitives[at..at + columns];
                found.primitives.extend_from_slice(row);
            }
            self.interpolate(half, cull, precision, &mut found);
            for row in rows {
                let at = index(lattice, *first, row);
                let (from, to) = (row * columns..(row + 1) * columns, at..at + columns);
                hits.primitives[to.clone()].copy_from_slice(&found.primitives[from.clone()]);
                hits.t[to.clone()].copy_from_slice(&found.t[from.clone()]);
                hits.u[to.clone()].copy_from_slice(&found.u[from.clone()]);
                hits.v[to].copy_from_slice(&found.v[from]);
            }
        }
    }

    /// [`Accel::find_closest`] where rays share no eye.
    pub(super) fn find_each(
        &self,
        clip: &Clip,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        primitives: &mut [u32],
    ) -> CastCounts {
        let mut counts = CastCounts::default();
        let mut find = Find {
            accel: self,
            clip,
            lattice,
            cull,
            precision,
            primitives,
            counts: &mut counts,
            shared: Rc::new(SharedTriangles::new(false)),
            last: None,
        };
        find.cast_each(&RayRect::all(lattice));
        counts
    }

    /// [`Accel::interpolate`] where rays share no eye.
    pub(super) fn interpolate_each(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        hits: &mut Hits,
    ) {
        for at in 0..hits.len() {
            let primitive = hits.primitives[at];
            let mut hit = PrimitiveHit::NONE;
            if primitive != MISS {
                let ray = lattice.ray(at as u32 % lattice.columns, at as u32 / lattice.columns);
                let ray = self.prepare(&ray, cull, precision);
                hit = ray.map_or(hit, |ray| {
                    (ray.hit_on(primitive, self.corners(primitive))).to_primitive_hit()
                });
            }
            hits.primitives[at] = hit.primitive;
            (hits.t[at], hits.u[at], hits.v[at]) = (hit.t, hit.u, hit.v);
        }
    }
}

/// The index in the whole lattice of a half's row.
fn index(lattice: &Lattice, (column, row): (u32, u32), row_of_half: usize) -> usize {
    (row as usize + row_of_half) * lattice.columns as usize + column as usize
}
