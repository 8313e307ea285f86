//! A record of casting a lattice: per large packet and per packet, what each step kept; for pictures and tables.
//!
//! The traversal is that of [`Accel::find_closest`], recorded by an [`Observer`].

use super::cast::Find;
use super::counts::CastCounts;
use super::interval_zbuffer::IntervalZBuffer;
use super::observer::Observer;
use super::params::{LARGE_SIDE, SIDE};
use super::ray_rect::RayRect;
use super::traversal::Traversal;
use crate::bvh::Accel;
use crate::camera::Lattice;
use crate::hit::{Cull, MISS, Precision};
use crate::num::simd::{Lanes, Plain, Work};
use crate::scene::Bounds;
use crate::triangle::SharedTriangles;
use crate::triangle::clip::Clip;
use std::ops::Range;
use std::rc::Rc;

/// A large packet of a lattice: its entry points, and the packets that start from them.
#[derive(Clone, Debug, PartialEq)]
pub struct LargeTrace {
    /// Its rays: 64 × 64, fewer where the lattice ends.
    pub rays: Lattice,
    /// Nodes whose children's boxes were tested to find the entry points.
    pub nodes: u64,
    /// Subtrees that its frustum touches, near to far.
    pub entry_points: Vec<EntryPoint>,
    /// Its packets, row by row; none where there is no entry point.
    pub packets: Vec<PacketTrace>,
}

/// A subtree that a large packet's packets start from.
#[derive(Clone, Debug, PartialEq)]
pub struct EntryPoint {
    /// Its box, in world space.
    pub bounds: Bounds,
    /// Primitive indices of its triangles, ascending.
    pub primitives: Vec<u32>,
}

/// A packet. Primitive indices are ascending and distinct.
#[derive(Clone, Debug, PartialEq)]
pub struct PacketTrace {
    /// Its rays: 32 × 32, fewer at the lattice's end.
    pub rays: Lattice,
    /// Nodes whose children's boxes were tested; each pair of entry points counts as one.
    pub nodes: u64,
    /// Triangles of the leaves reached.
    pub reached: Vec<u32>,
    /// The reached triangles that were set up, or merged as small triangles: neither outside of all rays nor surely
    /// occluded.
    pub set_up: Vec<u32>,
    /// The triangles that some ray hits first.
    pub seen: Vec<u32>,
}

impl Accel {
    /// Casts a lattice as [`Accel::find_closest`] does and records each step, large packet by large packet, row by row.
    /// Each triangle seen was set up, or hit by an undecided ray that was cast alone; each triangle set up was reached;
    /// each one reached lies below an entry point; and no ray hits a triangle that lies below none.
    ///
    /// The record is the same for every instruction set. Slower than [`Accel::find_closest`].
    pub fn record_trace(&self, lattice: &Lattice, cull: Cull) -> Vec<LargeTrace> {
        let mut traces = Vec::new();
        RecordTrace {
            accel: self,
            lattice,
            cull,
            traces: &mut traces,
        }
        .run(Plain);
        traces
    }
}

#[derive(Default)]
struct Recorder {
    reached: Vec<u32>,
    set_up: Vec<u32>,
}

impl Observer for Recorder {
    fn reached(&mut self, primitives: Range<u32>) {
        self.reached.extend(primitives);
    }

    fn set_up(&mut self, primitives: &[u32]) {
        self.set_up.extend(primitives);
    }
}

struct RecordTrace<'a> {
    accel: &'a Accel,
    lattice: &'a Lattice,
    cull: Cull,
    traces: &'a mut Vec<LargeTrace>,
}

impl Work for RecordTrace<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            accel,
            lattice,
            cull,
            traces,
        } = self;
        let whole = RayRect::all(lattice);
        let mut primitives = vec![MISS; lattice.len()];
        let clip = Clip::NONE;
        let mut find = Find {
            accel,
            clip: &clip,
            lattice,
            cull,
            precision: Precision::Exact,
            primitives: &mut primitives,
            counts: &mut CastCounts::default(),
            shared: Rc::new(SharedTriangles::new(false)),
            last: None,
        };
        let mut traversal = Traversal::<true>::new(accel, &clip, lattice, Precision::Exact);
        let mut zbuffer = IntervalZBuffer::new();
        for large in whole.split(LARGE_SIDE) {
            let before = traversal.counts.nodes;
            traversal.find_entry_points(lanes, &large);
            let mut trace = LargeTrace {
                rays: lattice.part(large.rect()),
                nodes: traversal.counts.nodes - before,
                entry_points: Vec::with_capacity(traversal.entry_points.len()),
                packets: Vec::new(),
            };
            for &(subtree, bounds, _) in &traversal.entry_points {
                trace.entry_points.push(EntryPoint {
                    bounds: Bounds {
                        min: accel.origin + bounds.min.as_dvec3(),
                        max: accel.origin + bounds.max.as_dvec3(),
                    },
                    primitives: accel.primitives_below(subtree),
                });
            }
            if !trace.entry_points.is_empty() {
                for packet in large.split(SIDE as u32) {
                    let mut recorder = Recorder::default();
                    let before = traversal.counts.nodes;
                    if traversal.cast(lanes, &packet, cull, &mut zbuffer, &mut recorder) {
                        find.keep(&packet, &zbuffer);
                    }
                    let seen = ray_indices(lattice, &packet).map(|at| find.primitives[at]);
                    trace.packets.push(PacketTrace {
                        rays: lattice.part(packet.rect()),
                        nodes: traversal.counts.nodes - before,
                        reached: ascending(recorder.reached),
                        set_up: ascending(recorder.set_up),
                        seen: ascending(seen.filter(|&primitive| primitive != MISS).collect()),
                    });
                }
            }
            traces.push(trace);
        }
    }
}

/// Indices of a rectangle's rays in the lattice.
fn ray_indices(lattice: &Lattice, packet: &RayRect) -> impl Iterator<Item = usize> {
    let (packet, columns) = (*packet, lattice.columns);
    (packet.row..packet.row + packet.rows).flat_map(move |row| {
        (packet.column..packet.column + packet.columns)
            .map(move |column| row as usize * columns as usize + column as usize)
    })
}

fn ascending(mut primitives: Vec<u32>) -> Vec<u32> {
    primitives.sort_unstable();
    primitives.dedup();
    primitives
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Rect;
    use crate::packet::cast_tests::{cameras, waves};
    use crate::triangle::BoundedHit;
    use glam::DVec3;

    fn lattices(size: f64, offset: DVec3) -> impl Iterator<Item = Lattice> {
        let rect = Rect {
            x: 3,
            y: 0,
            width: 98,
            height: 75,
        };
        cameras(size, offset)
            .into_iter()
            .map(move |camera| camera.sub_camera(rect).lattice())
    }

    fn holds(outer: &[u32], inner: &[u32]) -> bool {
        inner
            .iter()
            .all(|primitive| outer.binary_search(primitive).is_ok())
    }

    #[test]
    fn the_trace_counts_what_casting_counts() {
        for (size, offset) in [
            (1.0, DVec3::ZERO),
            (30.0, DVec3::new(148376.0, 1234.0, -223423.0)),
        ] {
            let accel = waves(40, size, offset);
            let (mut seen, mut spared) = (0, 0);
            for lattice in lattices(size, offset) {
                for cull in [Cull::None, Cull::Back] {
                    let mut primitives = Vec::new();
                    let counts =
                        accel.find_closest(&lattice, cull, Precision::Exact, &mut primitives);
                    let traces = accel.record_trace(&lattice, cull);
                    let packets = || traces.iter().flat_map(|large| &large.packets);
                    let nodes = traces.iter().map(|large| large.nodes).sum::<u64>()
                        + packets().map(|packet| packet.nodes).sum::<u64>();
                    let set_up = packets().map(|packet| packet.set_up.len()).sum::<usize>();
                    assert_eq!(nodes, counts.nodes);
                    assert_eq!(set_up as u64, counts.triangles);
                    for large in &traces {
                        let listed = large
                            .entry_points
                            .iter()
                            .flat_map(|listed| listed.primitives.clone());
                        let listed = ascending(listed.collect());
                        spared += accel.len() - listed.len();
                        for packet in &large.packets {
                            let rect = RayRect {
                                column: packet.rays.x - lattice.x,
                                row: packet.rays.y - lattice.y,
                                columns: packet.rays.columns,
                                rows: packet.rays.rows,
                            };
                            let found = ray_indices(&lattice, &rect).map(|at| primitives[at]);
                            let found = found.filter(|&primitive| primitive != MISS).collect();
                            assert_eq!(packet.seen, ascending(found));
                            // This would fail only where all rays of a cell are undecided.
                            assert!(holds(&packet.set_up, &packet.seen));
                            assert!(holds(&packet.reached, &packet.set_up));
                            assert!(holds(&listed, &packet.reached));
                            seen += packet.seen.len();
                        }
                    }
                }
            }
            assert!(seen > 1000 && spared > 1000, "{seen} {spared}");
        }
    }

    #[test]
    fn no_ray_hits_what_is_not_listed_and_none_first_what_is_not_reached() {
        let accel = waves(12, 1.0, DVec3::ZERO);
        let all = accel.len() as u32;
        for lattice in lattices(1.0, DVec3::ZERO) {
            for large in accel.record_trace(&lattice, Cull::None) {
                for listed in &large.entry_points {
                    for &primitive in &listed.primitives {
                        for corner in accel.corners(primitive) {
                            let corner = corner.as_dvec3();
                            let Bounds { min, max } = listed.bounds;
                            assert!(min.cmple(corner).all() && corner.cmple(max).all());
                        }
                    }
                }
                let listed = large
                    .entry_points
                    .iter()
                    .flat_map(|listed| listed.primitives.clone());
                let listed = ascending(listed.collect());
                for place in (0..large.rays.len() as u32).step_by(3) {
                    let columns = large.rays.columns;
                    let (column, row) = (place % columns, place / columns);
                    let ray = large.rays.ray(column, row);
                    let prepared = accel
                        .prepare(&ray, Cull::None, Precision::Exact)
                        .expect("a ray");
                    for primitive in
                        (0..all).filter(|primitive| listed.binary_search(primitive).is_err())
                    {
                        let mut nearest = BoundedHit::NONE;
                        accel.intersect(&prepared, primitive, &mut nearest);
                        assert!(nearest.is_miss(), "{primitive} {column} {row}");
                    }
                    let mut nearest = BoundedHit::NONE;
                    for primitive in 0..all {
                        accel.intersect(&prepared, primitive, &mut nearest);
                    }
                    if nearest.is_miss() {
                        continue;
                    }
                    let side = SIDE as u32;
                    let at = row / side * columns.div_ceil(side) + column / side;
                    let packet = &large.packets[at as usize];
                    assert!(holds(&packet.reached, &[nearest.primitive]));
                    assert!(holds(&packet.seen, &[nearest.primitive]));
                }
            }
        }
    }

    #[test]
    fn an_empty_scene_has_no_entry_points() {
        let accel = waves(0, 1.0, DVec3::ZERO);
        for lattice in lattices(1.0, DVec3::ZERO).take(1) {
            for large in accel.record_trace(&lattice, Cull::None) {
                assert_eq!(
                    (large.nodes, large.entry_points.len(), large.packets.len()),
                    (0, 0, 0)
                );
            }
        }
    }
}
