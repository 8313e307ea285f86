//! A tile of rays against the tree: one walk for many rays (Reshetov, Soupikov, Hurley, "Multi-Level Ray
//! Tracing Algorithm", 2005). Rays that a block cannot decide go the way of the single ray.

use super::simd::{Lanes, Work, dispatch};
use super::walk::{Part, Walk};
use super::{Accel, MISS, SlotHit, traverse};
use crate::camera::Lattice;
use crate::intersect::block::Block;
use crate::intersect::row::{self, Corners, RowHits, meet_row};
use crate::intersect::setup::SIDE;
use crate::intersect::{Cull, Detail, Precision, PreparedRay};

/// Rays along the side of a block that walks down the tree first.
pub(super) const LARGE_SIDE: u32 = 64;

/// What casting a lattice took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CastCounts {
    /// Rays that met something.
    pub hits: u64,
    /// Nodes of the tree whose children's boxes were tested.
    pub nodes: u64,
    /// Triangles that a block's rays were held against, counted for each block: those set up, and those
    /// of few rays that needed no set-up.
    pub triangles: u64,
    /// Rays that single precision with its bounds left open, and doubles decided.
    pub double_rays: u64,
    /// Rays that doubles with their bounds left open too, decided by exact arithmetic.
    pub exact_rays: u64,
}

impl std::ops::AddAssign for CastCounts {
    fn add_assign(&mut self, other: Self) {
        self.hits += other.hits;
        self.nodes += other.nodes;
        self.triangles += other.triangles;
        self.double_rays += other.double_rays;
        self.exact_rays += other.exact_rays;
    }
}

impl Accel {
    /// Casts every ray of a lattice: its hits row by row, in place of what `hits` held.
    ///
    /// Each is what [`Accel::cast_slot`] answers for that ray, as far as `detail` asks for it. With
    /// [`Precision::Fast`] a block may be right where a single ray in doubles is not.
    pub fn cast_lattice(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        detail: Detail,
        hits: &mut Vec<SlotHit>,
    ) {
        let mut slots = Vec::new();
        self.find(lattice, cull, precision, &mut slots);
        match detail {
            Detail::Full => self.evaluate(lattice, cull, precision, &slots, hits),
            Detail::Triangle => {
                hits.clear();
                hits.extend(slots.iter().map(|&slot| SlotHit {
                    slot,
                    ..SlotHit::NONE
                }));
            }
        }
    }

    /// Finds the triangle that each ray of a lattice meets first: its slot or [`MISS`], row by row,
    /// in place of what `slots` held.
    pub fn find(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        slots: &mut Vec<u32>,
    ) -> CastCounts {
        slots.clear();
        slots.resize(lattice.len(), MISS);
        let mut counts = CastCounts::default();
        if self.tree.root.is_some() {
            dispatch(
                self.simd,
                Find {
                    accel: self,
                    lattice,
                    cull,
                    precision,
                    slots,
                    counts: &mut counts,
                },
            );
        }
        counts
    }

    /// Where the rays of a lattice meet the triangles that [`Accel::find`] found for them, in place
    /// of what `hits` held: what [`Accel::cast_slot`] answers, bit for bit.
    pub fn evaluate(
        &self,
        lattice: &Lattice,
        cull: Cull,
        precision: Precision,
        slots: &[u32],
        hits: &mut Vec<SlotHit>,
    ) {
        hits.clear();
        hits.resize(slots.len(), SlotHit::NONE);
        dispatch(
            self.simd,
            Evaluate {
                accel: self,
                lattice,
                cull,
                precision,
                slots,
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
    pub(super) slots: &'a mut [u32],
    pub(super) counts: &'a mut CastCounts,
}

impl Work for Find<'_> {
    #[inline(always)]
    fn run(mut self, lanes: impl Lanes) {
        let whole = Part {
            column: 0,
            row: 0,
            columns: self.lattice.columns,
            rows: self.lattice.rows,
        };
        let mut walk = Walk::new(self.accel, self.lattice);
        let mut block = Block::new();
        for large in whole.split(LARGE_SIDE) {
            walk.list(lanes, &large);
            if walk.list.is_empty() {
                continue;
            }
            for part in large.split(SIDE as u32) {
                if walk.cast(lanes, &part, self.cull, &mut block, &mut ()) {
                    self.keep(&part, &block);
                }
            }
        }
        *self.counts = CastCounts {
            nodes: walk.counts.nodes,
            triangles: walk.counts.triangles,
            ..*self.counts
        };
    }
}

impl Find<'_> {
    /// Keeps what a block found, and casts the rays that it left open.
    #[inline(always)]
    pub(super) fn keep(&mut self, part: &Part, block: &Block) {
        let columns = part.columns as usize;
        for row in 0..part.rows {
            let first = ((part.row + row) * self.lattice.columns + part.column) as usize;
            let held = &block.row(row)[..columns];
            let (mut met, mut any_open) = (0, false);
            let kept = &mut self.slots[first..first + columns];
            for (kept, &held) in kept.iter_mut().zip(held) {
                *kept = Block::slot(held);
                met += u32::from(held != MISS);
                any_open |= Block::is_open(held);
            }
            self.counts.hits += u64::from(met);
            if any_open {
                for (column, _) in held
                    .iter()
                    .enumerate()
                    .filter(|held| Block::is_open(*held.1))
                {
                    let slot = self.cast_one(part.column + column as u32, part.row + row);
                    self.slots[first + column] = slot;
                    // It was counted as one that met something.
                    self.counts.hits -= u64::from(slot == MISS);
                }
            }
        }
    }

    /// What [`Accel::cast_slot`] answers.
    #[inline(never)]
    fn cast_one(&mut self, column: u32, row: u32) -> u32 {
        let ray = self.lattice.ray(column, row);
        let ray = PreparedRay::new(&ray, self.accel.origin, self.cull, self.precision);
        let Some(ray) = ray else { return MISS };
        let slot = traverse::nearest(self.accel, &ray).slot;
        if ray.was_exact() {
            self.counts.exact_rays += 1;
        } else {
            self.counts.double_rays += 1;
        }
        slot
    }
}

struct Evaluate<'a> {
    accel: &'a Accel,
    lattice: &'a Lattice,
    cull: Cull,
    precision: Precision,
    slots: &'a [u32],
    hits: &'a mut [SlotHit],
}

impl Work for Evaluate<'_> {
    #[inline(always)]
    fn run(mut self, _: impl Lanes) {
        for row in 0..self.lattice.rows {
            for column in (0..self.lattice.columns).step_by(row::LANES) {
                self.evaluate_row(column, row);
            }
        }
    }
}

impl Evaluate<'_> {
    /// At most eight rays of a row.
    #[inline(always)]
    fn evaluate_row(&mut self, column: u32, row: u32) {
        let first = (row * self.lattice.columns + column) as usize;
        let count = row::LANES.min((self.lattice.columns - column) as usize);
        let slots = &self.slots[first..first + count];
        let one = slots.iter().all(|&slot| slot == slots[0]);
        if one && slots[0] == MISS {
            return;
        }
        let mut corners: Corners = [[0.0; row::LANES]; 9];
        if one {
            let [a, b, c] = self.accel.corners(slots[0]).map(|corner| corner.to_array());
            for (all, one) in corners.iter_mut().zip([a, b, c].into_iter().flatten()) {
                *all = [one; row::LANES];
            }
        } else {
            for (lane, &slot) in slots.iter().enumerate().filter(|(_, slot)| **slot != MISS) {
                for (corner, at) in self.accel.corners(slot).iter().zip([0, 3, 6]) {
                    corners[at][lane] = corner.x;
                    corners[at + 1][lane] = corner.y;
                    corners[at + 2][lane] = corner.z;
                }
            }
        }
        let place = self.lattice.place(column, row);
        let stride = f64::from(self.lattice.stride);
        let row_hits = meet_row(
            &self.lattice.camera,
            self.accel.origin,
            place,
            stride,
            &corners,
        );
        let RowHits { t, u, v, sure } = &row_hits;
        for (lane, &slot) in slots.iter().enumerate().filter(|(_, slot)| **slot != MISS) {
            if sure[lane] {
                // Number by number: a hit put together elsewhere first would be read before it is
                // all written.
                let hit = &mut self.hits[first + lane];
                hit.slot = slot;
                hit.t = t[lane];
                hit.u = u[lane];
                hit.v = v[lane];
            } else {
                self.hits[first + lane] = self.evaluate_one(slot, column + lane as u32, row);
            }
        }
    }

    #[inline(never)]
    fn evaluate_one(&self, slot: u32, column: u32, row: u32) -> SlotHit {
        let ray = self.lattice.ray(column, row);
        let ray = PreparedRay::new(&ray, self.accel.origin, self.cull, self.precision);
        ray.map_or(SlotHit::NONE, |ray| {
            ray.evaluate(slot, self.accel.corners(slot)).to_slot_hit()
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::accel::Simd;
    use crate::camera::{Camera, ImagePlane, Orbit, Projection, Rect};
    use crate::scene::{Mesh, MeshData, Object, Scene};
    use glam::DVec3;
    use std::sync::Arc;

    /// Waves of triangles over a square, `side²` quads of them.
    pub(in crate::accel) fn waves(side: u32, size: f64, offset: DVec3) -> Accel {
        build([waves_mesh(side, size, offset)])
    }

    fn build(meshes: impl IntoIterator<Item = Mesh>) -> Accel {
        let objects = meshes
            .into_iter()
            .map(|mesh| Object::new("mesh", Arc::new(mesh)));
        let scene = Scene {
            objects: objects.collect(),
        };
        Accel::build(&scene).expect("a valid scene")
    }

    fn waves_mesh(side: u32, size: f64, offset: DVec3) -> Mesh {
        let positions = (0..=side)
            .flat_map(|y| (0..=side).map(move |x| (x, y)))
            .map(|(x, y)| {
                let (x, y) = (
                    f64::from(x) / f64::from(side) - 0.5,
                    f64::from(y) / f64::from(side) - 0.5,
                );
                DVec3::new(x, 0.1 * (x * 20.0).sin() * (y * 17.0).cos(), y) * size + offset
            })
            .collect();
        let row = side + 1;
        let triangles = (0..side * side)
            .flat_map(|cell| {
                let a = cell / side * row + cell % side;
                [[a, a + row, a + row + 1], [a, a + row + 1, a + 1]]
            })
            .collect();
        Mesh::new(MeshData {
            positions,
            triangles,
            ..MeshData::default()
        })
    }

    fn assert_tiles_equal_rays(accel: &Accel, camera: Camera) -> usize {
        let plane = camera.plane();
        let rect = Rect {
            x: 0,
            y: 0,
            width: plane.columns,
            height: plane.rows,
        };
        let mut hits = Vec::new();
        let mut met = 0;
        for (stride, phase) in [(1, (0, 0)), (4, (2, 0))] {
            for cull in [Cull::None, Cull::Back] {
                let lattice = Lattice::new(camera, rect, stride, phase);
                accel.cast_lattice(&lattice, cull, Precision::Exact, Detail::Full, &mut hits);
                assert_eq!(hits.len(), lattice.len());
                for (at, hit) in hits.iter().enumerate() {
                    let (column, row) = (at as u32 % lattice.columns, at as u32 / lattice.columns);
                    let expected =
                        accel.cast_slot(&lattice.ray(column, row), cull, Precision::Exact);
                    assert_eq!(*hit, expected, "{column} {row} {camera:?}");
                    met += usize::from(!hit.is_miss());
                }
            }
        }
        met
    }

    pub(in crate::accel) fn cameras(size: f64, offset: DVec3) -> Vec<Camera> {
        let mut cameras = Vec::new();
        for projection in [Projection::Perspective, Projection::Orthographic] {
            for (yaw, pitch, distance) in [
                (22.0, 16.0, 1.5),
                (0.0, 90.0, 1.0),
                (0.0, 0.0, 1.0),
                (130.0, -20.0, 0.6),
                (77.0, 3.0, 0.05),
            ] {
                let orbit = Orbit {
                    pivot: offset,
                    yaw,
                    pitch,
                    distance: distance * size,
                };
                let plane =
                    ImagePlane::new(101, 75, 0.012 * size * distance).expect("a good plane");
                cameras.push(Camera::new(orbit.placement(), projection, plane));
            }
        }
        cameras
    }

    #[test]
    fn tiles_answer_as_single_rays_do() {
        for (size, offset) in [
            (1.0, DVec3::ZERO),
            (1e-12, DVec3::ZERO),
            (1e9, DVec3::ZERO),
            (30.0, DVec3::new(148376.0, 1234.0, -223423.0)),
        ] {
            let accel = waves(40, size, offset);
            let met: usize = cameras(size, offset)
                .into_iter()
                .map(|camera| assert_tiles_equal_rays(&accel, camera))
                .sum();
            assert!(met > 50_000, "{met}");
        }
    }

    #[test]
    fn triangles_of_few_rays_are_met_as_single_rays_do() {
        // From many rays a triangle to many triangles a ray; one layer, and layers so close that what
        // is told from a triangle's nearest and furthest corner alone does not order them.
        let apart = |gap: f64| DVec3::new(0.0, gap, 0.0);
        for layers in [
            vec![0.0],
            vec![0.0, 1e-3, 2e-3],
            vec![0.0, 1e-6],
            vec![0.0, 0.0],
        ] {
            for side in [60, 120, 200] {
                let meshes = layers.iter().map(|&gap| waves_mesh(side, 1.0, apart(gap)));
                let accel = build(meshes);
                let met: usize = cameras(1.0, DVec3::ZERO)
                    .into_iter()
                    .map(|camera| assert_tiles_equal_rays(&accel, camera))
                    .sum();
                assert!(met > 50_000, "{met}");
            }
        }
    }

    #[test]
    fn fast_pictures_are_the_exact_ones_but_for_a_millionth() {
        let accel = waves(40, 1.0, DVec3::ZERO);
        let (mut rays, mut wrong) = (0, 0);
        let slanted = |camera: &Camera| camera.forward().abs().min_element() > 0.01;
        for camera in cameras(1.0, DVec3::ZERO).into_iter().filter(slanted) {
            let rect = Rect {
                x: 0,
                y: 0,
                width: 101,
                height: 75,
            };
            let mut lattice = Lattice::new(camera, rect, 1, (0, 0));
            // The middle ray would go through a vertex, which is not what pictures are like.
            lattice.offset = (0.3, 0.6);
            let cast = |precision| {
                let mut hits = Vec::new();
                accel.cast_lattice(&lattice, Cull::None, precision, Detail::Triangle, &mut hits);
                hits
            };
            let pairs = cast(Precision::Fast)
                .into_iter()
                .zip(cast(Precision::Exact));
            wrong += pairs
                .filter(|(fast, exact)| fast.slot != exact.slot)
                .count();
            rays += lattice.len();
        }
        assert!(rays > 40_000 && wrong == 0, "{wrong} of {rays}");
    }

    #[test]
    fn lattices_aimed_at_vertices_are_decided_exactly() {
        // A flat grid of unit cells, and rays exactly through its vertices, edges and middles.
        let side = 32;
        let positions = (0..=side)
            .flat_map(|y| (0..=side).map(move |x| DVec3::new(f64::from(x), f64::from(y), 0.0)))
            .collect();
        let row = side + 1;
        let triangles = (0..side * side)
            .flat_map(|cell| {
                let a: u32 = cell / side * row + cell % side;
                [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]
            })
            .collect();
        let mesh = Mesh::new(MeshData {
            positions,
            triangles,
            ..MeshData::default()
        });
        let accel = build([mesh]);
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let orbit = Orbit {
                pivot: DVec3::new(16.0, 16.0, 0.0),
                yaw: 0.0,
                pitch: 0.0,
                distance: 8.0,
            };
            let plane = ImagePlane::new(64, 64, 0.5).expect("a good plane");
            let camera = Camera::new(orbit.placement(), projection, plane);
            let rect = Rect {
                x: 0,
                y: 0,
                width: 64,
                height: 64,
            };
            let mut lattice = Lattice::new(camera, rect, 1, (0, 0));
            lattice.offset = (0.0, 0.0);
            let mut hits = Vec::new();
            accel.cast_lattice(
                &lattice,
                Cull::None,
                Precision::Exact,
                Detail::Full,
                &mut hits,
            );
            for (at, hit) in hits.iter().enumerate() {
                let ray = lattice.ray(at as u32 % 64, at as u32 / 64);
                assert_eq!(*hit, accel.cast_slot(&ray, Cull::None, Precision::Exact));
                assert_eq!(
                    accel.cast(&ray, Cull::None),
                    accel.cast_brute_force(&ray, Cull::None)
                );
                assert!(!hit.is_miss(), "a hole at ray {at}");
            }
        }
    }

    #[test]
    fn what_is_hidden_need_not_be_told_apart() {
        // Two triangles in one place, and a third in front of both, in every order. The two lean
        // towards the eye, so that they come first.
        let far = [
            DVec3::new(-4.0, -4.0, -2.0),
            DVec3::new(4.0, -4.0, -2.5),
            DVec3::new(0.25, 30.0, 14.0),
        ];
        // The same plane from another corner, so that rounding tells nothing.
        let other = [far[0] + (far[0] - far[1]), far[1], far[2]];
        let near = [
            DVec3::new(-9.0, -9.0, 3.0),
            DVec3::new(9.0, -9.0, 3.0),
            DVec3::new(0.0, 9.0, 3.0),
        ];
        let triangles = [far, other, near];
        for order in [
            [0, 1, 2],
            [0, 2, 1],
            [1, 0, 2],
            [1, 2, 0],
            [2, 0, 1],
            [2, 1, 0],
        ] {
            let open = |shown: &[usize]| {
                let positions: Vec<_> = shown.iter().flat_map(|&at| triangles[at]).collect();
                let accel = build([Mesh::new(MeshData {
                    triangles: (0..shown.len() as u32)
                        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
                        .collect(),
                    positions,
                    ..MeshData::default()
                })]);
                let orbit = Orbit {
                    pivot: DVec3::ZERO,
                    distance: 20.0,
                    yaw: 0.0,
                    pitch: 0.0,
                };
                let plane = ImagePlane {
                    columns: 64,
                    rows: 64,
                    step: 0.03,
                };
                let camera = Camera::new(orbit.placement(), Projection::Perspective, plane);
                let rect = Rect {
                    x: 0,
                    y: 0,
                    width: 64,
                    height: 64,
                };
                let lattice = Lattice::new(camera, rect, 1, (0, 0));
                let mut slots = Vec::new();
                let counts = accel.find(&lattice, Cull::None, Precision::Exact, &mut slots);
                counts.double_rays + counts.exact_rays
            };
            let without: Vec<_> = order.into_iter().filter(|&at| at != 2).collect();
            assert!(open(&without) > 500, "{order:?}");
            assert!(open(&order) < 10, "{order:?}");
        }
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let camera = cameras(1.0, DVec3::ZERO)[0];
        let rect = Rect {
            x: 0,
            y: 0,
            width: 101,
            height: 75,
        };
        let lattice = Lattice::new(camera, rect, 1, (0, 0));
        let cast = |simd| {
            let mut hits = Vec::new();
            let accel = waves(40, 1.0, DVec3::ZERO).with_simd(simd);
            accel.cast_lattice(
                &lattice,
                Cull::None,
                Precision::Exact,
                Detail::Full,
                &mut hits,
            );
            hits
        };
        let plain = cast(Simd::Plain);
        assert_eq!(plain, cast(Simd::Avx2));
        assert_eq!(plain, cast(Simd::Avx512));
    }
}
