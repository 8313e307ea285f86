//! All hits of each ray of a large packet, in exact order (Gribble, Naveros, Kerzner, "Multi-Hit Ray Traversal", 2014).
//!
//! A packet's triangles are set up as for its closest hits, without skipping what is occluded by translucent ones. Where
//! bounds leave a hit or an order of two undecided, the ray's possible hits are tested as a single ray's.

use super::hit_buffer::{HitBuffer, Surface};
use super::params::{LARGE_SIDE, SIDE};
use super::ray_rect::RayRect;
use super::traversal::Traversal;
use crate::camera::Lattice;
use crate::hit::{Cull, Precision};
use crate::num::simd::{Lanes, Work, dispatch};
use crate::single::{Clipped, MOST_HITS, OrderedHits};
use std::ops::Range;

/// All hits of many rays, each ray's from the nearest on: see [`Clipped::find_all`].
#[derive(Debug, Default)]
pub struct MultiHits {
    /// For each ray, where its hits are in `primitives`.
    rays: Vec<Range<u32>>,
    primitives: Vec<u32>,
    ordered: OrderedHits,
    buffer: HitBuffer,
}

impl MultiHits {
    /// The primitive indices of the triangles that a ray hits, by its number in the lattice, row by row; none for a number
    /// beyond the last.
    pub fn of(&self, ray: usize) -> &[u32] {
        let Range { start, end } = self.rays.get(ray).cloned().unwrap_or_default();
        &self.primitives[start as usize..end as usize]
    }

    /// Finds the hits of the `wanted` rays of a lattice, row by row, in the order of [`OrderedHits::find`]; the others get none.
    pub(crate) fn find(
        &mut self,
        kept: &Clipped<'_>,
        lattice: &Lattice,
        options: (Cull, Precision),
        wanted: &[bool],
        is_opaque: &dyn Fn(u32) -> bool,
    ) {
        self.primitives.clear();
        self.rays.clear();
        self.rays.resize(lattice.len(), 0..0);
        let mut find = FindAll {
            hits: self,
            kept,
            lattice,
            options,
            wanted,
            is_opaque,
        };
        let camera = &lattice.camera;
        let is_planar = camera.projection().panorama().is_none()
            && lattice.halves().is_none()
            && !camera.has_an_eye_a_column();
        let simd = kept.accel.simd();
        if !is_planar {
            find.each_of(&RayRect::all(lattice));
        } else if kept.accel.has_instances() {
            dispatch(simd, InPackets::<true>(find));
        } else {
            dispatch(simd, InPackets::<false>(find));
        }
    }
}

impl Clipped<'_> {
    /// Finds all triangles that the rays of a lattice hit and that planes and masks keep: nearest first by exact distance;
    /// equal distances go by object, then by triangle. Of each ray the first 256 are found.
    pub fn find_all(&self, lattice: &Lattice, cull: Cull, hits: &mut MultiHits) {
        let wanted = vec![true; lattice.len()];
        let options = (cull, Precision::Exact);
        hits.find(self, lattice, options, &wanted, &|_| false);
    }
}

struct FindAll<'a> {
    hits: &'a mut MultiHits,
    kept: &'a Clipped<'a>,
    lattice: &'a Lattice,
    options: (Cull, Precision),
    wanted: &'a [bool],
    is_opaque: &'a dyn Fn(u32) -> bool,
}

struct InPackets<'a, const INSTANCES: bool>(FindAll<'a>);

impl<const INSTANCES: bool> Work for InPackets<'_, INSTANCES> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let mut find = self.0;
        let (kept, lattice, (cull, precision)) = (find.kept, find.lattice, find.options);
        let is_opaque = find.is_opaque;
        let surface = |primitive| Surface {
            is_opaque: is_opaque(primitive),
            is_partial: kept.is_masked(primitive),
        };
        let mut traversal = Traversal::<INSTANCES>::new(kept.accel, &kept.clip, lattice, precision);
        for large in RayRect::all(lattice).split(LARGE_SIDE) {
            traversal.find_entry_points(lanes, &large);
            if traversal.entry_points.is_empty() {
                continue;
            }
            if traversal.is_sparse(lanes, lattice, &large) {
                find.each_of(&large);
                continue;
            }
            for packet in large.split(SIDE as u32) {
                if find.wants_none(&packet) {
                    continue;
                }
                let mut buffer = std::mem::take(&mut find.hits.buffer);
                let wanted = find.wanted_of(packet);
                if traversal.gather(lanes, &packet, cull, &surface, wanted, &mut buffer) {
                    find.order(&packet, &mut buffer);
                } else {
                    find.each_of(&packet);
                }
                find.hits.buffer = buffer;
            }
        }
    }
}

impl FindAll<'_> {
    fn index(&self, column: u32, row: u32) -> usize {
        row as usize * self.lattice.columns as usize + column as usize
    }

    fn wants_none(&self, packet: &RayRect) -> bool {
        self.wanted_of(*packet).next().is_none()
    }

    /// The wanted rays of a packet, as its columns and rows.
    fn wanted_of(&self, packet: RayRect) -> impl Iterator<Item = (u32, u32)> {
        let rays = (0..packet.rows)
            .flat_map(move |row| (0..packet.columns).map(move |column| (column, row)));
        let (wanted, columns) = (self.wanted, self.lattice.columns as usize);
        rays.filter(move |(column, row)| {
            wanted[(packet.row + row) as usize * columns + (packet.column + column) as usize]
        })
    }

    /// Stores the hits of a packet, in order.
    #[inline(never)]
    fn order(&mut self, packet: &RayRect, buffer: &mut HitBuffer) {
        buffer.order(|ray| {
            let (column, row) = (packet.column + ray.column, packet.row + ray.row);
            if ray.are_ordered {
                let primitives = &mut self.hits.primitives;
                let begin = primitives.len();
                for hit in ray.hits.iter().take(MOST_HITS) {
                    primitives.push(hit.primitive);
                    if hit.is_opaque {
                        break;
                    }
                }
                self.keep(column, row, begin);
                return;
            }
            let (_, precision) = self.options;
            match precision {
                Precision::Exact => {
                    let primitives = ray.hits.iter().map(|hit| hit.primitive);
                    self.hits.ordered.find_among(
                        primitives,
                        self.kept,
                        &self.lattice.ray(column, row),
                        self.options,
                        self.is_opaque,
                    );
                    self.keep_ordered(column, row);
                }
                // In double precision a ray may hit a triangle that it exactly misses.
                Precision::Fast => self.one(column, row),
            }
        });
    }

    /// Finds the hits of the wanted rays of a rectangle one by one.
    #[inline(never)]
    fn each_of(&mut self, rect: &RayRect) {
        for row in rect.row..rect.row + rect.rows {
            for column in rect.column..rect.column + rect.columns {
                if self.wanted[self.index(column, row)] {
                    self.one(column, row);
                }
            }
        }
    }

    fn one(&mut self, column: u32, row: u32) {
        let ray = self.lattice.ray(column, row);
        (self.hits.ordered).find(self.kept, &ray, self.options, self.is_opaque);
        self.keep_ordered(column, row);
    }

    fn keep_ordered(&mut self, column: u32, row: u32) {
        let MultiHits {
            primitives,
            ordered,
            ..
        } = &mut *self.hits;
        let begin = primitives.len();
        primitives.extend(ordered.primitives());
        self.keep(column, row, begin);
    }

    /// Stores that the hits from `begin` on are a ray's.
    fn keep(&mut self, column: u32, row: u32, begin: usize) {
        let at = self.index(column, row);
        self.hits.rays[at] = begin as u32..self.hits.primitives.len() as u32;
    }
}
