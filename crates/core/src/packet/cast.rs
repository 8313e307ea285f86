//! Casting lattices of rays. Rays that a packet leaves undecided are cast as single rays.

mod around;
mod evaluate;
mod eyes;

use super::counts::CastCounts;
use super::interval_zbuffer::IntervalZBuffer;
use super::params::{LARGE_SIDE, SIDE};
use super::ray_rect::RayRect;
use super::traversal::Traversal;
use crate::bvh::Accel;
use crate::camera::Lattice;
use crate::hit::{Cull, Detail, MISS, Precision, PrimitiveHit};
use crate::hits::Hits;
use crate::num::simd::{Lanes, Work, dispatch};
use crate::single::{self, Clipped};
use crate::triangle::clip::Clip;
use crate::triangle::{Nearest, PreparedRay};
use around::FindAround;

impl Accel {
    /// Casts every ray of a lattice into `hits`, row by row.
    ///
    /// Each hit is what [`Accel::cast_primitive`] answers for that ray, as far as `detail` requires. With
    /// [`Precision::Fast`] a packet may be right where a single ray in double precision is not.
    pub fn cast_lattice(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        detail: Detail,
        hits: &mut Vec<PrimitiveHit>,
    ) {
        let mut found = Hits::default();
        self.find(lattice, cull, precision, &mut found.primitives);
        if detail == Detail::Full {
            self.evaluate(lattice, cull, precision, &mut found);
        }
        hits.clear();
        hits.extend(found.iter());
    }

    /// Finds the closest triangle of each ray of a lattice: its primitive index or [`MISS`], row by row into
    /// `primitives`.
    pub fn find(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        primitives: &mut Vec<u32>,
    ) -> CastCounts {
        self.find_kept(&Clip::NONE, lattice, cull, precision, primitives)
    }

    fn find_kept(
        &self,
        clip: &Clip,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        primitives: &mut Vec<u32>,
    ) -> CastCounts {
        primitives.clear();
        primitives.resize(lattice.len(), MISS);
        if let Some(halves) = lattice.halves() {
            return self.find_halves(clip, (lattice, halves), cull, precision, primitives);
        }
        if lattice.camera.has_an_eye_a_column() {
            return self.find_each(clip, lattice, cull, precision, primitives);
        }
        let mut counts = CastCounts::default();
        if lattice.camera.projection().panorama().is_some() {
            let find = Find {
                accel: self,
                clip,
                lattice,
                cull,
                precision,
                primitives,
                counts: &mut counts,
            };
            dispatch(self.simd, FindAround(find));
        } else if self.tree.root.is_some() {
            if self.has_instances() {
                self.find_in::<true>(clip, lattice, cull, precision, primitives, &mut counts);
            } else {
                self.find_in::<false>(clip, lattice, cull, precision, primitives, &mut counts);
            }
        }
        counts
    }

    fn find_in<const INSTANCES: bool>(
        &self,
        clip: &Clip,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        primitives: &mut [u32],
        counts: &mut CastCounts,
    ) {
        dispatch(
            self.simd,
            Find::<INSTANCES> {
                accel: self,
                clip,
                lattice,
                cull,
                precision,
                primitives,
                counts,
            },
        );
    }
}

impl Clipped<'_> {
    /// As [`Accel::cast_lattice`], for the closest hits that are kept.
    pub fn cast_lattice(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        detail: Detail,
        hits: &mut Vec<PrimitiveHit>,
    ) {
        let mut found = Hits::default();
        self.find(lattice, cull, precision, &mut found.primitives);
        if detail == Detail::Full {
            self.accel.evaluate(lattice, cull, precision, &mut found);
        }
        hits.clear();
        hits.extend(found.iter());
    }

    /// As [`Accel::find`], for the closest hits whose points are kept; [`Accel::evaluate`] interpolates t, u and v.
    pub fn find(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        primitives: &mut Vec<u32>,
    ) -> CastCounts {
        let mut counts = (self.accel).find_kept(&self.clip, lattice, cull, precision, primitives);
        counts.hits -= self.reject_masked(lattice, cull, precision, primitives);
        counts
    }
}

pub(super) struct Find<'a, const INSTANCES: bool> {
    pub(super) accel: &'a Accel,
    pub(super) clip: &'a Clip,
    pub(super) lattice: &'a Lattice,
    pub(super) cull: Cull,
    pub(super) precision: Precision,
    pub(super) primitives: &'a mut [u32],
    pub(super) counts: &'a mut CastCounts,
}

impl<const INSTANCES: bool> Work for Find<'_, INSTANCES> {
    #[inline(always)]
    fn run(mut self, lanes: impl Lanes) {
        let whole = RayRect::all(self.lattice);
        let mut traversal =
            Traversal::<INSTANCES>::new(self.accel, self.clip, self.lattice, self.precision);
        let mut zbuffer = IntervalZBuffer::new();
        for large in whole.split(LARGE_SIDE) {
            traversal.list(lanes, &large);
            if traversal.list.is_empty() {
                continue;
            }
            // Fast casting keeps the packet's answers, which may be right where the single ray in double precision is
            // not.
            let is_exact = self.precision == Precision::Exact;
            if is_exact && traversal.is_sparse(lanes, self.lattice, &large) {
                self.cast_each(&large);
                continue;
            }
            for part in large.split(SIDE as u32) {
                if traversal.cast(lanes, &part, self.cull, &mut zbuffer, &mut ()) {
                    self.keep(&part, &mut zbuffer);
                }
            }
        }
        *self.counts = CastCounts {
            nodes: traversal.counts.nodes,
            triangles: traversal.counts.triangles,
            ..*self.counts
        };
    }
}

impl<const INSTANCES: bool> Find<'_, INSTANCES> {
    /// Stores what a packet found, and casts its undecided rays.
    #[inline(always)]
    pub(super) fn keep(&mut self, part: &RayRect, zbuffer: &mut IntervalZBuffer) {
        let columns = part.columns as usize;
        let mut undecided = 0;
        for row in 0..part.rows {
            let first = ((part.row + row) * self.lattice.columns + part.column) as usize;
            let stored = &zbuffer.row(row)[..columns];
            let (mut count, mut any_undecided) = (0, false);
            let kept = &mut self.primitives[first..first + columns];
            for (kept, &stored) in kept.iter_mut().zip(stored) {
                *kept = IntervalZBuffer::primitive(stored);
                count += u32::from(stored != MISS);
                any_undecided |= IntervalZBuffer::is_undecided(stored);
            }
            self.counts.hits += u64::from(count);
            undecided |= u32::from(any_undecided) << (row % SIDE as u32);
        }
        if undecided != 0 {
            self.decide(part, zbuffer, undecided);
        }
    }

    /// Casts the undecided rays of a packet; `rows` (as bits) are those that have any.
    #[inline(never)]
    fn decide(&mut self, part: &RayRect, zbuffer: &mut IntervalZBuffer, rows: u32) {
        zbuffer.sort_rivals();
        for row in (0..part.rows).filter(|row| rows >> row & 1 != 0) {
            for column in 0..part.columns {
                if !IntervalZBuffer::is_undecided(zbuffer.row(row)[column as usize]) {
                    continue;
                }
                let rivals = zbuffer.rivals(row, column);
                let (column, row) = (part.column + column, part.row + row);
                let primitive = self.cast_one(column, row, rivals);
                self.primitives[(row * self.lattice.columns + column) as usize] = primitive;
                // The ray was counted as a hit.
                self.counts.hits -= u64::from(primitive == MISS);
            }
        }
    }

    /// The answer of [`Accel::cast_primitive`] for a ray whose closest hit, if any, is one of its rivals.
    fn cast_one(&mut self, column: u32, row: u32, rivals: Option<&[(u32, u32)]>) -> u32 {
        let ray = self.lattice.ray(column, row);
        let ray = PreparedRay::new(&ray, self.accel.origin, self.cull, self.precision);
        let Some(ray) = ray else { return MISS };
        let nearest = match rivals {
            Some(rivals) if self.precision == Precision::Exact => {
                let mut nearest = Nearest::NONE;
                for &(_, primitive) in rivals {
                    self.accel
                        .intersect_kept(self.clip, &ray, primitive, &mut nearest);
                }
                nearest
            }
            // In double precision, which fast casting trusts, the ray may hit a triangle that it exactly misses and
            // that is therefore no rival: it traverses the tree.
            _ => single::nearest(self.accel, self.clip, &ray),
        };
        let primitive = nearest.primitive;
        if ray.was_exact() {
            self.counts.exact_rays += 1;
        } else {
            self.counts.double_rays += 1;
        }
        primitive
    }

    /// Casts the rays of a rectangle one by one.
    #[inline(never)]
    fn cast_each(&mut self, part: &RayRect) {
        for row in part.row..part.row + part.rows {
            for column in part.column..part.column + part.columns {
                let primitive = self.cast_one(column, row, None);
                self.counts.hits += u64::from(primitive != MISS);
                self.primitives[(row * self.lattice.columns + column) as usize] = primitive;
            }
        }
    }
}
