//! t, u and v of the rays of a lattice at the triangles that they are known to hit, eight rays of a row at a time.

use crate::bvh::Accel;
use crate::camera::{Lattice, PanoramaRays, Projection};
use crate::hit::{Cull, Detail, HitNumbers, MISS, Precision, PrimitiveHit};
use crate::hits::Hits;
use crate::num::simd::{F32x8, Lanes, Mask8, Work, dispatch};
use crate::ray::Ray;
use crate::triangle::interpolate::{
    LANES, RowHits, RowPlaces, interpolate_around, interpolate_row,
};
use crate::triangle::linear::{LinearHit, Pencil, PencilRow};
use crate::triangle::{CornerLanes, SharedTriangles};
use std::rc::Rc;

impl Accel {
    /// Interpolates t, u and v where the rays of a lattice hit the triangles that [`Accel::find_closest`] found, given
    /// by the primitive indices in `hits`: bit for bit what [`Accel::cast_primitive`] answers.
    pub fn interpolate(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        hits: &mut Hits,
    ) {
        self.interpolate_numbers(lattice, cull, precision, HitNumbers::All, hits);
    }

    /// [`Accel::interpolate`] of some of the numbers; the others may be anything.
    pub(crate) fn interpolate_numbers(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        numbers: HitNumbers,
        hits: &mut Hits,
    ) {
        hits.primitives.resize(lattice.len(), MISS);
        hits.resize_tuv();
        if let Some(halves) = lattice.halves() {
            return self.interpolate_halves((lattice, halves), cull, precision, hits);
        }
        if lattice.camera.has_an_eye_a_column() {
            return self.interpolate_each(lattice, cull, precision, hits);
        }
        // Panoramas use the variant for instances, so that it is compiled once only.
        if self.has_instances() || lattice.camera.projection().panorama().is_some() {
            self.interpolate_in::<true>(lattice, cull, precision, numbers, hits);
        } else {
            self.interpolate_in::<false>(lattice, cull, precision, numbers, hits);
        }
    }

    fn interpolate_in<const INSTANCES: bool>(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        numbers: HitNumbers,
        hits: &mut Hits,
    ) {
        dispatch(
            self.simd,
            InterpolateLattice::<INSTANCES> {
                accel: self,
                lattice,
                cull,
                precision,
                numbers,
                hits,
            },
        );
    }
}

struct InterpolateLattice<'a, const INSTANCES: bool> {
    accel: &'a Accel,
    lattice: &'a Lattice,
    cull: Cull,
    precision: Precision,
    numbers: HitNumbers,
    hits: &'a mut Hits,
}

/// Eight rays of a row: the triangles that they hit, and t, u and v there.
struct EightHits<'h> {
    primitives: &'h mut [u32; LANES],
    t: &'h mut [f32; LANES],
    u: &'h mut [f32; LANES],
    v: &'h mut [f32; LANES],
}

impl<const INSTANCES: bool> Work for InterpolateLattice<'_, INSTANCES> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let columns = self.lattice.columns as usize;
        if columns == 0 {
            return;
        }
        let Self {
            accel,
            lattice,
            cull,
            precision,
            numbers,
            hits,
        } = self;
        let has_eye = lattice.camera.projection() != Projection::Orthographic;
        let mut interpolate = Interpolate::<INSTANCES> {
            accel,
            lattice,
            cull,
            precision,
            numbers,
            pencil: Pencil::new(lattice, accel.origin),
            around: PanoramaRays::new(lattice).filter(|_| INSTANCES),
            cached: [(MISS, LinearHit::default()); CACHED],
            shared: Rc::new(SharedTriangles::new(has_eye)),
            last: None,
        };
        let rows = (hits.primitives.chunks_mut(columns))
            .zip(hits.t.chunks_mut(columns))
            .zip(hits.u.chunks_mut(columns).zip(hits.v.chunks_mut(columns)));
        for (row, ((primitives, t), (u, v))) in (0..).zip(rows) {
            let (_, y) = lattice.place(0, row);
            let (_, along) = lattice.camera.across_and_along(0.0, y);
            let pencil_row = interpolate.pencil.as_ref().map(|pencil| pencil.row(along));
            let (primitives, rest) = primitives.as_chunks_mut();
            let (t, t_rest) = t.as_chunks_mut();
            let (u, u_rest) = u.as_chunks_mut();
            let (v, v_rest) = v.as_chunks_mut();
            let mut column = 0;
            for ((primitives, t), (u, v)) in primitives.iter_mut().zip(t).zip(u.iter_mut().zip(v)) {
                let eight = EightHits {
                    primitives,
                    t,
                    u,
                    v,
                };
                interpolate.eight(lanes, column, row, pencil_row.as_ref(), eight);
                column += LANES as u32;
            }
            if !rest.is_empty() {
                let mut primitives = [MISS; LANES];
                let [mut t, mut u, mut v] = [[0.0; LANES]; 3];
                primitives[..rest.len()].copy_from_slice(rest);
                let eight = EightHits {
                    primitives: &mut primitives,
                    t: &mut t,
                    u: &mut u,
                    v: &mut v,
                };
                interpolate.eight(lanes, column, row, pencil_row.as_ref(), eight);
                rest.copy_from_slice(&primitives[..rest.len()]);
                for (rest, all) in [(t_rest, t), (u_rest, u), (v_rest, v)] {
                    rest.copy_from_slice(&all[..rest.len()]);
                }
            }
        }
    }
}

/// Triangles whose linear functions are cached: those that a row of 64 rays hits, most of which the next row hits as
/// well. Fewer entries set functions up again, more use more of the first-level cache.
const CACHED: usize = 64;

/// The most triangles among eight rays that are interpolated by linear functions. With more, their functions cost more
/// than interpolating from the corners, even where they are cached.
const FEW_TRIANGLES: u32 = 3;

struct Interpolate<'a, const INSTANCES: bool> {
    accel: &'a Accel,
    lattice: &'a Lattice,
    cull: Cull,
    precision: Precision,
    numbers: HitNumbers,
    pencil: Option<Pencil>,
    /// The rays of a panorama.
    around: Option<PanoramaRays>,
    /// Indexed by the low bits of the primitive index.
    cached: [(u32, LinearHit); CACHED],
    /// What the rays share of triangles.
    shared: Rc<SharedTriangles>,
    /// The single ray that was interpolated last, its triangle, and the hit: the next one may be the same.
    last: Option<(Ray, u32, PrimitiveHit)>,
}

impl<const INSTANCES: bool> Interpolate<'_, INSTANCES> {
    /// Interpolates eight rays of a row, from a column on; rays beyond the row's end are misses.
    #[inline(always)]
    fn eight(
        &mut self,
        lanes: impl Lanes,
        column: u32,
        row: u32,
        pencil_row: Option<&PencilRow>,
        eight: EightHits<'_>,
    ) {
        let EightHits {
            primitives,
            t,
            u,
            v,
        } = eight;
        if *primitives == [MISS; LANES] {
            *t = [PrimitiveHit::NONE.t; LANES];
            *u = [PrimitiveHit::NONE.u; LANES];
            *v = [PrimitiveHit::NONE.v; LANES];
            return;
        }
        // No closure: what is called in one would not be compiled for the instruction set.
        let found = if INSTANCES && let Some(rays) = &self.around {
            let directions = rays.eight_in_world(column, row);
            let corners = self.corners(lanes, primitives);
            let first = (primitives.iter().position(|&it| it != MISS)).unwrap_or_default();
            let (camera, tree_origin) = (&self.lattice.camera, self.accel.origin);
            interpolate_around(camera, tree_origin, (&directions, first), &corners)
        } else {
            let places = RowPlaces::new(self.lattice, column, row);
            match self.linear(places, pencil_row, primitives) {
                Some(found) => found,
                None => {
                    let corners = self.corners(lanes, primitives);
                    interpolate_row(&self.lattice.camera, self.accel.origin, places, &corners)
                }
            }
        };
        let mut undecided = false;
        for lane in 0..LANES {
            let is_hit = primitives[lane] != MISS;
            undecided |= is_hit & !found.sure[lane];
            t[lane] = if is_hit {
                found.t[lane]
            } else {
                PrimitiveHit::NONE.t
            };
            u[lane] = if is_hit {
                found.u[lane]
            } else {
                PrimitiveHit::NONE.u
            };
            v[lane] = if is_hit {
                found.v[lane]
            } else {
                PrimitiveHit::NONE.v
            };
        }
        if undecided {
            for lane in (0..LANES).filter(|&lane| !found.sure[lane]) {
                if primitives[lane] != MISS {
                    let hit = self.one(primitives[lane], column + lane as u32, row);
                    primitives[lane] = hit.primitive;
                    (t[lane], u[lane], v[lane]) = (hit.t, hit.u, hit.v);
                }
            }
        }
    }

    /// The hits of eight rays with one triangle by its linear functions, or with few whose functions are cached. `None`
    /// where any lane is not sure, and for other rays: setting up linear functions costs as much as interpolating a few
    /// rays without.
    #[inline(always)]
    fn linear(
        &mut self,
        places: RowPlaces,
        row: Option<&PencilRow>,
        primitives: &[u32; LANES],
    ) -> Option<RowHits> {
        let row = row?;
        let across = places.across(&self.lattice.camera);
        if *primitives == [primitives[0]; LANES] {
            let found = self.linear_of(&across, row, primitives[0])?;
            return (found.sure == [true; LANES]).then_some(found);
        }
        if !self.are_few_and_cached(primitives) {
            return None;
        }
        let mut found = RowHits::NONE;
        let mut lane = 0;
        // From left to right, each over all lanes from its first on: the next one overwrites the rest.
        while lane < LANES {
            let (first, primitive) = (lane, primitives[lane]);
            while lane < LANES && primitives[lane] == primitive {
                lane += 1;
            }
            if primitive != MISS {
                found.replace_from(first, &self.linear_of(&across, row, primitive)?);
            }
        }
        let mut sure = true;
        for (is_sure, &primitive) in found.sure.iter().zip(primitives) {
            sure &= is_sure | (primitive == MISS);
        }
        sure.then_some(found)
    }

    /// Whether eight rays hit few triangles, and the linear functions of all are cached.
    #[inline(always)]
    fn are_few_and_cached(&self, primitives: &[u32; LANES]) -> bool {
        let mut triangles = 0;
        let mut last = MISS;
        for &primitive in primitives {
            if primitive != last && primitive != MISS {
                triangles += 1;
                if triangles > FEW_TRIANGLES
                    || self.cached[primitive as usize % CACHED].0 != primitive
                {
                    return false;
                }
            }
            last = primitive;
        }
        true
    }

    /// Eight rays' hits of a triangle by its linear functions; `None` where their errors are too large.
    #[inline(always)]
    fn linear_of(
        &mut self,
        across: &[f64; LANES],
        row: &PencilRow,
        primitive: u32,
    ) -> Option<RowHits> {
        let numbers = self.numbers;
        let hit = self.cached(primitive)?;
        if !hit.is_useful() {
            return None;
        }
        Some(match numbers {
            HitNumbers::T => hit.interpolate::<true, false>(row, across),
            HitNumbers::Weights => hit.interpolate::<false, true>(row, across),
            HitNumbers::All => hit.interpolate::<true, true>(row, across),
        })
    }

    /// A triangle's linear functions, cached or computed. `None` where they are of no use.
    #[inline(always)]
    fn cached(&mut self, primitive: u32) -> Option<&LinearHit> {
        let (cached, hit) = &mut self.cached[primitive as usize % CACHED];
        if *cached != primitive {
            *hit = LinearHit::new(
                self.pencil.as_ref()?,
                self.accel.corners_of::<INSTANCES>(primitive),
            );
            *cached = primitive;
        }
        Some(hit)
    }

    /// Corners of the triangles that eight rays hit. Each triangle is written to all lanes from its first on, and the
    /// next one overwrites the rest.
    #[inline(always)]
    fn corners<L: Lanes>(&self, lanes: L, primitives: &[u32; LANES]) -> CornerLanes {
        let mut all = [lanes.splat(0.0); 9];
        let mut lane = 0;
        while lane < LANES {
            let primitive = primitives[lane];
            let from = lanes.mask_from(lane);
            while lane < LANES && primitives[lane] == primitive {
                lane += 1;
            }
            if primitive != MISS {
                let [a, b, c] = self.accel.corners_of::<INSTANCES>(primitive);
                let one = [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z];
                for (all, one) in all.iter_mut().zip(one) {
                    *all = from.select(lanes.splat(one), *all);
                }
            }
        }
        let mut corners = [[0.0; LANES]; 9];
        for (corner, all) in corners.iter_mut().zip(all) {
            all.store(corner);
        }
        corners
    }

    #[inline(never)]
    fn one(&mut self, primitive: u32, column: u32, row: u32) -> PrimitiveHit {
        let ray = self.lattice.ray(column, row);
        if let Some((last, triangle, hit)) = self.last
            && (last, triangle) == (ray, primitive)
        {
            return hit;
        }
        let Some(prepared) = (self.accel).prepare(&ray, self.cull, self.precision) else {
            return PrimitiveHit::NONE;
        };
        let corners = self.accel.corners_of::<INSTANCES>(primitive);
        let prepared = prepared.sharing(&self.shared, Detail::Full);
        let hit = prepared.hit_on(primitive, corners).to_primitive_hit();
        self.last = Some((ray, primitive, hit));
        hit
    }
}
