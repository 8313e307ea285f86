//! Entry points: the subtrees from which a large packet's packets start (Reshetov, Soupikov, Hurley, "Multi-Level Ray
//! Tracing Algorithm", 2005).

use super::Traversal;
use crate::bvh::tree::{Box32, BoxPair, Subtree};
use crate::camera::Camera;
use crate::num::simd::Lanes;
use crate::packet::depth_reference::DepthReference;
use crate::packet::frustum::{Frustum, Window};
use crate::packet::ray_rect::RayRect;
use glam::{DVec3, Vec3};

/// The number of entry points at which a large packet's descent ends. With fewer its packets repeat the upper levels
/// of the tree; with more each packet tests subtrees that it misses.
const MAX_ENTRY_POINTS: usize = 24;

/// Fills the last pair where the number of entry points is odd: an empty leaf whose box is outside every frustum,
/// since its least corner is above its greatest (both finite, since planes multiply them by zero). Where a frustum's
/// own numbers overflow, with an eye 1e150 away, every box may count as inside.
const NOTHING: (Box32, Subtree) = (
    Box32 {
        min: Vec3::MAX,
        max: Vec3::MIN,
    },
    Subtree::leaf(0, 0),
);

/// Two entry points.
pub(super) struct EntryPair {
    pub(super) boxes: BoxPair,
    pub(super) subtrees: [Subtree; 2],
    /// Where the nearer one begins along the view axis.
    pub(super) near: f32,
}

impl<const INSTANCES: bool> Traversal<'_, INSTANCES> {
    /// Finds the entry points of a large packet.
    #[inline(always)]
    pub(in crate::packet) fn find_entry_points(&mut self, lanes: impl Lanes, large: &RayRect) {
        let frustum = self.frustum(large);
        let camera = &self.lattice.camera;
        self.find_entry_points_in(lanes, &frustum, camera);
    }

    /// Finds the entry points of a frustum of a camera.
    #[inline(always)]
    fn find_entry_points_in(&mut self, lanes: impl Lanes, frustum: &Frustum, camera: &Camera) {
        let tree = &self.accel.tree;
        self.entry_points.clear();
        self.pairs.clear();
        let Some(root) = tree.root else { return };
        self.entry_points
            .push((root, tree.bounds, f32::NEG_INFINITY));
        let mut deepened = true;
        while deepened && self.entry_points.len() < MAX_ENTRY_POINTS {
            deepened = false;
            self.next.clear();
            for &(subtree, bounds, near) in &self.entry_points {
                let Some(index) = subtree.node() else {
                    self.next.push((subtree, bounds, near));
                    continue;
                };
                deepened = true;
                self.counts.nodes += 1;
                let mut opened = None;
                let (boxes, children) = self.accel.open::<INSTANCES>(index, &mut opened);
                let entered = frustum.enter(lanes, boxes);
                for (child, (near, inside)) in entered.into_iter().enumerate() {
                    if inside && !self.removes(boxes, child) {
                        self.next.push((children[child], boxes.get(child), near));
                    }
                }
            }
            std::mem::swap(&mut self.entry_points, &mut self.next);
        }
        // Fast casting uses no reference: it leaves undecided orders to rounding.
        if self.decisions.are_exact() {
            let boxes = self.entry_points.iter().map(|entry| entry.1);
            self.reference = DepthReference::of(boxes, camera, self.eye);
        }
        self.entry_points
            .sort_unstable_by(|a, b| a.2.total_cmp(&b.2));
        for pair in self.entry_points.chunks(2) {
            let (subtree, first, near) = pair[0];
            let (second, beside) = pair.get(1).map_or(NOTHING, |second| (second.1, second.0));
            self.pairs.push(EntryPair {
                boxes: BoxPair::of([first, second]),
                subtrees: [subtree, beside],
                near,
            });
        }
    }

    /// Finds the entry points of a large packet whose packets share a view, from the rays through a window of it.
    /// Returns whether there are any.
    #[inline(always)]
    pub(in crate::packet) fn find_entry_points_through(
        &mut self,
        lanes: impl Lanes,
        view: &Camera,
        window: &Window,
    ) -> bool {
        let frustum = Frustum::new(self.seen_from(view), window);
        self.find_entry_points_in(lanes, &frustum, view);
        !self.entry_points.is_empty()
    }

    /// Finds the entry points of a large packet of a panorama that looks along an axis in world space, within a cone
    /// of this tangent; without a known cone, the whole tree. Returns whether there are any.
    #[inline(always)]
    pub(in crate::packet) fn find_entry_points_around(
        &mut self,
        lanes: impl Lanes,
        cone: Option<(DVec3, f64)>,
    ) -> bool {
        let tree = &self.accel.tree;
        let Some(root) = tree.root else { return false };
        if let Some((axis, tangent)) = cone {
            let view = Camera::along(axis);
            let window = Window {
                across: (-tangent, tangent),
                along: (-tangent, tangent),
            };
            let frustum = Frustum::new(self.seen_from(&view), &window);
            self.find_entry_points_in(lanes, &frustum, &view);
        } else {
            self.entry_points.clear();
            self.pairs.clear();
            self.entry_points
                .push((root, tree.bounds, f32::NEG_INFINITY));
            self.pairs.push(EntryPair {
                boxes: BoxPair::of([tree.bounds, NOTHING.0]),
                subtrees: [root, NOTHING.1],
                near: f32::NEG_INFINITY,
            });
        }
        // Each packet has a view axis of its own, so depths along the large packet's axis do not apply.
        for pair in &mut self.pairs {
            pair.near = f32::NEG_INFINITY;
        }
        !self.entry_points.is_empty()
    }
}
