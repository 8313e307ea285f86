//! A packet's descent through the tree: the stack of subtrees, and the depths beyond which everything is occluded.

use crate::bvh::tree::{BoxPair, DEPTH_LIMIT, Subtree};
use crate::camera::{Lattice, Projection};
use crate::packet::frustum::{CellFrusta, Frustum};
use std::ops::Range;

/// The most triangles of a subtree with a small box that is treated as a leaf. With more, triangles are projected that
/// its nodes would cull; with fewer, visiting nodes takes longer than projecting the triangles that they cull.
const SMALL_COUNT: u32 = 32;

/// The largest size of a small box, the sum of its three sides, in columns. With a larger limit, triangles beside the
/// packet of 32 columns are projected that nodes would cull; with a smaller one, nodes are visited that cull few.
const SMALL_SIZE: f64 = 16.0;

/// The greatest depth of the stack: a pair of entry points, one more subtree a level below, and the entry above the
/// top that is written without a branch.
const STACK: usize = DEPTH_LIMIT + 3;

/// How far along the view axis a box may begin and still contain a closest hit.
#[derive(Clone, Copy)]
pub(super) struct DepthLimits {
    /// For any ray of the packet.
    pub(super) furthest: f32,
    /// For every ray of some cell: a box beyond it is occluded in at least one cell.
    pub(super) nearest_cell: f32,
}

/// The state of a packet's descent through the tree.
pub(super) struct Descent {
    pub(super) frustum: Frustum,
    pub(super) small: SmallBoxes,
    pub(super) limits: DepthLimits,
    /// The number of nodes so far whose children may be occluded in all cells that they touch.
    pub(super) doubtful: usize,
    /// The frusta of the cells, once they save more than they cost.
    pub(super) cells: Option<CellFrusta>,
    /// Subtrees to visit, the nearest on top, and where each begins along the view axis.
    pub(super) stack: [(Subtree, f32); STACK],
    pub(super) depth: usize,
    /// The next pair of entry points.
    pub(super) pair: usize,
    /// The rest of the leaf that was reached.
    pub(super) leaf: Range<u32>,
    /// Whether small triangles were merged since hi-z was updated.
    pub(super) merged_small: bool,
}

impl Descent {
    #[inline(always)]
    pub(super) fn new(frustum: Frustum, small: SmallBoxes) -> Self {
        Self {
            frustum,
            small,
            limits: DepthLimits {
                furthest: f32::INFINITY,
                nearest_cell: f32::INFINITY,
            },
            doubtful: 0,
            cells: None,
            stack: [(Subtree::default(), 0.0); STACK],
            depth: 0,
            pair: 0,
            leaf: 0..0,
            merged_small: false,
        }
    }

    /// Pushes those of two children that are hit, the nearer one on top. Without a branch: a child that is missed is
    /// written above the top.
    #[inline(always)]
    pub(super) fn push(
        &mut self,
        [(a, near_a, a_hit), (b, near_b, b_hit)]: [(Subtree, f32, bool); 2],
    ) {
        let b_nearer = near_b < near_a;
        let a_above = if b_nearer { !a_hit } else { b_hit };
        let b_above = if b_nearer { a_hit } else { !b_hit };
        self.stack[self.depth + usize::from(a_above)] = (a, near_a);
        self.stack[self.depth + usize::from(b_above)] = (b, near_b);
        self.depth += usize::from(a_hit) + usize::from(b_hit);
    }
}

/// The size below which boxes count as small: a limit on the sum of their sides, linear in where they begin along the
/// view axis.
pub(super) struct SmallBoxes {
    slope: f32,
    constant: f32,
}

impl SmallBoxes {
    /// For the packets of a lattice.
    pub(super) fn new(lattice: &Lattice) -> Self {
        let camera = &lattice.camera;
        let side = (SMALL_SIZE * camera.plane().step * f64::from(lattice.stride)) as f32;
        match camera.projection() {
            Projection::Perspective | Projection::Panoramic(_) => Self {
                slope: side / camera.distance() as f32,
                constant: 0.0,
            },
            Projection::Orthographic => Self {
                slope: 0.0,
                constant: side,
            },
        }
    }

    /// The subtree, or a leaf of all its triangles if its box is small.
    #[inline(always)]
    pub(super) fn leaf_if_small(
        &self,
        boxes: &BoxPair,
        which: usize,
        near: f32,
        subtree: Subtree,
    ) -> Subtree {
        let extent = |axis: usize| boxes.max[axis][which] - boxes.min[axis][which];
        let small = extent(0) + extent(1) + extent(2) < near * self.slope + self.constant;
        if small & (subtree.count <= SMALL_COUNT) {
            subtree.as_leaf()
        } else {
            subtree
        }
    }
}
