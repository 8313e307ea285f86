//! What casting a lattice goes through on its way down the tree, level by level: to be looked at.
//!
//! The walk is the very one of [`Accel::find`], which tells what it does to a [`Notice`].

use super::cast::Find;
use super::counts::CastCounts;
use super::interval_zbuffer::Block;
use super::observer::Notice;
use super::params::{LARGE_SIDE, SIDE};
use super::traversal::{Part, Walk};
use crate::bvh::Accel;
use crate::camera::Lattice;
use crate::hit::{Cull, MISS, Precision};
use crate::num::simd::{Lanes, Plain, Work};
use crate::scene::Bounds;
use std::ops::Range;

/// A large block of a lattice's rays: the list that its frustum leaves, and the blocks that start
/// from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Levels {
    /// The block's rays: 64 × 64, fewer where the lattice ends.
    pub rays: Lattice,
    /// Nodes of the tree whose children's boxes were tested to make the list.
    pub nodes: u64,
    /// Sub-trees that the block's frustum touches, from near to far.
    pub list: Vec<Listed>,
    /// Its blocks, row by row; none where nothing is listed.
    pub blocks: Vec<BlockLevel>,
}

/// A sub-tree on a large block's list.
#[derive(Clone, Debug, PartialEq)]
pub struct Listed {
    /// Its box, in world space.
    pub bounds: Bounds,
    /// The slots of its triangles, ascending.
    pub slots: Vec<u32>,
}

/// A block of rays that start from a large block's list. Slots are ascending, none twice.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockLevel {
    /// The block's rays: 32 × 32, fewer where the lattice ends.
    pub rays: Lattice,
    /// Nodes whose children's boxes were tested, the list's sub-trees in pairs among them.
    pub nodes: u64,
    /// Triangles of the leaves that its walk came to.
    pub reached: Vec<u32>,
    /// Those of them that were set up, or met as ones of few rays: not outside of all rays, not surely
    /// behind what was met.
    pub set_up: Vec<u32>,
    /// Those that a ray meets first.
    pub seen: Vec<u32>,
}

impl Accel {
    /// What [`Accel::find`] goes through for these rays, large block by large block, row by row. Each
    /// triangle seen was set up, or a ray that was left open and cast alone met it; each set up was
    /// reached; each reached was listed; and what was not listed, no ray meets.
    ///
    /// The same for every instruction set. It takes longer than finding: it is there for pictures and
    /// tables of the way.
    pub fn levels(&self, lattice: &Lattice, cull: Cull) -> Vec<Levels> {
        let mut levels = Vec::new();
        Tell {
            accel: self,
            lattice,
            cull,
            levels: &mut levels,
        }
        .run(Plain);
        levels
    }
}

#[derive(Default)]
struct Noted {
    reached: Vec<u32>,
    set_up: Vec<u32>,
}

impl Notice for Noted {
    fn reached(&mut self, slots: Range<u32>) {
        self.reached.extend(slots);
    }

    fn set_up(&mut self, slots: &[u32]) {
        self.set_up.extend(slots);
    }
}

struct Tell<'a> {
    accel: &'a Accel,
    lattice: &'a Lattice,
    cull: Cull,
    levels: &'a mut Vec<Levels>,
}

impl Work for Tell<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self {
            accel,
            lattice,
            cull,
            levels,
        } = self;
        let whole = Part {
            column: 0,
            row: 0,
            columns: lattice.columns,
            rows: lattice.rows,
        };
        let mut slots = vec![MISS; lattice.len()];
        let mut find = Find {
            accel,
            lattice,
            cull,
            precision: Precision::Exact,
            slots: &mut slots,
            counts: &mut CastCounts::default(),
        };
        let mut walk = Walk::new(accel, lattice);
        let mut block = Block::new();
        for large in whole.split(LARGE_SIDE) {
            let before = walk.counts.nodes;
            walk.list(lanes, &large);
            let mut level = Levels {
                rays: rays(lattice, &large),
                nodes: walk.counts.nodes - before,
                list: Vec::with_capacity(walk.list.len()),
                blocks: Vec::new(),
            };
            for &(subtree, bounds, _) in &walk.list {
                level.list.push(Listed {
                    bounds: Bounds {
                        min: accel.origin + bounds.min.as_dvec3(),
                        max: accel.origin + bounds.max.as_dvec3(),
                    },
                    slots: subtree.slots().collect(),
                });
            }
            if !level.list.is_empty() {
                for part in large.split(SIDE as u32) {
                    let mut noted = Noted::default();
                    let before = walk.counts.nodes;
                    if walk.cast(lanes, &part, cull, &mut block, &mut noted) {
                        find.keep(&part, &block);
                    }
                    let seen = places(lattice, &part).map(|at| find.slots[at]);
                    level.blocks.push(BlockLevel {
                        rays: rays(lattice, &part),
                        nodes: walk.counts.nodes - before,
                        reached: ascending(noted.reached),
                        set_up: ascending(noted.set_up),
                        seen: ascending(seen.filter(|&slot| slot != MISS).collect()),
                    });
                }
            }
            levels.push(level);
        }
    }
}

/// A part's rays as a lattice of their own.
fn rays(lattice: &Lattice, part: &Part) -> Lattice {
    Lattice {
        x: lattice.x + part.column * lattice.stride,
        y: lattice.y + part.row * lattice.stride,
        columns: part.columns,
        rows: part.rows,
        ..*lattice
    }
}

/// Where a part's rays are among the lattice's.
fn places(lattice: &Lattice, part: &Part) -> impl Iterator<Item = usize> {
    let (part, columns) = (*part, lattice.columns);
    (part.row..part.row + part.rows).flat_map(move |row| {
        (part.column..part.column + part.columns)
            .map(move |column| row as usize * columns as usize + column as usize)
    })
}

fn ascending(mut slots: Vec<u32>) -> Vec<u32> {
    slots.sort_unstable();
    slots.dedup();
    slots
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Rect;
    use crate::packet::cast_tests::{cameras, waves};
    use crate::triangle::{Nearest, PreparedRay};
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
            .map(move |camera| Lattice::new(camera, rect, 1, (0, 0)))
    }

    fn holds(outer: &[u32], inner: &[u32]) -> bool {
        inner.iter().all(|slot| outer.binary_search(slot).is_ok())
    }

    #[test]
    fn levels_are_what_finding_goes_through() {
        for (size, offset) in [
            (1.0, DVec3::ZERO),
            (30.0, DVec3::new(148376.0, 1234.0, -223423.0)),
        ] {
            let accel = waves(40, size, offset);
            let (mut seen, mut spared) = (0, 0);
            for lattice in lattices(size, offset) {
                for cull in [Cull::None, Cull::Back] {
                    let mut slots = Vec::new();
                    let counts = accel.find(&lattice, cull, Precision::Exact, &mut slots);
                    let levels = accel.levels(&lattice, cull);
                    let blocks = || levels.iter().flat_map(|large| &large.blocks);
                    let nodes = levels.iter().map(|large| large.nodes).sum::<u64>()
                        + blocks().map(|block| block.nodes).sum::<u64>();
                    let set_up = blocks().map(|block| block.set_up.len()).sum::<usize>();
                    assert_eq!(nodes, counts.nodes);
                    assert_eq!(set_up as u64, counts.triangles);
                    for large in &levels {
                        let listed = large.list.iter().flat_map(|listed| listed.slots.clone());
                        let listed = ascending(listed.collect());
                        spared += accel.len() - listed.len();
                        for block in &large.blocks {
                            let part = Part {
                                column: block.rays.x - lattice.x,
                                row: block.rays.y - lattice.y,
                                columns: block.rays.columns,
                                rows: block.rays.rows,
                            };
                            let found = places(&lattice, &part).map(|at| slots[at]);
                            let found = found.filter(|&slot| slot != MISS).collect();
                            assert_eq!(block.seen, ascending(found));
                            // Only where all rays of a sub-block are left open may it be otherwise.
                            assert!(holds(&block.set_up, &block.seen));
                            assert!(holds(&block.reached, &block.set_up));
                            assert!(holds(&listed, &block.reached));
                            seen += block.seen.len();
                        }
                    }
                }
            }
            assert!(seen > 1000 && spared > 1000, "{seen} {spared}");
        }
    }

    #[test]
    fn no_ray_meets_what_is_not_listed_and_none_first_what_is_not_reached() {
        let accel = waves(12, 1.0, DVec3::ZERO);
        let all = accel.len() as u32;
        for lattice in lattices(1.0, DVec3::ZERO) {
            for large in accel.levels(&lattice, Cull::None) {
                for listed in &large.list {
                    for &slot in &listed.slots {
                        for corner in accel.corners(slot) {
                            let corner = corner.as_dvec3();
                            let Bounds { min, max } = listed.bounds;
                            assert!(min.cmple(corner).all() && corner.cmple(max).all());
                        }
                    }
                }
                let listed = large.list.iter().flat_map(|listed| listed.slots.clone());
                let listed = ascending(listed.collect());
                for place in (0..large.rays.len() as u32).step_by(3) {
                    let columns = large.rays.columns;
                    let (column, row) = (place % columns, place / columns);
                    let ray = large.rays.ray(column, row);
                    let prepared =
                        PreparedRay::new(&ray, accel.origin, Cull::None, Precision::Exact)
                            .expect("a ray");
                    for slot in (0..all).filter(|slot| listed.binary_search(slot).is_err()) {
                        let mut nearest = Nearest::NONE;
                        accel.meet(&prepared, slot, &mut nearest);
                        assert!(nearest.is_miss(), "{slot} {column} {row}");
                    }
                    let mut nearest = Nearest::NONE;
                    for slot in 0..all {
                        accel.meet(&prepared, slot, &mut nearest);
                    }
                    if nearest.is_miss() {
                        continue;
                    }
                    let side = SIDE as u32;
                    let at = row / side * columns.div_ceil(side) + column / side;
                    let block = &large.blocks[at as usize];
                    assert!(holds(&block.reached, &[nearest.slot]));
                    assert!(holds(&block.seen, &[nearest.slot]));
                }
            }
        }
    }

    #[test]
    fn nothing_has_no_list() {
        let accel = waves(0, 1.0, DVec3::ZERO);
        for lattice in lattices(1.0, DVec3::ZERO).take(1) {
            for large in accel.levels(&lattice, Cull::None) {
                assert_eq!(
                    (large.nodes, large.list.len(), large.blocks.len()),
                    (0, 0, 0)
                );
            }
        }
    }
}
