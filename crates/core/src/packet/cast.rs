//! Casting lattices of rays. Rays that a packet leaves undecided are cast as single rays.

mod around;
mod eyes;
mod far;
mod interpolate;

use super::counts::CastCounts;
use super::interval_zbuffer::IntervalZBuffer;
use super::params::{LARGE_SIDE, SIDE};
use super::places::NearEye;
use super::ray_rect::RayRect;
use super::traversal::Traversal;
use crate::bvh::Accel;
use crate::camera::{Camera, Lattice, Projection};
use crate::hit::{Cull, Detail, MISS, Precision, PrimitiveHit};
use crate::hits::Hits;
use crate::num::simd::{Lanes, Work, dispatch};
use crate::ray::Ray;
use crate::single::{self, Clipped};
use crate::triangle::clip::Clip;
use crate::triangle::{BoundedHit, SharedTriangles};
use around::FindAround;
use std::iter::Empty;
use std::rc::Rc;

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
        self.find_closest(lattice, cull, precision, &mut found.primitives);
        if detail == Detail::Full {
            self.interpolate(lattice, cull, precision, &mut found);
        }
        hits.clear();
        hits.extend(found.iter());
    }

    /// Finds the closest triangle of each ray of a lattice: its primitive index or [`MISS`], row by row into
    /// `primitives`.
    pub fn find_closest(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        primitives: &mut Vec<u32>,
    ) -> CastCounts {
        self.find_clipped(&Clip::NONE, lattice, cull, precision, primitives)
    }

    fn find_clipped(
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
        if self.tree.root.is_none() {
            return counts;
        }
        let has_eye = lattice.camera.projection() != Projection::Orthographic;
        let mut find = Find {
            accel: self,
            clip,
            lattice,
            cull,
            precision,
            primitives,
            counts: &mut counts,
            shared: Rc::new(SharedTriangles::new(has_eye)),
            last: None,
        };
        if lattice.camera.projection().panorama().is_none() {
            match NearEye::of(self, lattice) {
                Some(near) if find.may_see_from_near() => find.find_from(near),
                _ => find.find_on(RayRect::all(lattice), None),
            }
        } else if let Some(faces) = lattice.faces() {
            for (rect, camera) in faces {
                find.find_on(RayRect::of(rect), Some(camera));
            }
        } else {
            dispatch(self.simd, FindAround(find));
        }
        counts
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
        self.find_closest(lattice, cull, precision, &mut found.primitives);
        if detail == Detail::Full {
            self.accel.interpolate(lattice, cull, precision, &mut found);
        }
        hits.clear();
        hits.extend(found.iter());
    }

    /// As [`Accel::find_closest`], for the closest hits whose points are kept; [`Accel::interpolate`] interpolates t, u
    /// and v.
    pub fn find_closest(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        primitives: &mut Vec<u32>,
    ) -> CastCounts {
        let mut counts =
            (self.accel).find_clipped(&self.clip, lattice, cull, precision, primitives);
        counts.hits -= self.reject_masked(lattice, cull, precision, primitives);
        counts
    }
}

/// What is found of a lattice's rays.
pub(super) struct Find<'a> {
    pub(super) accel: &'a Accel,
    pub(super) clip: &'a Clip,
    /// The rays are this lattice's.
    pub(super) lattice: &'a Lattice,
    pub(super) cull: Cull,
    pub(super) precision: Precision,
    pub(super) primitives: &'a mut [u32],
    pub(super) counts: &'a mut CastCounts,
    /// What single rays share of triangles.
    pub(super) shared: Rc<SharedTriangles>,
    /// The single ray that was cast last, and what it hits: where rays are closer together than roundings are, the next
    /// one is the same.
    pub(super) last: Option<(Ray, u32)>,
}

impl Find<'_> {
    /// Casts a rectangle's rays, which lie on a plane: the lattice's own, or that of a cube's face.
    fn find_on(&mut self, rect: RayRect, face: Option<Camera>) {
        let simd = self.accel.simd;
        let find = self;
        if find.accel.has_instances() {
            dispatch(simd, FindOnPlane::<true> { find, rect, face });
        } else {
            dispatch(simd, FindOnPlane::<false> { find, rect, face });
        }
    }
}

/// [`Find`] for a rectangle of rays that lie on a plane.
struct FindOnPlane<'f, 'a, const INSTANCES: bool> {
    find: &'f mut Find<'a>,
    rect: RayRect,
    /// The camera of a cube's face, whose rays differ from the lattice's by rounding; `None` where the lattice's own
    /// camera has a plane.
    face: Option<Camera>,
}

impl<const INSTANCES: bool> Work for FindOnPlane<'_, '_, INSTANCES> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self { find, rect, face } = self;
        let plane = Lattice {
            camera: face.unwrap_or(find.lattice.camera),
            ..*find.lattice
        };
        let mut traversal =
            Traversal::<INSTANCES>::new(find.accel, find.clip, &plane, find.precision);
        traversal.has_ray_error = face.is_some();
        let mut zbuffer = IntervalZBuffer::new();
        for large in rect.split(LARGE_SIDE) {
            traversal.find_entry_points(lanes, &large);
            if traversal.entry_points.is_empty() {
                continue;
            }
            // Fast casting keeps the packet's answers, which may be right where the single ray in double precision is
            // not.
            let is_exact = find.precision == Precision::Exact;
            if is_exact && traversal.is_sparse(lanes, &plane, &large) {
                find.cast_each(&large);
                continue;
            }
            for packet in large.split(SIDE as u32) {
                if traversal.cast(lanes, &packet, find.cull, &mut zbuffer, &mut ()) {
                    find.keep(&packet, &zbuffer);
                }
            }
        }
        find.counts.nodes += traversal.counts.nodes;
        find.counts.triangles += traversal.counts.triangles;
    }
}

impl Find<'_> {
    /// Stores what a packet found, and casts its undecided rays.
    #[inline(always)]
    pub(super) fn keep(&mut self, packet: &RayRect, zbuffer: &IntervalZBuffer) {
        let columns = packet.columns as usize;
        let mut undecided = 0;
        for row in 0..packet.rows {
            let first = ((packet.row + row) * self.lattice.columns + packet.column) as usize;
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
            self.decide(packet, zbuffer, undecided);
        }
    }

    /// Casts the undecided rays of a packet; `rows` (as bits) are those that have any.
    #[inline(never)]
    fn decide(&mut self, packet: &RayRect, zbuffer: &IntervalZBuffer, rows: u32) {
        for row in (0..packet.rows).filter(|row| rows >> row & 1 != 0) {
            for column in 0..packet.columns {
                if !IntervalZBuffer::is_undecided(zbuffer.row(row)[column as usize]) {
                    continue;
                }
                let rivals = zbuffer.rivals(row, column);
                let (column, row) = (packet.column + column, packet.row + row);
                let ray = self.lattice.ray(column, row);
                let same = match rivals {
                    Some(_) => None,
                    None => self.same_as_above(packet, (column, row), &ray),
                };
                let primitive = same.unwrap_or_else(|| self.cast_one(&ray, rivals));
                self.primitives[(row * self.lattice.columns + column) as usize] = primitive;
                // The ray was counted as a hit.
                self.counts.hits -= u64::from(primitive == MISS);
            }
        }
    }

    /// What the ray above hits, where it is the same: rays closer together than roundings are. The one to the left is
    /// [`Find::last`].
    fn same_as_above(&self, packet: &RayRect, (column, row): (u32, u32), ray: &Ray) -> Option<u32> {
        let above = (row > packet.row).then(|| row - 1)?;
        let is_same = self.lattice.ray(column, above) == *ray;
        is_same.then(|| self.primitives[(above * self.lattice.columns + column) as usize])
    }

    /// The answer of [`Accel::cast_primitive`] for a ray whose closest hit, if any, is one of its rivals; without
    /// rivals it traverses the tree.
    fn cast_one(&mut self, ray: &Ray, rivals: Option<impl Iterator<Item = u32>>) -> u32 {
        if let Some((last, primitive)) = self.last
            && last == *ray
        {
            return primitive;
        }
        let primitive = self.cast_another(ray, rivals);
        self.last = Some((*ray, primitive));
        primitive
    }

    /// [`Find::cast_one`] of another ray than the last.
    fn cast_another(&mut self, ray: &Ray, rivals: Option<impl Iterator<Item = u32>>) -> u32 {
        let Some(ray) = (self.accel).prepare(ray, self.cull, self.precision) else {
            return MISS;
        };
        let ray = ray.sharing(&self.shared, Detail::Triangle);
        let nearest = match rivals {
            Some(rivals) if self.precision == Precision::Exact => {
                let mut nearest = BoundedHit::NONE;
                for primitive in rivals {
                    self.accel
                        .intersect_kept(self.clip, &ray, primitive, &mut nearest);
                }
                nearest
            }
            // Fast casting trusts double precision, in which the ray may hit a triangle that it exactly misses and that
            // is no rival: it traverses the tree too.
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
    fn cast_each(&mut self, rect: &RayRect) {
        for row in rect.row..rect.row + rect.rows {
            for column in rect.column..rect.column + rect.columns {
                let primitive = self.cast_one(&self.lattice.ray(column, row), None::<Empty<u32>>);
                self.counts.hits += u64::from(primitive != MISS);
                self.primitives[(row * self.lattice.columns + column) as usize] = primitive;
            }
        }
    }
}
