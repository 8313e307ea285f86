//! Lattices of rays through the tree. Rays that a packet leaves undecided go to the single ray.

use super::counts::CastCounts;
use super::interval_zbuffer::IntervalZBuffer;
use super::params::{LARGE_SIDE, SIDE};
use super::traversal::{RayRect, Traversal};
use crate::bvh::Accel;
use crate::camera::Lattice;
use crate::hit::{Cull, Detail, MISS, Precision, PrimitiveHit};
use crate::hits::Hits;
use crate::num::simd::{F32x8, Lanes, Mask8, Work, dispatch};
use crate::single;
use crate::triangle::PreparedRay;
use crate::triangle::interpolate::{self as row, Corners, Places, RowHits, meet_row};

impl Accel {
    /// Casts every ray of a lattice into `hits`, row by row.
    ///
    /// Each hit is what [`Accel::cast_primitive`] answers for that ray, as far as `detail` asks for it. With
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
        primitives.clear();
        primitives.resize(lattice.len(), MISS);
        let mut counts = CastCounts::default();
        if self.tree.root.is_some() {
            dispatch(
                self.simd,
                Find {
                    accel: self,
                    lattice,
                    cull,
                    precision,
                    primitives,
                    counts: &mut counts,
                },
            );
        }
        counts
    }

    /// Interpolates t, u and v where the rays of a lattice hit the triangles that [`Accel::find`] found, the
    /// primitive indices in `hits`: what [`Accel::cast_primitive`] answers, bit for bit.
    pub fn evaluate(&self, lattice: &Lattice, cull: Cull, precision: Precision, hits: &mut Hits) {
        hits.primitives.resize(lattice.len(), MISS);
        hits.make_places();
        dispatch(
            self.simd,
            Evaluate {
                accel: self,
                lattice,
                cull,
                precision,
                hits,
            },
        );
    }
}

pub(super) struct Find<'a> {
    pub(super) accel: &'a Accel,
    pub(super) lattice: &'a Lattice,
    pub(super) cull: Cull,
    pub(super) precision: Precision,
    pub(super) primitives: &'a mut [u32],
    pub(super) counts: &'a mut CastCounts,
}

impl Work for Find<'_> {
    #[inline(always)]
    fn run(mut self, lanes: impl Lanes) {
        let whole = RayRect {
            column: 0,
            row: 0,
            columns: self.lattice.columns,
            rows: self.lattice.rows,
        };
        let mut traversal = Traversal::new(self.accel, self.lattice);
        let mut zbuffer = IntervalZBuffer::new();
        for large in whole.split(LARGE_SIDE) {
            traversal.list(lanes, &large);
            if traversal.list.is_empty() {
                continue;
            }
            for part in large.split(SIDE as u32) {
                if traversal.cast(lanes, &part, self.cull, &mut zbuffer, &mut ()) {
                    self.keep(&part, &zbuffer);
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

impl Find<'_> {
    /// Keeps what a packet found, and casts its undecided rays.
    #[inline(always)]
    pub(super) fn keep(&mut self, part: &RayRect, zbuffer: &IntervalZBuffer) {
        let columns = part.columns as usize;
        for row in 0..part.rows {
            let first = ((part.row + row) * self.lattice.columns + part.column) as usize;
            let held = &zbuffer.row(row)[..columns];
            let (mut met, mut any_undecided) = (0, false);
            let kept = &mut self.primitives[first..first + columns];
            for (kept, &held) in kept.iter_mut().zip(held) {
                *kept = IntervalZBuffer::primitive(held);
                met += u32::from(held != MISS);
                any_undecided |= IntervalZBuffer::is_undecided(held);
            }
            self.counts.hits += u64::from(met);
            if any_undecided {
                for (column, _) in held
                    .iter()
                    .enumerate()
                    .filter(|held| IntervalZBuffer::is_undecided(*held.1))
                {
                    let primitive = self.cast_one(part.column + column as u32, part.row + row);
                    self.primitives[first + column] = primitive;
                    // It was counted as a hit.
                    self.counts.hits -= u64::from(primitive == MISS);
                }
            }
        }
    }

    /// What [`Accel::cast_primitive`] answers.
    #[inline(never)]
    fn cast_one(&mut self, column: u32, row: u32) -> u32 {
        let ray = self.lattice.ray(column, row);
        let ray = PreparedRay::new(&ray, self.accel.origin, self.cull, self.precision);
        let Some(ray) = ray else { return MISS };
        let primitive = single::nearest(self.accel, &ray).primitive;
        if ray.was_exact() {
            self.counts.exact_rays += 1;
        } else {
            self.counts.double_rays += 1;
        }
        primitive
    }
}

struct Evaluate<'a> {
    accel: &'a Accel,
    lattice: &'a Lattice,
    cull: Cull,
    precision: Precision,
    hits: &'a mut Hits,
}

impl Work for Evaluate<'_> {
    #[inline(always)]
    fn run(mut self, lanes: impl Lanes) {
        for row in 0..self.lattice.rows {
            for column in (0..self.lattice.columns).step_by(row::LANES) {
                self.evaluate_row(lanes, column, row);
            }
        }
    }
}

impl Evaluate<'_> {
    /// Interpolates at most eight rays of a row.
    #[inline(always)]
    fn evaluate_row(&mut self, lanes: impl Lanes, column: u32, row: u32) {
        let first = (row * self.lattice.columns + column) as usize;
        let count = row::LANES.min((self.lattice.columns - column) as usize);
        let mut primitives = [MISS; row::LANES];
        primitives[..count].copy_from_slice(&self.hits.primitives[first..first + count]);
        if primitives == [MISS; row::LANES] {
            return;
        }
        let corners = self.corners(lanes, &primitives);
        let places = Places::new(self.lattice, column, row);
        let found = meet_row(&self.lattice.camera, self.accel.origin, places, &corners);
        let mut open = false;
        let RowHits {
            mut t,
            mut u,
            mut v,
            sure,
        } = found;
        for lane in 0..row::LANES {
            let met = primitives[lane] != MISS;
            open |= met & !sure[lane];
            t[lane] = if met { t[lane] } else { PrimitiveHit::NONE.t };
            u[lane] = if met { u[lane] } else { PrimitiveHit::NONE.u };
            v[lane] = if met { v[lane] } else { PrimitiveHit::NONE.v };
        }
        let Hits {
            t: all_t,
            u: all_u,
            v: all_v,
            ..
        } = &mut *self.hits;
        for (all, row) in [(all_t, t), (all_u, u), (all_v, v)] {
            all[first..first + count].copy_from_slice(&row[..count]);
        }
        if open {
            for lane in (0..count).filter(|&lane| primitives[lane] != MISS && !sure[lane]) {
                let hit = self.evaluate_one(primitives[lane], column + lane as u32, row);
                self.hits.set(first + lane, hit);
            }
        }
    }

    /// Corners of the triangles that eight rays hit. Each triangle is written to all lanes from its first on;
    /// the next one overwrites the rest.
    #[inline(always)]
    fn corners<L: Lanes>(&self, lanes: L, primitives: &[u32; row::LANES]) -> Corners {
        let mut all = [lanes.splat(0.0); 9];
        let mut lane = 0;
        while lane < row::LANES {
            let primitive = primitives[lane];
            let from = lanes.mask_from(lane);
            while lane < row::LANES && primitives[lane] == primitive {
                lane += 1;
            }
            if primitive != MISS {
                let [a, b, c] = self.accel.corners(primitive);
                let one = [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z];
                for (all, one) in all.iter_mut().zip(one) {
                    *all = from.select(lanes.splat(one), *all);
                }
            }
        }
        let mut corners = [[0.0; row::LANES]; 9];
        for (corner, all) in corners.iter_mut().zip(all) {
            all.store(corner);
        }
        corners
    }

    #[inline(never)]
    fn evaluate_one(&self, primitive: u32, column: u32, row: u32) -> PrimitiveHit {
        let ray = self.lattice.ray(column, row);
        let ray = PreparedRay::new(&ray, self.accel.origin, self.cull, self.precision);
        ray.map_or(PrimitiveHit::NONE, |ray| {
            ray.evaluate(primitive, self.accel.corners(primitive))
                .to_primitive_hit()
        })
    }
}
